// SPDX-License-Identifier: Apache-2.0
// The order of the work: which tetrahedron comes next, and what ends it.
#include "refinement/refine.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "conforming/place_point.hpp"
#include "core/vec3_math.hpp"
#include "quality/shape_lanes.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh {
namespace {

/// About acute angles refinement leaves only what is directly forced until it has made so many vertices, then all that touches an acute feature.
constexpr double kGenerousGrowth = 3;
constexpr std::size_t kGenerousAllowance = 500;
constexpr unsigned kMostCascades = 16;

SizeFieldDomain sampled_domain(const ConformingMesh& mesh, RunGuard& guard, const Limits& limits) {
    const auto cell_at = [&mesh, near = TetId{}](const Vec3& p) mutable {
        near = mesh.triangulation().locate(p, near);
        return mesh.tets().is_finite(near) ? mesh.cell(near) : CellId{0};
    };
    return {cell_at, [&mesh, &guard] { return guard.poll(mesh.vertex_count(), mesh.tets().live(), 0) == RunGuard::Verdict::go_on; }, limits.max_vertices};
}

}  // namespace

Refiner::Refiner(ConformingMesh& mesh, BoundaryRefiner& boundary, RunGuard& guard, const MeshOptions& options, Workers* workers)
    : mesh_(mesh), boundary_(boundary), guard_(guard), workers_(workers ? *workers : alone_), exemptions_(mesh, boundary.acute()), shared_sizes_(std::make_shared<const SizeField>(mesh.plc(), options.size, sampled_domain(mesh, guard, options.limits))), sizes_(*shared_sizes_),
      max_radius_edge_(options.quality.max_radius_edge_ratio),
      max_vertices_(options.limits.max_vertices) {
    double largest = 0;
    for (const Vec3& p : mesh.plc().vertices) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    rounding_ = 64 * largest * 0x1p-53;  // heights of a few ulp
    boundary_.judge = [this](const Cavity& cavity, const Placement& where, double radius) { return !judging_ || accepts(cavity, where, radius); };
}

void Refiner::set_sliver_rule(const SliverRule& rule) {
    sliver_rule_ = rule;
    candidates_ = boundary_.candidates = rule.candidates;
}

void Refiner::guard_edges() {
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) {
        const TetId t{i};
        if (!mesh_.tets().is_finite(t) || !mesh_.in_domain(t)) continue;
        const auto& c = mesh_.tets().corners(t);
        shortest = std::min(shortest, shortest_edge_squared(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3])));
    }
    shortest = std::sqrt(shortest);
    // A tetrahedron too large has at least the bound for circumradius, or that of the regular one of the bound's volume. Its point makes edges of
    // (1 - delta) R; on what its centre encroaches, sqrt(1/2) less, twice (Lemma 2.5).
    shortest = std::min(shortest, (1 - boundary_.rules.delta) / 2 * kCircumradiusPerEdgeLength * sizes_.smallest());
    // One bound for all places: the finest one's edges are on the boundaries of its neighbours, too, and grade from there.
    boundary_.reference_edge = shortest;
}

void Refiner::enqueue(const std::vector<TetId>& tets) {
    for (const TetId t : tets) {
        if (!mesh_.in_domain(t) || mesh_.tets().is_ghost(t)) continue;
        double badness = 0;
        const Fault fault = classify(t, badness);
        enqueue(t, fault, badness);
    }
}

void Refiner::enqueue(TetId t, Fault fault, double badness) {
    if (is_forced(t, fault)) return;
    switch (fault) {
        case Fault::none: break;
        case Fault::size: by_size_.push(t, mesh_.tets().corners(t), badness); break;
        case Fault::radius_edge:
        case Fault::flat: by_radius_edge_.push(t, mesh_.tets().corners(t), badness); break;
        case Fault::sliver: by_sliver_.push(t, mesh_.tets().corners(t), badness); break;
    }
}

void Refiner::enqueue_all() {
    constexpr std::size_t kGrain = std::size_t{1} << 14;
    struct Faulty {
        TetId tet{};
        Fault fault = Fault::none;
        double badness = 0;
    };
    // What forces a tetrahedron may be looked up for the first time: not by several threads at once. Few are faulty.
    const std::size_t slots = mesh_.tets().slots();
    std::vector<std::vector<Faulty>> found((slots + kGrain - 1) / kGrain);
    workers_.for_ranges(slots, kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        ShapeBatch<TetId> batch;
        const auto look = [&](TetId t, const SquaredShapes& shapes, std::size_t lane) {
            if (is_surely_faultless(t, shapes, lane)) return;
            Faulty f{t};
            f.fault = classify(t, f.badness);
            if (f.fault != Fault::none) found[piece].push_back(f);
        };
        for (std::size_t i = begin; i < end; ++i) {
            const TetId t{i};
            if (!mesh_.tets().is_finite(t) || !mesh_.in_domain(t)) continue;
            const TetStore::Corners& c = mesh_.tets().corners(t);
            batch.add(t, mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]), look);
        }
        batch.finish(look);
    });
    for (const std::vector<Faulty>& piece : found)
        for (const Faulty& f : piece) enqueue(f.tet, f.fault, f.badness);
}

/// From now on what is made is looked at; before, all of it would wait in vain, as the mesh is looked at as a whole.
void Refiner::listen() {
    boundary_.on_insert = [this](VertexId) { enqueue(mesh_.triangulation().new_tets()); };
    boundary_.on_repair = [this](const std::vector<TetId>& tets) { enqueue(tets); };
}

void Refiner::report_milestones() {
    if (!by_size_.empty()) return;
    if (!std::exchange(size_met_, true)) original_vertices_ = mesh_.vertex_slots();
    if (!boundary_.recorder) return;
    boundary_.recorder->on_milestone(InsertionRecorder::Milestone::size_met);
    if (by_radius_edge_.empty()) boundary_.recorder->on_milestone(InsertionRecorder::Milestone::almost_good);
}

/// Splits what is larger than its own segment or facet may have it, as large as pieces of tetrahedra within their bound can be: there is none here.
void Refiner::split_sized_boundary() {
    if (!sizes_.has_bare_entities()) return;
    const TetStore& tets = mesh_.tets();
    const SplitRequest request{InsertionReason::boundary_by_size, VertexId{}};
    std::size_t before = 0;
    do {
        before = mesh_.vertex_count();
        for (std::size_t i = 0; i < tets.slots(); ++i) {
            const TetId t{i};
            if (guard_.poll(before, tets.live(), 0) != RunGuard::Verdict::go_on) return;
            if (!tets.is_finite(t) || !mesh_.has_labels(t)) continue;
            const TetLabels labels = mesh_.labels(t);
            const auto c = tets.corners(t);
            const std::size_t vertices = mesh_.vertex_count();
            for (unsigned e = 0; e < 6 && mesh_.vertex_count() == vertices; ++e) {
                const VertexId a = c[kEdgeCorners[e][0]], b = c[kEdgeCorners[e][1]];
                if (labels.segments[e].valid() && distance(mesh_.point(a), mesh_.point(b)) > 2 * kCircumradiusPerEdgeLength * sizes_.of_segment(labels.segments[e]))
                    boundary_.split(Subsegment{a, b, labels.segments[e]}, request);
            }
            for (unsigned f = 0; f < 4 && mesh_.vertex_count() == vertices; ++f) {
                if (!labels.facets[f].valid()) continue;
                const auto fc = tets.face_corners(TetFace{t, f});
                double radius = 0;
                circumcentre(mesh_.point(fc[0]), mesh_.point(fc[1]), mesh_.point(fc[2]), &radius);
                if (radius > kCircumradiusPerEdgeLength * sizes_.of_facet(labels.facets[f])) boundary_.split(Subface{fc, labels.facets[f]}, request);
            }
            if (mesh_.vertex_count() != vertices) boundary_.conform();
        }
    } while (mesh_.vertex_count() > before);  // what rounding keeps from being split stays
}

RunGuard::Verdict Refiner::refine() {
    if (boundary_.acute().any()) frugal_from_ = static_cast<std::size_t>(kGenerousGrowth * static_cast<double>(mesh_.vertex_count())) + kGenerousAllowance;
    frugal_from_ += static_cast<std::size_t>(std::min(2 * sizes_.expected_vertices(), 1e9));
    split_sized_boundary();
    enqueue_all();
    listen();
    keeps_last_ = max_vertices_.has_value() || boundary_.acute().copies();
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    for (unsigned cascades = 0;; ++cascades) {
        try {
            if (cascades == 0) drain_in_zones();
            verdict = drain();
            break;
        } catch (const MeshError& e) {
            // A cascade at acute input that met the ceiling, or what can't be split any further: without what set it off, once more from the mesh before it.
            if (e.code() != ErrorCode::budget_exhausted || !last_) throw;
            last_->go_back();
            forget_waiting();
            if (cascades == kMostCascades) break;
            given_up_.insert(splitting_);
            enqueue_all();
        }
    }
    // The algorithm's own ceiling ends refinement, not the run.
    if (verdict == RunGuard::Verdict::out_of_vertices && !guard_.user_limit_spent()) verdict = RunGuard::Verdict::go_on;
    keeps_last_ = false;
    if (last_ && guard_.has_too_many(mesh_.vertex_count())) last_->go_back();
    last_.reset();
    return verdict;
}

void Refiner::forget_waiting() {
    by_size_.clear();
    by_radius_edge_.clear();
    by_sliver_.clear();
    squared_size_slack_ = 1;
    beside_holes_.clear();
    boundary_.forget_waiting();
}

/// A cascade may take more vertices than are left, by hundreds: then the mesh at the last savepoint is the result. One is made whenever half as many are left as at the
/// one before, so there are few, and little is lost; where only the algorithm's own ceiling is to be feared, whenever there are twice as many.
void Refiner::keep_last() {
    const std::uint64_t count = mesh_.vertex_count(), left = max_vertices_ ? *max_vertices_ - std::min(count, *max_vertices_) : count;
    const bool due = !last_ || (max_vertices_ ? left <= left_at_last_ / 2 : count >= 2 * left_at_last_);
    if (!due || left == 0 || !guard_.can_double()) return;
    last_.reset();  // savepoints end in the opposite order of their beginning
    last_.emplace(mesh_);
    left_at_last_ = left;
}

RunGuard::Verdict Refiner::drain() {
    // Filling gaps breaks the facets on their sides all the time.
    constexpr double kManyForGaps = 1000;
    boundary_.lets_holes_wait = gaps_.expected_vertices() > kManyForGaps && !strict() && !boundary_.recorder;
    const auto step = [&] {
        judging_ = sliver_rule_.has_value();
        boundary_.step();
        if (!boundary_.has_holes()) requeue_beside_holes();
    };
    while (true) {
        if (!boundary_.idle() && !boundary_.only_holes_wait()) {
            step();
            continue;
        }
        if (keeps_last_ && boundary_.idle()) keep_last();
        report_milestones();
        if (!by_sliver_.empty() && mesh_.vertex_count() >= sliver_budget_) {
            sliver_budget_spent_ = true;
            by_sliver_.clear();
        }
        if (by_size_.empty() && by_radius_edge_.empty() && by_sliver_.empty()) {
            if (boundary_.idle()) return RunGuard::Verdict::go_on;
            step();
            continue;
        }
        const RunGuard::Verdict verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), by_size_.size() + by_radius_edge_.size() + by_sliver_.size());
        if (verdict != RunGuard::Verdict::go_on) {
            while (!boundary_.idle()) step();
            by_size_.clear();
            by_radius_edge_.clear();
            by_sliver_.clear();
            return verdict;
        }
        BadTetQueue& queue = !by_size_.empty() ? by_size_ : !by_radius_edge_.empty() ? by_radius_edge_ : by_sliver_;
        const BadTetQueue::Entry e = queue.pop();
        if (!mesh_.tets().is_live(e.tet) || mesh_.tets().is_ghost(e.tet) || BadTetQueue::fingerprint(mesh_.tets().corners(e.tet)) != e.fingerprint) continue;
        if (!mesh_.in_domain(e.tet)) continue;
        double badness = 0;
        const Fault fault = classify(e.tet, badness);
        if (fault == Fault::none || is_forced(e.tet, fault) || given_up_.contains(e.fingerprint)) continue;
        splitting_ = e.fingerprint;
        const std::size_t vertices_before = mesh_.vertex_count();
        reached_hole_ = false;
        if (fault == Fault::flat) split_flat(e.tet);
        else process(e.tet, fault == Fault::size ? InsertionReason::size : fault == Fault::sliver ? InsertionReason::sliver : InsertionReason::radius_edge);
        // It may have survived when the boundary was split instead: then it waits again. If nothing could be done it is given up.
        if (reached_hole_) beside_holes_.push_back(e);
        else if (mesh_.vertex_count() != vertices_before && mesh_.tets().is_finite(e.tet) && BadTetQueue::fingerprint(mesh_.tets().corners(e.tet)) == e.fingerprint && mesh_.in_domain(e.tet)) {
            queue.push(e.tet, mesh_.tets().corners(e.tet), badness);
        }
    }
}

/// What could not be split before the boundary was whole again.
void Refiner::requeue_beside_holes() {
    for (const BadTetQueue::Entry& e : std::exchange(beside_holes_, {})) {
        if (!mesh_.tets().is_finite(e.tet) || BadTetQueue::fingerprint(mesh_.tets().corners(e.tet)) != e.fingerprint) continue;
        if (mesh_.in_domain(e.tet)) enqueue({e.tet});
    }
}

RunGuard::Verdict Refiner::split(TetId t, InsertionReason reason) {
    const std::uint32_t print = BadTetQueue::fingerprint(mesh_.tets().corners(t));
    double badness = 0;
    squared_size_slack_ = kSizeTolerance * kSizeTolerance;
    for (unsigned attempts = 0; attempts < 64; ++attempts) {
        if (!mesh_.tets().is_finite(t) || BadTetQueue::fingerprint(mesh_.tets().corners(t)) != print || !mesh_.in_domain(t)) break;
        if (classify(t, badness) == Fault::flat) split_flat(t);
        else process(t, reason);
        judging_ = sliver_rule_.has_value();
        while (!boundary_.idle()) boundary_.step();
    }
    const RunGuard::Verdict verdict = drain();
    squared_size_slack_ = 1;
    return verdict;
}

}  // namespace wellmesh
