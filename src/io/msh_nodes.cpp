// SPDX-License-Identifier: Apache-2.0
#include "io/msh_nodes.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "io/plc_building.hpp"

namespace wellmesh::io {

void MshNodes::check(std::int64_t tag, std::size_t row, const MshCursor& in) {
    if (tag < 1) in.fail(fmt::format("node {}: numbers are positive", tag));
    if (row >= kMostVertices) in.fail("more nodes than 32-bit numbers hold");
}

Vec3 MshNodes::read_coordinates(MshCursor& in, TextPrecision& precision) {
    Vec3 p;
    p.x = in.coordinate(precision);
    p.y = in.coordinate(precision);
    p.z = in.coordinate(precision);
    return p;
}

template <class Read>
void MshNodes::read_nodes(std::size_t n, const Read& read) {
    const std::size_t first = points_.size();
    const auto make_room = [&](std::size_t rows) {
        points_.resize(first + rows);
        tags_.resize(first + rows);
    };
    in_.read_rows(n, precision_, make_room, [&](MshCursor& in, std::size_t i, TextPrecision& precision) { read(in, first + i, precision); });
}

void MshNodes::read_2() {
    const std::size_t count = in_.count(in_.text().integer("the number of nodes"), "the number of nodes", 8, 4 + 3 * 8);
    in_.begin_data();
    points_.reserve(count);
    tags_.reserve(count);
    read_nodes(count, [&](MshCursor& in, std::size_t row, TextPrecision& precision) {
        tags_[row] = in.integer("the number of a node");
        points_[row] = read_coordinates(in, precision);
        check(tags_[row], row, in);
    });
    index();
}

void MshNodes::read_4() {
    in_.begin_data();
    const std::int64_t block_count = in_.size("the number of blocks"), nodes = in_.size("the number of nodes");
    (void)in_.size("the least number of a node");
    (void)in_.size("the largest number of a node");
    const std::size_t blocks = in_.count(block_count, "the number of blocks", 8, 3 * 4 + 8);
    const std::size_t total = in_.count(nodes, "the number of nodes", 8, 8 + 3 * 8);
    points_.reserve(total);
    tags_.reserve(total);
    std::vector<std::int64_t> tags;
    for (std::size_t b = 0; b < blocks; ++b) {
        const std::int64_t dimension = in_.integer("the dimension of a block");
        (void)in_.integer("the entity of a block");
        const bool parametric = in_.integer("whether a block has parameters") != 0;
        if (dimension < 0 || dimension > 3) in_.fail(fmt::format("the dimension of a block is 0 to 3, not {}", dimension));
        const std::size_t count = in_.count(in_.size("the number of nodes of a block"), "the number of nodes of a block", 8, 8 + 3 * 8);
        NoTally none;
        in_.read_rows(count, none, [&](std::size_t rows) { tags.resize(rows); },
                      [&](MshCursor& in, std::size_t i, NoTally&) { tags[i] = in.size("the number of a node"); });
        const std::size_t first = points_.size();
        read_nodes(count, [&](MshCursor& in, std::size_t row, TextPrecision& precision) {
            tags_[row] = tags[row - first];
            points_[row] = read_coordinates(in, precision);
            check(tags_[row], row, in);
            if (parametric)
                for (std::int64_t k = 0; k < dimension; ++k) (void)in.real("a parameter");
        });
    }
    if (points_.size() != total) in_.fail(fmt::format("$Nodes states {} nodes, its blocks have {}", total, points_.size()));
    index();
}

void MshNodes::index() {
    for (std::size_t i = 0; i < tags_.size() && sequential_; ++i) sequential_ = tags_[i] == static_cast<std::int64_t>(i) + 1;
    if (sequential_) return;
    // Without the few gaps of numbers, in the order of the numbers: so a mesh that was written block by block comes back as it was.
    std::vector<std::size_t> order(tags_.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return tags_[a] < tags_[b]; });
    std::vector<Vec3> points;
    points.reserve(order.size());
    index_of_.reserve(order.size());
    for (const std::size_t i : order) {
        if (!index_of_.emplace(tags_[i], static_cast<std::uint32_t>(points.size())).second)
            in_.fail(fmt::format("node {} is given twice", tags_[i]));
        points.push_back(points_[i]);
    }
    points_ = std::move(points);
}

std::uint32_t MshNodes::index_of(std::int64_t tag, const MshCursor& in) const {
    if (sequential_) {
        if (tag < 1 || static_cast<std::uint64_t>(tag) > points_.size())
            in.fail(fmt::format("node {} does not exist; the file has nodes 1 to {}", tag, points_.size()));
        return static_cast<std::uint32_t>(tag - 1);
    }
    const auto at = index_of_.find(tag);
    if (at == index_of_.end()) in.fail(fmt::format("node {} does not exist", tag));
    return at->second;
}

}  // namespace wellmesh::io
