// SPDX-License-Identifier: Apache-2.0
// Bounding-box tree over triangles: the closest one (rounded), and how many a segment crosses (exact).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/workers.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh::certifying {

struct Box3 {
    Vec3 low, high;
    static Box3 of(const Vec3* points, std::size_t n);
    void grow(const Box3& other);
    [[nodiscard]] bool meets(const Box3& o) const {
        return low.x <= o.high.x && o.low.x <= high.x && low.y <= o.high.y && o.low.y <= high.y && low.z <= o.high.z && o.low.z <= high.z;
    }
    [[nodiscard]] double squared_distance_to(const Vec3& p) const;
};

/// Boxes with the number each was given, in a binary tree by median splits.
class BoxTree {
public:
    BoxTree() = default;
    explicit BoxTree(const std::vector<Box3>& boxes);
    BoxTree(const std::vector<Box3>& boxes, Workers& workers);
    [[nodiscard]] bool empty() const { return leaves_.empty(); }

    /// Calls visit(number) for every box that meets `box`, until it returns true. @return whether it did.
    template <class Visit>
    bool any_meeting(const Box3& box, Visit&& visit) const {
        return !empty() && descend(0, 0, leaves_.size(), [&](const Box3& b) { return b.meets(box); }, visit);
    }
    /// Visits boxes that `admits` holds for, and whose ancestors it holds for; it may change its mind as the search goes on.
    template <class Admits, class Visit>
    bool any_admitted(Admits&& admits, Visit&& visit) const {
        return !empty() && descend(0, 0, leaves_.size(), admits, visit);
    }
    /// Calls visit(number, bound) for boxes nearer than sqrt(bound) to p, nearer subtrees first; visit lowers the bound.
    template <class Visit>
    void nearest(const Vec3& p, double& bound, Visit&& visit) const {
        if (!empty()) approach(0, 0, leaves_.size(), p, bound, visit);
    }

private:
    static constexpr std::size_t kLeaf = 4;
    struct Leaf {
        Box3 box;
        std::uint32_t number;
    };
    /// Of one node, not of those below.
    void split(std::size_t node, std::size_t begin, std::size_t end);
    void build(std::size_t node, std::size_t begin, std::size_t end);

    template <class Admits, class Visit>
    bool descend(std::size_t node, std::size_t begin, std::size_t end, Admits&& admits, Visit& visit) const {
        if (!admits(nodes_[node])) return false;
        if (end - begin <= kLeaf) {
            for (std::size_t i = begin; i < end; ++i)
                if (admits(leaves_[i].box) && visit(leaves_[i].number)) return true;
            return false;
        }
        const std::size_t middle = begin + (end - begin) / 2;
        return descend(2 * node + 1, begin, middle, admits, visit) || descend(2 * node + 2, middle, end, admits, visit);
    }
    template <class Visit>
    void approach(std::size_t node, std::size_t begin, std::size_t end, const Vec3& p, double& bound, Visit& visit) const {
        if (end - begin <= kLeaf) {
            for (std::size_t i = begin; i < end; ++i)
                if (leaves_[i].box.squared_distance_to(p) < bound) visit(leaves_[i].number, bound);
            return;
        }
        const std::size_t middle = begin + (end - begin) / 2;
        const double left = nodes_[2 * node + 1].squared_distance_to(p), right = nodes_[2 * node + 2].squared_distance_to(p);
        if (left <= right && left < bound) approach(2 * node + 1, begin, middle, p, bound, visit);
        if (right < bound) approach(2 * node + 2, middle, end, p, bound, visit);
        if (left > right && left < bound) approach(2 * node + 1, begin, middle, p, bound, visit);
    }

    std::vector<Leaf> leaves_;  // a node's are contiguous
    std::vector<Box3> nodes_;   // by heap numbering
};

using Corners = std::array<Vec3, 3>;

/// Distance between a point and a triangle, a few roundings of the distance to its farthest corner.
[[nodiscard]] double squared_distance(const Vec3& p, const Corners& triangle);

class TriangleTree {
public:
    struct Nearest {
        std::uint32_t triangle = 0;
        double distance = 0;
    };

    TriangleTree() = default;
    explicit TriangleTree(std::vector<Corners> triangles);
    TriangleTree(std::vector<Corners> triangles, Workers& workers);
    [[nodiscard]] const std::vector<Corners>& triangles() const { return triangles_; }

    /// @param hint  a triangle that is likely to be near; saves time. @pre there is a triangle.
    [[nodiscard]] Nearest nearest(const Vec3& p, std::uint32_t hint = 0) const;

    /// Is p inside the closed surface that the triangles form (parity of the crossings of a ray, exact)? True if p is on it.
    /// Empty if every one of a fixed set of rays passes through an edge.
    [[nodiscard]] std::optional<bool> encloses(const Vec3& p) const;

private:
    enum class Ray { inside, outside, on_surface, degenerate };
    [[nodiscard]] Ray cast(const Vec3& p, const Vec3& far) const;

    std::vector<Corners> triangles_;
    BoxTree tree_;
    Box3 box_{};
};

}  // namespace wellmesh::certifying
