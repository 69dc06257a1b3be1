// SPDX-License-Identifier: Apache-2.0
// An octree that holds a function of space as finely as the function's own values ask for: lengths, sampled where they are short.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "validation/box_tree.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

/// What to sample, and where.
struct SizeSampling {
    Vec3 lo{};
    double side = 1;                                  ///< of the root cube
    std::function<double(const Vec3&)> edge_length{}; ///< above 0; infinite: nothing is asked
    std::span<const Vec3> probes{};                   ///< points where it may be small
    std::span<const Box> surface{};                   ///< of the pieces that bound the domain
    std::function<bool(const Vec3&)> inside{};        ///< is a point, in none of these boxes, in the domain? Empty: everywhere
    unsigned least_depth = 2;
    std::function<bool(std::size_t leaves)> may_go_on{};  ///< false: no leaf is split any more. Empty: true
};

/// Leaves outside of the domain stay as large as they are; inside their sides are at most kLeafPerLength of the shortest length in them, and
/// interpolation between corners is within kInterpolationError of it, until they are kFinestLeafPerLength of it.
class SizeOctree {
public:
    static constexpr unsigned kMaxDepth = 20;
    static constexpr double kLeafPerLength = 2, kFinestLeafPerLength = 0.25, kInterpolationError = 0.03;

    struct Leaf {
        Vec3 lo{};
        double side = 0;
        std::array<double, 8> at_corner{};  ///< corner k: x, y, z from bits 0, 1, 2
        bool in_domain = false;             ///< meets it
        bool on_surface = false;            ///< meets a box of the surface
        std::span<const std::uint32_t> probes{};
    };

    /// Deterministic; throws what `edge_length` throws. O(leaves) samples.
    /// @param on_leaf  told of every leaf; may be empty
    explicit SizeOctree(const SizeSampling& sampling, const std::function<void(const Leaf&)>& on_leaf = {});

    /// Trilinear in the leaf that holds p; p is clamped to the root cube. Infinite where nothing is asked. O(depth).
    [[nodiscard]] double operator()(const Vec3& p) const;
    [[nodiscard]] std::size_t leaves() const { return values_.size(); }

private:
    struct Node {
        std::uint32_t first_child = 0;  // 0: leaf
        std::uint32_t values = 0;       // of a leaf
    };
    using At = std::array<std::uint32_t, 3>;  // in units of the finest cell
    class RecentSamples;
    struct Builder;

    Vec3 lo_;
    double side_, ceiling_ = 0;
    std::vector<Node> nodes_;
    std::vector<std::array<double, 8>> values_;
};

}  // namespace wellmesh
