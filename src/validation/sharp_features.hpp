// SPDX-License-Identifier: Apache-2.0
// Where the input is acute: features that meet at less than a right angle.
#pragma once

#include <vector>

#include "validation/report.hpp"
#include "validation/rounding.hpp"
#include "validation/valid_plc.hpp"

namespace wellmesh {

/// Lists, sorted by angle, every vertex at which two segments, or a segment and a facet that does not contain it, meet at less than 90
/// degrees (the smallest angle there), and every segment at which two facets do. Angles outside of the filled cells count, too: they
/// matter for conformity. Right angles stay right angles when rounding has bent them: an angle must fall short of 90 degrees by more
/// than rounding can explain, e / l for each of its sides, e the displacement of a vertex and l the extent of the side.
///
/// Each feature is also reported, as a warning that says whether the angle lies in a filled cell (facets only).
/// Near-linear in the number of features at a vertex as long as angles there are not all about equal and large.
[[nodiscard]] std::vector<AcuteFeature> find_sharp_features(const ValidPlc& plc, const Rounding& rounding, Report& report);

}  // namespace wellmesh
