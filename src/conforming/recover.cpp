// SPDX-License-Identifier: Apache-2.0
// Recovery: makes missing subsegments and subfaces appear by splitting, first all segments, then facet by facet.
//
// A facet is compared with the two-dimensional Delaunay triangulation of its vertices, which exists for the comparison only: a
// triangle of it that is no face of the mesh is split at its circumcentre. Where four or more vertices are nearly cocircular
// the two triangulations may legally choose other diagonals; then faces of the mesh are found that cover the same polygon.
#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "conforming/boundary_refiner.hpp"
#include "conforming/facet_delaunay.hpp"
#include "conforming/place_point.hpp"
#include "core/check.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {

void BoundaryRefiner::queue_chain(SegmentId s) {
    const std::vector<VertexId> chain = mesh_.chain_of(s);
    for (std::size_t i = 0; i + 1 < chain.size(); ++i) {
        const Subsegment piece{chain[i], chain[i + 1], s};
        if (!mesh_.find_subsegment(piece).valid()) segments_.push_back({piece, VertexId{}});
    }
}

void BoundaryRefiner::recover_segments() {
    for (std::size_t i = 0; i < mesh_.plc().segments.size(); ++i) queue_chain(SegmentId{i});
    drain_segments();
}

/// The face that is all of a facet, or an invalid one: of a surface of triangles most are such.
TetFace BoundaryRefiner::sole_triangle(FacetId f) {
    const ValidFacet& facet = mesh_.plc().facets[f.index()];
    if (facet.triangles.size() != 1 || facet.vertices.size() != 3 || !mesh_.steiner_vertices_of(f).empty()) return {};
    return mesh_.triangulation().find_face(facet.vertices[0], facet.vertices[1], facet.vertices[2]);
}

/// @return false if points had to be inserted (which may have broken other facets): call again.
bool BoundaryRefiner::recover_facet(FacetId f) {
    for (unsigned round = 0;; ++round) {
        constexpr unsigned kTooManyRounds = 1000;  // each inserts points where the facet is coarsest: dozens are many
        if (round > kTooManyRounds)
            throw MeshError(ErrorCode::budget_exhausted, guard_.stage(), fmt::format("facet {} could not be recovered", mesh_.plc().facets[f.index()].source_facet + 1),
                            {{EntityKind::facet, mesh_.plc().facets[f.index()].source_facet + 1, mesh_.plc().facets[f.index()].origin}});
        // Time and memory only: most facets need no vertex.
        guard_.require(0, 0, 0, [&] { return ElementRef{EntityKind::facet, mesh_.plc().facets[f.index()].source_facet + 1U, mesh_.plc().facets[f.index()].origin}; });
        if (const TetFace face = sole_triangle(f); face.valid()) {
            mesh_.relabel_facet(f, {face});
            return round == 0;
        }
        FacetDelaunay flat(mesh_, f);
        const std::vector<FacetDelaunay::Missing> missing = flat.match_faces(mesh_);
        if (missing.empty()) {
            mesh_.relabel_facet(f, flat.faces());
            return round == 0;
        }
        const std::size_t before = mesh_.vertex_count();
        std::vector<Vec3> taken;
        for (const auto& m : missing) {
            const Vec3 &a = mesh_.point(m.corners[0]), &b = mesh_.point(m.corners[1]), &c = mesh_.point(m.corners[2]);
            double radius = 0;
            const Vec3 centre = circumcentre(a, b, c, &radius);
            if (std::any_of(taken.begin(), taken.end(), [&](const Vec3& p) { return squared_distance(p, centre) < radius * radius; })) continue;
            const ValidFacet& facet = mesh_.plc().facets[f.index()];
            const std::uint64_t key = mix64(seed_, mix64(m.corners[0].value(), mix64(m.corners[1].value(), m.corners[2].value())));
            const Vec3 unit = picking_point(2, key, 1);
            const Vec3 wanted = project_to_facet(facet, centre + (rules.jitter * radius * unit.x) * facet.axis_u + (rules.jitter * radius * unit.y) * facet.axis_v);
            // The last vertex allowed may have been the last one needed.
            if (mesh_.vertex_count() > before && guard_.has_too_many(mesh_.vertex_count() + 1)) break;
            poll_or_throw(f);
            taken.push_back(centre);
            if (acute_.copies()) split_acute(f, m.corners, false, mesh_.triangulation().tet_of(m.corners[0]), {InsertionReason::recovery, m.corners[0]});
            else try_insert_on_facet(f, wanted, mesh_.triangulation().tet_of(m.corners[0]), {InsertionReason::recovery, m.corners[0]});
        }
        drain_segments();
        if (mesh_.vertex_count() == before) give_up(Subface{missing[0].corners, f});
    }
}

/// Inserts the point, or splits the subsegments that it would encroach. Nothing happens at the place of a vertex.
void BoundaryRefiner::try_insert_on_facet(FacetId f, const Vec3& wanted, TetId near, const SplitRequest& request) {
    const Placement where = Placement::on_facet(f);
    if (!std::isfinite(wanted.x + wanted.y + wanted.z) || !mesh_.triangulation().find_conflict_cavity(wanted, near, cavity_)) return;
    find_encroached(cavity_, where, encroached_segments_, encroached_faces_);
    const std::vector<Subsegment> targets = encroached_segments_;
    if (!targets.empty()) {
        for (const Subsegment& target : targets)
            if (mesh_.find_subsegment(target).valid()) split(target, request);
        return;
    }
    const VertexId v = mesh_.insert(cavity_, where, {.reason = request.reason, .parent = request.parent});
    inserted(v);
    if (!recorder) return;
    PickEvent e;
    e.reason = request.reason;
    e.point = mesh_.point(v);
    e.vertex = v;
    e.parent = request.parent;
    e.nearest = mesh_.info(v).insertion_length;
    recorder->on_pick(e);
}

void BoundaryRefiner::repair_broken() {
    drain_segments();
    for (const FacetId f : mesh_.take_broken_facets()) {
        recover_facet(f);
        cells_stale_ = true;
    }
}

/// Once everything is recovered: cells may have leaked through what was broken.
void BoundaryRefiner::refresh_cells() {
    cells_stale_ = false;
    std::vector<TetId> forgotten = mesh_.take_forgotten();
    std::sort(forgotten.begin(), forgotten.end());
    forgotten.erase(std::unique(forgotten.begin(), forgotten.end()), forgotten.end());
    std::erase_if(forgotten, [&](TetId t) { return !mesh_.tets().is_live(t); });
    if (!classify_again(mesh_, forgotten)) {
        find_all_cells();
        return;
    }
    enqueue_encroached(forgotten);
    if (on_repair) on_repair(forgotten);
}

void BoundaryRefiner::find_all_cells() {
    cells_stale_ = false;
    (void)mesh_.take_forgotten();
    classify_cells(mesh_);
    std::vector<TetId> all;
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i)
        if (mesh_.tets().is_live(TetId{i})) all.push_back(TetId{i});
    enqueue_encroached(all);
    if (on_repair) on_repair(all);
}

void BoundaryRefiner::recover_all() {
    recover_segments();
    std::vector<FacetId> todo;
    for (std::size_t i = 0; i < mesh_.plc().facets.size(); ++i) todo.push_back(FacetId{i});
    (void)recover_facets(std::move(todo), std::numeric_limits<std::size_t>::max());
    find_all_cells();
}

bool BoundaryRefiner::recover_broken(Workers& workers, std::size_t most) {
    drain_segments();
    if (!recover_facets(mesh_.take_broken_facets(), most)) return false;
    mesh_.find_cells_by_vertices(workers);
    if (classify_again(mesh_, mesh_.take_forgotten()) && enqueue_all_encroached(workers)) return true;
    segments_.clear();
    faces_.clear();
    find_all_cells();
    return true;
}

/// A point on one facet may destroy faces of another: goes round until a whole round changes nothing. @return false, half way, with more vertices than `most`
bool BoundaryRefiner::recover_facets(std::vector<FacetId> todo, std::size_t most) {
    while (!todo.empty()) {
        for (const FacetId f : todo) {
            if (mesh_.vertex_count() > most) return false;
            recover_facet(f);
        }
        drain_segments();
        todo = mesh_.take_broken_facets();
    }
    faces_.clear();
    cells_stale_ = false;
    return true;
}

}  // namespace wellmesh
