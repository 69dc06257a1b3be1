// SPDX-License-Identifier: Apache-2.0
#include "certify/ball_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/infinity.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

using Long = long double;
using LongVec = std::array<Long, 3>;

constexpr Long kLongUnit = std::numeric_limits<Long>::epsilon();       // 2^-63 on x86; 2^-52 where long double is double
constexpr double kUnit = std::numeric_limits<double>::epsilon();  // twice the rounding unit

LongVec difference(const Vec3& p, const Vec3& q, double scale) {
    const auto s = static_cast<Long>(scale);
    return {s * (static_cast<Long>(p.x) - static_cast<Long>(q.x)), s * (static_cast<Long>(p.y) - static_cast<Long>(q.y)),
            s * (static_cast<Long>(p.z) - static_cast<Long>(q.z))};
}
LongVec cross(const LongVec& a, const LongVec& b) { return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}; }
Long dot(const LongVec& a, const LongVec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
LongVec operator*(Long s, const LongVec& a) { return {s * a[0], s * a[1], s * a[2]}; }
LongVec operator+(const LongVec& a, const LongVec& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Long norm(const LongVec& a) { return std::sqrt(dot(a, a)); }

/// An edge of a weighted simplex from its base, its lift, and a bound of the lift's terms.
struct WeightedEdge {
    LongVec along;
    Long squared, lift, terms;
    WeightedEdge(const WeightedPoint& to, const WeightedPoint& base, double scale)
        : along(difference(to.point, base.point, scale)), squared(dot(along, along)), lift(squared), terms(squared) {
        const Long s2 = static_cast<Long>(scale) * static_cast<Long>(scale);
        lift -= s2 * (static_cast<Long>(to.weight) - static_cast<Long>(base.weight));
        terms += s2 * (std::abs(static_cast<Long>(to.weight)) + std::abs(static_cast<Long>(base.weight)));
    }
};

}  // namespace

BallSearch::BallSearch(const std::vector<Vec3>& points, const std::vector<double>& weights) {
    Workers alone;
    *this = BallSearch(points, weights, alone);
}

BallSearch::BallSearch(const std::vector<Vec3>& points, const std::vector<double>& weights, Workers& workers)
    : originals_(&points), weights_(weights.empty() ? nullptr : &weights), points_(points.size()) {
    double largest = 0;
    for (const Vec3& p : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    if (largest > 0) scale_ = std::ldexp(1.0, -std::ilogb(largest) - 1);
    if (weights_ != nullptr) largest_weight_ = scale_ * *std::max_element(weights.begin(), weights.end()) * scale_;
    root_ = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    for (std::size_t i = 0; i < points.size(); ++i) {
        points_[i] = {scale_ * points[i], static_cast<std::uint32_t>(i)};
        for (std::size_t k = 0; k < 3; ++k) {
            root_.low[k] = std::min(root_.low[k], coordinate(points_[i].at, k));
            root_.high[k] = std::max(root_.high[k], coordinate(points_[i].at, k));
        }
    }
    std::size_t nodes = 1;
    for (std::size_t n = points.size(); n > kLeaf; n = n - n / 2) nodes = 2 * nodes + 1;
    axes_.assign(nodes, 0);
    cuts_.assign(nodes, 0);
    // Level by level to where there are enough nodes for all threads, then each of these to its leaves.
    struct Node {
        std::size_t begin, end, node;
    };
    std::vector<Node> level{{0, points_.size(), 0}};
    for (int depth = 0; depth < 6 && level.front().end - level.front().begin > 64 * kLeaf; ++depth) {
        workers.for_each(level.size(), [&](std::size_t i) { split(level[i].begin, level[i].end, level[i].node); });
        std::vector<Node> next;
        for (const auto& [begin, end, node] : level) {
            const std::size_t middle = begin + (end - begin) / 2;
            next.push_back({begin, middle, 2 * node + 1});
            next.push_back({middle, end, 2 * node + 2});
        }
        level = std::move(next);
    }
    workers.for_each(level.size(), [&](std::size_t i) { build(level[i].begin, level[i].end, level[i].node); });
}

void BallSearch::split(std::size_t begin, std::size_t end, std::size_t node) {
    Vec3 low = points_[begin].at, high = low;
    for (std::size_t i = begin; i < end; ++i) {
        const Vec3& p = points_[i].at;
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const Vec3 size = high - low;
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    axes_[node] = static_cast<std::uint8_t>(axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    const auto sort_by = [&](double Vec3::* x) { std::nth_element(at(begin), at(middle), at(end), [x](const Point& p, const Point& q) { return p.at.*x < q.at.*x; }); };
    if (axis == 0) sort_by(&Vec3::x);
    else if (axis == 1) sort_by(&Vec3::y);
    else sort_by(&Vec3::z);
    cuts_[node] = coordinate(points_[middle].at, axis);
}

void BallSearch::build(std::size_t begin, std::size_t end, std::size_t node) {
    if (end - begin <= kLeaf) return;
    split(begin, end, node);
    const std::size_t middle = begin + (end - begin) / 2;
    build(begin, middle, 2 * node + 1);
    build(middle, end, 2 * node + 2);
}

// The coefficients are computed in long double. Every difference has a relative error of one rounding; A and each component of N are
// sums of at most 12 products of at most 6 rounded factors, so 64 roundings of the sum of absolute products (a_scale, n_scale bound
// it) are more than enough. Rounding them to Real, subtracting p - a, and evaluating f cost at most 8 roundings of Real relative
// to A |q|^2 and to |N_k q_k|, which are folded into a_low and n_error.
template <class Real>
BallForm<Real> BallSearch::form(Long a, const std::array<Long, 3>& n, Long a_error, Long n_error, Long largest_difference) const {
    constexpr auto kRounding = static_cast<Long>(std::numeric_limits<Real>::epsilon());
    BallForm<Real> form;
    form.a_low = static_cast<Real>(std::max(Long{0}, (a - a_error) * (1 - 16 * kRounding)));
    for (std::size_t k = 0; k < 3; ++k) {
        form.n[k] = static_cast<Real>(n[k]);
        form.n_error[k] = static_cast<Real>(n_error + 16 * kRounding * std::abs(n[k]));
    }
    form.allowance = static_cast<Real>((a + a_error) * (1 + 16 * kRounding) * largest_difference);
    return form;
}

Ball BallSearch::finish(const WeightedPoint& base, Long a, const std::array<Long, 3>& n, Long a_scale, Long n_scale) const {
    Ball ball;
    ball.base = scale_ * base.point;
    ball.base_weight = scale_ * base.weight * scale_;
    ball.a = a;
    ball.radius_squared = static_cast<double>(dot(n, n) / (4 * a * a));
    const Long a_error = 64 * kLongUnit * a_scale, n_error = 64 * kLongUnit * n_scale;
    const Long largest_difference = weights_ == nullptr ? 0 : std::max(Long{0}, static_cast<Long>(largest_weight_) - static_cast<Long>(ball.base_weight));
    ball.rough = form<double>(a, n, a_error, n_error, largest_difference);
    ball.close = form<Long>(a, n, a_error, n_error, largest_difference);
    return ball;
}

Ball BallSearch::circumball(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d) const {
    const WeightedEdge eu(b, a, scale_), ev(c, a, scale_), ew(d, a, scale_);
    const LongVec &u = eu.along, &v = ev.along, &w = ew.along, vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
    const Long lu = norm(u), lv = norm(v), lw = norm(w);
    return finish(a, dot(u, vw), eu.lift * vw + ev.lift * wu + ew.lift * uv, lu * lv * lw, eu.terms * lv * lw + ev.terms * lw * lu + ew.terms * lu * lv);
}

Ball BallSearch::equatorial_ball(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c) const {
    const WeightedEdge eu(b, a, scale_), ev(c, a, scale_);
    const LongVec &u = eu.along, &v = ev.along, n = cross(u, v);
    const Long lu = norm(u), lv = norm(v);
    return finish(a, dot(n, n), eu.lift * cross(v, n) + ev.lift * cross(n, u), eu.squared * ev.squared, lu * lv * (eu.terms * lv + ev.terms * lu));
}

Ball BallSearch::diametral_ball(const WeightedPoint& a, const WeightedPoint& b) const {
    const WeightedEdge e(b, a, scale_);
    return finish(a, 1, (e.lift / e.squared) * e.along, 1, (e.terms / e.squared) * norm(e.along));
}

namespace {

enum class Verdict : std::uint8_t { outside, meets, unsure };

/// The least of the form's share of one axis over the interval of these ends, differences from the base, and how wrong it may be.
template <class Real>
std::array<Real, 2> least_along(const BallForm<Real>& form, std::size_t k, Real low, Real high) {
    constexpr Real kRounding = std::numeric_limits<Real>::epsilon();
    // Rounding of the interval's ends: relative to their size, covered by the roundings in a_low and n_error.
    const auto parabola = [&](Real x) { return (form.a_low * x - form.n[k]) * x; };
    Real least = std::min(parabola(low), parabola(high));
    const Real bottom = form.a_low > 0 ? form.n[k] / (2 * form.a_low) : 0;
    if (form.a_low > 0 && low < bottom && bottom < high) least = -form.n[k] * bottom / 2;
    // The bottom's own rounding and that of the sum: relative to the terms, of which n x is the larger where f is near 0.
    return {least, (form.n_error[k] + 16 * kRounding * std::abs(form.n[k])) * std::max(std::abs(low), std::abs(high))};
}

/// Whether the ball meets the box, from what its axes add.
template <class Real>
Verdict where(const BallForm<Real>& form, const std::array<Real, 3>& least, const std::array<Real, 3>& slacks) {
    const Real lowest = (least[0] + least[1] + least[2]) - form.allowance, slack = slacks[0] + slacks[1] + slacks[2];
    return lowest > slack ? Verdict::outside : lowest < -slack ? Verdict::meets : Verdict::unsure;
}

}  // namespace

void BallSearch::Bounds::update(const Ball& ball, std::size_t axis) {
    const double base = coordinate(ball.base, axis);
    const auto [lowest, error] = least_along(ball.rough, axis, box.low[axis] - base, box.high[axis] - base);
    least[axis] = lowest;
    slack[axis] = error;
}

bool BallSearch::excludes(const Ball& ball, const Bounds& bounds) {
    if (const Verdict rough = where(ball.rough, bounds.least, bounds.slack); rough != Verdict::unsure) return rough == Verdict::outside;
    std::array<Long, 3> least{}, slack{};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto base = static_cast<Long>(coordinate(ball.base, k));
        const auto [lowest, error] = least_along(ball.close, k, static_cast<Long>(bounds.box.low[k]) - base, static_cast<Long>(bounds.box.high[k]) - base);
        least[k] = lowest;
        slack[k] = error;
    }
    return where(ball.close, least, slack) == Verdict::outside;
}

bool BallSearch::excludes(const Ball& ball, const Vec3& point) {
    Bounds bounds{{{point.x, point.y, point.z}, {point.x, point.y, point.z}}, {}, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) bounds.update(ball, axis);
    return excludes(ball, bounds);
}

bool BallSearch::list_near(std::span<const Ball> balls, Neighbourhood& near) const {
    for (std::vector<double>& along : near.at_) along.clear();
    near.numbers_.clear();
    Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    for (const Ball& ball : balls) {
        // Centre and radius from the least A and the largest N that they may have; 1e-12 is far more than the roundings here.
        const BallForm<double>& form = ball.rough;
        if (!(form.a_low > 0) || form.allowance != 0) return false;
        const double scale = (1 + 1e-12) / (2 * form.a_low);
        std::array<double, 3> most{};
        for (std::size_t k = 0; k < 3; ++k) most[k] = std::abs(form.n[k]) + form.n_error[k];
        const double radius = scale * std::sqrt(most[0] * most[0] + most[1] * most[1] + most[2] * most[2]);
        for (std::size_t k = 0; k < 3; ++k) {
            const double base = coordinate(ball.base, k), slack = 1e-12 * (std::abs(base) + radius) + 1e-150;
            box.low[k] = std::min(box.low[k], base + (std::min(0.0, scale * (form.n[k] - form.n_error[k])) - radius - slack));
            box.high[k] = std::max(box.high[k], base + (std::max(0.0, scale * (form.n[k] + form.n_error[k])) + radius + slack));
        }
    }
    return list_in(box, 0, points_.size(), 0, near);
}

bool BallSearch::list_in(const Box& box, std::size_t begin, std::size_t end, std::size_t node, Neighbourhood& near) const {
    if (end - begin > kLeaf) {
        const std::size_t middle = begin + (end - begin) / 2, axis = axes_[node];
        return (!(box.low[axis] <= cuts_[node]) || list_in(box, begin, middle, 2 * node + 1, near)) &&
               (!(box.high[axis] >= cuts_[node]) || list_in(box, middle, end, 2 * node + 2, near));
    }
    for (std::size_t i = begin; i < end; ++i) {
        const Point& p = points_[i];
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k) inside &= (box.low[k] <= coordinate(p.at, k)) & (coordinate(p.at, k) <= box.high[k]);
        if (!inside) continue;
        for (std::size_t k = 0; k < 3; ++k) near.at_[k].push_back(coordinate(p.at, k));
        near.numbers_.push_back(p.number);
    }
    return near.numbers_.size() <= kMostNear;
}

// As excludes() does it for a point: each axis adds (a x - n) x, with an error of (n_error + 16 roundings of n) |x|.
void BallSearch::Neighbourhood::measure(const Ball& ball) {
    constexpr double kRounding = std::numeric_limits<double>::epsilon();
    const std::size_t n = numbers_.size();
    margins_.resize(n);
    const BallForm<double>& form = ball.rough;
    std::array<double, 3> error{};
    for (std::size_t k = 0; k < 3; ++k) error[k] = form.n_error[k] + 16 * kRounding * std::abs(form.n[k]);
    const double* const xs = at_[0].data();
    const double* const ys = at_[1].data();
    const double* const zs = at_[2].data();
    double* const margins = margins_.data();
    for (std::size_t i = 0; i < n; ++i) {
        const double x = xs[i] - ball.base.x, y = ys[i] - ball.base.y, z = zs[i] - ball.base.z;
        const double value = ((form.a_low * x - form.n[0]) * x + (form.a_low * y - form.n[1]) * y) + (form.a_low * z - form.n[2]) * z;
        const double slack = (error[0] * std::abs(x) + error[1] * std::abs(y)) + error[2] * std::abs(z);
        margins[i] = value - slack;
    }
}

double BallSearch::depth(const Ball& ball, std::uint32_t vertex) const {
    const LongVec q = difference((*originals_)[vertex], (1 / scale_) * ball.base, scale_);
    const Long a = ball.a, base_weight = static_cast<Long>(ball.base_weight);
    const Long weight = weights_ == nullptr ? 0 : static_cast<Long>(scale_) * static_cast<Long>((*weights_)[vertex]) * static_cast<Long>(scale_);
    const Long f = a * dot(q, q) - dot(ball.close.n, q);
    return static_cast<double>((a * (weight - base_weight) - f) / (a * (static_cast<Long>(ball.radius_squared) + std::abs(base_weight) + std::abs(weight))));
}

}  // namespace wellmesh::certifying
