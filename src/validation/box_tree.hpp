// SPDX-License-Identifier: Apache-2.0
// Bounding boxes in a balanced binary tree. Answers are candidates; exact tests decide.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vec3_math.hpp"
#include "core/workers.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// @param axis  0, 1, 2 for x, y, z
constexpr double coordinate(const Vec3& p, std::size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

struct Box {
    Vec3 low{1, 1, 1}, high{0, 0, 0};  ///< empty until a point is added
    [[nodiscard]] bool empty() const { return low.x > high.x; }
    void add(const Vec3& p) {
        if (empty()) {
            low = high = p;
            return;
        }
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    void add(const Box& b) {
        if (b.empty()) return;
        add(b.low);
        add(b.high);
    }
    /// Its longest side's; the first one of several.
    [[nodiscard]] std::size_t longest_axis() const {
        const Vec3 extent = high - low;
        return extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    }
    [[nodiscard]] double squared_distance_to(const Vec3& p) const {
        const auto outside = [](double v, double from, double to) { return std::max(std::max(from - v, v - to), 0.0); };
        return squared_norm({outside(p.x, low.x, high.x), outside(p.y, low.y, high.y), outside(p.z, low.z, high.z)});
    }
    [[nodiscard]] double distance_to(const Vec3& p) const { return std::sqrt(squared_distance_to(p)); }
    [[nodiscard]] Box grown(double by) const { return {{low.x - by, low.y - by, low.z - by}, {high.x + by, high.y + by, high.z + by}}; }
    /// What a comparison says can't be foreseen: no branch.
    [[nodiscard]] bool meets(const Box& b) const {
        const auto overlap = [](double from, double to, double other_from, double other_to) { return static_cast<unsigned>(from <= other_to) & static_cast<unsigned>(other_from <= to); };
        return (overlap(low.x, high.x, b.low.x, b.high.x) & overlap(low.y, high.y, b.low.y, b.high.y) & overlap(low.z, high.z, b.low.z, b.high.z)) != 0;
    }
};

/// Does a closed segment meet boxes? Says yes too often by `pad`, which must exceed the rounding of the clipping.
class SegmentClipper {
public:
    SegmentClipper(const Vec3& p, const Vec3& q);
    [[nodiscard]] bool meets(const Box& box) const {
        double from = 0, to = 1;
        return clip(start_.x, along_.x, box.low.x, box.high.x, from, to) && clip(start_.y, along_.y, box.low.y, box.high.y, from, to) &&
               clip(start_.z, along_.z, box.low.z, box.high.z, from, to);
    }

private:
    [[nodiscard]] bool clip(double start, double along, double low, double high, double& from, double& to) const {
        if (along == 0) return start >= low - pad_ && start <= high + pad_;
        const double t0 = (low - pad_ - start) / along, t1 = (high + pad_ - start) / along;
        from = std::max(from, std::min(t0, t1));
        to = std::min(to, std::max(t0, t1));
        return from <= to;
    }
    Vec3 start_, along_;
    double pad_;
};

class BoxTree {
public:
    /// @param boxes  must outlive this; fewer than 2^32
    explicit BoxTree(std::span<const Box> boxes);
    /// The same tree, made on several threads.
    BoxTree(std::span<const Box> boxes, Workers& workers);

    [[nodiscard]] const Box& bounds() const { return bounds_; }

    /// Calls visit(index) for every box for which `meets(box)` holds; `meets` must hold for every box that contains one for which it holds.
    template <class Meets, class Visit>
    void query(Meets&& meets, Visit&& visit) const {
        if (order_.empty()) return;
        std::array<std::uint32_t, kMaxDepth + 1> stack{};  // one a level besides the node at hand
        std::size_t waiting = 1;
        while (waiting > 0) {
            const Node& node = nodes_[stack[--waiting]];
            if (!meets(node.box)) continue;
            if (node.left != 0) {
                stack[waiting++] = node.right;
                stack[waiting++] = node.left;
                continue;
            }
            for (std::uint32_t i = node.begin; i < node.end; ++i)
                if (meets(boxes_[order_[i]])) visit(order_[i]);
        }
    }

private:
    static constexpr std::size_t kMaxDepth = 32;  // halves of halves of 2^32
    struct Node {
        Box box;
        std::uint32_t begin = 0, end = 0;   ///< into order_
        std::uint32_t left = 0, right = 0;  ///< 0: leaf
    };
    class Builder;

    std::span<const Box> boxes_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
    Box bounds_;
};

}  // namespace wellmesh
