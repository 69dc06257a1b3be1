// SPDX-License-Identifier: Apache-2.0
#include "refinement/planar_refiner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace wellmesh {
namespace {

using Point = PlanarRefiner::Point;

/// Sine of the least angle that a new triangle may have at its rim edge.
constexpr double kLeastSine = 1e-9;
/// Of the squared radius: distances that differ by less are compared by a determinant, which knows no centre.
constexpr double kSurely = 1e-6;
/// Rounding of that determinant, over the sum of its terms' sizes [Shewchuk97].
constexpr double kDeterminantRounding = 12 * std::numeric_limits<double>::epsilon();

double squared_distance(const Point& a, const Point& b) { return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y); }

/// Twice the area of abc.
double turn(const Point& a, const Point& b, const Point& c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

/// Is d in the circle of abc beyond doubt?
bool surely_in_circle(const Point& a, const Point& b, const Point& c, const Point& d) {
    const double ax = a.x - d.x, ay = a.y - d.y, bx = b.x - d.x, by = b.y - d.y, cx = c.x - d.x, cy = c.y - d.y;
    const double a2 = ax * ax + ay * ay, b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
    const double value = a2 * (bx * cy - by * cx) + b2 * (cx * ay - cy * ax) + c2 * (ax * by - ay * bx);
    const double size = a2 * (std::abs(bx * cy) + std::abs(by * cx)) + b2 * (std::abs(cx * ay) + std::abs(cy * ax)) + c2 * (std::abs(ax * by) + std::abs(ay * bx));
    return value > kDeterminantRounding * size;
}

}  // namespace

bool PlanarRefiner::begin(std::span<const Point> points, std::span<const Corners> triangles, std::span<const std::uint8_t> fixed) {
    points_.assign(points.begin(), points.end());
    triangles_.clear();
    spare_.clear();
    triangle_of_.assign(points.size(), kNone);
    begins_at_.assign(points.size(), kNone);
    in_region_.assign(triangles.size(), 0);
    search_ = births_ = 0;
    struct Side {
        std::uint64_t edge;
        std::uint32_t triangle;
        std::uint32_t corner;
    };
    std::vector<Side> sides;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        Triangle it{.corners = triangles[t], .across = {kNone, kNone, kNone}, .fixed = fixed[t], .born = ++births_};
        if (!find_circle(it)) return false;
        triangles_.push_back(it);
        for (std::uint32_t k = 0; k < 3; ++k) {
            triangle_of_[it.corners[k]] = t;
            const std::uint64_t a = it.corners[(k + 1) % 3], b = it.corners[(k + 2) % 3];
            sides.push_back({std::min(a, b) << 32U | std::max(a, b), t, k});
        }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& x, const Side& y) { return x.edge < y.edge; });
    for (std::size_t i = 0; i < sides.size();) {
        std::size_t end = i + 1;
        while (end < sides.size() && sides[end].edge == sides[i].edge) ++end;
        if (end - i > 2) return false;
        if (end - i == 2) {
            triangles_[sides[i].triangle].across[sides[i].corner] = sides[i + 1].triangle;
            triangles_[sides[i + 1].triangle].across[sides[i + 1].corner] = sides[i].triangle;
        } else {
            triangles_[sides[i].triangle].fixed |= static_cast<std::uint8_t>(1U << sides[i].corner);
        }
        i = end;
    }
    return true;
}

/// @return false: flat
bool PlanarRefiner::find_circle(Triangle& t) const {
    const Point &a = points_[t.corners[0]], &b = points_[t.corners[1]], &c = points_[t.corners[2]];
    const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - a.x, vy = c.y - a.y;
    const double u2 = ux * ux + uy * uy, v2 = vx * vx + vy * vy, area2 = ux * vy - uy * vx;
    if (!(area2 > 0)) return false;
    const double x = (vy * u2 - uy * v2) / (2 * area2), y = (ux * v2 - vx * u2) / (2 * area2);
    t.centre = {a.x + x, a.y + y};
    t.squared_radius = x * x + y * y;
    return std::isfinite(t.squared_radius);
}

bool PlanarRefiner::in_conflict(const Triangle& t, const Point& p) const {
    const double d = squared_distance(t.centre, p);
    if (d < t.squared_radius * (1 - kSurely)) return true;
    if (d > t.squared_radius * (1 + kSurely)) return false;
    return surely_in_circle(points_[t.corners[0]], points_[t.corners[1]], points_[t.corners[2]], p);
}

/// Triangles in conflict with p, connected to the seed, which need not be, not across fixed edges; and their rim.
void PlanarRefiner::find_region(const Point& p, std::uint32_t seed) {
    region_.assign(1, seed);
    in_region_[seed] = ++search_;
    grow_region(p, kNone, kNone);
    list_rim(kNone, kNone);
}

/// From what is in it already. @param a, b  a fixed edge that is crossed
void PlanarRefiner::grow_region(const Point& p, std::uint32_t a, std::uint32_t b) {
    for (std::size_t i = 0; i < region_.size(); ++i) {
        const Triangle& t = triangles_[region_[i]];
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t next = t.across[k];
            if (next == kNone || in_region_[next] == search_) continue;
            const std::uint32_t from = t.corners[(k + 1) % 3], to = t.corners[(k + 2) % 3];
            const bool crossed = (from == a && to == b) || (from == b && to == a);
            if ((t.fixed >> k & 1U) != 0 && !crossed) continue;
            if (!in_conflict(triangles_[next], p)) continue;
            in_region_[next] = search_;
            region_.push_back(next);
        }
    }
}

/// All edges between what is in the region and what is not, and fixed ones, but for ab.
void PlanarRefiner::list_rim(std::uint32_t a, std::uint32_t b) {
    rim_.clear();
    for (const std::uint32_t t : region_) {
        const Triangle& it = triangles_[t];
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t from = it.corners[(k + 1) % 3], to = it.corners[(k + 2) % 3];
            if ((from == a && to == b) || (from == b && to == a)) continue;
            const bool fixed = (it.fixed >> k & 1U) != 0;
            const std::uint32_t next = it.across[k];
            if (fixed || next == kNone || in_region_[next] != search_) rim_.push_back({from, to, next, fixed});
        }
    }
}

/// Upon the diametral circle of the edge, or its other side.
bool PlanarRefiner::encroaches(const Point& p, const RimEdge& e) const {
    const Point &a = points_[e.a], &b = points_[e.b];
    return (a.x - p.x) * (b.x - p.x) + (a.y - p.y) * (b.y - p.y) <= 0 || turn(a, b, p) <= 0;
}

/// Does p see all of the rim, and is the region a disk with no vertex inside? @param is_on_rim  p lies on an edge that has nothing beyond
bool PlanarRefiner::is_star_of(const Point& p, bool is_on_rim) {
    if (rim_.size() != region_.size() + (is_on_rim ? 1 : 2)) return false;
    const auto sees = [&](const RimEdge& e) {
        const Point &from = points_[e.a], &to = points_[e.b];
        const double area = turn(from, to, p);
        return area > 0 && area * area > kLeastSine * kLeastSine * squared_distance(from, to) * squared_distance(from, p);
    };
    bool is_star = std::all_of(rim_.begin(), rim_.end(), sees);
    for (const RimEdge& e : rim_) is_star = std::exchange(begins_at_[e.a], 0U) == kNone && is_star;
    for (const RimEdge& e : rim_) begins_at_[e.a] = kNone;
    return is_star;
}

std::uint32_t PlanarRefiner::slot() {
    if (!spare_.empty()) {
        const std::uint32_t t = spare_.back();
        spare_.pop_back();
        return t;
    }
    triangles_.emplace_back();
    in_region_.push_back(0);
    return static_cast<std::uint32_t>(triangles_.size() - 1);
}

/// Replaces the region by the star of p. @param a, b  the fixed edge that p is on
std::uint32_t PlanarRefiner::insert(const Point& p, std::uint32_t a, std::uint32_t b) {
    const auto v = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
    triangle_of_.push_back(kNone);
    begins_at_.push_back(kNone);
    for (const std::uint32_t t : region_) {
        triangles_[t].born = 0;
        spare_.push_back(t);
    }
    made_.clear();
    for (const RimEdge& e : rim_) {
        const std::uint32_t t = slot();
        made_.push_back(t);
        Triangle& it = triangles_[t];
        it.corners = {e.a, e.b, v};
        it.across = {kNone, kNone, e.beyond};
        it.fixed = e.fixed ? 4 : 0;
        it.born = ++births_;
        in_region_[t] = 0;
        begins_at_[e.a] = t;
        triangle_of_[e.a] = triangle_of_[e.b] = triangle_of_[v] = t;
        (void)find_circle(it);
    }
    for (std::size_t i = 0; i < made_.size(); ++i) {
        const RimEdge& e = rim_[i];
        Triangle& it = triangles_[made_[i]];
        if (e.beyond != kNone) {
            Triangle& beyond = triangles_[e.beyond];
            for (std::uint32_t k = 0; k < 3; ++k)
                if (beyond.corners[(k + 1) % 3] == e.b && beyond.corners[(k + 2) % 3] == e.a) beyond.across[k] = made_[i];
        }
        const std::uint32_t next = begins_at_[e.b];
        if (next == kNone) continue;
        it.across[0] = next;
        triangles_[next].across[1] = made_[i];
    }
    for (const RimEdge& e : rim_) begins_at_[e.a] = kNone;
    for (const std::uint32_t t : made_) {
        Triangle& it = triangles_[t];
        if (it.across[0] == kNone || it.corners[1] == a || it.corners[1] == b) it.fixed |= 1;
        if (it.across[1] == kNone || it.corners[0] == a || it.corners[0] == b) it.fixed |= 2;
    }
    return v;
}

/// Some triangle with this edge; kNone if there is none.
std::uint32_t PlanarRefiner::triangle_with(std::uint32_t a, std::uint32_t b) const {
    const auto has = [&](std::uint32_t t) {
        const Corners& c = triangles_[t].corners;
        return std::find(c.begin(), c.end(), b) != c.end();
    };
    for (const std::uint32_t step : {1U, 2U}) {  // about a, one way and the other
        const std::uint32_t first = triangle_of_[a];
        for (std::uint32_t t = first; t != kNone;) {
            if (has(t)) return t;
            const Corners& c = triangles_[t].corners;
            const auto k = static_cast<std::uint32_t>(std::find(c.begin(), c.end(), a) - c.begin());
            t = triangles_[t].across[(k + step) % 3];
            if (t == first) break;
        }
    }
    // Where triangulations meet in a only.
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
        const Corners& c = triangles_[t].corners;
        if (is_live(t) && std::find(c.begin(), c.end(), a) != c.end() && has(t)) return t;
    }
    return kNone;
}

std::uint32_t PlanarRefiner::split_edge(std::uint32_t a, std::uint32_t b, const Point& p) {
    const std::uint32_t t = triangle_with(a, b);
    if (t == kNone) return kNone;
    for (const bool grows : {true, false}) {  // what rounding spoils is left without
        region_.assign(1, t);
        in_region_[t] = ++search_;
        bool is_on_rim = true;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const std::uint32_t from = triangles_[t].corners[(k + 1) % 3], to = triangles_[t].corners[(k + 2) % 3], beyond = triangles_[t].across[k];
            if (!((from == a && to == b) || (from == b && to == a)) || beyond == kNone) continue;
            in_region_[beyond] = search_;
            region_.push_back(beyond);
            is_on_rim = false;
        }
        if (grows) grow_region(p, a, b);
        list_rim(a, b);
        if (is_star_of(p, is_on_rim)) return insert(p, a, b);
    }
    return kNone;
}

}  // namespace wellmesh
