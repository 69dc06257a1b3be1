// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "predicates/four_inspheres.hpp"

namespace wellmesh {

/// signs[i] is 1 or -1, the sign of the insphere determinant of tets[i] and e, or 0 if that is as good as zero for double-doubles: most that are not zero, however flat
/// the tetrahedron, but for ties. Four at once take little more time than one.
/// @pre has_insphere_lanes(); coordinates are in the exact range; there is room for three signs more; there is a tetrahedron
void insphere_signs_of_records(PointRecords points, std::span<const RecordNumbers> tets, const Vec3& e, double* signs) noexcept;

}  // namespace wellmesh
