// SPDX-License-Identifier: Apache-2.0
// The local feature size of a piecewise linear complex: lfs(x) is the radius of the smallest ball about x that meets two vertices, segments
// or facets that are not incident, that is, have no point in common [LiTeng01, section 5; Shewchuk98]. The paper's text has vertices and segments
// only; without facets thin slabs would break its claims (docs/theory.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "validation/box_tree.hpp"
#include "validation/closest_points.hpp"
#include "validation/valid_plc.hpp"

namespace wellmesh {

/// Nothing is sampled: features are met in the order of their distance, through a tree of boxes, until one is not incident to one met before.
/// Distances are rounded to a few ulp of the largest coordinate. 1-Lipschitz up to that.
class LocalFeatureSize {
public:
    explicit LocalFeatureSize(const ValidPlc& plc);

    /// Infinite for a complex without two features that are not incident.
    [[nodiscard]] double operator()(const Vec3& x) const;

    /// Features in the order vertices, segments, facets; for tests.
    [[nodiscard]] std::size_t features() const { return vertices_.size(); }
    [[nodiscard]] bool incident(std::uint32_t f, std::uint32_t g) const;

private:
    struct Primitive {
        std::array<Vec3, 3> corners{};
        unsigned size = 0;  // corners in use: a point, a segment, a triangle of a facet
        std::uint32_t feature = 0;
    };
    struct Node {
        Box box;
        std::uint32_t begin = 0, end = 0;  // into order_, of a leaf
        std::uint32_t right = 0;           // the left child follows; 0: leaf
    };

    /// A primitive by its centre, to be sorted in its place.
    struct Item {
        Vec3 centre;
        std::uint32_t primitive;
    };
    std::uint32_t build(std::vector<Item>& items, std::uint32_t begin, std::uint32_t end);

    std::vector<Primitive> primitives_;
    std::vector<std::uint32_t> order_;  // of them
    std::vector<Node> nodes_;
    std::vector<std::vector<std::uint32_t>> vertices_;  // of each feature's closure, ascending
};

/// Distance from x to the second nearest of some points, which is 1-Lipschitz, and at one of them the distance to its nearest neighbour.
class SpacingOfPoints {
public:
    explicit SpacingOfPoints(std::vector<Vec3> points);
    /// Infinite for fewer than two points.
    [[nodiscard]] double operator()(const Vec3& x) const;

private:
    void build(std::size_t begin, std::size_t end, unsigned depth);
    void search(const Vec3& x, std::size_t begin, std::size_t end, unsigned depth, std::array<double, 2>& nearest) const;
    std::vector<Vec3> points_;  // median of each range in its middle, along x, y, z in turns
};

}  // namespace wellmesh
