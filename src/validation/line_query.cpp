// SPDX-License-Identifier: Apache-2.0
#include "validation/line_query.hpp"

#include <cmath>

#include "core/check.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"
#include "predicates/expansion.hpp"
#include "validation/plane.hpp"

namespace wellmesh {
namespace {

constexpr std::uint64_t kMaxAttempts = 256;  // a random line meets an edge with probability about 2^-50 an edge

std::vector<Box> boxes_of(std::span<const Vec3> points, std::span<const SoupTriangle> triangles) {
    std::vector<Box> boxes(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (const VertexId v : triangles[t].v) boxes[t].add(points[v.index()]);
    return boxes;
}

using Difference = Expansion<2>;

Difference scaled_difference(double a, double b) { return Difference(two_difference(kDifferenceScale * a, kDifferenceScale * b)); }

/// det(b - a, c - a, d - a), exactly, times a constant.
auto exact_volume(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const Difference bx = scaled_difference(b.x, a.x), by = scaled_difference(b.y, a.y), bz = scaled_difference(b.z, a.z);
    const Difference cx = scaled_difference(c.x, a.x), cy = scaled_difference(c.y, a.y), cz = scaled_difference(c.z, a.z);
    const Difference dx = scaled_difference(d.x, a.x), dy = scaled_difference(d.y, a.y), dz = scaled_difference(d.z, a.z);
    return bx * (cy * dz - cz * dy) + by * (cz * dx - cx * dz) + bz * (cx * dy - cy * dx);
}

Sign times(Sign a, Sign b) { return static_cast<Sign>(static_cast<int>(a) * static_cast<int>(b)); }

/// Signs of the line pq against the three edges of abc, or nothing if some edge says that the line misses.
std::optional<std::array<Sign, 3>> winding_around(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Sign ab = orient3d(p, q, a, b);
    const Sign bc = orient3d(p, q, b, c);
    if (times(ab, bc) == Sign::negative) return std::nullopt;
    const Sign ca = orient3d(p, q, c, a);
    if (times(ab, ca) == Sign::negative || times(bc, ca) == Sign::negative) return std::nullopt;
    return std::array{ab, bc, ca};
}

bool contains_coplanar(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    // in every projection in which the triangle has an area, the point is inside or on it; one of them suffices
    for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
        const PlaneProjection f(axis);
        const Sign area = orient2d(f(a), f(b), f(c));
        if (area == Sign::zero) continue;
        return times(area, orient2d(f(a), f(b), f(p))) != Sign::negative && times(area, orient2d(f(b), f(c), f(p))) != Sign::negative &&
               times(area, orient2d(f(c), f(a), f(p))) != Sign::negative;
    }
    return false;
}

}  // namespace

LineQuery::LineQuery(std::span<const Vec3> points, std::span<const SoupTriangle> triangles)
    : points_(points), triangles_(triangles), boxes_(boxes_of(points, triangles)), tree_(boxes_) {
    if (!boxes_.empty()) diagonal_ = distance(tree_.bounds().low, tree_.bounds().high);
}

Vec3 LineQuery::far_point(const Vec3& p, std::uint64_t attempt, double sign) const {
    Vec3 d{};
    double length = 0;
    for (std::uint64_t i = 0; length < 0.1 || length > 1; ++i) {  // uniform in a shell of the unit ball, hence in direction
        const auto draw = [&](std::uint64_t k) { return 2 * unit_double(mix64(mix64(attempt, 0x6c696e65), 3 * i + k)) - 1; };
        d = {draw(0), draw(1), draw(2)};
        length = norm(d);
    }
    const Vec3 centre = 0.5 * tree_.bounds().low + 0.5 * tree_.bounds().high;
    const double reach = 2 * (diagonal_ + distance(p, centre));
    return flush_to_exact_range(p + (sign * reach / length) * d);
}

bool LineQuery::is_before(const Hit& a, const Hit& b, const Vec3& p, const Vec3& q) const {
    if (std::abs(a.t - b.t) > a.t_error + b.t_error) return a.t < b.t;
    const auto volume = [&](const Hit& h, const Vec3& x) {
        return exact_volume(corner(h.triangle, 0), corner(h.triangle, 1), corner(h.triangle, 2), x);
    };
    // t = |P| / (|P| + |Q|) with the volumes P, Q over the triangle, of opposite sign
    const auto left = volume(a, p) * volume(b, q);
    const auto right = volume(b, p) * volume(a, q);
    const Sign order = (left - right).sign();
    // |P_a Q_b| < |P_b Q_a|; both products are negative times the two fronts' signs, which are equal factors
    const bool same = a.front_first == b.front_first;
    return order == (same ? Sign::positive : Sign::negative);
}

std::optional<std::vector<Hit>> LineQuery::pierce(const Vec3& p, const Vec3& q) const {
    std::vector<Hit> hits;
    bool degenerate = false;
    const SegmentClipper line(p, q);
    tree_.query([&](const Box& box) { return line.meets(box); }, [&](std::uint32_t t) {
        if (degenerate) return;
        const Vec3 &a = corner(t, 0), &b = corner(t, 1), &c = corner(t, 2);
        const Sign sp = orient3d(a, b, c, p), sq = orient3d(a, b, c, q);
        if (sp == sq && sp != Sign::zero) return;
        const auto winding = winding_around(p, q, a, b, c);
        if (!winding) return;
        const auto& w = *winding;
        if (sp == Sign::zero || sq == Sign::zero || w[0] == Sign::zero || w[1] == Sign::zero || w[2] == Sign::zero) {
            degenerate = true;
            return;
        }
        const double vp = std::abs(determinant(b - a, c - a, p - a)), vq = std::abs(determinant(b - a, c - a, q - a));
        // a determinant is off by at most 8 u times the product of its rows' lengths, u = 2^-53; 2^-48 also covers the division
        const double rows = norm(b - a) * norm(c - a) * std::max(norm(p - a), norm(q - a));
        const double sum = vp + vq;
        hits.push_back({t, sp == Sign::positive, sum > 0 ? vp / sum : 0.5, sum > 0 ? 0x1p-48 * std::max(1.0, rows / sum) : 1.0});
    });
    if (degenerate) return std::nullopt;
    std::sort(hits.begin(), hits.end(), [&](const Hit& a, const Hit& b) { return a.triangle != b.triangle && is_before(a, b, p, q); });
    return hits;
}

std::optional<std::uint32_t> LineQuery::triangle_at(const Vec3& p) const {
    std::optional<std::uint32_t> found;
    Box box;
    box.add(p);
    tree_.query([&](const Box& b) { return b.meets(box); },
                [&](std::uint32_t t) {
                    const Vec3 &a = corner(t, 0), &b = corner(t, 1), &c = corner(t, 2);
                    if (!found && orient3d(a, b, c, p) == Sign::zero && contains_coplanar(p, a, b, c)) found = t;
                });
    return found;
}

LineQuery::Place LineQuery::locate(const Vec3& p) const {
    if (const auto on = triangle_at(p)) return {std::nullopt, on};
    for (std::uint64_t attempt = 0; attempt < kMaxAttempts; ++attempt) {
        const auto hits = pierce(p, far_point(p, attempt));
        if (!hits) continue;
        if (hits->empty()) return {};
        return {hits->front().side_towards_start(), std::nullopt};
    }
    WELLMESH_CHECK(Stage::validate, !"no line in general position");
    return {};
}

}  // namespace wellmesh
