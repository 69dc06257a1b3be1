// SPDX-License-Identifier: Apache-2.0
#include "validation/box_tree.hpp"

#include <cmath>
#include <limits>
#include <numeric>

#include "core/vec3_math.hpp"

namespace wellmesh {

SegmentClipper::SegmentClipper(const Vec3& p, const Vec3& q) : start_(p), along_(q - p) {
    double largest = 0;
    for (const Vec3& x : {p, q}) largest = std::max({largest, std::abs(x.x), std::abs(x.y), std::abs(x.z)});
    // a clipped place is off by a few ulp of the segment's length, a difference by an ulp of the coordinates
    pad_ = 1e-12 * norm(along_) + 16 * std::numeric_limits<double>::epsilon() * largest;
}

BoxTree::BoxTree(std::span<const Box> boxes) : boxes_(boxes), order_(boxes.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    for (const Box& b : boxes) bounds_.add(b);
    if (!order_.empty()) {
        nodes_.reserve(order_.size());
        build(0, static_cast<std::uint32_t>(order_.size()));
    }
}

std::uint32_t BoxTree::build(std::uint32_t begin, std::uint32_t end) {
    constexpr std::uint32_t kLeafSize = 4;
    const auto id = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({});
    Box box;
    for (std::uint32_t i = begin; i < end; ++i) box.add(boxes_[order_[i]]);
    nodes_[id].box = box;
    nodes_[id].begin = begin;
    nodes_[id].end = end;
    if (end - begin <= kLeafSize) return id;
    const std::size_t axis = box.longest_axis();
    const auto centre = [&](std::uint32_t i) { return coordinate(boxes_[i].low, axis) + coordinate(boxes_[i].high, axis); };
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
        const double ca = centre(a), cb = centre(b);
        return ca != cb ? ca < cb : a < b;
    });
    const std::uint32_t left = build(begin, middle);
    const std::uint32_t right = build(middle, end);
    nodes_[id].left = left;
    nodes_[id].right = right;
    return id;
}

}  // namespace wellmesh
