// SPDX-License-Identifier: Apache-2.0
// A finished mesh whose vertices get weights: its tetrahedra with neighbours, and what must not be crossed.
//
// Only the domain is here, no hull and no ghosts: subfaces stay where they are, so what lies beyond them never changes.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/ids.hpp"
#include "delaunay/tet_store.hpp"
#include "delaunay/triangulation.hpp"
#include "predicates/predicates.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

/// A face that every state of the mesh must have: on the hull, between two regions, or a listed subface.
using ConstraintFace = std::array<std::uint32_t, 3>;

class WeightedMesh {
public:
    /// Weights start at those of `mesh`, or at zero. @pre positive tetrahedra, of which no three share a face.
    explicit WeightedMesh(const TetMesh& mesh);

    [[nodiscard]] const TetStore& tets() const { return tets_; }
    [[nodiscard]] std::size_t vertex_count() const { return points_->size(); }
    [[nodiscard]] const Vec3& point(VertexId v) const { return (*points_)[v.index()]; }
    [[nodiscard]] double weight(VertexId v) const { return weights_[v.index()]; }
    [[nodiscard]] WeightedPoint weighted(VertexId v) const { return {point(v), weight(v)}; }
    [[nodiscard]] std::int32_t region(TetId t) const { return region_[t.index()]; }
    [[nodiscard]] bool is_constrained(TetFace f) const { return (unsigned{constrained_[f.tet().index()]} >> f.face() & 1U) != 0; }
    [[nodiscard]] const std::vector<ConstraintFace>& constraint_faces() const { return constraint_faces_; }
    [[nodiscard]] bool is_subsegment(VertexId a, VertexId b) const;

    /// All tetrahedra of v. @return false if some cannot be reached from others through faces: then the star is no ball.
    bool find_star(VertexId v, std::vector<TetId>& star) const;

    /// Gives v a weight and joins it to the faces `link` instead of to those of its star. The tetrahedra inside the faces are deleted.
    /// @param deleted  the star and what is absorbed. @param created  the new star.
    void replace_star(VertexId v, double weight, const std::vector<TetId>& deleted, const std::vector<BoundaryFace>& link,
                      std::vector<TetId>& created);

    /// Puts tetrahedra and weights into `mesh`, the one that this was made from; weights stay empty if all are zero.
    void write_to(TetMesh& mesh) const;

private:
    struct Side {
        std::array<std::uint32_t, 2> edge{};
        TetFace face{};
        bool constrained = false;
    };
    void connect_tets(const TetMesh& mesh);
    void constrain(const TetMesh& mesh);
    void collect_sides(VertexId v, TetId t);
    void connect_sides();
    void constrain(TetFace f) { constrained_[f.tet().index()] = static_cast<std::uint8_t>(constrained_[f.tet().index()] | 1U << f.face()); }

    const std::vector<Vec3>* points_;
    TetStore tets_;
    std::vector<std::int32_t> region_;       // of each tetrahedron
    std::vector<std::uint8_t> constrained_;  // a bit a face
    std::vector<double> weights_;
    std::vector<TetId> tet_of_;
    std::vector<std::uint32_t> degree_;  // tetrahedra of each vertex
    std::vector<ConstraintFace> constraint_faces_;
    std::vector<std::array<std::uint32_t, 2>> subsegments_;  // ascending
    std::vector<char> on_subsegment_;
    mutable std::vector<std::uint32_t> mark_;
    mutable std::uint32_t mark_value_ = 0;
    std::vector<Side> sides_;                             // scratch
    std::vector<std::array<std::uint32_t, 2>> rim_edges_;  // scratch: with v they make a constrained face
};

}  // namespace wellmesh
