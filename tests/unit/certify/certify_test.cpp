// SPDX-License-Identifier: Apache-2.0
#include "wellmesh/certificate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "brute_force.hpp"
#include "certify/space_claims.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "support/synthetic_plcs.hpp"
#include "wellmesh/generate.hpp"

namespace wellmesh {
namespace {

using testing::BoxMesh;
using testing::two_region_box;

void expect_proven(const Certificate& certificate) {
    EXPECT_TRUE(certificate.proven());
    for (const Claim& claim : certificate.claims) EXPECT_NE(claim.state, Claim::State::refuted) << claim.name << ": " << claim.detail;
}

TEST(Certify, ProvesASoundMesh) {
    const BoxMesh& box = two_region_box();
    CertifyOptions options;
    options.max_radius_edge_ratio = 20;
    options.min_dihedral_angle_deg = 0.01;
    options.max_aspect_ratio = 1e5;
    options.min_sigma = 1e-6;
    options.max_volume = 1;
    const Certificate certificate = certify(box.mesh, options, &box.plc);
    expect_proven(certificate);
    for (const Claim& claim : certificate.claims) {
        if (claim.name == "exemptions") continue;  // none is asked for
        EXPECT_EQ(claim.state, Claim::State::proven) << claim.name;
        if (claim.name != "plc_isolated_vertices" && claim.name != "holes_empty") {
            EXPECT_GT(claim.checked, 0U) << claim.name;
        }
    }
    EXPECT_EQ(certificate.find("delaunay")->checked, box.mesh.tets.size());
    for (const auto& [name, count] : testing::count_by_brute_force(box.mesh)) EXPECT_EQ(count, 0U) << name;
}

TEST(Certify, NamesAreDistinctAndKnown) {
    const Certificate certificate = certify(two_region_box().mesh);
    std::set<std::string> names;
    for (const Claim& claim : certificate.claims) {
        EXPECT_TRUE(names.insert(claim.name).second) << claim.name;
        EXPECT_FALSE(claim.statement.empty());
    }
    for (const char* name : {"finite_coordinates", "numbers_in_range", "positive_tets", "face_sharing", "opposite_sides", "distinct_tets", "disjoint_tets", "face_balance",
                             "distinct_vertices", "used_vertices", "listed_subfaces_exist", "listed_subsegments_exist", "delaunay", "gabriel_subfaces", "gabriel_subsegments",
                             "plc_distance", "plc_area", "plc_vertices", "plc_segments", "plc_isolated_vertices", "plc_filled", "holes_empty", "region_volumes", "radius_edge", "dihedral", "aspect_ratio",
                             "sigma", "max_volume", "exemptions"})
        EXPECT_TRUE(names.contains(name)) << name;
    EXPECT_EQ(names.size(), 29U);
}

TEST(Certify, WithoutPlcAndBoundsTheirClaimsStayOpen) {
    const Certificate certificate = certify(two_region_box().mesh);
    for (const char* name : {"plc_distance", "plc_area", "plc_vertices", "plc_segments", "plc_isolated_vertices", "plc_filled", "holes_empty", "region_volumes", "radius_edge", "dihedral", "aspect_ratio",
                             "sigma", "max_volume"})
        EXPECT_EQ(certificate.find(name)->state, Claim::State::not_checked) << name;
    EXPECT_TRUE(certificate.proven());
    for (const RegionVolume& region : certificate.regions) EXPECT_FALSE(region.plc_volume.has_value());
}

TEST(Certify, EmptyMeshIsRefutedAndNamesAllClaims) {
    const Certificate certificate = certify(TetMesh{});
    EXPECT_FALSE(certificate.proven());
    EXPECT_EQ(certificate.find("has_tets")->state, Claim::State::refuted);
    EXPECT_EQ(certificate.find("delaunay")->state, Claim::State::not_checked);
    EXPECT_EQ(certificate.claims.size(), 30U);
}

TEST(Certify, BoundsAreChecked) {
    const TetMesh& mesh = two_region_box().mesh;
    const ShapeStatistics s = certify(mesh).all;
    CertifyOptions options;
    options.max_radius_edge_ratio = s.max_radius_edge_ratio;  // equality is allowed
    options.min_dihedral_angle_deg = s.min_dihedral_angle_deg;
    options.max_aspect_ratio = s.max_aspect_ratio;
    options.min_sigma = s.min_sigma;
    options.max_volume = s.max_volume;
    expect_proven(certify(mesh, options));
    const double less = 1 - 1e-9, more = 1 + 1e-9;
    options = {s.max_radius_edge_ratio * less, s.min_dihedral_angle_deg * more, s.max_aspect_ratio * less, s.min_sigma * more, s.max_volume * less};
    const Certificate certificate = certify(mesh, options);
    for (const char* name : {"radius_edge", "dihedral", "aspect_ratio", "sigma", "max_volume"}) {
        EXPECT_EQ(certificate.find(name)->violations, 1U) << name;
        EXPECT_EQ(certificate.find(name)->checked, mesh.tets.size()) << name;
        EXPECT_EQ(certificate.find(name)->witness->kind, EntityKind::tetrahedron) << name;
    }
}

TEST(Certify, TheBoundaryMayHaveBoundsOfItsOwn) {
    const Plc plc = wellmesh::testing::cube();
    MeshOptions wanted;
    wanted.slivers = SliverStrategy::none;
    wanted.size.edge_length = 0.25;
    const TetMesh mesh = generate(plc, wanted).mesh;
    const Certificate plain = certify(mesh, {}, &plc);
    ASSERT_GT(plain.interior.tets, 0U);
    EXPECT_EQ(plain.find("dihedral_boundary"), nullptr);
    EXPECT_EQ(plain.find("sigma_boundary"), nullptr);
    // Each part is compared with its own bound: exactly reached it is proven, a little more is refuted, whatever the other part has.
    const ShapeStatistics &inside = plain.interior, &boundary = plain.boundary;
    for (const double by : {1.0, 1 + 1e-9})
        for (const bool at_boundary : {false, true}) {
            CertifyOptions options;
            options.min_dihedral_angle_deg = inside.min_dihedral_angle_deg * (at_boundary ? 1 : by);
            options.min_dihedral_boundary_deg = boundary.min_dihedral_angle_deg * (at_boundary ? by : 1);
            options.min_sigma = inside.min_sigma * (at_boundary ? 1 : by);
            options.min_sigma_boundary = boundary.min_sigma * (at_boundary ? by : 1);
            const Certificate certificate = certify(mesh, options, &plc);
            const auto expected = [&](bool own) { return own && by > 1 ? Claim::State::refuted : Claim::State::proven; };
            for (const char* name : {"dihedral", "sigma"}) {
                EXPECT_EQ(certificate.find(name)->state, expected(!at_boundary)) << name;
                EXPECT_EQ(certificate.find(name)->checked, inside.tets) << name;
                const Claim* own = certificate.find(std::string(name) + "_boundary");
                ASSERT_NE(own, nullptr);
                EXPECT_EQ(own->state, expected(at_boundary)) << name;
                EXPECT_EQ(own->checked, boundary.tets) << name;
            }
        }
}

TEST(Certify, StatisticsOfThePartsAddUp) {
    const Certificate certificate = certify(two_region_box().mesh);
    EXPECT_EQ(certificate.all.tets, certificate.interior.tets + certificate.boundary.tets);
    EXPECT_EQ(certificate.all.min_edge, std::min(certificate.interior.tets > 0 ? certificate.interior.min_edge : 1e300, certificate.boundary.min_edge));
    for (std::size_t i = 0; i < certificate.all.min_dihedral_histogram.size(); ++i)
        EXPECT_EQ(certificate.all.min_dihedral_histogram[i], certificate.interior.min_dihedral_histogram[i] + certificate.boundary.min_dihedral_histogram[i]);
    Certificate shape;
    measure_shape(two_region_box().mesh, shape);
    EXPECT_TRUE(shape.claims.empty());
    EXPECT_EQ(shape.all.tets, certificate.all.tets);
    EXPECT_EQ(shape.all.mean_edge, certificate.all.mean_edge);
    EXPECT_EQ(shape.boundary.max_aspect_ratio, certificate.boundary.max_aspect_ratio);
}

TEST(Certify, SurvivesRotationShiftAndScale) {
    // A rotation about (1, 2, 3) by an angle without meaning; facets are planar up to rounding afterwards.
    const Vec3 axis = (1 / std::sqrt(14.0)) * Vec3{1, 2, 3};
    const double c = std::cos(0.7), s = std::sin(0.7);
    const auto rotated = [&](const Vec3& p) { return c * p + s * cross(axis, p) + ((1 - c) * dot(axis, p)) * axis; };
    for (const double shift : {0.0, 5e3, 5e6})  // up to 1e6 diagonals
        for (const double scale : {1e-6, 1.0, 1e6}) {
            const BoxMesh box = testing::mapped(two_region_box(), [&](const Vec3& p) { return scale * (rotated(p) + Vec3{shift, shift, shift}); });
            CertifyOptions options;
            options.tolerance = shift > 1e5 ? 1e-7 : 1e-9;
            const Certificate certificate = certify(box.mesh, options, &box.plc);
            SCOPED_TRACE(std::to_string(shift) + " " + std::to_string(scale));
            expect_proven(certificate);
            for (const RegionVolume& region : certificate.regions) {
                const double cube = scale * scale * scale;
                EXPECT_NEAR(region.volume / cube, 8, 8 * (1e-12 + 1e-15 * shift));
                EXPECT_NEAR(*region.plc_volume / cube, 8, 8 * (1e-12 + 1e-15 * shift));
            }
        }
}

TEST(Certify, IsDeterministic) {
    const BoxMesh& box = two_region_box();
    TetMesh damaged = box.mesh;
    damaged.vertices[13].x += 0.45;
    const Certificate a = certify(damaged, {}, &box.plc), b = certify(damaged, {}, &box.plc);
    ASSERT_EQ(a.claims.size(), b.claims.size());
    for (std::size_t i = 0; i < a.claims.size(); ++i) {
        EXPECT_EQ(a.claims[i].detail, b.claims[i].detail);
        EXPECT_EQ(a.claims[i].violations, b.claims[i].violations);
    }
}

TEST(Certify, CoordinatesBelowTheExactRangeCountAsZero) {
    TetMesh mesh;
    mesh.vertices = {{0, 1e-70, 0}, {1, 0, 0}, {0, 1, -1e-300}, {0, 0, 1}};
    mesh.tets = {{0, 1, 2, 3}};
    EXPECT_EQ(certify(mesh).find("finite_coordinates")->state, Claim::State::proven);
    EXPECT_EQ(certify(mesh).find("positive_tets")->violations, 0U);
    mesh.vertices[3].z = 1e-80;
    EXPECT_EQ(certify(mesh).find("positive_tets")->violations, 1U);
    mesh.vertices[3].z = 1e30;
    EXPECT_EQ(certify(mesh).find("finite_coordinates")->violations, 1U);
}

// ---- overlaps

TEST(Overlap, AgreesWithSampling) {
    using certifying::SuspectMesh;
    const auto inside = [](const TetMesh& m, std::size_t t, const Vec3& p) {
        for (std::size_t k = 0; k < 4; ++k) {
            auto corners = m.tets[t];
            std::array<Vec3, 4> c;
            for (std::size_t i = 0; i < 4; ++i) c[i] = m.vertices[corners[i]];
            c[k] = p;
            if (orient3d(c[0], c[1], c[2], c[3]) != Sign::positive) return false;
        }
        return true;
    };
    int overlapping = 0, apart = 0;
    for (std::uint64_t key = 0; key < 400; ++key) {
        TetMesh m;
        const std::uint32_t shared = static_cast<std::uint32_t>(key % 4);  // how many vertices the two have in common
        for (std::uint64_t v = 0; v < 8 - shared; ++v) m.vertices.push_back({unit_double(mix64(key, 3 * v)), unit_double(mix64(key, 3 * v + 1)), unit_double(mix64(key, 3 * v + 2))});
        m.tets = {{0, 1, 2, 3}, {4 - shared, 5 - shared, 6 - shared, 7 - shared}};
        for (auto& t : m.tets)
            if (orient3d(m.vertices[t[0]], m.vertices[t[1]], m.vertices[t[2]], m.vertices[t[3]]) == Sign::negative) std::swap(t[0], t[1]);
        const bool found = certifying::overlap(SuspectMesh(m), 0, 1);
        EXPECT_EQ(found, certifying::overlap(SuspectMesh(m), 1, 0));
        bool sampled = false;
        for (std::uint64_t i = 0; i < 4000 && !sampled; ++i) {
            // barycentric coordinates in the first
            std::array<double, 4> w;
            double sum = 0;
            for (std::uint64_t k = 0; k < 4; ++k) sum += w[k] = -std::log(1 - unit_double(mix64(mix64(key, i), k)));
            Vec3 p{};
            for (std::size_t k = 0; k < 4; ++k) p = p + (w[k] / sum) * m.vertices[m.tets[0][k]];
            sampled = inside(m, 0, p) && inside(m, 1, p);
        }
        if (sampled) {
            EXPECT_TRUE(found) << key;
        }
        overlapping += sampled;
        apart += !found;
        if (!found) {
            EXPECT_FALSE(sampled) << key;
        }
    }
    EXPECT_GT(overlapping, 100);
    EXPECT_GT(apart, 50);
}

TEST(Overlap, TouchingIsNotOverlapping) {
    TetMesh m;
    m.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, {0.25, 0.25, 0}, {1, 1, -1}, {-1, -1, -1}, {1, -1, -1}};
    m.tets = {{0, 1, 2, 3}, {1, 0, 2, 4}, {5, 6, 8, 7}};
    std::swap(m.tets[2][0], m.tets[2][1]);
    for (auto& t : m.tets)
        if (orient3d(m.vertices[t[0]], m.vertices[t[1]], m.vertices[t[2]], m.vertices[t[3]]) == Sign::negative) std::swap(t[0], t[1]);
    const certifying::SuspectMesh mesh(m);
    EXPECT_FALSE(certifying::overlap(mesh, 0, 1));
    EXPECT_FALSE(certifying::overlap(mesh, 0, 2)) << "a corner in the face of the other";
    EXPECT_TRUE(certifying::overlap(mesh, 1, 2));
}

// The mesh of a cube in two ways, with the same vertices: every face has at most two tetrahedra, all are positive, the hull faces do
// not pierce anything. Only the comparison of tetrahedra finds it.
TEST(Overlap, TwoMeshesOfOneCubeAreFound) {
    TetMesh m;
    for (std::uint32_t i = 0; i < 8; ++i) m.vertices.push_back({static_cast<double>(i & 1), static_cast<double>(i >> 1 & 1), static_cast<double>(i >> 2 & 1)});
    m.tets = {{0, 3, 5, 6}, {0, 1, 3, 5}, {0, 3, 2, 6}, {0, 5, 6, 4}, {3, 5, 6, 7},   // the middle one and four corners
              {1, 2, 4, 7}, {1, 2, 0, 4}, {1, 2, 3, 7}, {1, 4, 5, 7}, {2, 4, 6, 7}};  // and the same mirrored
    for (auto& t : m.tets)
        if (orient3d(m.vertices[t[0]], m.vertices[t[1]], m.vertices[t[2]], m.vertices[t[3]]) == Sign::negative) std::swap(t[0], t[1]);
    const Certificate certificate = certify(m);
    for (const char* name : {"positive_tets", "face_sharing", "opposite_sides", "distinct_tets", "distinct_vertices", "used_vertices", "delaunay", "face_balance"})
        EXPECT_EQ(certificate.find(name)->state, Claim::State::proven) << name;
    EXPECT_EQ(certificate.find("disjoint_tets")->violations, 10U);
    m.tets.resize(5);
    EXPECT_EQ(certify(m).find("disjoint_tets")->state, Claim::State::proven);
}

// The box of the large tetrahedron's slanted face holds the other two, which are beyond its plane: that says nothing about their own faces' planes.
TEST(Overlap, IsFoundWhereAnotherPlaneIsLookedAtFirst) {
    TetMesh m;
    m.vertices = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}, {0, 0, 10}};
    for (const double x : {7.0, 7.2})
        for (const Vec3& corner : {Vec3{x, x, x}, Vec3{x + 1, x, x}, Vec3{x, x + 1, x}, Vec3{x, x, x + 1}}) m.vertices.push_back(corner);
    m.tets = {{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}};
    EXPECT_EQ(certify(m).find("positive_tets")->state, Claim::State::proven);
    EXPECT_EQ(certify(m).find("disjoint_tets")->violations, 2U);
    for (std::size_t v = 8; v < 12; ++v) m.vertices[v] = m.vertices[v] + Vec3{0, 0, 1};
    EXPECT_EQ(certify(m).find("disjoint_tets")->state, Claim::State::proven);
}

// Delaunay by faces and Delaunay by searching every ball agree, on meshes that are and on meshes that are not.
TEST(Delaunay, ProofByFacesAgreesWithTheSearch) {
    int proven = 0, refuted = 0;
    for (std::uint64_t key = 0; key < 60; ++key) {
        TetMesh mesh = two_region_box().mesh;
        const double size = key % 2 == 0 ? 1e-3 : 0.3;
        for (const std::uint32_t v : {13U, 31U}) {
            mesh.vertices[v] = mesh.vertices[v] + size * Vec3{unit_double(mix64(key, v)) - 0.5, unit_double(mix64(key, v + 100)) - 0.5, unit_double(mix64(key, v + 200)) - 0.5};
        }
        const certifying::SuspectMesh suspect(mesh);
        certifying::VertexSearch search(suspect);
        const Claim by_search = certifying::claim_delaunay(suspect, search, false);
        const Claim claim = *certify(mesh).find("delaunay");
        EXPECT_EQ(claim.violations, by_search.violations);
        EXPECT_EQ(claim.state, by_search.state);
        ++(claim.violations == 0 ? proven : refuted);
    }
    EXPECT_GT(proven, 20);
    EXPECT_GT(refuted, 10);
}

}  // namespace
}  // namespace wellmesh
