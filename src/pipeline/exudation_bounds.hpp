// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "exudation/star_growth.hpp"
#include "sizing/size_field.hpp"
#include "validation/valid_plc.hpp"
#include "wellmesh/options.hpp"

namespace wellmesh {

/// Goals that the mesh has met stay met; sizes within the tolerance that moving vertices has, too.
/// @param sizes  must outlive the bounds
[[nodiscard]] ExudationBounds exudation_bounds(const MeshOptions& options, const ValidPlc& plc, const SizeField& sizes);

}  // namespace wellmesh
