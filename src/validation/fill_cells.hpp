// SPDX-License-Identifier: Apache-2.0
// Which cells are meshed, and under which region reference.
#pragma once

#include "validation/find_cells.hpp"
#include "validation/report.hpp"
#include "validation/rounding.hpp"
#include "validation/valid_plc.hpp"

namespace wellmesh {

/// Applies the fill rule, hole seeds and region seeds, numbers the remaining filled cells with unused positive references, and finds a
/// point inside each filled cell. A seed within the rounding of doubles of a facet lies on it: that would decide which cell it names. Reports seeds that are
/// outside, on a facet or in conflict, and domains without any filled cell; a seed as near a facet as the file's digits may be off is only warned of.
/// Under the winding rule, facets that cannot be oriented consistently (a note) fill every bounded cell.
[[nodiscard]] std::vector<ValidCell> fill_cells(const CleanInput& input, const Soup& soup, const CellMap& map, const LineQuery& lines, const Rounding& rounding, Report& report);

}  // namespace wellmesh
