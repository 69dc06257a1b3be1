// SPDX-License-Identifier: Apache-2.0
// Extremes and histogram of shape over sets of tetrahedra.
#pragma once

#include "quality/tet_shape.hpp"
#include "wellmesh/certificate.hpp"

namespace wellmesh {

/// Adds tetrahedra one by one. Edge lengths are not its business.
class ShapeAccumulator {
public:
    void add(const TetShape& shape);
    /// All fields but the three of the edges. Without a tetrahedron every field is 0.
    [[nodiscard]] ShapeStatistics result() const;

private:
    ShapeStatistics extremes_;
};

}  // namespace wellmesh
