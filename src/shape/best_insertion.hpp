// SPDX-License-Identifier: Apache-2.0
// Insertion that never makes anything worse [LiTeng01, section 6]: the best of sampled points of the picking region of a tetrahedron, or of
// a subface or subsegment of it, taken only if its star is better than everything that it destroys and leaves nothing encroached.
#pragma once

#include <cstdint>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "shape/tet_judge.hpp"

namespace wellmesh {

class BestInsertion {
public:
    BestInsertion(ConformingMesh& mesh, BoundaryRefiner& boundary, const TetJudge& judge, std::uint64_t seed)
        : mesh_(mesh), boundary_(boundary), judge_(judge), seed_(seed) {}

    /// Replaces t by the star of a point inside its cell, else on one of its subfaces, else on one of its subsegments, in which nothing is
    /// worse than `limit`. @return the new vertex, or an invalid id.
    VertexId insert(TetId t, double limit);
    [[nodiscard]] const std::vector<TetId>& changed() const { return changed_; }
    [[nodiscard]] std::uint64_t count() const { return count_; }
    /// The same for a view of a zone, which it may leave: then nothing has changed.
    [[nodiscard]] BestInsertion for_zone(ConformingMesh& view, BoundaryRefiner& boundary, const TetJudge& judge) const { return {view, boundary, judge, seed_}; }
    void join(const BestInsertion& zone) {
        count_ += zone.count_;
        evaluations_ += zone.evaluations_;
    }
    [[nodiscard]] std::uint64_t evaluations() const { return evaluations_; }

private:
    VertexId insert_at(TetId t, const Placement& where, const Vec3& centre, double reach, unsigned samples, double limit);
    [[nodiscard]] Vec3 candidate(const Placement& where, const Vec3& centre, double reach, const Vec3& unit) const;

    ConformingMesh& mesh_;
    BoundaryRefiner& boundary_;
    const TetJudge& judge_;
    std::uint64_t seed_, count_ = 0, evaluations_ = 0;
    Cavity cavity_;
    ConformingMesh::Snapshot before_;
    std::vector<TetId> changed_;
    std::vector<Subsegment> encroached_segments_;
    std::vector<Subface> encroached_faces_;
};

}  // namespace wellmesh
