// SPDX-License-Identifier: Apache-2.0
// A sound mesh, damaged in many ways: the certificate must refute it, count as brute force counts, and name what was damaged.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "brute_force.hpp"
#include "core/vec3_math.hpp"
#include "wellmesh/certificate.hpp"

namespace wellmesh {
namespace {

using testing::BoxMesh;

/// The inner grid vertex (1, 1, 1) of the first region; (2, 1, 1) is on the inner facet, (1, 2, 1) on a side.
constexpr std::uint32_t kInner = 9 + 3 + 1, kOnFacet = 18 + 3 + 1, kOnSide = 9 + 6 + 1, kOnEdge = 9;

struct Mutation {
    std::string name;
    std::function<void(TetMesh&)> damage;
    std::vector<std::string> refuted;                     ///< among the claims that are
    std::string witnessed_by{};                           ///< claim whose witness is looked at
    std::optional<std::uint64_t> witness{};               ///< its number
};

Vec3 centroid(const TetMesh& m, const std::array<std::uint32_t, 4>& t) {
    return 0.25 * ((m.vertices[t[0]] + m.vertices[t[1]]) + (m.vertices[t[2]] + m.vertices[t[3]]));
}

void drop_tet(TetMesh& m, std::size_t t) {
    m.tets.erase(m.tets.begin() + static_cast<std::ptrdiff_t>(t));
    m.tet_regions.erase(m.tet_regions.begin() + static_cast<std::ptrdiff_t>(t));
}

void add_tet(TetMesh& m, const std::array<std::uint32_t, 4>& t, std::int32_t region) {
    m.tets.push_back(t);
    m.tet_regions.push_back(region);
}

void list_triangle(TetMesh& m, const std::array<std::uint32_t, 3>& t) {
    m.subfaces.push_back(t);
    m.subface_facets.push_back(1);
    m.subface_markers.push_back(0);
}

void list_edge(TetMesh& m, const std::array<std::uint32_t, 2>& e) {
    m.subsegments.push_back(e);
    m.subsegment_segments.push_back(1);
}

/// Replaces each tetrahedron at the face by three with apex p; the face's listed triangle as well.
void split_face(TetMesh& m, const std::array<std::uint32_t, 3>& face, const Vec3& p) {
    const auto apex = static_cast<std::uint32_t>(m.vertices.size());
    m.vertices.push_back(p);
    for (std::size_t t = m.tets.size(); t-- > 0;) {
        const auto old = m.tets[t];
        const std::int32_t region = m.tet_regions[t];
        if (!std::all_of(face.begin(), face.end(), [&](std::uint32_t v) { return std::find(old.begin(), old.end(), v) != old.end(); })) continue;
        drop_tet(m, t);
        for (const std::uint32_t v : face) {
            auto part = old;
            std::replace(part.begin(), part.end(), v, apex);
            add_tet(m, part, region);
        }
    }
    for (std::size_t i = 0; i < m.subfaces.size(); ++i) {
        if (m.subfaces[i] != face) continue;
        m.subfaces[i] = {face[0], face[1], apex};
        list_triangle(m, {face[1], face[2], apex});
        list_triangle(m, {face[0], face[2], apex});
        break;
    }
}

void append_copy(TetMesh& m, const Vec3& shift) {
    const TetMesh original = m;
    const auto n = static_cast<std::uint32_t>(m.vertices.size());
    for (const Vec3& p : original.vertices) m.vertices.push_back(p + shift);
    for (std::size_t t = 0; t < original.tets.size(); ++t) {
        auto tet = original.tets[t];
        for (std::uint32_t& v : tet) v += n;
        add_tet(m, tet, original.tet_regions[t]);
    }
}

const std::vector<Mutation>& mutations() {
    static const double nan = std::numeric_limits<double>::quiet_NaN();
    static const std::vector<Mutation> all{
        {"inner_vertex_moved", [](TetMesh& m) { m.vertices[kInner].x += 0.45; }, {"delaunay"}},
        {"inner_vertex_moved_beyond_its_star", [](TetMesh& m) { m.vertices[kInner].x += 5; }, {"positive_tets", "delaunay"}},
        {"vertex_moved_off_the_hull", [](TetMesh& m) { m.vertices[kOnSide].y += 1e-6; }, {"plc_distance", "region_volumes"}},
        {"vertex_moved_off_the_inner_facet", [](TetMesh& m) { m.vertices[kOnFacet].x += 1e-6; }, {"plc_distance", "region_volumes"}},
        {"vertex_moved_into_the_facet_of_the_hull", [](TetMesh& m) { m.vertices[kOnSide].y -= 0.3; }, {"plc_distance", "region_volumes"}},
        {"corner_moved_along_an_edge", [](TetMesh& m) { m.vertices[0].x += 1e-5; }, {"plc_segments", "region_volumes"}},
        {"vertex_on_an_edge_moved_into_the_face", [](TetMesh& m) { m.vertices[kOnEdge].y += 1e-3; }, {"plc_segments", "region_volumes"}},
        {"two_vertices_at_one_place", [](TetMesh& m) { m.vertices[kInner] = m.vertices[kOnFacet]; }, {"distinct_vertices", "positive_tets"}, "distinct_vertices", kOnFacet + 1},
        {"two_vertices_swapped", [](TetMesh& m) { std::swap(m.vertices[kInner], m.vertices[kInner + 18]); }, {"positive_tets"}},
        {"vertex_in_no_tet", [](TetMesh& m) { m.vertices.push_back(centroid(m, m.tets[3])); }, {"used_vertices", "delaunay"}, "used_vertices", 46},
        {"vertex_in_no_tet_far_away", [](TetMesh& m) { m.vertices.push_back({100, 0, 0}); }, {"used_vertices"}, "used_vertices", 46},
        {"tet_inverted", [](TetMesh& m) { std::swap(m.tets[7][0], m.tets[7][1]); }, {"positive_tets"}, "positive_tets", 8},
        {"all_tets_inverted", [](TetMesh& m) { for (auto& t : m.tets) std::swap(t[2], t[3]); }, {"positive_tets", "region_volumes"}, "positive_tets", 1},
        {"tet_dropped", [](TetMesh& m) { drop_tet(m, 40); }, {"plc_area"}},
        {"tet_twice", [](TetMesh& m) { add_tet(m, m.tets[5], m.tet_regions[5]); }, {"face_sharing", "distinct_tets"}, "distinct_tets", 0},
        {"tet_twice_permuted", [](TetMesh& m) { add_tet(m, {m.tets[5][1], m.tets[5][2], m.tets[5][0], m.tets[5][3]}, 1); }, {"distinct_tets"}, "distinct_tets", 0},
        {"tet_with_a_foreign_vertex", [](TetMesh& m) { m.tets[5][2] = 44; }, {"disjoint_tets"}},
        {"tet_with_a_vertex_twice", [](TetMesh& m) { m.tets[5][2] = m.tets[5][1]; }, {"positive_tets"}, "positive_tets", 6},
        {"tet_out_of_range", [](TetMesh& m) { m.tets[5][2] = 45; }, {"numbers_in_range"}, "numbers_in_range", 6},
        {"triangle_out_of_range", [](TetMesh& m) { m.subfaces[4][0] = 4000000000U; }, {"numbers_in_range"}, "numbers_in_range", 5},
        {"edge_out_of_range", [](TetMesh& m) { m.subsegments[2][1] = 45; }, {"numbers_in_range"}, "numbers_in_range", 3},
        {"too_few_regions", [](TetMesh& m) { m.tet_regions.pop_back(); }, {"numbers_in_range"}},
        {"coordinate_not_a_number", [](TetMesh& m) { m.vertices[3].y = nan; }, {"finite_coordinates"}, "finite_coordinates", 4},
        {"coordinate_infinite", [](TetMesh& m) { m.vertices[3].z = -std::numeric_limits<double>::infinity(); }, {"finite_coordinates"}, "finite_coordinates", 4},
        {"no_tets", [](TetMesh& m) { m.tets.clear(), m.tet_regions.clear(); }, {"has_tets"}},
        {"tet_split_at_its_centroid",
         [](TetMesh& m) {
             const auto old = m.tets[9];
             const std::int32_t region = m.tet_regions[9];
             const auto p = static_cast<std::uint32_t>(m.vertices.size());
             m.vertices.push_back(centroid(m, old));
             drop_tet(m, 9);
             for (std::size_t k = 0; k < 4; ++k) {
                 auto part = old;
                 part[k] = p;
                 add_tet(m, part, region);
             }
         },
         {"delaunay"}},
        {"facet_encroached",
         [](TetMesh& m) {  // a vertex in a hull triangle, close to one of its edges
             const auto f = m.subfaces[0];
             split_face(m, f, m.vertices[f[0]] + 0.48 * (m.vertices[f[1]] - m.vertices[f[0]]) + 0.04 * (m.vertices[f[2]] - m.vertices[f[0]]));
         },
         {"gabriel_subfaces", "delaunay"}},
        {"flat_tet_on_the_hull",
         [](TetMesh& m) {
             const auto f = m.subfaces[0];
             m.vertices.push_back(m.vertices[f[0]] + 0.25 * (m.vertices[f[1]] - m.vertices[f[0]]) + 0.25 * (m.vertices[f[2]] - m.vertices[f[0]]));
             add_tet(m, {f[0], f[1], f[2], 45}, 1);
         },
         {"positive_tets"}},
        {"region_of_a_tet", [](TetMesh& m) { m.tet_regions[20] = 3 - m.tet_regions[20]; }, {"plc_distance", "plc_area", "region_volumes"}},
        {"regions_exchanged_with_the_outside", [](TetMesh& m) { std::fill(m.tet_regions.begin(), m.tet_regions.end(), 1), m.subfaces.clear(), m.subface_facets.clear(), m.subface_markers.clear(); }, {"plc_area"}},
        {"half_the_mesh_missing",
         [](TetMesh& m) {
             for (std::size_t t = m.tets.size(); t-- > 0;)
                 if (m.tet_regions[t] == 2) drop_tet(m, t);
         },
         {"used_vertices", "listed_subfaces_exist"}},
        {"triangle_listed_inside", [](TetMesh& m) { list_triangle(m, {m.tets[30][0], m.tets[30][1], m.tets[30][2]}); }, {}},
        {"triangle_listed_that_is_no_face", [](TetMesh& m) { list_triangle(m, {0, 22, 44}); }, {"listed_subfaces_exist", "plc_distance"}, "listed_subfaces_exist", 0},
        {"triangle_degenerate", [](TetMesh& m) { list_triangle(m, {3, 3, 4}); }, {"listed_subfaces_exist"}, "listed_subfaces_exist", 0},
        {"edge_listed_that_is_none", [](TetMesh& m) { list_edge(m, {0, 44}); }, {"listed_subsegments_exist", "gabriel_subsegments"}, "listed_subsegments_exist", 0},
        {"edge_degenerate", [](TetMesh& m) { list_edge(m, {5, 5}); }, {"listed_subsegments_exist"}},
        {"copy_in_place", [](TetMesh& m) { append_copy(m, {0, 0, 0}); }, {"distinct_vertices", "disjoint_tets", "plc_area"}},
        {"copy_overlapping", [](TetMesh& m) { append_copy(m, {0.4, 0.3, 0.2}); }, {"disjoint_tets", "delaunay", "plc_distance"}},
        {"squashed", [](TetMesh& m) { for (Vec3& p : m.vertices) p.z *= 1e-3; }, {"delaunay", "plc_distance", "plc_filled", "region_volumes"}},
    };
    return all;
}

class MutationTest : public ::testing::TestWithParam<std::size_t> {
protected:
    [[nodiscard]] static const Mutation& mutation() { return mutations()[GetParam()]; }
};

TEST_P(MutationTest, IsRefutedWithItsWitness) {
    BoxMesh box = testing::two_region_box();
    const TetMesh sound = box.mesh;
    mutation().damage(box.mesh);
    const Certificate certificate = certify(box.mesh, {}, &box.plc);
    for (const std::string& name : mutation().refuted) {
        const Claim* claim = certificate.find(name);
        ASSERT_NE(claim, nullptr) << name;
        EXPECT_EQ(claim->state, Claim::State::refuted) << name;
        EXPECT_GT(claim->violations, 0U) << name;
        EXPECT_FALSE(claim->detail.empty()) << name;
    }
    if (!mutation().refuted.empty()) {
        EXPECT_FALSE(certificate.proven());
    }
    for (const Claim& claim : certificate.claims) {
        EXPECT_EQ(claim.state == Claim::State::refuted, claim.violations > 0) << claim.name;
        EXPECT_EQ(claim.witness.has_value(), claim.violations > 0 && claim.name != "has_tets") << claim.name;
    }
    if (mutation().witness) {
        const Claim* claim = certificate.find(mutation().witnessed_by);
        ASSERT_TRUE(claim->witness.has_value());
        // 0 stands for the last one of its kind: it was appended.
        const std::uint64_t last = claim->witness->kind == EntityKind::tetrahedron ? box.mesh.tets.size()
                                   : claim->witness->kind == EntityKind::triangle  ? box.mesh.subfaces.size()
                                   : claim->witness->kind == EntityKind::edge      ? box.mesh.subsegments.size()
                                                                                   : 0;
        EXPECT_EQ(claim->witness->number, *mutation().witness == 0 ? last : *mutation().witness) << claim->detail;
    }
}

TEST_P(MutationTest, CountsAsBruteForceCounts) {
    BoxMesh box = testing::two_region_box();
    mutation().damage(box.mesh);
    const Certificate certificate = certify(box.mesh);
    const Claim *numbers = certificate.find("numbers_in_range"), *finite = certificate.find("finite_coordinates");
    if (numbers->state == Claim::State::refuted || finite->state == Claim::State::refuted || box.mesh.tets.empty()) {
        for (const Claim& claim : certificate.claims) {
            if (claim.name != numbers->name && claim.name != finite->name && claim.name != "has_tets") {
                EXPECT_EQ(claim.state, Claim::State::not_checked) << claim.name;
            }
        }
        return;
    }
    for (const auto& [name, count] : testing::count_by_brute_force(box.mesh)) {
        ASSERT_NE(certificate.find(name), nullptr) << name;
        EXPECT_EQ(certificate.find(name)->violations, count) << name;
    }
}

INSTANTIATE_TEST_SUITE_P(All, MutationTest, ::testing::Range(std::size_t{0}, std::size_t{39}),
                         [](const auto& test) { return mutations()[test.param].name; });

TEST(MutationTable, IsTestedCompletely) { EXPECT_EQ(mutations().size(), 39U); }

}  // namespace
}  // namespace wellmesh
