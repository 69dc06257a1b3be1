// SPDX-License-Identifier: Apache-2.0
// Sizes that are known at points: linear in the tetrahedra between them.
#pragma once

#include <cstdint>
#include <vector>

#include "validation/box_tree.hpp"
#include "wellmesh/background_mesh.hpp"

namespace wellmesh {

class NodalSizes {
public:
    /// @param background  must outlive this. @throws MeshError{bad_options} if its arrays don't fit together.
    explicit NodalSizes(const BackgroundMesh& background);
    NodalSizes(const NodalSizes&) = delete;
    NodalSizes& operator=(const NodalSizes&) = delete;

    /// Infinite where no tetrahedron is, and in those with a corner that asks for nothing.
    [[nodiscard]] double operator()(const Vec3& p) const;

private:
    /// Where p lies deeper in the tetrahedron than `depth`, both are its own then.
    void look_in(std::uint32_t tet, const Vec3& p, double& depth, double& size) const;

    const BackgroundMesh& background_;
    std::vector<Box> boxes_;
    BoxTree tree_;
};

/// Points with sizes, and the Delaunay tetrahedra between them: none if they lie in one plane.
[[nodiscard]] BackgroundMesh triangulate_sizes(const std::vector<Vec3>& points, const std::vector<double>& sizes);

}  // namespace wellmesh
