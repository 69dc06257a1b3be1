// SPDX-License-Identifier: Apache-2.0
// Keeps the boundary: no vertex may come into conflict with the smallest sphere orthogonal to a subface or subsegment ("weighted Gabriel").
//
// While that holds, every subface and subsegment is in the weighted Delaunay triangulation of all vertices, whatever lies on its other side,
// and so the tetrahedra in conflict with a vertex of the domain are those that it reaches without crossing a subface. A weight w of p
// moves the spheres of its own subfaces, and puts p into others; all conditions are affine in w, so each gives a limit.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "exudation/weighted_mesh.hpp"
#include "validation/box_tree.hpp"

namespace wellmesh {

class BoundarySpheres {
public:
    /// @param reach  the largest weight that each vertex will ever have.
    BoundarySpheres(const WeightedMesh& mesh, const TetMesh& lists, const std::vector<double>& reach);
    BoundarySpheres(const BoundarySpheres&) = delete;
    BoundarySpheres& operator=(const BoundarySpheres&) = delete;

    /// The largest weight of p, up to its reach and up to rounding, for which the boundary stays. Less than its present one if it has none to spare.
    [[nodiscard]] double limit(VertexId p) const;

    /// Exact: would the boundary stay if p had this weight?
    [[nodiscard]] bool allows(VertexId p, double weight) const;

private:
    /// A subface, or a subsegment (the third corner repeats the second).
    using Constraint = std::array<VertexId, 3>;
    struct Sphere {
        Vec3 base, offset;  // of the centre from the base, a corner
        double base_weight = 0;
        [[nodiscard]] double power(const Vec3& p) const;
    };
    static bool is_segment(const Constraint& c) { return c[1] == c[2]; }
    static bool has(const Constraint& c, VertexId v) { return c[0] == v || c[1] == v || c[2] == v; }
    [[nodiscard]] Sphere sphere(const Constraint& c, const std::array<double, 3>& weights) const;
    [[nodiscard]] Sphere sphere_with(const Constraint& c, VertexId p, double weight) const;
    [[nodiscard]] Box reachable_box(const Constraint& c) const;
    [[nodiscard]] bool conflicts(const Constraint& c, VertexId p, double weight, VertexId q) const;

    /// Calls visit(constraint, vertex) for a superset of the pairs in which a weight of p can make the vertex conflict.
    template <class Visit>
    void for_pairs(VertexId p, Visit&& visit) const;

    const WeightedMesh& mesh_;
    const std::vector<double>& reach_;
    std::vector<Constraint> constraints_;
    std::vector<std::uint32_t> first_, own_;  // constraints of each vertex
    std::vector<Box> sphere_boxes_, vertex_boxes_;
    BoxTree spheres_, vertices_;
};

}  // namespace wellmesh
