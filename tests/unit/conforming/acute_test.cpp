// SPDX-License-Identifier: Apache-2.0
// Acute input: the lemmas behind the copies, the bars for conformity, and what exemptions promise.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "conforming/acute_exemptions.hpp"
#include "conforming/acute_geometry.hpp"
#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "support/acute_plcs.hpp"
#include "support/staged_mesh.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh::testing {
namespace {

double uniform(std::uint64_t key, double low, double high) { return low + (high - low) * unit_double(mix64(key, 77)); }

/// Random witnesses on the second slope of a wedge, random spheres with centres on the first: copies of what is inside stay inside.
TEST(AcuteGeometry, CopiesOnAFacetStayInsideTheSphere) {
    for (const double angle : {60.0, 10.0, 0.1, 0.001}) {
        const ValidPlc plc = validate(wedge(angle));
        Workers workers;
        const AcuteGeometry acute(plc, workers);
        ASSERT_TRUE(acute.any());
        // The segment where the two slopes meet at the sharpest angle.
        const AcuteFeature& sharpest = *std::find_if(plc.acute_features.begin(), plc.acute_features.end(), [](const AcuteFeature& f) { return f.kind == EntityKind::segment; });
        const ValidSegment& s = plc.segments[sharpest.id];
        const FacetId f = s.facets[0], g = s.facets[1];
        const Vec3 a = plc.vertices[s.ends[0].index()], b = plc.vertices[s.ends[1].index()], along = b - a;
        const auto inward = [&](FacetId id) {
            Vec3 w = cross(plc.facets[id.index()].normal, along);
            Vec3 middle{};
            for (const VertexId v : plc.facets[id.index()].vertices) middle = middle + plc.vertices[v.index()];
            middle = (1.0 / static_cast<double>(plc.facets[id.index()].vertices.size())) * middle;
            if (dot(w, middle - a) < 0) w = -w;
            return (1 / norm(w)) * w;
        };
        const Vec3 wf = inward(f), wg = inward(g);
        unsigned copies = 0;
        for (std::uint64_t i = 0; i < 2000; ++i) {
            const Vec3 q = a + uniform(4 * i, 0, 1) * along + uniform(4 * i + 1, 1e-6, 1) * wg;
            const Vec3 centre = a + uniform(4 * i + 2, 0, 1) * along + uniform(4 * i + 3, 1e-6, 1) * wf;
            const double radius = distance(q, centre) * (1 + 1e-9);
            const auto copy = acute.copy_on_facet(f, {q, CarrierKind::facet, g.value()}, centre, radius);
            ASSERT_TRUE(copy) << angle << " degrees, case " << i;
            EXPECT_LT(distance(copy->point, centre), radius * (1 + 1e-12));
            EXPECT_NEAR(dot(copy->point - plc.facets[f.index()].origin, plc.facets[f.index()].normal), 0, 1e-15);
            ++copies;
        }
        EXPECT_EQ(copies, 2000U);
    }
}

/// Copies from one segment to another and back are where they began: the pattern is closed under copying.
TEST(AcuteGeometry, CopiesOnSegmentsFormOnePattern) {
    const ValidPlc plc = validate(spike(7));
    Workers workers;
    const AcuteGeometry acute(plc, workers);
    for (std::uint32_t v = 0; v < plc.vertices.size(); ++v) {
        const auto at = acute.segments_at(VertexId{v});
        for (const SegmentId s : at)
            for (const SegmentId t : at) {
                if (s == t) continue;
                const auto other = [&](SegmentId x) { return plc.vertices[plc.segments[x.index()].ends[plc.segments[x.index()].ends[0] == VertexId{v} ? 1 : 0].index()]; };
                const Vec3 &o = plc.vertices[v], q = o + 0.3 * (other(s) - o);
                const auto there = acute.copy_on_segment(t, {q, CarrierKind::segment, s.value()});
                if (!there || there->end != VertexId{v}) continue;
                const Vec3 p = o + (there->distance / distance(o, other(t))) * (other(t) - o);
                const auto back = acute.copy_on_segment(s, {p, CarrierKind::segment, t.value()});
                if (!back || back->end != VertexId{v}) continue;
                EXPECT_NEAR(back->distance, distance(o, q), 1e-14);
            }
    }
}

TEST(AcuteGeometry, RadiiAreTheSameForAnyThreadsAndCanBeStopped) {
    const ValidPlc plc = validate(bumpy_ball(16));
    Workers alone(1), three(3);
    const AcuteGeometry one(plc, alone), other(plc, three);
    ASSERT_TRUE(one.any());
    EXPECT_GT(*std::max_element(one.balls().begin(), one.balls().end()), 0);
    EXPECT_EQ(one.balls(), other.balls());
    unsigned looks = 0;
    const auto stop = [&] {
        if (++looks == 3) throw std::runtime_error("stop");
    };
    EXPECT_THROW(AcuteGeometry(plc, alone, false, stop), std::runtime_error);
    EXPECT_EQ(looks, 3U) << "before and amid the radii";
}

TEST(AcuteGeometry, BallsAreDisjointAndClearOfOtherCells) {
    const ValidPlc plc = validate(bundle(3, 7));
    Workers workers;
    AcuteGeometry acute(plc, workers);
    const LocalFeatureSize lfs(plc);
    for (std::size_t i = 0; i < plc.vertices.size(); ++i) {
        const double r = acute.ball_radius(VertexId{i});
        EXPECT_LE(r, lfs(plc.vertices[i]) / 3 * (1 + 1e-12));
        for (std::size_t j = 0; j < i; ++j) EXPECT_LT(r + acute.ball_radius(VertexId{j}), distance(plc.vertices[i], plc.vertices[j]));
    }
}

std::size_t vertices_to_conform(const Plc& plc) {
    StagedMesh staged(plc);
    staged.conform();
    EXPECT_EQ(staged.problem(true), "");
    return staged.mesh.vertex_count();
}

TEST(AcuteSplits, ConformWithFewVertices) {
    EXPECT_LE(vertices_to_conform(fan(16)), 200U);
    EXPECT_LE(vertices_to_conform(fan(64)), 3500U);
    for (const double angle : {60.0, 30.0, 5.0, 1.0, 0.1, 0.01}) EXPECT_LE(vertices_to_conform(wedge(angle)), 6U) << angle;
    for (const double angle : {30.0, 5.0, 0.1, 0.01}) EXPECT_LE(vertices_to_conform(spike(angle)), 40U) << angle;
    EXPECT_LE(vertices_to_conform(tip_to_tip(7, 12, 0)), 150U);
    EXPECT_LE(vertices_to_conform(tip_to_tip(1, 10, 0.1)), 2000U);
    EXPECT_LE(vertices_to_conform(touching_triangles(0.1)), 100U);
    for (std::uint64_t seed = 0; seed < 6; ++seed) EXPECT_LE(vertices_to_conform(bundle(seed, 7)), 600U) << seed;
}

/// Random complexes in cubes, slabs and needles. Where a split has nowhere to go it must not go into a ball: those chased each other to the last bit.
TEST(AcuteSplits, RandomComplexesConform) {
    for (std::uint64_t seed = 0; seed < 60; seed += 6) {
        SCOPED_TRACE(seed);
        const Plc plc = random_complex(seed);
        EXPECT_LE(vertices_to_conform(plc), 400 * plc.vertices.size());
    }
}

/// Where no angle is acute nothing may be exempt; where one is, exempt tetrahedra have two vertices on the boundary, name an acute feature of the input
/// with its angle, miss a goal, and all others keep the goals.
TEST(AcuteExemptions, NameWhatForcesThem) {
    for (const double angle : {10.0, 3.0, 1.0}) {
        const Plc plc = wedge(angle);
        const MeshResult result = generate(plc);
        EXPECT_EQ(result.termination, Termination::goals_met);
        EXPECT_FALSE(result.exemptions.empty());
        EXPECT_GE(result.certificate.unexempt.min_dihedral_angle_deg, 20);
        EXPECT_LE(result.certificate.unexempt.max_radius_edge_ratio, 2);
        std::uint64_t last = 0;
        for (const Exemption& e : result.exemptions) {
            EXPECT_TRUE(e.tet >= last);
            last = e.tet;
            EXPECT_NEAR(e.angle_deg, angle, 1e-6 * angle);
            const auto& c = result.mesh.tets[e.tet];
            EXPECT_GE(std::count_if(c.begin(), c.end(), [&](std::uint32_t v) { return result.mesh.vertex_carriers[v].kind != CarrierKind::region; }), 2);
        }
    }
    EXPECT_TRUE(generate(l_block()).exemptions.empty());
}

TEST(AcuteExemptions, CertificateRefutesOnesInside) {
    const MeshResult result = generate(wedge(3));
    CertifyOptions options;
    options.min_dihedral_angle_deg = 20;
    EXPECT_EQ(certify(result.mesh, options).find("dihedral")->state, Claim::State::refuted);
    for (const Exemption& e : result.exemptions) options.exempt.push_back(e.tet);
    EXPECT_EQ(certify(result.mesh, options).find("dihedral")->state, Claim::State::proven);
    EXPECT_EQ(certify(result.mesh, options).find("exemptions")->state, Claim::State::proven);
    options.exempt = {result.mesh.tets.size()};
    EXPECT_EQ(certify(result.mesh, options).find("exemptions")->state, Claim::State::refuted);
}

/// Unit squares at one segment, `angle` degrees apart, in a box.
Plc book(double angle, std::uint32_t pages) {
    Plc plc = cube();
    for (Vec3& p : plc.vertices) p = {4 * p.x - 2, 4 * p.y - 2, 3 * p.z - 1};
    const auto spine = static_cast<std::uint32_t>(plc.vertices.size());
    plc.vertices.insert(plc.vertices.end(), {{0, 0, 0}, {0, 0, 1}});
    for (std::uint32_t k = 0; k < pages; ++k) {
        const double t = angle * k * std::numbers::pi / 180;
        const auto first = static_cast<std::uint32_t>(plc.vertices.size());
        plc.vertices.insert(plc.vertices.end(), {{std::cos(t), std::sin(t), 0}, {std::cos(t), std::sin(t), 1}});
        PlcFacet page = plc.facets[0];
        page.polygons = {{spine, spine + 1, first + 1, first}};
        plc.facets.push_back(page);
    }
    return plc;
}

/// A size finer than a ball halves it, and the middle of what is split may be inside still: it goes where the copy goes.
TEST(Acute, SizesBelowBallsEnd) {
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        SCOPED_TRACE(fmt::format("seed {}", seed));
        MeshOptions options;
        options.size.edge_length = 0.15;
        options.quality.min_dihedral_angle_deg = 0;
        options.seed = seed;
        EXPECT_GT(generate(book(5, 4), options).mesh.tets.size(), 1000U);
    }
}

}  // namespace
}  // namespace wellmesh::testing
