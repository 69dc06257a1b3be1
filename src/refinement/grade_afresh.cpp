// SPDX-License-Identifier: Apache-2.0
// Edges that an acute angle makes short are graded out of, and where a ball that stays empty is in the way of that, tetrahedra are left which nothing
// acute excuses. There the grading is taken back: what touches the acute feature stays as it is, and what lies around it is filled once more.
#include <algorithm>

#include "conforming/place_point.hpp"
#include "core/vec3_math.hpp"
#include "quality/tet_shape.hpp"
#include "refinement/refine.hpp"

namespace wellmesh {
namespace {

constexpr double kReach = 3;  // in radii of the ball: no cell that is not incident to its vertex comes nearer
constexpr std::size_t kMostTets = 200;  // of a star: filling the hole costs the square

}  // namespace

/// The ball that keeps the tetrahedron's splitting point, or that of the boundary which that encroaches, from being inserted.
VertexId Refiner::refusing_ball(TetId t) {
    const auto& k = mesh_.tets().corners(t);
    const Vec3 centre = flush_to_exact_range(circumcentre(mesh_.point(k[0]), mesh_.point(k[1]), mesh_.point(k[2]), mesh_.point(k[3])));
    if (!in_exact_range(centre) || !mesh_.triangulation().find_conflict_cavity(centre, t, cavity_)) return {};
    if (const VertexId v = boundary_.ball_around(cavity_); v.valid()) return v;
    boundary_.find_encroached(cavity_, Placement::in_cell(mesh_.cell(t)), encroached_segments_, encroached_faces_);
    if (!encroached_segments_.empty()) return boundary_.ball_holding(longest_of(mesh_, encroached_segments_));
    if (encroached_faces_.empty()) return {};
    double depth = 0;
    return boundary_.ball_holding(Subface{holder_of_projection(mesh_, encroached_faces_, centre, depth)});
}

bool Refiner::is_relieved(TetId t) const {
    return std::any_of(relieved_.begin(), relieved_.end(), [&](VertexId v) {
        const double reach = kReach * boundary_.acute().ball_radius(v);
        const auto& c = mesh_.tets().corners(t);
        return std::any_of(c.begin(), c.end(), [&](VertexId w) { return squared_distance(mesh_.point(w), mesh_.point(v)) < reach * reach; });
    });
}

/// Takes out the vertices inside the domain that are within reach of the ball about v.
void Refiner::clear_around(VertexId v) {
    const double reach = kReach * boundary_.acute().ball_radius(v);
    std::vector<VertexId> near{v};
    std::unordered_set<std::uint32_t> seen{v.value()};
    std::vector<TetId> star;
    for (std::size_t i = 0; i < near.size(); ++i) {
        mesh_.triangulation().find_star(near[i], star);
        for (const TetId t : star)
            for (const VertexId w : mesh_.tets().corners(t))
                if (w != kInfiniteVertex && squared_distance(mesh_.point(w), mesh_.point(v)) < reach * reach && seen.insert(w.value()).second) near.push_back(w);
    }
    Hole hole;
    for (const VertexId w : near)
        if (mesh_.info(w).carrier == CarrierKind::region && mesh_.triangulation().find_hole(w, hole, kMostTets)) mesh_.remove(hole);
}

RunGuard::Verdict Refiner::grade_afresh(const std::vector<TetId>& stuck) {
    std::vector<VertexId> balls;
    for (const TetId t : stuck)
        if (const VertexId v = refusing_ball(t); v.valid() && std::find(balls.begin(), balls.end(), v) == balls.end()) balls.push_back(v);
    for (const VertexId v : balls) {
        // A second time in the way: it is too large for what lies around it, whatever that is.
        if (std::find(relieved_.begin(), relieved_.end(), v) == relieved_.end()) relieved_.push_back(v);
        else boundary_.acute().halve_ball(v);
        clear_around(v);
    }
    if (balls.empty()) return RunGuard::Verdict::go_on;
    enqueue_all();
    squared_size_slack_ = kSizeTolerance * kSizeTolerance;
    const RunGuard::Verdict verdict = drain();
    squared_size_slack_ = 1;
    return verdict;
}

}  // namespace wellmesh
