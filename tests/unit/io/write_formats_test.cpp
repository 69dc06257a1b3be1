// SPDX-License-Identifier: Apache-2.0
// What is in the files that wellmesh writes but doesn't read, and the formats' formal rules.
#include <clocale>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "quality/tet_shape.hpp"
#include "sample_files.hpp"
#include "sample_mesh.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

using testing::expect_error;
using testing::TemporaryDirectory;

std::string written(const TetMesh& mesh, const char* name, const WriteOptions& options = {}) {
    const TemporaryDirectory directory;
    write_mesh(mesh, directory / name, options);
    return TemporaryDirectory::read(directory / name);
}

/// The lines of one $Section of a .msh.
std::istringstream section(const std::string& file, const std::string& name) {
    const std::size_t first = file.find("$" + name + "\n"), last = file.find("$End" + name + "\n");
    EXPECT_NE(first, std::string::npos) << name;
    EXPECT_NE(last, std::string::npos) << name;
    return std::istringstream(file.substr(first + name.size() + 2, last - first - name.size() - 2));
}

/// The array behind one DataArray tag of a .vtu.
template <class T>
std::vector<T> appended_array(const std::string& file, const std::string& name) {
    const std::size_t tag = file.find("Name=\"" + name + "\""), at = file.find("offset=\"", tag) + 8;
    const std::size_t data = file.find("<AppendedData encoding=\"raw\">") + std::strlen("<AppendedData encoding=\"raw\">\n_");
    const std::size_t offset = data + std::stoul(file.substr(at));
    std::uint64_t size = 0;
    std::memcpy(&size, file.data() + offset, sizeof size);
    std::vector<T> values(size / sizeof(T));
    std::memcpy(values.data(), file.data() + offset + sizeof size, size);
    return values;
}

TEST(WriteMedit, HasTheSectionsInOrder) {
    const std::string file = written(testing::sample_mesh(2), "a.mesh");
    std::size_t at = 0;
    for (const char* const word :
         {"MeshVersionFormatted 2\nDimension 3\n", "Vertices\n27\n", "Edges\n24\n", "Triangles\n48\n", "Tetrahedra\n48\n", "End\n"}) {
        const std::size_t found = file.find(word, at);
        ASSERT_NE(found, std::string::npos) << word;
        at = found;
    }
}

TEST(WriteVtu, HoldsTheMeshAndItsShape) {
    const TetMesh mesh = testing::sample_mesh(3);
    const std::string file = written(mesh, "a.vtu");
    EXPECT_NE(file.find("header_type=\"UInt64\""), std::string::npos);
    EXPECT_NE(file.find("NumberOfPoints=\"64\" NumberOfCells=\"162\""), std::string::npos);
    const auto points = appended_array<double>(file, "Points");
    ASSERT_EQ(points.size(), 3 * mesh.vertices.size());
    EXPECT_EQ(std::memcmp(points.data(), mesh.vertices.data(), points.size() * sizeof(double)), 0);
    const auto connectivity = appended_array<std::int64_t>(file, "connectivity");
    ASSERT_EQ(connectivity.size(), 4 * mesh.tets.size());
    const auto offsets = appended_array<std::int64_t>(file, "offsets");
    const auto types = appended_array<std::uint8_t>(file, "types");
    const auto angles = appended_array<double>(file, "min_dihedral_angle_deg"), ratios = appended_array<double>(file, "radius_edge_ratio");
    for (const std::size_t size : {offsets.size(), types.size(), angles.size(), ratios.size()}) ASSERT_EQ(size, mesh.tets.size());
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const auto& [a, b, c, d] = mesh.tets[t];
        EXPECT_EQ(connectivity[4 * t + 3], d);
        EXPECT_EQ(offsets[t], static_cast<std::int64_t>(4 * t + 4));
        EXPECT_EQ(types[t], 10);
        const TetShape shape = shape_of(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c], mesh.vertices[d]);
        EXPECT_GT(shape.volume, 0);
        EXPECT_NEAR(angles[t], shape.min_dihedral_deg, 1e-9);
        EXPECT_NEAR(ratios[t], shape.radius_edge, 1e-12);
    }
    EXPECT_EQ(appended_array<std::int32_t>(file, "region"), mesh.tet_regions);
}

TEST(WriteMsh, NamesPhysicalGroups) {
    for (const int version : {41, 22}) {
        const std::string file = written(testing::sample_mesh(2), "a.msh", {.msh_version = version});
        EXPECT_TRUE(file.starts_with(version == 41 ? "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n" : "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"));
        for (const char* const name :
             {"\n16\n1 1 \"segment_1\"", "\n1 12 \"segment_12\"\n", "\n2 100 \"facet_marker_100\"\n", "\n2 101 \"facet_marker_-7\"\n",
              "\n3 21 \"region_-10\"\n", "\n3 20 \"region_20\"\n"})
            EXPECT_NE(file.find(name), std::string::npos) << name;
    }
}

TEST(WriteMsh, Version41IsConsistent) {
    const TetMesh mesh = testing::sample_mesh(3);
    const std::string file = written(mesh, "a.msh");
    std::set<std::pair<int, int>> entities;
    std::istringstream in = section(file, "Entities");
    int points = 0, curves = 0, surfaces = 0, volumes = 0;
    in >> points >> curves >> surfaces >> volumes;
    EXPECT_EQ((std::array{points, curves, surfaces, volumes}), (std::array{0, 12, 6, 2}));
    for (const auto& [dimension, count] : {std::pair{1, curves}, {2, surfaces}, {3, volumes}})
        for (int i = 0; i < count; ++i) {
            int tag = 0, groups = 0, group = 0, bounds = -1;
            double box[6];
            in >> tag;
            for (double& b : box) in >> b;
            in >> groups >> group >> bounds;
            ASSERT_TRUE(in) << dimension << " " << i;
            EXPECT_TRUE(box[0] <= box[3] && box[1] <= box[4] && box[2] <= box[5]);
            EXPECT_EQ(groups, 1);
            if (dimension == 2) EXPECT_EQ(group, tag <= 2 ? 100 : 101);
            else EXPECT_EQ(group, tag);
            EXPECT_EQ(bounds, 0);
            entities.emplace(dimension, tag);
        }
    in = section(file, "Nodes");
    std::size_t blocks = 0, nodes = 0, least = 0, most = 0;
    in >> blocks >> nodes >> least >> most;
    EXPECT_EQ(nodes, mesh.vertices.size());
    EXPECT_EQ(least, 1U);
    EXPECT_EQ(most, nodes);
    std::map<std::size_t, Vec3> seen;
    for (std::size_t b = 0; b < blocks; ++b) {
        int dimension = 0, tag = 0, parametric = 0;
        std::size_t count = 0;
        in >> dimension >> tag >> parametric >> count;
        EXPECT_TRUE(entities.contains({dimension, tag}));
        std::vector<std::size_t> tags(count);
        for (std::size_t& t : tags) in >> t;
        for (const std::size_t t : tags) {
            Vec3 p;
            in >> p.x >> p.y >> p.z;
            EXPECT_TRUE(seen.emplace(t, p).second) << "node " << t << " twice";
        }
    }
    ASSERT_TRUE(in);
    ASSERT_EQ(seen.size(), mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) EXPECT_EQ(seen.at(v + 1), mesh.vertices[v]);
    in = section(file, "Elements");
    std::size_t elements = 0, read = 0;
    in >> blocks >> elements >> least >> most;
    for (std::size_t b = 0; b < blocks; ++b) {
        int dimension = 0, tag = 0, type = 0;
        std::size_t count = 0;
        in >> dimension >> tag >> type >> count;
        EXPECT_TRUE(entities.contains({dimension, tag}));
        for (std::size_t i = 0; i < count * static_cast<std::size_t>(dimension + 2); ++i) {
            std::size_t value = 0;
            in >> value;
            ASSERT_TRUE(in);
            EXPECT_GE(value, 1U);
        }
        read += count;
    }
    EXPECT_EQ(read, elements);
    EXPECT_EQ(elements, mesh.tets.size() + mesh.subfaces.size() + mesh.subsegments.size());
}

TEST(WriteMsh, Version22IsConsistent) {
    const TetMesh mesh = testing::sample_mesh(2);
    const std::string file = written(mesh, "a.msh", {.msh_version = 22});
    std::istringstream in = section(file, "Elements");
    std::size_t count = 0;
    in >> count;
    ASSERT_EQ(count, mesh.tets.size() + mesh.subfaces.size() + mesh.subsegments.size());
    std::map<int, std::size_t> of_type;
    for (std::size_t e = 1; e <= count; ++e) {
        std::size_t number = 0, node = 0;
        int type = 0, tags = 0, physical = 0, elementary = 0;
        in >> number >> type >> tags >> physical >> elementary;
        EXPECT_EQ(number, e);
        EXPECT_EQ(tags, 2);
        EXPECT_GT(physical, 0);
        for (int i = 0; i < (type == 4 ? 4 : type + 1); ++i) in >> node;
        ++of_type[type];
    }
    ASSERT_TRUE(in);
    EXPECT_EQ(of_type, (std::map<int, std::size_t>{{1, mesh.subsegments.size()}, {2, mesh.subfaces.size()}, {4, mesh.tets.size()}}));
}

TEST(WriteFormats, EmptyAndPartialMeshesAreValid) {
    TetMesh mesh;
    for (const char* const name : {"a.mesh", "a.vtu", "a.msh", "a.inp", "a.node"}) EXPECT_NO_THROW((void)written(mesh, name)) << name;
    mesh = testing::sample_mesh(1);
    mesh.vertices.push_back({9, 9, 9});  // on nothing
    std::istringstream in = section(written(mesh, "a.msh"), "Nodes");
    std::size_t blocks = 0, nodes = 0;
    in >> blocks >> nodes;
    EXPECT_EQ(nodes, 9U);
}

TEST(WriteFormats, BytesDependOnTheMeshAlone) {
    const TetMesh mesh = testing::sample_mesh(2);
    for (const char* const name : {"a.mesh", "a.vtu", "a.msh", "a.inp", "a.node"}) {
        const std::string plain = written(mesh, name);
        const bool german = std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
        EXPECT_EQ(written(mesh, name), plain) << name << (german ? " in a German locale" : "");
        std::setlocale(LC_ALL, "C");
    }
}

TEST(WriteFormats, RefusesMeshesThatContradictThemselves) {
    const TemporaryDirectory directory;
    const auto refuse = [&](const TetMesh& mesh, const char* word) {
        expect_error(ErrorCode::bad_input, {word}, [&] { write_mesh(mesh, directory / "a.mesh"); });
    };
    TetMesh mesh = testing::sample_mesh(1);
    mesh.tet_regions.pop_back();
    refuse(mesh, "differ in length");
    mesh = testing::sample_mesh(1);
    mesh.tets[3][2] = 8;
    refuse(mesh, "vertex 8");
    mesh = testing::sample_mesh(1);
    mesh.vertices[2].y = std::numeric_limits<double>::quiet_NaN();
    refuse(mesh, "not finite");
    mesh = testing::sample_mesh(1);
    expect_error(ErrorCode::cannot_write, {"a.xyz", ".vtu"}, [&] { write_mesh(mesh, directory / "a.xyz"); });
    expect_error(ErrorCode::bad_options, {"43"}, [&] { write_mesh(mesh, directory / "a.msh", {.msh_version = 43}); });
    Plc plc;
    plc.vertices = {{0, 0, 0}};
    plc.facets.resize(1);
    plc.facets[0].polygons = {{0, 1, 2}};
    expect_error(ErrorCode::bad_input, {"vertex 1"}, [&] { write_plc(plc, directory / "a.poly"); });
    expect_error(ErrorCode::cannot_write, {".poly"}, [&] { write_plc(plc, directory / "a.xyz"); });
    EXPECT_TRUE(directory.files().empty());
}

}  // namespace
}  // namespace wellmesh
