// SPDX-License-Identifier: Apache-2.0
// Sizes that sources ask for, growing with the distance from them: min over sources of h + g d.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "validation/box_tree.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// A point, segment or triangle on which edges are to be of one length.
struct SizeSource {
    std::array<Vec3, 3> corners{};
    unsigned size = 1;       ///< corners in use
    double edge_length = 0;  ///< input units
};

/// A tree of boxes, each with the smallest length in it, so that only what may win is looked at: O(log n) a query for sources that are spread.
class SourceTree {
public:
    /// @param growth  of lengths a unit of distance, at least 0
    SourceTree(std::vector<SizeSource> sources, double growth);

    [[nodiscard]] bool empty() const { return sources_.empty(); }
    [[nodiscard]] std::size_t size() const { return sources_.size(); }
    /// The least of `bound` and what the sources ask for at p.
    [[nodiscard]] double operator()(const Vec3& p, double bound = std::numeric_limits<double>::infinity()) const;

private:
    struct Node {
        Box box;
        double least = 0;                  // edge length
        std::uint32_t begin = 0, end = 0;  // sources of a leaf
        std::uint32_t right = 0;           // the left child follows; 0: leaf
    };
    std::uint32_t build(std::uint32_t begin, std::uint32_t end);
    [[nodiscard]] double least_in(const Node& node, const Vec3& p) const;

    std::vector<SizeSource> sources_;
    std::vector<Node> nodes_;
    double growth_;
};

}  // namespace wellmesh
