// SPDX-License-Identifier: Apache-2.0
// The two-dimensional Delaunay triangulation of a facet's vertices, and which of its triangles are faces of the mesh.
#pragma once

#include <array>
#include <map>
#include <utility>
#include <vector>

#include "conforming/conforming_mesh.hpp"

namespace wellmesh {

/// The planar triangulation is the link of one apex point above the plane: the planar in-circle test is the in-sphere test of
/// tetrahedra with the apex, so the three-dimensional kernel serves, exact and with consistent ties.
class FacetDelaunay {
public:
    struct Missing {
        std::array<VertexId, 3> corners{};
    };

    /// @pre the facet's segments are chains of edges of the mesh: match_faces() tells inside from outside by them.
    FacetDelaunay(const ConformingMesh& mesh, FacetId f);

    /// Compares with the mesh. @return triangles that are covered by no faces of the mesh, largest first.
    std::vector<Missing> match_faces(ConformingMesh& mesh);
    /// After match_faces found nothing missing: faces that cover the facet.
    [[nodiscard]] const std::vector<TetFace>& faces() const { return faces_; }

private:
    using Triangle = std::array<std::uint32_t, 3>;  // local vertex numbers, counter-clockwise about the facet's normal
    struct InnerSides {
        Vec3 along{};  // from the segment's first end to its second, in the plane
        bool left = false, right = false;
    };
    void collect_vertices(const ConformingMesh& mesh);
    void triangulate();
    void keep_inside(const ConformingMesh& mesh);
    [[nodiscard]] SegmentId segment_between(VertexId a, VertexId b) const;
    [[nodiscard]] std::map<SegmentId, InnerSides> inner_sides(const ConformingMesh& mesh) const;
    bool cover(ConformingMesh& mesh, const std::vector<std::size_t>& cluster, std::vector<TetFace>& faces) const;
    [[nodiscard]] double area2(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;

    FacetId facet_;
    std::vector<VertexId> vertices_;
    std::vector<std::pair<std::array<VertexId, 2>, SegmentId>> subsegments_;  // ends ascending; sorted
    std::vector<Vec3> flat_;  // (u, v, 0)
    std::vector<Triangle> triangles_;
    std::vector<std::array<std::uint32_t, 3>> neighbours_;  // of each triangle, opposite its corners
    std::vector<TetFace> faces_;
    static constexpr std::uint32_t kNone = 0xffffffffU;
};

}  // namespace wellmesh
