// SPDX-License-Identifier: Apache-2.0
// Point sets: TetGen's .node, and .xyz (three coordinates a line, further columns passed over; an optional first line with the
// number of points alone, which some programs write).
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/plc_building.hpp"
#include "io/readers.hpp"
#include "io/tetgen_nodes.hpp"
#include "io/text_rows.hpp"

namespace wellmesh::io {
namespace {

struct Points {
    std::vector<Vec3> points;
    void join(const Points& later) { points.insert(points.end(), later.points.begin(), later.points.end()); }
};

}  // namespace

std::vector<Vec3> read_node_points(const SourceFile& source) {
    TextScanner in(source, kTetgenSyntax);
    TextPrecision unused;
    NodeList nodes = read_node_list(in, unused);
    if (!in.at_end()) in.fail_expected(in.next(), "nothing after the points");
    normalise_zeros(nodes.points);
    return std::move(nodes.points);
}

std::vector<Vec3> read_xyz_points(const SourceFile& source) {
    TextScanner in(source, kTetgenSyntax);
    Points read;
    std::optional<std::size_t> stated;
    TextScanner ahead = in;
    if (const std::string_view token = ahead.next(); !token.empty() && ahead.at_end_of_line()) {
        constexpr std::size_t kLeastPointBytes = 6;  // "0 0 0\n"
        in.move_to(ahead.place());
        stated = in.to_count(token, "the number of points", kLeastPointBytes);
        read.points.reserve(*stated);
    }
    read_rows_while(in, std::numeric_limits<std::size_t>::max(), read, [](std::size_t) {}, [](TextScanner& row, std::size_t i, Points& to) {
        const std::string_view token = row.next();
        if (token.empty()) return false;
        Vec3 point;
        point.x = row.to_real(token, "a coordinate");
        point.y = row.to_real(row.next_on_line(), "a coordinate");
        point.z = row.to_real(row.next_on_line(), "a coordinate");
        if (i >= kMostVertices) row.fail("more points than 32-bit numbers hold");
        to.points.push_back(point);
        row.skip_line();
        return true;
    });
    std::vector<Vec3>& points = read.points;
    if (!stated && points.empty()) in.fail("the file has no points");
    if (stated && points.size() != *stated)
        in.fail("the file has " + std::to_string(points.size()) + " points, but its first line states " + std::to_string(*stated));
    normalise_zeros(points);
    return std::move(points);
}

}  // namespace wellmesh::io
