// SPDX-License-Identifier: Apache-2.0
#include "exudation/exude.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <vector>

#include "core/vec3_math.hpp"
#include "exudation/boundary_spheres.hpp"
#include "exudation/weighted_mesh.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh {
namespace {

/// Largest weights: by the nearest vertex, which is joined to each in a Delaunay mesh (one beyond the boundary is kept off by it).
std::vector<double> largest_weights(const TetMesh& mesh) {
    std::vector<double> result(mesh.vertices.size(), std::numeric_limits<double>::infinity());
    for (const auto& tet : mesh.tets)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j) {
                const double d = kMaxWeightRatio * kMaxWeightRatio * squared_distance(mesh.vertices[tet[i]], mesh.vertices[tet[j]]);
                result[tet[i]] = std::min(result[tet[i]], d);
                result[tet[j]] = std::min(result[tet[j]], d);
            }
    for (double& w : result)
        if (std::isinf(w)) w = 0;
    return result;
}

class Exuder {
public:
    Exuder(TetMesh& mesh, double goal_deg, const ExudationBounds& bounds, RunGuard& guard)
        : goal_(std::cos(goal_deg * (std::numbers::pi / 180))), guard_(guard), reach_(largest_weights(mesh)), mesh_(mesh), boundary_(mesh_, mesh, reach_),
          growth_(mesh_, boundary_, reach_, bounds), stamp_(mesh_.tets().slots(), 0),
          changed_at_(mesh.vertices.size(), 0) {}

    ExudationReport run() {
        for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) offer(TetId{i});
        report_.slivers_before = queue_.size();
        bool progress = true;
        while (progress && report_.verdict == RunGuard::Verdict::go_on) {
            const std::uint64_t before = report_.changes;
            work_off();
            progress = report_.changes != before;
            std::vector<Sliver> waiting;
            for (const Sliver& s : stuck_)
                if (is_current(s)) (has_new_neighbours(s) ? queue_.push(s) : waiting.push_back(s));
            stuck_ = std::move(waiting);
        }
        for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) report_.slivers_after += mesh_.tets().is_live(TetId{i}) && growth_.cosine(TetId{i}) > goal_;
        for (std::size_t v = 0; v < mesh_.vertex_count(); ++v) report_.weighted_vertices += mesh_.weight(VertexId{v}) != 0;
        return report_;
    }
    void write_to(TetMesh& mesh) const { mesh_.write_to(mesh); }

private:
    struct Sliver {
        double cosine = 0;
        TetId tet{};
        std::uint32_t stamp = 0;
        std::uint64_t tried_at = 0;  ///< number of changes when nothing helped
        friend bool operator<(const Sliver& a, const Sliver& b) { return a.cosine != b.cosine ? a.cosine < b.cosine : a.tet > b.tet; }
    };

    bool is_current(const Sliver& s) const { return mesh_.tets().is_live(s.tet) && stamp_[s.tet.index()] == s.stamp; }

    void offer(TetId t) {
        const double cosine = growth_.cosine(t);
        if (cosine > goal_) queue_.push({cosine, t, stamp_[t.index()], 0});
    }

    void work_off() {
        while (!queue_.empty()) {
            report_.verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), queue_.size() + stuck_.size());
            if (report_.verdict != RunGuard::Verdict::go_on) return;
            Sliver s = queue_.top();
            queue_.pop();
            if (!is_current(s) || cure(s)) continue;
            s.tried_at = report_.changes;
            stuck_.push_back(s);
        }
    }

    /// Calls visit for the vertices whose weights may help: the corners and the apexes across unconstrained faces.
    template <class Visit>
    void for_helpers(TetId t, Visit&& visit) const {
        const TetStore& tets = mesh_.tets();
        for (unsigned i = 0; i < 4; ++i) visit(tets.corner(t, i));
        for (unsigned f = 0; f < 4; ++f) {
            const TetFace other = tets.across(t, f);
            if (other.valid() && !mesh_.is_constrained(other)) visit(tets.corner(other.tet(), other.face()));
        }
    }

    bool has_new_neighbours(const Sliver& s) const {
        bool found = false;
        for_helpers(s.tet, [&](VertexId v) { found = found || changed_at_[v.index()] > s.tried_at; });
        return found;
    }

    bool cure(const Sliver& s) {
        WeightChoice best;
        for_helpers(s.tet, [&](VertexId p) {
            const WeightChoice choice = growth_.best_weight(p, s.tet, s.cosine);
            if (choice.found() && (!best.found() || choice.cosine < best.cosine)) best = choice;
        });
        if (!best.found() || !growth_.apply(best, created_)) return false;
        ++report_.changes;
        for (const TetId t : created_) {
            if (t.index() >= stamp_.size()) stamp_.resize(t.index() + 1, 0);
            ++stamp_[t.index()];
            for (const VertexId v : mesh_.tets().corners(t)) changed_at_[v.index()] = report_.changes;
            offer(t);
        }
        return true;
    }

    double goal_;
    RunGuard& guard_;
    std::vector<double> reach_;
    WeightedMesh mesh_;
    BoundarySpheres boundary_;
    StarGrowth growth_;
    std::vector<std::uint32_t> stamp_;  // how often each slot was filled
    std::vector<std::uint64_t> changed_at_;  // number of the last change of each vertex's star
    std::priority_queue<Sliver> queue_;
    std::vector<Sliver> stuck_;
    std::vector<TetId> created_;
    ExudationReport report_;
};

}  // namespace

ExudationReport exude(TetMesh& mesh, double goal_deg, const ExudationBounds& bounds, RunGuard& guard) {
    Exuder exuder(mesh, goal_deg, bounds, guard);
    const ExudationReport report = exuder.run();
    exuder.write_to(mesh);
    return report;
}

}  // namespace wellmesh
