// SPDX-License-Identifier: Apache-2.0
#include "theory/run_recorder.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/vec3_math.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh {
namespace {

/// Points on segments and facets miss their place by a few ulp of the largest coordinate (conforming/place_point.hpp), or by what the input's
/// own vertices miss it; a distance of two has twice that.
double position_error(const ValidPlc& plc) {
    double largest = 0;
    for (const Vec3& p : plc.vertices) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return 2 * (8 * largest * 0x1p-53 + plc.coplanar_tolerance);
}

}  // namespace

RunRecorder::RunRecorder(const ConformingMesh& mesh, const TheoryConstants& constants, bool sized)
    : mesh_(mesh), ledger_(constants, position_error(mesh.plc())), complex_lfs_(mesh.plc()), sized_(sized) {
    const std::vector<double> nearest = nearest_neighbours();
    for (std::size_t i = 0; i < nearest.size(); ++i) ledger_.add_input(mesh.point(VertexId{i}), nearest[i]);
}

/// Nearest neighbours are Delaunay neighbours.
std::vector<double> RunRecorder::nearest_neighbours() const {
    std::vector<double> squared(mesh_.vertex_slots(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) {
        if (!mesh_.tets().is_finite(TetId{i})) continue;
        const auto& c = mesh_.tets().corners(TetId{i});
        for (const auto& e : kEdgeCorners) {
            const VertexId a = c[e[0]], b = c[e[1]];
            const double d = squared_distance(mesh_.point(a), mesh_.point(b));
            squared[a.index()] = std::min(squared[a.index()], d);
            squared[b.index()] = std::min(squared[b.index()], d);
        }
    }
    for (double& d : squared) d = std::sqrt(d);
    return squared;
}

/// Vertices that came without an event (lattice seeds) enter the account with nothing claimed of them.
void RunRecorder::enter_unpicked(std::size_t vertices) {
    while (ledger_.vertices() < vertices) {
        const VertexId v{ledger_.vertices()};
        PickEvent seed;
        seed.reason = InsertionReason::lattice;
        seed.point = mesh_.point(v);
        seed.vertex = v;
        seed.nearest = mesh_.info(v).insertion_length;
        (void)ledger_.add(seed);
    }
}

std::uint32_t RunRecorder::on_pick(const PickEvent& event) {
    enter_unpicked(event.vertex.valid() ? event.vertex.index() : mesh_.vertex_slots());
    return ledger_.add(event);
}

void RunRecorder::on_milestone(Milestone reached) {
    enter_unpicked(mesh_.vertex_slots());
    if (!ledger_.has_original()) {
        double shortest = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) {
            if (!mesh_.tets().is_finite(TetId{i}) || !mesh_.in_domain(TetId{i})) continue;
            const auto& c = mesh_.tets().corners(TetId{i});
            shortest = std::min(shortest, shortest_edge_squared(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3])));
        }
        ledger_.set_original(std::sqrt(shortest));
        if (sized_) {
            std::vector<Vec3> points;
            for (std::size_t i = 0; i < mesh_.vertex_slots(); ++i) points.push_back(mesh_.point(VertexId{i}));
            original_spacing_.emplace(std::move(points));
        }
    }
    if (reached == Milestone::almost_good && almost_good_vertices_ == 0) almost_good_vertices_ = mesh_.vertex_count();
}

double RunRecorder::local_feature_size(const Vec3& x) const {
    const double lfs = complex_lfs_(x);
    return original_spacing_ ? std::min(lfs, (*original_spacing_)(x)) : lfs;
}

double RunRecorder::check_final_tetrahedra() {
    double shortest = std::numeric_limits<double>::infinity();
    Vec3 where;
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) {
        const TetId t{i};
        if (!mesh_.tets().is_finite(t) || !mesh_.in_domain(t)) continue;
        const auto& c = mesh_.tets().corners(t);
        const TetShape s = shape_of(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]));
        if (s.shortest_edge < shortest) {
            shortest = s.shortest_edge;
            where = mesh_.point(c[0]);
        }
        if (!std::isfinite(s.radius_edge)) continue;  // flat in rounded arithmetic: both sides are infinite
        // The volume, which is what rounding blurs, cancels from this quotient but for the circumradius, which it blurs as much.
        const double value = s.aspect * s.sigma / (std::numbers::sqrt3 * s.radius_edge * s.radius_edge * s.radius_edge);
        ledger_.observe(ClaimId::lemma_2_1, value, 1e-12, mesh_.point(c[0]),
                        fmt::format("tetrahedron {} {} {} {}: R/r = {:.6g}, rho = {:.6g}, sigma = {:.6g}", c[0].value(), c[1].value(), c[2].value(), c[3].value(), s.aspect,
                                    s.radius_edge, s.sigma));
    }
    if (ledger_.has_original())
        ledger_.observe(ClaimId::theorem_4_2, shortest / ledger_.reference_edge(), ledger_.position_error() / shortest, where,
                        fmt::format("shortest edge of the final mesh, {:.9g}, at ({}, {}, {})", shortest, where.x, where.y, where.z));
    return shortest;
}

void RunRecorder::check_final_vertices() {
    const std::vector<double> nearest = nearest_neighbours();
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        const Vec3& p = mesh_.point(VertexId{i});
        const double lfs = local_feature_size(p);
        if (!std::isfinite(lfs)) continue;
        ledger_.observe(ClaimId::theorem_5_2, lfs / nearest[i], ledger_.position_error() / nearest[i], p,
                        fmt::format("vertex {} at ({}, {}, {}): lfs = {:.9g}, N = {:.9g}", i, p.x, p.y, p.z, lfs, nearest[i]));
    }
}

InvariantReport RunRecorder::finish() {
    ledger_.check_density([this](const Vec3& x) { return local_feature_size(x); });
    const double shortest = check_final_tetrahedra();
    check_final_vertices();
    const auto final_vertices = static_cast<double>(mesh_.vertex_count());
    if (almost_good_vertices_ > 0)
        ledger_.observe(ClaimId::theorem_5_3, final_vertices / static_cast<double>(almost_good_vertices_), 0, {},
                        fmt::format("{} vertices, {} of them when the mesh was almost good", mesh_.vertex_count(), almost_good_vertices_));
    InvariantReport report = ledger_.report();
    report.shortest_edge = shortest;
    report.almost_good_vertices = almost_good_vertices_;
    report.final_vertices = mesh_.vertex_count();
    return report;
}

}  // namespace wellmesh
