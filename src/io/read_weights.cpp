// SPDX-License-Identifier: Apache-2.0
// Weights of vertices: MEDIT's solution format (text), with one scalar a vertex, or the first attribute of a TetGen .node.
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/readers.hpp"
#include "io/tetgen_nodes.hpp"
#include "io/text_rows.hpp"

namespace wellmesh::io {

std::vector<double> read_medit_weights(const SourceFile& source) {
    TextScanner in(source, {});
    if (const std::string_view word = in.next(); word != "MeshVersionFormatted") in.fail_expected(word, "'MeshVersionFormatted'");
    if (const std::int64_t version = in.integer("the version of the format"); version < 1 || version > 4)
        in.fail(fmt::format("version {} of the format is unknown; known are 1 to 4", version));
    if (const std::string_view word = in.next(); word != "Dimension") in.fail_expected(word, "'Dimension'");
    if (const std::int64_t dimension = in.integer("the dimension"); dimension != 3) in.fail(fmt::format("the dimension is {}, only 3 is supported", dimension));
    if (const std::string_view word = in.next(); word != "SolAtVertices") in.fail_expected(word, "'SolAtVertices'");
    const std::size_t count = in.count("the number of vertices", 2);
    if (const std::int64_t fields = in.integer("the number of fields"); fields != 1) in.fail(fmt::format("weights are one field, not {}", fields));
    if (const std::int64_t type = in.integer("the type of the field"); type != 1) in.fail(fmt::format("weights are scalars (type 1), not of type {}", type));
    std::vector<double> weights;
    weights.reserve(count);
    NoTally none;
    read_rows(in, count, none, [&](std::size_t rows) { weights.resize(rows); },
              [&](TextScanner& row, std::size_t i, NoTally&) { weights[i] = row.real("a weight"); });
    if (const std::string_view word = in.next(); !word.empty() && word != "End") in.fail_expected(word, "'End' after the weights");
    return weights;
}

std::vector<double> read_node_weights(const SourceFile& source) {
    TextScanner in(source, kTetgenSyntax);
    TextPrecision unused;
    NodeList nodes = read_node_list(in, unused);
    if (!in.at_end()) in.fail_expected(in.next(), "nothing after the points");
    if (nodes.first_attributes.size() != nodes.points.size()) fail_in_file(source, "the points have no attribute, which would be their weight");
    return std::move(nodes.first_attributes);
}

}  // namespace wellmesh::io
