// SPDX-License-Identifier: Apache-2.0
// TetGen's mesh sizes at points (.mtr): "points 1" and one size a line, in the order of the .node file. 0: none.
#include <filesystem>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "io/readers.hpp"
#include "io/tetgen_nodes.hpp"
#include "io/text_rows.hpp"

namespace wellmesh::io {

std::vector<double> read_mtr(const SourceFile& source, std::size_t points) {
    TextScanner in(source, kTetgenSyntax);
    constexpr std::size_t kLeastSizeBytes = 2;  // "1\n"
    const std::size_t count = in.count("the number of points", kLeastSizeBytes);
    if (count != points) in.fail(fmt::format("{} sizes, but there are {} points", count, points));
    std::int64_t width = 1;
    if (!in.at_end_of_line()) width = in.to_integer(in.next_on_line(), "the number of values a point (1)");
    if (width != 1) in.fail(fmt::format("{} values a point are not supported, only one: the edge length", width));
    if (!in.at_end_of_line()) in.fail_expected(in.next_on_line(), "the end of the line after the counts");
    std::vector<double> sizes;
    sizes.reserve(count);
    NoTally none;
    read_rows(in, count, none, [&](std::size_t rows) { sizes.resize(rows); }, [&](TextScanner& row, std::size_t i, NoTally&) {
        sizes[i] = row.real("a size");
        if (!(sizes[i] >= 0)) row.fail(fmt::format("a size is a number above 0, or 0 for none, not {}", sizes[i]));
        row.skip_line();
    });
    if (!in.at_end()) in.fail_expected(in.next(), fmt::format("nothing after the {} sizes", count).c_str());
    return sizes;
}

BackgroundMesh read_tetgen_background(const std::filesystem::path& path, unsigned threads) {
    BackgroundMesh background{read_tetgen_mesh(path, threads), {}};
    std::filesystem::path sizes = path;
    sizes.replace_extension(".mtr");
    background.sizes = read_mtr(read_source(sizes, threads), background.mesh.vertices.size());
    return background;
}

}  // namespace wellmesh::io
