// SPDX-License-Identifier: Apache-2.0
// Damaged files of every format end in a MeshError or in a result that is consistent in itself, and in memory that is
// proportional to the file: cut at every byte, bytes flipped, numbers replaced by huge ones, other formats' content, noise.
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <new>

#include <gtest/gtest.h>

#include "expect_error.hpp"
#include "io/readers.hpp"
#include "foreign_meshes.hpp"
#include "sample_files.hpp"
#include "sample_mesh.hpp"
#include "wellmesh/io.hpp"

namespace {

// Bytes that operator new holds, and the most since the last reset.
std::atomic<std::size_t> g_live{0}, g_peak{0};

void* counted_allocation(std::size_t size) {
    void* const memory = std::malloc(std::max<std::size_t>(size, 1));
    if (memory == nullptr) throw std::bad_alloc();
    const std::size_t live = g_live.fetch_add(malloc_usable_size(memory)) + malloc_usable_size(memory);
    if (live > g_peak.load()) g_peak.store(live);
    return memory;
}

void counted_free(void* memory) noexcept {
    if (memory == nullptr) return;
    g_live.fetch_sub(malloc_usable_size(memory));
    std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) { return counted_allocation(size); }
void* operator new[](std::size_t size) { return counted_allocation(size); }
void operator delete(void* memory) noexcept { counted_free(memory); }
void operator delete[](void* memory) noexcept { counted_free(memory); }
void operator delete(void* memory, std::size_t) noexcept { counted_free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { counted_free(memory); }

namespace wellmesh::io {
namespace {

using testing::source_of;

bool finite(const Vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

bool consistent(const Plc& plc) {
    const auto in_range = [&](std::uint32_t v) { return v < plc.vertices.size(); };
    for (const PlcFacet& facet : plc.facets) {
        for (const auto& polygon : facet.polygons)
            if (!std::all_of(polygon.begin(), polygon.end(), in_range)) return false;
        if (!std::all_of(facet.holes.begin(), facet.holes.end(), finite)) return false;
    }
    for (const PlcSegment& segment : plc.segments)
        if (!std::all_of(segment.vertices.begin(), segment.vertices.end(), in_range)) return false;
    const auto empty_or = [](const auto& lines, std::size_t n) { return lines.empty() || lines.size() == n; };
    return std::all_of(plc.vertices.begin(), plc.vertices.end(), finite) && empty_or(plc.vertex_lines, plc.vertices.size()) &&
           empty_or(plc.facet_lines, plc.facets.size()) && empty_or(plc.vertex_markers, plc.vertices.size()) &&
           plc.relative_rounding >= 0 && plc.relative_rounding < 1;
}

bool consistent(const TetMesh& mesh) {
    const auto in_range = [&](const auto& elements) {
        return std::all_of(elements.begin(), elements.end(),
                           [&](const auto& e) { return std::all_of(e.begin(), e.end(), [&](auto v) { return v < mesh.vertices.size(); }); });
    };
    return in_range(mesh.tets) && in_range(mesh.subfaces) && in_range(mesh.subsegments) && mesh.tets.size() == mesh.tet_regions.size() &&
           mesh.subfaces.size() == mesh.subface_facets.size() && mesh.subfaces.size() == mesh.subface_markers.size() &&
           mesh.subsegments.size() == mesh.subsegment_segments.size() && std::all_of(mesh.vertices.begin(), mesh.vertices.end(), finite);
}

bool consistent(const std::vector<Vec3>& points) {
    return std::all_of(points.begin(), points.end(), finite);
}

struct Format {
    std::string name, valid;
    std::function<bool(const SourceFile&)> read;  // whether the result is consistent
};

std::vector<Format> formats() {
    const testing::Surface quads = testing::sample_surface(), triangles = testing::triangulated(testing::sample_surface(true));
    const auto plc = [](Plc (*reader)(const SourceFile&)) { return [reader](const SourceFile& source) { return consistent(reader(source)); }; };
    const testing::TemporaryDirectory directory;
    write_mesh(testing::sample_mesh(2), directory / "a.mesh");
    const std::string medit = testing::TemporaryDirectory::read(directory / "a.mesh");
    const auto written = [&](const char* name, int version = 41) {
        write_mesh(testing::sample_mesh(1), directory / name, {.msh_version = version});
        return testing::TemporaryDirectory::read(directory / name);
    };
    const std::string vtu = written("b.vtu"), msh41 = written("b.msh"), msh22 = written("b.msh", 22);
    const auto mesh = [](TetMesh (*reader)(const SourceFile&)) { return [reader](const SourceFile& source) { return consistent(reader(source)); }; };
    write_plc(read_ply(source_of(testing::ply_bytes(quads, "ascii", true))), directory / "b.vtp");
    const std::string vtp = testing::TemporaryDirectory::read(directory / "b.vtp");
    return {{"off", testing::off_text(quads), plc(read_off)},
            {"obj", testing::obj_text(quads), plc(read_obj)},
            {"stl text", testing::stl_text(triangles), plc(read_stl)},
            {"stl binary", testing::stl_binary(triangles), plc(read_stl)},
            {"ply text", testing::ply_bytes(quads, "ascii", true), plc(read_ply)},
            {"ply little", testing::ply_bytes(quads, "binary_little_endian", true), plc(read_ply)},
            {"ply big", testing::ply_bytes(quads, "binary_big_endian", false), plc(read_ply)},
            {"poly", testing::poly_text(quads, false), plc(read_poly)},
            {"smesh", testing::poly_text(quads, true), plc(read_smesh)},
            {"medit surface", testing::medit_text(quads), plc(read_medit_surface)},
            {"medit mesh", medit, [](const SourceFile& source) { return consistent(read_medit_mesh(source)); }},
            {"msh 4.1", msh41, mesh(read_msh_mesh)},
            {"msh 2.2", msh22, mesh(read_msh_mesh)},
            {"msh binary", testing::msh_binary(testing::sample_mesh(1), true), mesh(read_msh_mesh)},
            {"msh surface", msh22, plc(read_msh_surface)},
            {"vtu", vtu, mesh(read_vtu_mesh)},
            {"vtu compressed", testing::vtu_text(testing::sample_mesh(1), {.base64 = true, .compressed = true}), mesh(read_vtu_mesh)},
            {"vtp", vtp, plc(read_vtp_surface)},
            {"xyz", "1 2 3\n4 5 6\n7.5 8 1e3\n", [](const SourceFile& source) { return consistent(read_xyz_points(source)); }},
            {"node", "3 3 1 1\n1 0 0 0 0.5 1\n2 1 0 0 0.5 1\n3 1 1 0 0.5 2\n",
             [](const SourceFile& source) { return consistent(read_node_points(source)); }}};
}

/// Bytes of memory a byte of input may cost: 2-byte faces without corners make facets of about 150 bytes; 64 KiB for the rest.
constexpr std::size_t kBytesPerByte = 150, kFixedBytes = 65536;

enum class Outcome { error, result };

Outcome read_damaged(const Format& format, std::string bytes) {
    const SourceFile source = source_of(std::move(bytes), "nowhere/damaged");
    const std::size_t before = g_live.load();
    g_peak.store(before);
    Outcome outcome = Outcome::result;
    try {
        EXPECT_TRUE(format.read(source)) << format.name;
    } catch (const MeshError& error) {
        outcome = Outcome::error;
        EXPECT_TRUE(error.code() == ErrorCode::bad_input || error.code() == ErrorCode::cannot_read) << error.what();
        EXPECT_EQ(error.stage(), Stage::read);
        EXPECT_LT(std::string(error.what()).size(), 400U);
    }
    EXPECT_LE(g_peak.load() - before, kFixedBytes + kBytesPerByte * source.bytes.size()) << format.name << ", " << source.bytes.size() << " bytes";
    return outcome;
}

TEST(MalformedFiles, ValidOnesAreRead) {
    for (const Format& format : formats()) EXPECT_EQ(read_damaged(format, format.valid), Outcome::result) << format.name;
}

TEST(MalformedFiles, CutAtEveryByte) {
    for (const Format& format : formats()) {
        std::size_t errors = 0;
        for (std::size_t size = 0; size < format.valid.size(); ++size)
            errors += read_damaged(format, format.valid.substr(0, size)) == Outcome::error ? 1U : 0U;
        // OBJ and xyz have no counts and no end mark: a cut between lines, or within a number, is another valid file.
        const bool countless = format.name == "obj" || format.name == "xyz";
        EXPECT_GE(errors * 10, format.valid.size() * (countless ? 1 : 8)) << format.name << ": " << errors << " of " << format.valid.size();
    }
}

TEST(MalformedFiles, FlippedAndReplacedBytes) {
    constexpr std::string_view kReplacements{"\0\n\r \"#-.0e9\x7f\xff/\\", 16};
    for (const Format& format : formats()) {
        std::size_t errors = 0, tries = 0;
        for (std::uint64_t round = 0; round < 3000; ++round) {
            std::string damaged = format.valid;
            for (std::uint64_t i = 0; i <= round % 3; ++i) {
                const std::uint64_t random = mix64(round, i);
                char& byte = damaged[(random >> 8) % damaged.size()];
                byte =
                    (random & 1) != 0 ? kReplacements[(random >> 40) % kReplacements.size()] : static_cast<char>(byte ^ (1 << ((random >> 1) & 7)));
            }
            errors += read_damaged(format, damaged) == Outcome::error ? 1U : 0U;
            ++tries;
        }
        EXPECT_GT(errors, tries / 100) << format.name;  // most bytes of a binary STL are harmless
        EXPECT_LT(errors, tries) << format.name;
    }
}

TEST(MalformedFiles, NumbersReplacedByOthers) {
    for (const Format& format : formats())
        for (std::size_t at = 0; at < format.valid.size(); ++at) {
            const auto digit = [&](std::size_t i) { return i < format.valid.size() && format.valid[i] >= '0' && format.valid[i] <= '9'; };
            if (!digit(at) || (at > 0 && digit(at - 1))) continue;
            std::size_t end = at;
            while (digit(end)) ++end;
            for (const char* const number :
                 {"99999999999999999999", "18446744073709551615", "4294967295", "353535235358", "2147483648", "-1", "nan", "1e999", "x"}) {
                std::string damaged = format.valid;
                damaged.replace(at, end - at, number);
                (void)read_damaged(format, damaged);
            }
        }
}

TEST(MalformedFiles, LinesDroppedAndRepeated) {
    for (const Format& format : formats()) {
        std::vector<std::size_t> starts{0};
        for (std::size_t i = 0; i + 1 < format.valid.size(); ++i)
            if (format.valid[i] == '\n') starts.push_back(i + 1);
        starts.push_back(format.valid.size());
        for (std::size_t l = 0; l + 1 < starts.size(); ++l) {
            const std::string line = format.valid.substr(starts[l], starts[l + 1] - starts[l]);
            std::string dropped = format.valid, repeated = format.valid;
            (void)read_damaged(format, dropped.erase(starts[l], line.size()));
            (void)read_damaged(format, repeated.insert(starts[l], line));
        }
    }
}

TEST(MalformedFiles, OtherFormatsAndNoise) {
    const std::vector<Format> all = formats();
    std::vector<std::string> contents{std::string(4096, '\0'),
                                      std::string(100000, '\n'),
                                      std::string(100000, '9'),
                                      "\xff\xfe"
                                      "O\0F\0F\0",
                                      "PK\x03\x04",
                                      "{\"json\": [1, 2]}"};
    for (std::uint64_t i = 0; i < 50; ++i) {
        std::string noise;
        for (std::uint64_t k = 0; k < 40 * i; ++k) testing::append_number(noise, mix64(i, k), true);
        contents.push_back(noise);
    }
    for (const Format& reader : all) {
        for (const std::string& content : contents) EXPECT_EQ(read_damaged(reader, content), Outcome::error) << reader.name;
        for (const Format& other : all) {
            const bool related = reader.valid == other.valid || reader.name.substr(0, 3) == other.name.substr(0, 3) ||
                                 (reader.name == "xyz" && (other.name == "xyz")) || (reader.name == "medit surface" && other.name == "medit mesh");
            if (!related) (void)read_damaged(reader, other.valid);
        }
    }
}

TEST(MalformedFiles, EmptyFilesDirectoriesAndDevices) {
    const testing::TemporaryDirectory directory;
    for (const char* const name : {"a.off", "a.stl", "a.obj", "a.ply", "a.poly", "a.smesh", "a.mesh"}) {
        testing::expect_error(ErrorCode::cannot_read, {name, "No such file"}, [&] { (void)wellmesh::read_plc(directory / name); });
        directory.write(name, "");
        testing::expect_error(ErrorCode::bad_input, {name, "empty"}, [&] { (void)wellmesh::read_plc(directory / name); });
        std::filesystem::remove(directory / name);
        std::filesystem::create_directory(directory / name);
        testing::expect_error(ErrorCode::cannot_read, {name, "directory"}, [&] { (void)wellmesh::read_plc(directory / name); });
    }
    std::filesystem::create_symlink("/dev/zero", directory / "b.off");
    testing::expect_error(ErrorCode::cannot_read, {"b.off", "regular"}, [&] { (void)wellmesh::read_plc(directory / "b.off"); });
    testing::expect_error(ErrorCode::cannot_read, {"c.step", ".off"}, [&] { (void)wellmesh::read_plc(directory / "c.step"); });
    testing::expect_error(ErrorCode::cannot_read, {"c.off"}, [&] { (void)wellmesh::read_mesh(directory / "c.off"); });
}

}  // namespace
}  // namespace wellmesh::io
