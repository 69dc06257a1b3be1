// SPDX-License-Identifier: Apache-2.0
// Delaunay refinement with sliver-aware points [LiTeng01, Shewchuk98]: every bad tetrahedron is split by a point of its picking region
// (the ball of radius delta R about its circumcentre), or, where its circumcentre encroaches a subsegment or subface, by a point of
// that one's picking region. The first candidate whose star holds no new sliver is taken.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "core/run_guard.hpp"
#include "refinement/bad_tet_queue.hpp"
#include "refinement/sizing.hpp"
#include "wellmesh/options.hpp"

namespace wellmesh {

struct RefineStatistics {
    std::uint64_t insertions = 0, candidates = 0, fallbacks = 0, guarded = 0;
};

class Refiner {
public:
    Refiner(ConformingMesh& mesh, BoundaryRefiner& boundary, RunGuard& guard, const MeshOptions& options);

    /// Splits until no tetrahedron of the domain violates its size or the radius-edge bound.
    /// @return what stopped it; the mesh conforms in any case.
    RunGuard::Verdict refine();
    /// Splits tetrahedron t with the cascade of refine(), then restores size and radius-edge bound in what that made; circumradii within
    /// kSizeTolerance of their bound stay, as moves may have made them.
    RunGuard::Verdict split(TetId t, InsertionReason reason);

    enum class Fault : std::uint8_t { none, size, radius_edge, flat };
    [[nodiscard]] Fault classify(TetId t, double& squared_badness) const;
    [[nodiscard]] const RefineStatistics& statistics() const { return statistics_; }
    [[nodiscard]] const std::vector<CellSize>& sizes() const { return sizes_; }
    /// Edges shorter than this are never made for quality [LiTeng01, Theorem 4.2].
    void set_shortest_edge(double length) { shortest_allowed_ = length; }
    [[nodiscard]] double max_radius_edge() const { return max_radius_edge_; }
    /// Cosine of the angle below which candidates are rejected; 1 or more: circumcentres only.
    void set_sliver_cosine(double cosine, unsigned candidates) {
        sliver_cosine_ = cosine;
        candidates_ = candidates;
        boundary_.candidates = candidates;
    }

private:
    RunGuard::Verdict drain();
    void enqueue(const std::vector<TetId>& tets);
    void enqueue_all();
    void process(TetId t, InsertionReason reason);
    void split_flat(TetId t);
    bool star_is_good(const Cavity& cavity, const Placement& where) const;
    [[nodiscard]] VertexId responsible_vertex(TetId t, InsertionReason reason) const;
    bool insert_in_cell(TetId t, const Vec3& centre, double radius, InsertionReason reason);

    ConformingMesh& mesh_;
    BoundaryRefiner& boundary_;
    RunGuard& guard_;
    std::vector<CellSize> sizes_;
    double max_radius_edge_, shortest_allowed_ = 0;
    double rounding_ = 0;  // input units: a tetrahedron this thin is flat
    double sliver_cosine_ = 2;
    double squared_size_slack_ = 1;
    unsigned candidates_ = 1;
    bool judging_ = false;
    BadTetQueue by_size_, by_radius_edge_;
    RefineStatistics statistics_;
    Cavity cavity_;
    std::vector<Subsegment> encroached_segments_;
    std::vector<Subface> encroached_faces_;
};

}  // namespace wellmesh
