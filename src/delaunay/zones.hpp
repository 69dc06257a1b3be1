// SPDX-License-Identifier: Apache-2.0
// Space cut into zones of about as much work each, and views of a triangulation that each touch the tetrahedra of one zone and nothing else. Which zones there
// are depends on the work alone, never on the number of threads: so what comes of it is the same for any number.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "core/infinity.hpp"
#include "core/shared_array.hpp"
#include "core/vec3_math.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {

/// A k-d tree whose leaves hold as many points of a sample each. The cuts of each turn are oblique to those of the others, so that what lies along cuts of one
/// turn mostly lies inside zones in the next.
class Zones {
public:
    static constexpr std::size_t kMost = 128;

    /// Into how many zones so much work is worth being cut, of which each is to have `least`; 0: into none. Less in later turns, as more zones have more limits.
    /// @param least_tets  the same into two zones from so many tetrahedra on
    static std::size_t worth(std::size_t tets, std::size_t work, std::size_t least, unsigned turn, std::size_t least_tets = kTetsOfTwo) {
        if (work < tets / kTetsPerWork || tets < least_tets) return 0;
        const std::size_t by_size = std::max<std::size_t>(2, static_cast<std::size_t>(2 * std::sqrt(static_cast<double>(tets) / kTetsOfTwo)));
        const std::size_t most = std::bit_floor(std::min({work / least, by_size, kMost}));
        return most < 2 ? 0 : std::max<std::size_t>(2, most >> turn);
    }
    static constexpr unsigned kTurns = 4;

    /// @param count  a power of two, at most kMost
    Zones(std::vector<Vec3> sample, std::size_t count, unsigned turn) : count_(count), nodes_(count), frame_(kFrames[turn % kFrames.size()]) {
        for (Vec3& p : sample) p = turned(p);
        cut(sample, 1);
    }

    [[nodiscard]] std::size_t count() const { return count_; }
    [[nodiscard]] std::uint8_t zone_of(const Vec3& point) const {
        const Vec3 p = turned(point);
        std::size_t node = 1;
        while (node < count_) node = 2 * node + (coordinate(p, nodes_[node].axis) < nodes_[node].limit ? 0 : 1);
        return static_cast<std::uint8_t>(node - count_);
    }

private:
    /// So many tetrahedra are worth two zones, four times as many worth four, and so on: small zones are mostly limits.
    static constexpr std::size_t kTetsOfTwo = std::size_t{1} << 15;
    /// Cutting and joining costs some ten nanoseconds a tetrahedron, a move or a split some ten microseconds.
    static constexpr std::size_t kTetsPerWork = 2048;

    struct Node {
        unsigned axis = 0;
        double limit = 0;
    };
    using Frame = std::array<Vec3, 3>;
    /// Orthogonal, each of one length.
    static constexpr std::array<Frame, 4> kFrames{{{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}},
                                                   {Vec3{2, 2, 1}, Vec3{-2, 1, 2}, Vec3{1, -2, 2}},
                                                   {Vec3{2, 3, 6}, Vec3{3, -6, 2}, Vec3{6, 2, -3}},
                                                   {Vec3{2, -1, 2}, Vec3{2, 2, -1}, Vec3{-1, 2, 2}}}};

    [[nodiscard]] Vec3 turned(const Vec3& p) const { return {dot(frame_[0], p), dot(frame_[1], p), dot(frame_[2], p)}; }
    static double coordinate(const Vec3& p, unsigned axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

    void cut(std::span<Vec3> points, std::size_t node) {
        if (node >= count_) return;
        const unsigned axis = longest_axis(points);
        const std::size_t half = points.size() / 2;
        if (half < points.size()) {
            std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(half), points.end(),
                             [axis](const Vec3& p, const Vec3& q) { return coordinate(p, axis) < coordinate(q, axis); });
            nodes_[node] = {axis, coordinate(points[half], axis)};
        }
        cut(points.first(half), 2 * node);
        cut(points.subspan(half), 2 * node + 1);
    }
    static unsigned longest_axis(std::span<const Vec3> points) {
        std::array<double, 3> low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
        for (const Vec3& p : points)
            for (unsigned a = 0; a < 3; ++a) {
                low[a] = std::min(low[a], coordinate(p, a));
                high[a] = std::max(high[a], coordinate(p, a));
            }
        const double x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
        return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    }

    std::size_t count_;
    std::vector<Node> nodes_;  // inner ones are 1 to count - 1, as in a heap
    Frame frame_;
};

/// Tetrahedra belong to a zone if all of their vertices do. A view of a zone refuses what meets others, and says so (Triangulation::left_zone).
struct ZoneViews {
    std::vector<Triangulation> views;
    std::vector<std::size_t> tets;             ///< how many belong to each zone
    SharedArray<std::uint8_t> zone_of_vertex;  ///< of those inserted
    SharedArray<std::uint8_t> zone_of_tet;
    static constexpr std::uint8_t kNone = 255;
};

}  // namespace wellmesh
