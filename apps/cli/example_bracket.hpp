// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "wellmesh/plc.hpp"

namespace wellmesh::cli {

/// An angle bracket of two materials: a plate with two twelve-sided holes and an upright (region 1), and a bushing in one of
/// the holes that stands above the plate (region 2). Every angle between facets and between segments is at least 90 degrees.
[[nodiscard]] Plc example_bracket();

}  // namespace wellmesh::cli
