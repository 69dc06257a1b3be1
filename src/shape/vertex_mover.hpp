// SPDX-License-Identifier: Apache-2.0
// Moves one vertex along its carrier, or takes it out. The vertex is taken out of the triangulation once; every candidate is judged by its
// cavity there and nothing is inserted for a trial, so the triangulation stays Delaunay, and a candidate that would leave anything encroached
// is refused, so it stays Gabriel.
//
// Sampled relocation in the spirit of [Tournois09] and [EdelsbrunnerEtAl00]; the optimal-Delaunay point is [ChenXu04]'s: the mean of the
// circumcentres of the star, weighted by volume. On a facet or segment it is projected: by reflection the tangential part is the same.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "shape/change_log.hpp"
#include "shape/tet_judge.hpp"

namespace wellmesh {

class StarJudge;

struct MoveStatistics {
    std::uint64_t moves = 0, smoothings = 0, removals = 0, attempts = 0, evaluations = 0, undone = 0;
};

class VertexMover {
public:
    VertexMover(ConformingMesh& mesh, BoundaryRefiner& boundary, const TetJudge& judge, std::uint64_t seed)
        : mesh_(mesh), boundary_(boundary), judge_(judge), seed_(seed) {}

    /// For a view of a zone of the mesh. If a move fails there because it would have left the zone, the view says so.
    [[nodiscard]] VertexMover for_zone(ConformingMesh& view, BoundaryRefiner& boundary, const TetJudge& judge);
    /// Takes the zone's counts over.
    void join(const VertexMover& zone);

    /// Moves v so that the worst tetrahedron of its star gets better, to the first place found that reaches `goal`, or the best.
    /// @param worst  a tetrahedron of the star that is to be mended. @return was it moved?
    bool move(VertexId v, TetId worst, double goal, unsigned samples);
    /// Propose steps along the gradients of [Tournois09], too: the squared circumradius of the worst tetrahedron, so that its sphere comes to
    /// swallow a neighbour and it is flipped away, and its volume, down as well as up.
    void follow_gradients(bool on) { follow_gradients_ = on; }
    /// Moves v to its optimal-Delaunay point, or half the way, if nothing gets worse than `floor` or than the star is now.
    bool smooth(VertexId v, double floor);
    /// Takes v out if what fills the hole is at least as good as `limit`, or better than the star was.
    bool remove(VertexId v, double limit);

    /// Tetrahedra that an acute angle of the input forces: no change has to mend them, nor may it make them worse. Empty: there are none.
    std::function<bool(TetId)> excuses{};
    /// Moves, too? That takes more trials: without, only removals look for what is excused.
    void move_beside_excused(bool yes) { beside_excused_ = yes; }

    /// Takes v out if the mesh conforms without it, whatever its shape and even if something is encroached then. For chains of changes, which
    /// look at that in the end.
    bool drop(VertexId v);
    /// Would remove() have taken out what drop() just has?
    [[nodiscard]] bool fits_without(double limit) const;
    /// Moves v part of the way to `target`, to where its star is best, if nothing of it is worse than `limit`.
    bool pull(VertexId v, const Vec3& target, double limit);
    /// Where changes are noted while it is open.
    [[nodiscard]] ChangeLog& log() { return log_; }

    /// Tetrahedra that the last success made; some ids may be dead.
    [[nodiscard]] const std::vector<TetId>& changed() const { return changed_; }
    [[nodiscard]] const MoveStatistics& statistics() const { return statistics_; }

private:
    struct Candidate {
        Vec3 point{};
        double cosine = 0;
    };

    bool look_at_star(VertexId v);
    bool take_out();
    void judge_filling();
    void put_back();
    bool put_best(double limit, std::size_t trials);
    void note(bool removed);
    bool put(const Vec3& p, double judged, double limit);
    void propose(TetId worst, unsigned samples);
    void propose_gradients(TetId worst, double reach);
    [[nodiscard]] bool is_flat_at_acute() const;
    void offer(const Vec3& offset, double reach);
    [[nodiscard]] bool find_placement();
    [[nodiscard]] std::uint32_t count_attempt();
    [[nodiscard]] Vec3 on_carrier(const Vec3& p) const;
    /// Cosine of the star that p would get, more than `limit` as soon as that is certain, infinite if p is not to be had. Leaves p's cavity.
    [[nodiscard]] double try_point(const Vec3& p, double limit);
    [[nodiscard]] TetId conflicting_tet(const Vec3& p, double limit);
    [[nodiscard]] bool fails_like_others(StarJudge& star, const Vec3& p);
    void note_failure(const BoundaryFace& face);
    [[nodiscard]] bool encroaches_nothing();
    [[nodiscard]] bool fits(double limit, bool is_judged = false) const;
    [[nodiscard]] double unexcused_star_cosine(double goal) const;

    ConformingMesh& mesh_;
    BoundaryRefiner& boundary_;
    const TetJudge& judge_;
    std::uint64_t seed_;
    SharedArray<std::uint32_t> attempts_;  // at each vertex
    ChangeLog log_;
    bool follow_gradients_ = false, beside_excused_ = false;

    // The vertex at hand.
    VertexId vertex_{};
    Placement where_{};
    Vec3 home_{}, optimal_{}, middle_{};  // offsets from home: optimal-Delaunay point, mean of the neighbours
    double star_cosine_ = 0, mean_edge_ = 0;

    Hole hole_;
    Cavity cavity_;
    ConformingMesh::Snapshot star_before_, cavity_before_;
    std::vector<Vec3> proposals_;
    std::vector<Candidate> ranked_;
    std::vector<BoundaryFace> failures_;  // on which candidates for the hole failed, the latest first
    std::vector<TetId> filling_, changed_;
    std::vector<double> filling_cosine_;
    std::size_t worst_filling_ = 0;
    std::vector<Subsegment> encroached_segments_;
    std::vector<Subface> encroached_faces_;
    MoveStatistics statistics_;
};

/// Steps smaller than this gain in cosine are no progress.
inline constexpr double kWorthwhile = 1e-4;

}  // namespace wellmesh
