// SPDX-License-Identifier: Apache-2.0
// What is read, and what is said of what can't be read, is the same for any number of threads.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/rng.hpp"
#include "io/text_rows.hpp"
#include "sample_files.hpp"
#include "support/any_threads.hpp"
#include "wellmesh/io.hpp"

namespace wellmesh {
namespace {

using testing::TemporaryDirectory;

class Random {
public:
    explicit Random(std::uint64_t seed) : seed_(seed) {}
    std::uint64_t below(std::uint64_t n) { return mix64(seed_, count_++) % n; }
    bool one_in(std::uint64_t n) { return below(n) == 0; }
    double real() { return 2 * unit_double(mix64(seed_, count_++)) - 1; }

private:
    std::uint64_t seed_, count_ = 0;
};

constexpr std::uint64_t kVertices = 7000, kCells = 14000;  // text of five to twenty stretches

/// Lines of a file; rows are those that make up the long lists.
struct Line {
    std::string text;
    bool is_row = true;
};
using Lines = std::vector<Line>;

std::string point(Random& random) {
    switch (random.below(8)) {
        case 0: return fmt::format("{} {} {}", random.below(9), -0.5, "-0.0");
        case 1: return fmt::format("{:.7e} {:.3f} +{}", random.real(), random.real(), random.below(1000));
        default: return fmt::format("{} {} {}", random.real(), random.real(), random.real());
    }
}

/// Numbers of `n` vertices from `first`.
std::string corners(Random& random, std::uint64_t n, std::uint64_t first) {
    std::string out;
    for (std::uint64_t i = 0; i < n; ++i) out += fmt::format("{}{}", i == 0 ? "" : " ", first + random.below(kVertices));
    return out;
}

void add_points(Lines& lines, Random& random, const char* before = "", const char* behind = "") {
    for (std::uint64_t v = 0; v < kVertices; ++v) lines.push_back({fmt::format("{}{}{}", before, point(random), behind)});
}

void add_nodes(Lines& lines, Random& random) {
    lines.push_back({fmt::format("{} 3 1 1", kVertices), false});
    for (std::uint64_t v = 0; v < kVertices; ++v) lines.push_back({fmt::format("{} {} {} {}", v + 1, point(random), random.real(), random.below(3))});
}

enum class Kind { points, mesh, plc };

struct Format {
    std::string file;
    Kind kind;
    bool comments, free;  // whether '#' begins one; whether rows may end anywhere
    std::function<void(Lines&, Random&)> make;
};

const std::vector<Format>& formats() {
    static const std::vector<Format> all{
        {"a.node", Kind::points, true, false, add_nodes},
        {"a.xyz", Kind::points, true, false, [](Lines& lines, Random& random) { add_points(lines, random); }},
        {"a.ele", Kind::mesh, true, false, [](Lines& lines, Random& random) {
            lines.push_back({fmt::format("{} 4 1", kCells), false});
            for (std::uint64_t t = 0; t < kCells; ++t) lines.push_back({fmt::format("{} {} {}", t + 1, corners(random, 4, 1), random.below(4))});
        }},
        {"a.mesh", Kind::mesh, true, true, [](Lines& lines, Random& random) {
            lines.push_back({fmt::format("MeshVersionFormatted 2 Dimension 3 Vertices {}", kVertices), false});
            add_points(lines, random, "", " 0");
            lines.push_back({fmt::format("Triangles {}", kCells), false});
            for (std::uint64_t t = 0; t < kCells; ++t) lines.push_back({corners(random, 3, 1) + " 5"});
            lines.push_back({fmt::format("Ridges {}", kCells), false});
            for (std::uint64_t t = 0; t < kCells; ++t) lines.push_back({std::to_string(t)});
            lines.push_back({fmt::format("Tetrahedra {}", kCells), false});
            for (std::uint64_t t = 0; t < kCells; ++t) lines.push_back({corners(random, 4, 1) + " 7"});
            lines.push_back({"End", false});
        }},
        {"surface.mesh", Kind::plc, true, true, [](Lines& lines, Random& random) {
            lines.push_back({fmt::format("MeshVersionFormatted 2 Dimension 3 Vertices {}", kVertices), false});
            add_points(lines, random, "", " 0");
            lines.push_back({fmt::format("Quadrilaterals {}", kCells), false});
            for (std::uint64_t t = 0; t < kCells; ++t) lines.push_back({corners(random, 4, 1) + " 5"});
        }},
        {"v2.msh", Kind::mesh, false, true, [](Lines& lines, Random& random) {
            for (const char* line : {"$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes"}) lines.push_back({line, false});
            lines.push_back({std::to_string(kVertices), false});
            for (std::uint64_t v = 0; v < kVertices; ++v) lines.push_back({fmt::format("{} {}", v + 1, point(random))});
            for (const char* line : {"$EndNodes", "$Elements"}) lines.push_back({line, false});
            lines.push_back({std::to_string(2 * kCells), false});
            for (std::uint64_t t = 0; t < kCells; ++t) {  // every cell in two groups, of which the first counts
                const std::string tet = corners(random, 4, 1);
                for (int group = 1; group <= 2; ++group) lines.push_back({fmt::format("{} 4 2 {} 1 {}", 2 * t + 1, group, tet)});
            }
            lines.push_back({"$EndElements", false});
        }},
        {"v4.msh", Kind::mesh, false, true, [](Lines& lines, Random& random) {
            for (const char* line : {"$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$Nodes"}) lines.push_back({line, false});
            lines.push_back({fmt::format("1 {0} 1 {0}", kVertices), false});
            lines.push_back({fmt::format("3 1 0 {}", kVertices), false});
            for (std::uint64_t v = 0; v < kVertices; ++v) lines.push_back({std::to_string(kVertices - v)});
            add_points(lines, random);
            for (const char* line : {"$EndNodes", "$Elements"}) lines.push_back({line, false});
            lines.push_back({fmt::format("2 {0} 1 {0}", 2 * kCells), false});
            for (std::uint64_t dimension = 2; dimension <= 3; ++dimension) {
                lines.push_back({fmt::format("{} 1 {} {}", dimension, 2 * dimension - 2, kCells), false});
                for (std::uint64_t t = 0; t < kCells; ++t) lines.push_back({fmt::format("{} {}", t + 1, corners(random, dimension + 1, 1))});
            }
            lines.push_back({"$EndElements", false});
        }},
        {"a.off", Kind::plc, true, false, [](Lines& lines, Random& random) {
            lines.push_back({"OFF", false});
            lines.push_back({fmt::format("{} {} 0", kVertices, kCells), false});
            add_points(lines, random);
            for (std::uint64_t f = 0; f < kCells; ++f) lines.push_back({fmt::format("{0} {1}", 3 + f % 3, corners(random, 3 + f % 3, 0))});
        }},
        {"a.ply", Kind::plc, false, true, [](Lines& lines, Random& random) {
            for (const char* line : {"ply", "format ascii 1.0", "element camera 7000", "property int id"}) lines.push_back({line, false});
            lines.push_back({fmt::format("element vertex {}", kVertices), false});
            for (const char* line : {"property double x", "property double y", "property double z", "property uchar red"}) lines.push_back({line, false});
            lines.push_back({fmt::format("element face {}", kCells), false});
            for (const char* line : {"property list uchar int vertex_indices", "property list uchar short rings", "end_header"}) lines.push_back({line, false});
            for (std::uint64_t c = 0; c < kVertices; ++c) lines.push_back({std::to_string(c)});
            add_points(lines, random, "", " 255");
            for (std::uint64_t f = 0; f < kCells; ++f) lines.push_back({fmt::format("3 {} 1 {}", corners(random, 3, 0), f)});
        }},
        {"a.obj", Kind::plc, true, false, [](Lines& lines, Random& random) {
            for (std::uint64_t part = 0; part < 2; ++part) {
                add_points(lines, random, "v ");
                for (std::uint64_t v = 0; v < kVertices; ++v) lines.push_back({fmt::format("vn {}", point(random))});
                lines.push_back({fmt::format("g part {}", part), false});
                for (std::uint64_t f = 0; f < kCells; ++f) {
                    if (random.one_in(3)) lines.push_back({fmt::format("f -{} -{}//7 {}", 1 + random.below(kVertices), 1 + random.below(kVertices), 2 * kVertices)});
                    else lines.push_back({fmt::format("f {} {}/3 {}/1/2", 1 + random.below(kVertices), 1 + random.below(kVertices), 1 + random.below(kVertices))});
                }
            }
            lines.push_back({"l 1 2 3", false});
        }},
        {"a.stl", Kind::plc, false, true, [](Lines& lines, Random& random) {
            std::vector<std::string> points;
            for (std::uint64_t v = 0; v < kVertices / 4; ++v) points.push_back(point(random));
            for (const char* name : {"one", "two"}) {
                lines.push_back({fmt::format("solid {}", name), false});
                for (std::uint64_t f = 0; f < kCells / 4; ++f) {
                    for (const char* line : {"facet normal 0 0 nan", "outer loop"}) lines.push_back({line});
                    for (int corner = 0; corner < 3; ++corner) lines.push_back({"vertex " + points[random.below(points.size())]});
                    for (const char* line : {"endloop", "endfacet"}) lines.push_back({line});
                }
                lines.push_back({fmt::format("endsolid {}", name), false});
            }
        }},
        {"a.poly", Kind::plc, true, false, [](Lines& lines, Random& random) {
            add_nodes(lines, random);
            lines.push_back({fmt::format("{} 1", kCells), false});
            for (std::uint64_t f = 0; f < kCells; ++f) {
                lines.push_back({fmt::format("1 0 {}", f % 5)});
                lines.push_back({"3 " + corners(random, 3, 1)});
            }
            lines.push_back({"0", false});
        }},
        {"a.smesh", Kind::plc, true, false, [](Lines& lines, Random& random) {
            add_nodes(lines, random);
            lines.push_back({fmt::format("{} 1", kCells), false});
            for (std::uint64_t f = 0; f < kCells; ++f) lines.push_back({fmt::format("3 {} {}", corners(random, 3, 1), f % 5)});
            lines.push_back({"0", false});
        }}};
    return all;
}

enum class Layout {
    plain,
    decorated,  // comments, blank lines and blanks, CR LF or CR
    irregular   // some rows on two lines, some two to a line, where that is allowed; else as decorated
};

std::string text_of(const Format& format, Layout layout, Random& random) {
    Lines lines;
    format.make(lines, random);
    const std::string_view end = layout == Layout::plain ? "\n" : std::array<std::string_view, 3>{"\n", "\r\n", "\r"}[random.below(8) == 0 ? 2 : random.below(2)];
    std::string text;
    for (auto& [line, is_row] : lines) {
        if (layout != Layout::plain && is_row) {
            if (random.one_in(20)) text += end;
            if (random.one_in(20)) line = " \t" + line + " ";
            if (format.comments && random.one_in(20)) line += "# 1 2 3";
            if (format.comments && random.one_in(20)) text.append("  # 4 5 6").append(end);
        }
        if (layout == Layout::irregular && is_row && format.free && line.find('#') == std::string::npos) {
            if (const std::size_t blank = line.find(' ', 2); random.one_in(2000) && blank != std::string::npos) line.replace(blank, 1, end);
            if (random.one_in(2000)) {
                text += line + ' ';
                continue;
            }
        }
        text.append(line).append(end);
    }
    return text;
}

/// Everything that a reader gives, or the error, as bytes.
class Reading {
public:
    template <class T>
    void add(const std::vector<T>& values) {
        bytes_ += fmt::format("{}:", values.size());
        bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
    }
    template <class T>
    void add(const T& value) { add(std::vector<T>{value}); }
    void add(const Names& names) {
        for (const auto& of_dimension : names.of_dimension)
            for (const auto& [marker, name] : of_dimension) bytes_ += fmt::format("{}={}\n", marker, name);
    }
    template <class... Parts>
    void add_all(const Parts&... parts) { (add(parts), ...); }
    [[nodiscard]] const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
};

std::string read(const std::filesystem::path& path, Kind kind, unsigned threads) {
    const ReadOptions options{.threads = threads};
    Reading reading;
    try {
        if (kind == Kind::points) {
            reading.add(read_points(path, options));
        } else if (kind == Kind::mesh) {
            const TetMesh mesh = read_mesh(path, options);
            reading.add_all(mesh.vertices, mesh.vertex_markers, mesh.tets, mesh.tet_regions, mesh.subfaces, mesh.subface_facets, mesh.subface_markers,
                            mesh.relative_rounding, mesh.names);
        } else {
            const Plc plc = read_plc(path, options);
            reading.add_all(plc.vertices, plc.vertex_lines, plc.vertex_markers, plc.facet_lines, plc.relative_rounding, plc.names);
            for (const PlcFacet& facet : plc.facets) {
                reading.add(facet.marker);
                for (const auto& polygon : facet.polygons) reading.add(polygon);
            }
            for (const PlcSegment& segment : plc.segments) reading.add_all(segment.vertices, segment.marker);
        }
    } catch (const MeshError& error) {
        return std::string("error: ") + error.what();
    }
    return reading.bytes();
}

TEST(ReadThreads, SameData) {
    const TemporaryDirectory directory;
    std::uint64_t seed = 1;
    for (const Format& format : formats())
        for (const Layout layout : {Layout::plain, Layout::decorated, Layout::irregular}) {
            if (testing::kSanitized && layout == Layout::decorated) continue;
            SCOPED_TRACE(::testing::Message() << format.file << ", layout " << static_cast<int>(layout));
            Random random(seed++);
            const std::string text = text_of(format, layout, random);
            ASSERT_GT(text.size(), 300000U);  // smaller files are read on one thread
            const auto path = directory.write(format.file, text);
            if (format.file == "a.ele") (void)directory.write("a.node", text_of(formats().front(), layout, random));
            const std::string reading = testing::same_for_any_threads([&](unsigned threads) { return read(path, format.kind, threads); });
            EXPECT_GT(reading.size(), 9000U) << reading;  // no error
        }
}

/// Something small that a file may have wrong, somewhere.
void damage(std::string& text, Random& random) {
    constexpr std::string_view kBlank = " \n\r";
    const std::size_t at = random.below(text.size());
    const std::size_t word = std::min(text.find_first_not_of(kBlank, at), text.size()), word_end = std::min(text.find_first_of(kBlank, word), text.size());
    const std::size_t line = std::min(text.find('\n', at), text.size() - 1) + 1, line_end = std::min(text.find('\n', line), text.size() - 1) + 1;
    switch (random.below(7)) {
        case 0: text.resize(at); break;
        case 1: text.replace(word, word_end - word, "x1"); break;
        case 2: text.replace(word, word_end - word, "99999999"); break;
        case 3: text.erase(word, word_end - word); break;
        case 4: text.erase(line, line_end - line); break;
        case 5: text.insert(line, text.substr(line, line_end - line)); break;
        default: text.insert(word, "1e999 "); break;
    }
}

TEST(ReadThreads, SameErrors) {
    const TemporaryDirectory directory;
    (void)directory.write("a.node", [] {
        Random random(1000);
        return text_of(formats().front(), Layout::plain, random);
    }());
    std::uint64_t seed = 2000;
    const int rounds = testing::kSanitized ? 2 : 6;
    for (const Format& format : formats()) {
        int errors = 0;
        for (int round = 0; round < rounds; ++round) {
            SCOPED_TRACE(::testing::Message() << format.file << ", round " << round);
            Random random(seed++);
            std::string text = text_of(format, round % 2 == 0 ? Layout::plain : Layout::decorated, random);
            for (int i = 0; i <= round % 3; ++i) damage(text, random);
            const std::string name = format.file == "a.node" ? "b.node" : format.file;
            const auto path = directory.write(name, text);
            const std::string reading = testing::same_for_any_threads([&](unsigned threads) { return read(path, format.kind, threads); });
            errors += reading.starts_with("error: ") ? 1 : 0;
        }
        EXPECT_GE(errors, rounds / 3) << format.file;
    }
}

/// Counts its rows, and those that were read in a stretch.
struct Rows {
    std::vector<std::uint64_t> lines;
    std::size_t in_stretches = 0;
    void join(const Rows& later) {
        lines.insert(lines.end(), later.lines.begin(), later.lines.end());
        in_stretches += later.lines.size();
    }
};

Rows read_words(const std::string& text, std::size_t words_a_row, unsigned threads) {
    io::SourceFile source = testing::source_of(text);
    if (threads > 1) source.workers = std::make_unique<Workers>(threads);
    io::TextScanner in(source, {});
    Rows rows;
    const std::size_t n = io::read_rows_while(in, 1000000, rows, [](std::size_t) {}, [&](io::TextScanner& row, std::size_t, Rows& to) {
        for (std::size_t w = 0; w < words_a_row; ++w)
            if (row.next().empty()) return false;
        to.lines.push_back(row.line());
        return true;
    });
    EXPECT_EQ(n, rows.lines.size());
    return rows;
}

TEST(ReadThreads, RowsOfSeveralLinesAreSharedOut) {
    constexpr std::size_t kRows = 20000;
    for (const std::size_t lines_a_row : {1U, 2U, 7U})
        for (const bool disturbed : {false, true}) {
            Random random(lines_a_row);
            std::string text;
            for (std::size_t row = 0; row < kRows; ++row)
                for (std::size_t line = 0; line < lines_a_row; ++line) {
                    if (random.one_in(10)) text += "\n # a comment\n";
                    text += "words ";
                    text += disturbed && row == kRows / 2 && line == 0 ? "\n\n twice\n" : "twice\n";
                }
            const Rows rows = testing::compare_for_any_threads([&](unsigned threads) { return read_words(text, 2 * lines_a_row, threads); },
                                                               [&](const Rows& one, const Rows& other) {
                                                                   EXPECT_EQ(one.lines, other.lines);
                                                                   EXPECT_GE(other.in_stretches, kRows * 3 / 4);
                                                               });
            EXPECT_EQ(rows.lines.size(), kRows);
        }
}

}  // namespace
}  // namespace wellmesh
