// SPDX-License-Identifier: Apache-2.0
#include "sizing/source_tree.hpp"

#include <algorithm>
#include <cmath>

#include "core/infinity.hpp"
#include "core/vec3_math.hpp"
#include "validation/local_feature_size.hpp"

namespace wellmesh {
namespace {

constexpr std::uint32_t kLeaf = 4;

Vec3 middle_of(const SizeSource& s) {
    Vec3 sum;
    for (unsigned k = 0; k < s.size; ++k) sum = sum + s.corners[k];
    return (1.0 / s.size) * sum;
}

double distance_to(const SizeSource& s, const Vec3& p) {
    if (s.size == 1) return distance(p, s.corners[0]);
    if (s.size == 2) return distance_to_segment(p, s.corners[0], s.corners[1]);
    return distance_to_triangle(p, s.corners[0], s.corners[1], s.corners[2]);
}

}  // namespace

SourceTree::SourceTree(std::vector<SizeSource> sources, double growth) : sources_(std::move(sources)), growth_(growth) {
    if (!sources_.empty()) build(0, static_cast<std::uint32_t>(sources_.size()));
}

std::uint32_t SourceTree::build(std::uint32_t begin, std::uint32_t end) {
    Node node{{}, kInfinity, begin, end, 0};
    for (std::uint32_t i = begin; i < end; ++i) {
        node.least = std::min(node.least, sources_[i].edge_length);
        for (unsigned k = 0; k < sources_[i].size; ++k) node.box.add(sources_[i].corners[k]);
    }
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(node);
    if (end - begin <= kLeaf) return at;
    const std::size_t axis = node.box.longest_axis();
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(sources_.begin() + begin, sources_.begin() + middle, sources_.begin() + end, [axis](const SizeSource& s, const SizeSource& t) {
        return coordinate(middle_of(s), axis) < coordinate(middle_of(t), axis);
    });
    build(begin, middle);
    const std::uint32_t right = build(middle, end);
    nodes_[at].right = right;
    return at;
}

double SourceTree::least_in(const Node& node, const Vec3& p) const {
    return node.least + growth_ * node.box.distance_to(p);
}

double SourceTree::operator()(const Vec3& p, double bound) const {
    if (nodes_.empty() || !(least_in(nodes_[0], p) < bound)) return bound;
    // Depth 32 for 2^32 sources, and one node waits a level.
    std::array<std::pair<double, std::uint32_t>, 64> waiting;
    std::size_t n = 0;
    waiting[n++] = {least_in(nodes_[0], p), 0U};
    while (n > 0) {
        const auto [least, at] = waiting[--n];
        if (!(least < bound)) continue;
        const Node& node = nodes_[at];
        if (node.right == 0) {
            for (std::uint32_t i = node.begin; i < node.end; ++i) bound = std::min(bound, sources_[i].edge_length + growth_ * distance_to(sources_[i], p));
            continue;
        }
        std::pair<double, std::uint32_t> first{least_in(nodes_[at + 1], p), at + 1}, second{least_in(nodes_[node.right], p), node.right};
        if (second.first < first.first) std::swap(first, second);
        waiting[n++] = second;
        waiting[n++] = first;
    }
    return bound;
}

}  // namespace wellmesh
