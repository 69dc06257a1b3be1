// SPDX-License-Identifier: Apache-2.0
#include "io/msh_nodes.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "io/plc_building.hpp"

namespace wellmesh::io {

void MshNodes::add(std::int64_t tag, const Vec3& p) {
    if (tag < 1) in_.fail(fmt::format("node {}: numbers are positive", tag));
    if (points_.size() >= kMostVertices) in_.fail("more nodes than 32-bit numbers hold");
    tags_.push_back(tag);
    points_.push_back(p);
}

Vec3 MshNodes::read_coordinates() {
    Vec3 p;
    p.x = in_.coordinate(precision_);
    p.y = in_.coordinate(precision_);
    p.z = in_.coordinate(precision_);
    return p;
}

void MshNodes::read_2() {
    const std::size_t count = in_.count(in_.text().integer("the number of nodes"), "the number of nodes", 8, 4 + 3 * 8);
    in_.begin_data();
    points_.reserve(count);
    tags_.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::int64_t tag = in_.integer("the number of a node");
        add(tag, read_coordinates());
    }
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
        tags.clear();
        for (std::size_t i = 0; i < count; ++i) tags.push_back(in_.size("the number of a node"));
        for (const std::int64_t tag : tags) {
            add(tag, read_coordinates());
            if (parametric)
                for (std::int64_t k = 0; k < dimension; ++k) (void)in_.real("a parameter");
        }
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

std::uint32_t MshNodes::index_of(std::int64_t tag) const {
    if (sequential_) {
        if (tag < 1 || static_cast<std::uint64_t>(tag) > points_.size())
            in_.fail(fmt::format("node {} does not exist; the file has nodes 1 to {}", tag, points_.size()));
        return static_cast<std::uint32_t>(tag - 1);
    }
    const auto at = index_of_.find(tag);
    if (at == index_of_.end()) in_.fail(fmt::format("node {} does not exist", tag));
    return at->second;
}

}  // namespace wellmesh::io
