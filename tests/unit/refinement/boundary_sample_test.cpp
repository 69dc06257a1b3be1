// SPDX-License-Identifier: Apache-2.0
#include "refinement/boundary_sample.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <vector>

#include "core/infinity.hpp"
#include "core/vec3_math.hpp"
#include "support/acute_plcs.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

struct Sampled {
    BoundarySample sample;
    std::vector<Vec3> points;  // by vertex
};

Sampled sample_of(StagedMesh& staged, const std::function<double(const Vec3&, CellId)>& radius, bool varies, unsigned threads = 1) {
    Workers workers(threads);
    SharedGuard guard(staged.guard, 0, 0);
    std::optional<BoundarySample> sample = sample_boundary(staged.mesh, staged.acute, radius, varies, 1, workers, guard);
    EXPECT_TRUE(sample.has_value());
    Sampled out{std::move(*sample), {}};
    for (std::size_t v = 0; v < staged.mesh.vertex_slots(); ++v) out.points.push_back(staged.mesh.point(VertexId{v}));
    for (const BoundarySample::Point& p : out.sample.points) out.points.push_back(p.at.point);
    return out;
}

double area_of(const Sampled& s, const Subface& f) {
    const Vec3 &a = s.points[f.corners[0].index()], &b = s.points[f.corners[1].index()], &c = s.points[f.corners[2].index()];
    return norm(cross(b - a, c - a)) / 2;
}

/// Pieces and faces cover segments and facets, are fine enough, and their new vertices lie on them.
void expect_boundary(const StagedMesh& staged, const Sampled& s, const std::function<double(const Vec3&, CellId)>& radius, double slack) {
    const ValidPlc& plc = staged.plc;
    std::vector<double> length(plc.segments.size(), 0), area(plc.facets.size(), 0);
    for (const Subsegment& piece : s.sample.segments) {
        const Vec3 &a = s.points[piece.a.index()], &b = s.points[piece.b.index()];
        length[piece.segment.index()] += distance(a, b);
        double most = kInfinity;
        for (const FacetId f : plc.segments[piece.segment.index()].facets)
            for (const CellId c : plc.facets[f.index()].cells)
                if (staged.mesh.is_filled(c)) most = std::min(most, radius(0.5 * (a + b), c));
        EXPECT_LE(distance(a, b), 2 * most * (1 + slack));
    }
    for (std::size_t i = 0; i < length.size(); ++i) {
        const auto& ends = plc.segments[i].ends;
        EXPECT_NEAR(length[i], distance(plc.vertices[ends[0].index()], plc.vertices[ends[1].index()]), 1e-9 * length[i]);
    }
    std::size_t coarse = 0;
    for (const Subface& f : s.sample.faces) {
        area[f.facet.index()] += area_of(s, f);
        const Vec3 &a = s.points[f.corners[0].index()], &b = s.points[f.corners[1].index()], &c = s.points[f.corners[2].index()];
        const double r = distance(a, b) * distance(b, c) * distance(c, a) / (4 * area_of(s, f));
        double most = kInfinity;
        for (const CellId cell : plc.facets[f.facet.index()].cells)
            if (staged.mesh.is_filled(cell)) most = std::min(most, radius((1.0 / 3) * (a + b + c), cell));
        coarse += r > most * (1 + slack);
    }
    EXPECT_LE(static_cast<double>(coarse), 0.01 * static_cast<double>(s.sample.faces.size()));
    for (std::size_t i = 0; i < area.size(); ++i) {
        double whole = 0;
        for (const auto& t : plc.facets[i].triangles)
            whole += norm(cross(plc.vertices[t[1].index()] - plc.vertices[t[0].index()], plc.vertices[t[2].index()] - plc.vertices[t[0].index()])) / 2;
        EXPECT_NEAR(area[i], whole, 1e-9 * whole) << i;
    }
    for (const BoundarySample::Point& p : s.sample.points) {
        if (p.at.carrier == CarrierKind::facet) {
            const ValidFacet& f = plc.facets[p.at.carrier_id];
            EXPECT_LE(std::abs(dot(p.at.point - f.origin, f.normal)), f.tolerance + 1e-12 * staged.largest_coordinate());
        } else {
            ASSERT_EQ(p.at.carrier, CarrierKind::segment);
            const auto& ends = plc.segments[p.at.carrier_id].ends;
            EXPECT_LE(distance_to_segment(p.at.point, plc.vertices[ends[0].index()], plc.vertices[ends[1].index()]), 1e-12 * staged.largest_coordinate());
        }
    }
}

TEST(BoundarySample, IsAsFineAsItIsToBeAndCoversTheBoundary) {
    for (const NamedPlc& named : all_synthetic_plcs())
        for (const bool varies : {false, true}) {
            SCOPED_TRACE(fmt::format("{} {}", named.name, varies ? "graded" : "even"));
            const Plc plc = transformed(named.plc, 1, 0, 1);
            const double even = 0.02 * diagonal(named.plc);
            const auto radius = [&](const Vec3& p, CellId) { return varies ? 0.5 * even + 0.05 * distance(p, plc.vertices[0]) : even; };
            StagedMesh staged(plc);
            staged.conform();
            const Sampled s = sample_of(staged, radius, varies);
            EXPECT_GT(s.sample.points.size(), 500U);
            expect_boundary(staged, s, radius, 1e-6);
        }
}

TEST(BoundarySample, IsTheSameOnAnyNumberOfThreads) {
    const Plc plc = transformed(stepped_shaft(), 2, 0, 1);
    StagedMesh staged(plc);
    staged.conform();
    const auto radius = [](const Vec3&, CellId) { return 0.05; };
    const Sampled one = sample_of(staged, radius, false, 1);
    for (const unsigned threads : {2U, 3U, 8U}) {
        const Sampled several = sample_of(staged, radius, false, threads);
        EXPECT_TRUE(several.points == one.points);
        ASSERT_EQ(several.sample.faces.size(), one.sample.faces.size());
        for (std::size_t i = 0; i < one.sample.faces.size(); ++i) EXPECT_EQ(several.sample.faces[i].corners, one.sample.faces[i].corners);
    }
}

/// Balls about acute vertices get no vertex inside, only on their spheres.
TEST(BoundarySample, BallsStayEmpty) {
    for (const NamedPlc& named : {NamedPlc{"wedge", wedge(30)}, NamedPlc{"spike", spike(20)}, NamedPlc{"fan", fan(7)}, NamedPlc{"ball", bumpy_ball(6)}, random_acute(3)}) {
        SCOPED_TRACE(named.name);
        StagedMesh staged(named.plc);
        staged.conform();
        const double even = 0.02 * diagonal(named.plc);
        const Sampled s = sample_of(staged, [&](const Vec3&, CellId) { return even; }, false);
        for (std::size_t v = 0; v < staged.plc.vertices.size(); ++v) {
            const double ball = staged.acute.ball_radius(VertexId{v});
            if (!(ball > 0)) continue;
            for (const BoundarySample::Point& p : s.sample.points) ASSERT_GE(distance(p.at.point, staged.plc.vertices[v]), ball * (1 - 1e-9));
        }
    }
}

TEST(BoundarySample, NothingIsAskedNothingIsAdded) {
    StagedMesh staged(cube());
    staged.conform();
    const Sampled s = sample_of(staged, [](const Vec3&, CellId) { return kInfinity; }, false);
    EXPECT_TRUE(s.sample.points.empty());
    EXPECT_EQ(s.sample.segments.size(), 12U);
}

/// What is named wrongly is found to be missing, and recovered.
TEST(Relabel, WhatIsNotThereIsBroken) {
    StagedMesh staged(cube());
    staged.conform();
    ConformingMesh& mesh = staged.mesh;
    const auto radius = [](const Vec3&, CellId) { return 0.2; };
    const Sampled s = sample_of(staged, radius, false);
    std::vector<std::uint32_t> order;
    const std::size_t first = mesh.vertex_slots();
    ASSERT_EQ(mesh.add_vertices(s.sample.points.size()), VertexId{first});
    for (std::size_t k = 0; k < s.sample.points.size(); ++k) {
        mesh.set_new_vertex(VertexId{first + k}, s.sample.points[k].at, InsertionReason::boundary_by_size);
        order.push_back(VertexId{first + k}.value());
    }
    mesh.insert_at_once(staged.workers, order);
    std::vector<Subsegment> segments = s.sample.segments;
    std::vector<Subface> faces = s.sample.faces;
    segments[3] = {segments[3].a, VertexId{order.back()}, segments[3].segment};
    std::swap(faces[5].corners[0], faces[5 + faces.size() / 2].corners[0]);
    mesh.relabel(staged.workers, segments, faces);
    EXPECT_TRUE(mesh.has_broken());
    const auto broken = mesh.broken_facets();
    EXPECT_NE(std::find(broken.begin(), broken.end(), faces[5].facet), broken.end());
    EXPECT_TRUE(staged.boundary.recover_broken(staged.workers));
    staged.boundary.conform();
    EXPECT_FALSE(mesh.has_broken());
    EXPECT_EQ(staged.problem(true), "");
}

}  // namespace
}  // namespace wellmesh::testing
