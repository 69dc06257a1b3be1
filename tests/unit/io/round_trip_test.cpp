// SPDX-License-Identifier: Apache-2.0
// What is written reads back as the same bits, through every format that is both written and read.
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "sample_files.hpp"
#include "sample_mesh.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

using testing::TemporaryDirectory;

void expect_same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        const auto bits = [](double c) { return std::bit_cast<std::uint64_t>(c); };
        EXPECT_TRUE(bits(a[i].x) == bits(b[i].x) && bits(a[i].y) == bits(b[i].y) && bits(a[i].z) == bits(b[i].z)) << i;
    }
}

/// The sample mesh, its first vertices replaced by doubles from everywhere: random bits, denormal, extreme, negative zero.
TetMesh extreme_mesh() {
    TetMesh mesh = testing::sample_mesh(4);
    using Limits = std::numeric_limits<double>;
    mesh.vertices[0] = {-0.0, Limits::denorm_min(), Limits::max()};
    mesh.vertices[1] = {Limits::lowest(), Limits::min(), 0.1 + 0.2};
    std::size_t v = 2;
    for (std::uint64_t i = 0; v < mesh.vertices.size(); ++i) {
        const Vec3 p{std::bit_cast<double>(mix64(1, i)), std::bit_cast<double>(mix64(2, i)), std::bit_cast<double>(mix64(3, i))};
        if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) mesh.vertices[v++] = p;
    }
    return mesh;
}

TEST(RoundTrip, SampleMeshIsWhatItClaims) {
    const TetMesh mesh = testing::sample_mesh(3);
    ASSERT_EQ(mesh.tets.size(), 6U * 27);
    EXPECT_EQ(mesh.subfaces.size(), 6U * 9 * 2);
    EXPECT_EQ(mesh.subsegments.size(), 12U * 3);
}

TEST(RoundTrip, MeditMesh) {
    const TemporaryDirectory directory;
    const TetMesh mesh = extreme_mesh();
    EXPECT_EQ(write_mesh(mesh, directory / "a.mesh"), std::vector{directory / "a.mesh"});
    const TetMesh back = read_mesh(directory / "a.mesh");
    expect_same_bits(back.vertices, mesh.vertices);
    EXPECT_EQ(back.tets, mesh.tets);
    EXPECT_EQ(back.tet_regions, mesh.tet_regions);
    EXPECT_EQ(back.subfaces, mesh.subfaces);
    EXPECT_EQ(back.subface_facets, mesh.subface_facets);
    EXPECT_EQ(back.subsegments, mesh.subsegments);
    EXPECT_EQ(back.subsegment_segments, mesh.subsegment_segments);
}

TEST(RoundTrip, TetgenMesh) {
    const TemporaryDirectory directory;
    TetMesh mesh = extreme_mesh();
    const auto written = write_mesh(mesh, directory / "a.ele");
    EXPECT_EQ(written, (std::vector{directory / "a.node", directory / "a.ele", directory / "a.face", directory / "a.edge"}));
    TetMesh back = read_mesh(directory / "a.node");
    expect_same_bits(back.vertices, mesh.vertices);
    EXPECT_EQ(back.tets, mesh.tets);
    EXPECT_EQ(back.tet_regions, mesh.tet_regions);
    EXPECT_EQ(back.subfaces, mesh.subfaces);
    EXPECT_EQ(back.subface_markers, mesh.subface_markers);
    EXPECT_EQ(back.subsegments, mesh.subsegments);
    EXPECT_EQ(back.subsegment_segments, mesh.subsegment_segments);
    mesh.subface_markers.assign(mesh.subfaces.size(), 0);
    write_mesh(mesh, directory / "a.ele");
    EXPECT_EQ(read_mesh(directory / "a.ele").subface_markers, mesh.subface_facets) << "an input without markers: facet numbers";
}

TEST(RoundTrip, SurfaceOfAMeditMesh) {
    const TemporaryDirectory directory;
    const TetMesh mesh = testing::sample_mesh(2);
    write_mesh(mesh, directory / "a.mesh");
    const Plc plc = read_plc(directory / "a.mesh");
    expect_same_bits(plc.vertices, mesh.vertices);
    ASSERT_EQ(plc.facets.size(), mesh.subfaces.size());
    for (std::size_t f = 0; f < plc.facets.size(); ++f) EXPECT_EQ(plc.facets[f].marker, mesh.subface_facets[f]);
}

TEST(RoundTrip, Poly) {
    const TemporaryDirectory directory;
    for (const std::uint32_t first : {0U, 1U}) {
        Plc plc;
        plc.vertices = extreme_mesh().vertices;
        plc.vertices[0].x = 0.0;  // readers of complexes make -0.0 to 0.0
        plc.vertex_markers.assign(plc.vertices.size(), -3);
        plc.facets.resize(2);
        plc.facets[0].polygons = {{0, 1, 2, 3}, {4, 5}, {6}};
        plc.facets[0].holes = {{0.1, 0.2, 0.3}, {1, 2, 3}};
        plc.facets[0].marker = -7;
        plc.facets[1].polygons = {{2, 1, 9}};
        plc.segments = {{{7, 8}, 4}};
        plc.hole_seeds = {{1e-300, 0.3, 5}};
        plc.region_seeds = {{{0.7, 0.1, 0.2}, -10, 0.01}, {{3, 2, 1}, 5, 0}};
        plc.first_number = first;
        write_plc(plc, directory / "a.poly");
        const Plc back = read_plc(directory / "a.poly");
        expect_same_bits(back.vertices, plc.vertices);
        EXPECT_EQ(back.vertex_markers, plc.vertex_markers);
        ASSERT_EQ(back.facets.size(), 2U);
        for (std::size_t f = 0; f < 2; ++f) {
            EXPECT_EQ(back.facets[f].polygons, plc.facets[f].polygons);
            expect_same_bits(back.facets[f].holes, plc.facets[f].holes);
            EXPECT_EQ(back.facets[f].marker, plc.facets[f].marker);
        }
        ASSERT_EQ(back.segments.size(), 1U);
        EXPECT_EQ(back.segments[0].vertices, plc.segments[0].vertices);
        EXPECT_EQ(back.segments[0].marker, 4);
        expect_same_bits(back.hole_seeds, plc.hole_seeds);
        ASSERT_EQ(back.region_seeds.size(), 2U);
        EXPECT_EQ(back.region_seeds[0].point, plc.region_seeds[0].point);
        EXPECT_EQ(back.region_seeds[0].id, -10);
        EXPECT_EQ(back.region_seeds[0].max_volume, 0.01);
        EXPECT_LE(back.region_seeds[1].max_volume, 0);
        EXPECT_EQ(back.first_number, first);
    }
}

// The same surface, made independently in every text format, is the same complex.
TEST(RoundTrip, FormatsAgree) {
    const TemporaryDirectory directory;
    const testing::Surface surface = testing::triangulated(testing::sample_surface());
    const std::pair<const char*, std::string> files[] = {{"a.off", testing::off_text(surface)},
                                                         {"a.obj", testing::obj_text(surface)},
                                                         {"a.ply", testing::ply_bytes(surface, "ascii", true)},
                                                         {"a.mesh", testing::medit_text(surface)},
                                                         {"a.poly", testing::poly_text(surface, false)},
                                                         {"a.smesh", testing::poly_text(surface, true)},
                                                         {"b.ply", testing::ply_bytes(surface, "binary_big_endian", true)}};
    for (const auto& [name, bytes] : files) {
        const Plc plc = read_plc(directory.write(name, bytes));
        expect_same_bits(plc.vertices, surface.vertices);
        ASSERT_EQ(plc.facets.size(), surface.polygons.size()) << name;
        for (std::size_t f = 0; f < plc.facets.size(); ++f) EXPECT_EQ(plc.facets[f].polygons, testing::Polygons{surface.polygons[f]}) << name;
        EXPECT_EQ(plc.source_name, (directory / name).string());
    }
}

}  // namespace
}  // namespace wellmesh
