// SPDX-License-Identifier: Apache-2.0
// Names, markers and numbers of entities through every format, as far as it carries them; and what it is said not to carry.
#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "sample_files.hpp"
#include "sample_mesh.hpp"
#include "wellmesh/convert.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

using testing::TemporaryDirectory;

TetMesh named_mesh() {
    TetMesh mesh = testing::sample_mesh(2);
    for (std::int32_t& region : mesh.tet_regions) region = region < 0 ? -10 : 20;
    for (const std::int32_t segment : mesh.subsegment_segments) mesh.subsegment_markers.push_back(segment % 3 == 0 ? 0 : segment % 2 == 0 ? 4 : -4);
    mesh.vertex_markers.assign(mesh.vertices.size(), 0);
    mesh.vertex_markers[3] = 9;
    mesh.vertex_markers[11] = -9;
    mesh.names.of_dimension[0][9] = "probe";
    mesh.names.of_dimension[1][4] =
        "weld, \xc3\xa4u\xc3\x9f"
        "ere";
    mesh.names.of_dimension[2][100] = "wall <hot> & 'dry'";
    mesh.names.of_dimension[3][20] = "wall <hot> & 'dry'";  // the same name in another dimension
    return mesh;
}

template <std::size_t N>
auto rows(const std::vector<std::array<std::uint32_t, N>>& corners, const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
    std::vector<std::tuple<std::array<std::uint32_t, N>, std::int32_t, std::int32_t>> out;
    for (std::size_t i = 0; i < corners.size(); ++i) out.emplace_back(corners[i], a.empty() ? 0 : a[i], b.empty() ? 0 : b[i]);
    std::sort(out.begin(), out.end());
    return out;
}

void expect_same(const TetMesh& back, const TetMesh& mesh) {
    EXPECT_EQ(back.vertices, mesh.vertices);
    EXPECT_EQ(rows(back.tets, back.tet_regions, {}), rows(mesh.tets, mesh.tet_regions, {}));
    EXPECT_EQ(rows(back.subfaces, back.subface_facets, back.subface_markers), rows(mesh.subfaces, mesh.subface_facets, mesh.subface_markers));
    EXPECT_EQ(rows(back.subsegments, back.subsegment_segments, back.subsegment_markers),
              rows(mesh.subsegments, mesh.subsegment_segments, mesh.subsegment_markers));
    EXPECT_EQ(back.vertex_markers, mesh.vertex_markers);
    EXPECT_EQ(back.names, mesh.names);
}

TEST(MeshNames, ComeBackFromMshAndVtu) {
    const TemporaryDirectory directory;
    const TetMesh mesh = named_mesh();
    for (const auto& [name, version] : {std::pair{"a.msh", 41}, {"b.msh", 22}, {"a.vtu", 41}}) {
        SCOPED_TRACE(name);
        EXPECT_TRUE(not_carried(mesh, directory / name).empty());
        write_mesh(mesh, directory / name, {.msh_version = version});
        expect_same(read_mesh(directory / name), mesh);
    }
}

TEST(MeshNames, WithoutMarkersEntitiesComeBack) {
    const TemporaryDirectory directory;
    TetMesh mesh = testing::sample_mesh(2);
    mesh.subface_markers.assign(mesh.subfaces.size(), 0);
    for (const auto& [name, version] : {std::pair{"a.msh", 41}, {"b.msh", 22}, {"a.vtu", 41}}) {
        SCOPED_TRACE(name);
        write_mesh(mesh, directory / name, {.msh_version = version});
        expect_same(read_mesh(directory / name), mesh);
    }
}

TEST(MeshNames, OneEntityWithSeveralMarkers) {  // meshes of other programs
    const TemporaryDirectory directory;
    TetMesh mesh = testing::sample_mesh(2);
    mesh.subface_facets.assign(mesh.subfaces.size(), -1);
    for (std::size_t f = 0; f < mesh.subfaces.size(); ++f) mesh.subface_markers[f] = static_cast<std::int32_t>(f % 3);
    write_mesh(mesh, directory / "a.msh");
    const TetMesh back = read_mesh(directory / "a.msh");
    EXPECT_EQ(rows(back.subfaces, back.subface_markers, {}), rows(mesh.subfaces, mesh.subface_markers, {}));
}

TEST(MeshNames, MeditReferencesAreNumbersOrMarkers) {
    const TemporaryDirectory directory;
    TetMesh mesh = named_mesh();
    mesh.vertex_carriers.assign(mesh.vertices.size(), {CarrierKind::region, 1});
    mesh.vertex_carriers[5] = {CarrierKind::input_vertex, 40};
    write_mesh(mesh, directory / "a.mesh");
    write_mesh(mesh, directory / "b.mesh", {.references = References::marker});
    const TetMesh numbers = read_mesh(directory / "a.mesh"), markers = read_mesh(directory / "b.mesh");
    EXPECT_EQ(numbers.subface_facets, mesh.subface_facets);
    EXPECT_EQ(numbers.subsegment_segments, mesh.subsegment_segments);
    EXPECT_EQ(numbers.vertex_markers[5], 41);
    EXPECT_EQ(numbers.vertex_markers[3], 0);
    EXPECT_EQ(markers.subface_facets, mesh.subface_markers);
    EXPECT_EQ(markers.subsegment_segments, mesh.subsegment_markers);
    EXPECT_EQ(markers.vertex_markers, mesh.vertex_markers);
    EXPECT_EQ(not_carried(mesh, "a.mesh").size(), 5U) << "four names, and markers";
}

TEST(MeshNames, TetgenCarriesMarkers) {
    const TemporaryDirectory directory;
    const TetMesh mesh = named_mesh();
    write_mesh(mesh, directory / "a.node");
    const TetMesh back = read_mesh(directory / "a.node");
    EXPECT_EQ(back.subface_markers, mesh.subface_markers);
    EXPECT_EQ(back.subsegment_markers, mesh.subsegment_markers);
    EXPECT_EQ(back.vertex_markers, mesh.vertex_markers);
    EXPECT_EQ(not_carried(mesh, "a.ele").size(), 4U);
}

/// The sample box with markers, a wire, a point, seeds and names; one side has a hole and another is two polygons.
Plc named_complex() {
    Plc plc;
    plc.vertices = {{0, 0, 0}, {1, 0, 0},       {1, 1, 0},       {0, 1, 0},      {0, 0, 1},       {1, 0, 1},      {1, 1, 1},
                    {0, 1, 1}, {0.25, 0.25, 1}, {0.75, 0.25, 1}, {0.5, 0.75, 1}, {0.5, 0.5, 0.5}, {0.5, 0.4, 0.6}};
    const std::vector<std::vector<std::uint32_t>> sides{{3, 2, 1, 0}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    for (std::size_t f = 0; f < sides.size(); ++f) plc.facets.push_back({{sides[f]}, {}, f < 3 ? 5 : -6});
    plc.facets.push_back({{{4, 5, 6, 7}, {8, 9, 10}}, {{0.5, 0.5, 1}}, 7});
    plc.facets.push_back({{{8, 9, 10}}, {}, 8});
    plc.facets.push_back({{{12}}, {}, 0});
    plc.segments.push_back({{8, 11}, 3});
    plc.vertex_markers.assign(plc.vertices.size(), 0);
    plc.vertex_markers[11] = 2;
    plc.hole_seeds = {{9, 9, 9}};
    plc.region_seeds = {{{0.1, 0.1, 0.1}, 4, 0}};
    plc.names.of_dimension[0][2] = "sensor";
    plc.names.of_dimension[1][3] = "wire";
    plc.names.of_dimension[2] = {{5, "side"}, {8, "window of glass"}};
    plc.names.of_dimension[3][4] = "air";
    return plc;
}

double area_of(const Plc& plc, std::int32_t marker, const std::string& name) {
    double sum = 0;
    for (const PlcFacet& facet : plc.facets) {
        const std::string* its = plc.names.find(2, facet.marker);
        if (name.empty() ? facet.marker != marker : its == nullptr || *its != name) continue;
        const auto& p = facet.polygons[0];
        Vec3 n{};
        for (std::size_t i = 2; i < p.size(); ++i) {
            const Vec3 &a = plc.vertices[p[0]], &b = plc.vertices[p[i - 1]], &c = plc.vertices[p[i]];
            const Vec3 u{b.x - a.x, b.y - a.y, b.z - a.z}, v{c.x - a.x, c.y - a.y, c.z - a.z};
            n = {n.x + u.y * v.z - u.z * v.y, n.y + u.z * v.x - u.x * v.z, n.z + u.x * v.y - u.y * v.x};
        }
        sum += std::hypot(n.x, n.y, n.z) / 2;
    }
    return sum;
}

TEST(ComplexNames, ThroughEveryFormat) {
    const TemporaryDirectory directory;
    const Plc plc = named_complex();
    struct Case {
        const char* file;
        std::size_t losses;
        bool markers, names, segments, vertex_markers, seeds, point;
        WriteOptions options;
    };
    const std::vector<Case> cases{{"a.poly", 4, true, false, true, true, true, true, {}},
                                  {"a.smesh", 5, true, false, true, true, true, true, {}},
                                  {"a.obj", 8, true, true, true, false, false, false, {}},
                                  {"a.stl", 11, true, true, false, false, false, false, {}},
                                  {"b.stl", 14, false, false, false, false, false, false, {.binary_stl = true}},
                                  {"a.off", 12, false, false, false, false, false, false, {}},
                                  {"a.ply", 12, false, false, false, false, false, false, {}},
                                  {"a.mesh", 8, true, false, true, true, false, true, {}},
                                  {"a.msh", 6, true, true, true, true, false, false, {}},
                                  {"b.msh", 6, true, true, true, true, false, false, {.msh_version = 22}},
                                  {"a.vtp", 4, true, true, true, true, false, true, {}}};
    for (const Case& c : cases) {
        SCOPED_TRACE(c.file);
        const auto losses = not_carried(plc, directory / c.file, c.options);
        std::string list;
        for (const auto& loss : losses) list += loss + '\n';
        EXPECT_EQ(losses.size(), c.losses) << list;
        write_plc(plc, directory / c.file, c.options);
        const Plc back = read_plc(directory / c.file);
        EXPECT_NEAR(area_of(back, 8, c.names ? "window of glass" : ""), c.markers || c.names ? 0.125 : 0, 1e-12);
        EXPECT_NEAR(area_of(back, 5, c.names ? "side" : ""), c.markers || c.names ? 3 : 0, 1e-12);
        if (c.markers) {
            EXPECT_NEAR(area_of(back, -6, ""), 2, 1e-12);
        }
        if (c.file != std::string("a.poly")) {
            EXPECT_NEAR(area_of(back, 7, ""), c.markers ? 0.875 : 0, 1e-12) << "what the hole leaves";
        }
        ASSERT_EQ(back.segments.size(), c.segments ? 1U : 0U);
        if (c.segments) {
            EXPECT_TRUE(back.segments[0].marker == 3 ||
                        (back.names.find(1, back.segments[0].marker) && *back.names.find(1, back.segments[0].marker) == "wire"));
            EXPECT_EQ(back.vertices[back.segments[0].vertices[1]], (Vec3{0.5, 0.5, 0.5}));
        }
        EXPECT_EQ(back.vertex_markers.empty() ? 0 : back.vertex_markers[11], c.vertex_markers ? 2 : 0);
        EXPECT_EQ(back.region_seeds.size() + back.hole_seeds.size(), c.seeds ? 2U : 0U);
        const bool point = std::any_of(back.facets.begin(), back.facets.end(), [](const PlcFacet& f) { return f.polygons[0].size() == 1; });
        if (c.file != std::string("a.vtp")) {
            EXPECT_EQ(point, c.point);
        }
    }
}

TEST(ComplexNames, SurfacesKeepTheirRule) {
    const TemporaryDirectory directory;
    const testing::Surface quads = testing::sample_surface();
    const auto off = directory.write("a.off", testing::off_text(quads));
    const Plc plc = read_plc(off);
    for (const char* name : {"b.off", "b.obj", "b.ply", "b.stl", "b.mesh", "b.msh", "b.vtp"}) {
        write_plc(plc, directory / name);
        const Plc back = read_plc(directory / name);
        EXPECT_EQ(back.fill, FillRule::nonzero_winding) << name;
        EXPECT_EQ(back.vertices.size(), 8U) << name;
        for (const PlcFacet& f : back.facets) EXPECT_EQ(f.marker, 0) << name;
    }
}

TEST(ComplexNames, LostDigitsStayKnown) {
    const TemporaryDirectory directory;
    testing::Surface quads = testing::sample_surface();
    for (Vec3& p : quads.vertices) p = {std::round(p.x * 1e5) / 1e5, std::round(p.y * 1e5) / 1e5, std::round(p.z * 1e5) / 1e5};
    const Plc plc = read_plc(directory.write("a.off", testing::off_text(quads)));
    ASSERT_GT(plc.relative_rounding, 1e-7);
    for (const char* name : {"b.obj", "b.mesh", "b.msh", "b.vtp"}) {
        write_plc(plc, directory / name);
        EXPECT_EQ(read_plc(directory / name).relative_rounding, plc.relative_rounding) << name;
    }
}

TEST(ComplexNames, ObjGroupsAndStlSolids) {
    const TemporaryDirectory directory;
    const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
    const Plc obj = read_plc(directory.write("a.obj", v + "o part\ng base\nf 1 3 2\ng walls of it\nf 1 2 4\nf 2 3 4\nusemtl red\nf 1 4 3\n"));
    EXPECT_EQ(*obj.names.find(2, obj.facets[0].marker), "base");
    EXPECT_EQ(*obj.names.find(2, obj.facets[1].marker), "walls of it");
    EXPECT_EQ(*obj.names.find(2, obj.facets[3].marker), "walls of it/red");
    EXPECT_TRUE(read_plc(directory.write("b.obj", v + "g all\nf 1 3 2\nf 1 2 4\n")).names.empty()) << "one group tells nothing apart";
    const auto facet = [](const char* c) {
        return std::string("facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex ") + c + "\nendloop\nendfacet\n";
    };
    const Plc stl = read_plc(directory.write("a.stl", "solid  Inner case \n" + facet("0 1 0") + "endsolid\nsolid\n" + facet("0 0 1") + "endsolid\n"));
    EXPECT_EQ(*stl.names.find(2, 1), "Inner case");
    EXPECT_EQ(stl.names.find(2, 2), nullptr);
}

TEST(SimpleFacets, RefusesWhatHasNoTriangles) {
    Plc plc = named_complex();
    plc.facets[5].polygons = {{4, 5, 7, 6}};  // a bow tie
    plc.facets[5].holes.clear();
    testing::expect_error(ErrorCode::bad_input, {"facet 5", "cross"}, [&] { (void)with_simple_facets(plc, 3); });
    EXPECT_NO_THROW((void)with_simple_facets(plc, 4)) << "a polygon of four corners is stated as it is";
}

TEST(SimpleFacets, TurnAsTheOuterPolygon) {
    for (const bool reversed : {false, true}) {
        Plc plc = named_complex();
        if (reversed) std::reverse(plc.facets[5].polygons[0].begin(), plc.facets[5].polygons[0].end());
        for (const PlcFacet& facet : with_simple_facets(plc, 3).facets) {
            if (facet.marker != 7) continue;
            const auto& p = facet.polygons[0];
            const Vec3 &a = plc.vertices[p[0]], &b = plc.vertices[p[1]], &c = plc.vertices[p[2]];
            EXPECT_EQ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0, !reversed);
        }
    }
}

}  // namespace
}  // namespace wellmesh
