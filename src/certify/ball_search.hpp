// SPDX-License-Identifier: Apache-2.0
// Which mesh vertices may lie inside a ball? A kd-tree prunes by rounded arithmetic with proven error bounds; what it cannot
// exclude, an exact predicate decides.
//
// A ball about the circumcentre of a simplex with corner a is written without division, in q = p - a, as
//     inside  <=>  f(q) = A |q|^2 - N . q < 0,        centre = a + N / (2 A),  A > 0.
// For the tetrahedron A = det(u, v, w) and N = |u|^2 v x w + |v|^2 w x u + |w|^2 u x v; for the equatorial ball of a triangle with
// normal n = u x v, A = |n|^2 and N = |u|^2 v x n + |v|^2 n x u; for the diametral ball of an edge A = 1 and N = u. So balls of almost
// flat simplices, whose centres no double holds, are searched as well as others: f is a sum of one parabola a coordinate, and its
// minimum over a box is the sum of three minima over intervals.
//
// With weights the ball is that of the sphere orthogonal to the corners: |u|^2 - w_b + w_a stands for |u|^2 in N, and so on, and p is in
// conflict iff f(q) < A (w_p - w_a). The search allows for the largest weight of all.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/workers.hpp"
#include "wellmesh/predicates.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh::certifying {

/// f as above in the search's scaled coordinates, with bounds on the errors of its coefficients, in one precision.
template <class Real>
struct BallForm {
    Real a_low = 0;                 ///< at most A; 0 when not even its sign is sure: then nothing is pruned by distance
    std::array<Real, 3> n{};
    std::array<Real, 3> n_error{};  ///< of each component, rounding of later evaluations included
    Real allowance = 0;             ///< at least A (w_p - w_a) for every vertex p
};

/// Made by BallSearch only.
struct Ball {
    Vec3 base{};
    long double a = 0;
    BallForm<double> rough;
    /// For what the rough form can't exclude: thousands of vertices on a tangent of the ball, with spacings below the square root of a rounding.
    BallForm<long double> close;
    double base_weight = 0;     ///< w_a, scaled
    double radius_squared = 0;  ///< |N|^2 / (4 A^2), rounded: of the base's distance from the centre
};

class BallSearch {
public:
    /// @param weights  of all points, or empty. Both must outlive this.
    explicit BallSearch(const std::vector<Vec3>& points, const std::vector<double>& weights = {});
    BallSearch(const std::vector<Vec3>& points, const std::vector<double>& weights, Workers& workers);

    [[nodiscard]] Ball circumball(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d) const;
    [[nodiscard]] Ball equatorial_ball(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c) const;
    [[nodiscard]] Ball diametral_ball(const WeightedPoint& a, const WeightedPoint& b) const;

    /// Calls visit(vertex) for a superset of the vertices strictly inside the ball, or in conflict, until it returns true. @return whether it did.
    template <class Visit>
    bool any_in(const Ball& ball, Visit&& visit) const {
        if (points_.empty()) return false;
        Bounds bounds{root_, {}, {}};
        for (std::size_t axis = 0; axis < 3; ++axis) bounds.update(ball, axis);
        return search(ball, 0, points_.size(), 0, bounds, visit);
    }

    /// The points near a few balls, to be held against each of them: faster than a search for each where the balls are neighbours.
    class Neighbourhood {
    public:
        /// The same as BallSearch::any_in, for one of the balls.
        template <class Visit>
        bool any_in(const Ball& ball, Visit&& visit);

    private:
        friend class BallSearch;
        /// Margins of all points: positive where a point is surely outside.
        void measure(const Ball& ball);
        std::array<std::vector<double>, 3> at_;  // scaled
        std::vector<double> margins_;
        std::vector<std::uint32_t> numbers_, found_;
    };
    /// @return whether there are few enough, and the balls are not those of almost collinear corners.
    bool list_near(std::span<const Ball> balls, Neighbourhood& near) const;

    /// By how much the vertex is inside, as a fraction of the squared radius: 1 - |p - centre|^2 / R^2, rounded (64 bits of mantissa
    /// where long double has them). With weights: its weight minus its power, over |a - centre|^2 + |w_a| + |w_p|.
    [[nodiscard]] double depth(const Ball& ball, std::uint32_t vertex) const;

private:
    struct Box {
        std::array<double, 3> low, high;
    };
    struct Point {
        Vec3 at;  // scaled
        std::uint32_t number;
    };
    static constexpr std::size_t kLeaf = 8;

    template <class Real>
    [[nodiscard]] BallForm<Real> form(long double a, const std::array<long double, 3>& n, long double a_error, long double n_error, long double largest_difference) const;
    [[nodiscard]] Ball finish(const WeightedPoint& base, long double a, const std::array<long double, 3>& n, long double a_scale, long double n_scale) const;
    /// Of one node, not of those below.
    void split(std::size_t begin, std::size_t end, std::size_t node);
    void build(std::size_t begin, std::size_t end, std::size_t node);
    [[nodiscard]] static bool excludes(const Ball& ball, const Vec3& point);

    /// A box, and for each axis the least that the rough form adds over it, and how wrong that may be: a cut changes one of the three.
    struct Bounds {
        Box box;
        std::array<double, 3> least, slack;
        void update(const Ball& ball, std::size_t axis);
    };
    [[nodiscard]] static bool excludes(const Ball& ball, const Bounds& bounds);

    template <class Visit>
    bool search(const Ball& ball, std::size_t begin, std::size_t end, std::size_t node, const Bounds& bounds, Visit& visit) const {
        if (end - begin <= kLeaf) {
            for (std::size_t i = begin; i < end; ++i)
                if (!excludes(ball, points_[i].at) && visit(points_[i].number)) return true;
            return false;
        }
        const std::size_t middle = begin + (end - begin) / 2, axis = axes_[node];
        const double cut = cuts_[node];
        Bounds near = bounds;
        std::size_t near_begin = begin, near_end = middle, near_node = 2 * node + 1, far_begin = middle, far_end = end, far_node = 2 * node + 2;
        const bool upper_first = coordinate(ball.base, axis) > cut;  // the corner's side first: what is inside is mostly near the simplex
        if (upper_first) std::swap(near_begin, far_begin), std::swap(near_end, far_end), std::swap(near_node, far_node);
        (upper_first ? near.box.low : near.box.high)[axis] = cut;
        near.update(ball, axis);
        if (!excludes(ball, near) && search(ball, near_begin, near_end, near_node, near, visit)) return true;
        Bounds far = bounds;
        (upper_first ? far.box.high : far.box.low)[axis] = cut;
        far.update(ball, axis);
        return !excludes(ball, far) && search(ball, far_begin, far_end, far_node, far, visit);
    }
    static constexpr std::size_t kMostNear = 512;  ///< in a neighbourhood
    /// Lists the points in the box. @return false: there are more than kMostNear.
    bool list_in(const Box& box, std::size_t begin, std::size_t end, std::size_t node, Neighbourhood& near) const;
    [[nodiscard]] static double coordinate(const Vec3& p, std::size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

    double scale_ = 1;                 // power of two: tree coordinates are at most 1, so no fourth power under- or overflows
    const std::vector<Vec3>* originals_;
    const std::vector<double>* weights_;  // null: none
    double largest_weight_ = 0;           // scaled
    std::vector<Point> points_;         // a node's are contiguous, its first half before its cut
    std::vector<std::uint8_t> axes_;    // of each inner node, heap numbering
    std::vector<double> cuts_;          // scaled: a coordinate of the first half is at most this, of the second at least
    Box root_{};
};

template <class Visit>
bool BallSearch::Neighbourhood::any_in(const Ball& ball, Visit&& visit) {
    measure(ball);
    found_.resize(margins_.size() + 1);
    std::size_t n = 0;
    for (std::size_t i = 0; i < margins_.size(); ++i) {
        found_[n] = static_cast<std::uint32_t>(i);
        n += !(margins_[i] > 0);
    }
    found_.resize(n);
    return std::any_of(found_.begin(), found_.end(), [&](std::uint32_t i) { return visit(numbers_[i]); });
}

}  // namespace wellmesh::certifying
