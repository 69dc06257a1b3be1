// SPDX-License-Identifier: Apache-2.0
// What the formats of complexes can state.
#pragma once

#include <cstddef>
#include <limits>
#include <string_view>

#include "io/atomic_file.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh::io {

struct PlcFormat {
    std::string_view extension;
    std::size_t most_corners;  ///< of a facet, which is one polygon; 0: facets may be anything
    void (*write)(const Plc&, OutputFile&);  ///< null: depends on options
    bool facet_markers, segments, segment_markers, points, vertex_markers, seeds, facet_names, segment_names, vertex_names;
    bool bounded_cells;  ///< read as a complex whose every bounded cell is filled; else by its winding number
};

/// Null if there is no such format.
[[nodiscard]] const PlcFormat* find_plc_format(std::string_view extension);

}  // namespace wellmesh::io
