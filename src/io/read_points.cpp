// SPDX-License-Identifier: Apache-2.0
// Point sets: TetGen's .node, and .xyz (three coordinates a line, further columns passed over; an optional first line with the
// number of points alone, which some programs write).
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/plc_building.hpp"
#include "io/readers.hpp"
#include "io/tetgen_nodes.hpp"

namespace wellmesh::io {

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
    std::vector<Vec3> points;
    bool first = true;
    std::size_t stated = 0;
    bool is_stated = false;
    for (std::string_view token = in.next(); !token.empty(); token = in.next()) {
        if (std::exchange(first, false) && in.at_end_of_line()) {
            constexpr std::size_t kLeastPointBytes = 6;  // "0 0 0\n"
            stated = in.to_count(token, "the number of points", kLeastPointBytes);
            is_stated = true;
            points.reserve(stated);
            continue;
        }
        Vec3 point;
        point.x = in.to_real(token, "a coordinate");
        point.y = in.to_real(in.next_on_line(), "a coordinate");
        point.z = in.to_real(in.next_on_line(), "a coordinate");
        if (points.size() >= kMostVertices) in.fail("more points than 32-bit numbers hold");
        points.push_back(point);
        in.skip_line();
    }
    if (!is_stated && points.empty()) in.fail("the file has no points");
    if (is_stated && points.size() != stated)
        in.fail("the file has " + std::to_string(points.size()) + " points, but its first line states " + std::to_string(stated));
    normalise_zeros(points);
    return points;
}

}  // namespace wellmesh::io
