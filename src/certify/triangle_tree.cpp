// SPDX-License-Identifier: Apache-2.0
#include "certify/triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "wellmesh/predicates.hpp"

namespace wellmesh::certifying {
namespace {

double coordinate(const Vec3& p, std::size_t axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

/// Can the segment p + t d, 0 <= t <= 1, touch the box? Separating axes: the three coordinate axes and d's products with them [Ericson05].
/// Slightly generous, so that rounding loses no box.
bool may_touch(const Vec3& p, const Vec3& d, const Box3& box) {
    const Vec3 half = 0.5 * (box.high - box.low), centre = box.low + half, m = (p + 0.5 * d) - centre;
    const Vec3 e{std::abs(d.x) / 2, std::abs(d.y) / 2, std::abs(d.z) / 2};
    // Everything is a difference of coordinates or a product of two: 1e-14 of the largest terms exceeds all roundings.
    const double reach = std::abs(p.x) + std::abs(p.y) + std::abs(p.z) + norm(d) + std::abs(centre.x) + std::abs(centre.y) + std::abs(centre.z) + norm(half);
    const double slack = 1e-14 * reach;
    if (std::abs(m.x) > half.x + e.x + slack || std::abs(m.y) > half.y + e.y + slack || std::abs(m.z) > half.z + e.z + slack) return false;
    const double product_slack = 4 * slack * reach;
    return std::abs(m.y * d.z - m.z * d.y) / 2 <= half.y * e.z + half.z * e.y + product_slack &&
           std::abs(m.z * d.x - m.x * d.z) / 2 <= half.x * e.z + half.z * e.x + product_slack &&
           std::abs(m.x * d.y - m.y * d.x) / 2 <= half.x * e.y + half.y * e.x + product_slack;
}

double squared_distance_to_edge(const Vec3& p, const Vec3& q) {  // from the origin
    const Vec3 d = q - p;
    const double length = squared_norm(d);
    const double t = length > 0 ? std::clamp(-dot(p, d) / length, 0.0, 1.0) : 0.0;
    // From the nearer end: a point close to q keeps its digits.
    return t <= 0.5 ? squared_norm(p + t * d) : squared_norm(q - (1 - t) * d);
}

}  // namespace

Box3 Box3::of(const Vec3* points, std::size_t n) {
    Box3 box{points[0], points[0]};
    for (std::size_t i = 1; i < n; ++i) box.grow({points[i], points[i]});
    return box;
}

void Box3::grow(const Box3& o) {
    low = {std::min(low.x, o.low.x), std::min(low.y, o.low.y), std::min(low.z, o.low.z)};
    high = {std::max(high.x, o.high.x), std::max(high.y, o.high.y), std::max(high.z, o.high.z)};
}

double Box3::squared_distance_to(const Vec3& p) const {
    const double dx = std::max({low.x - p.x, p.x - high.x, 0.0}), dy = std::max({low.y - p.y, p.y - high.y, 0.0});
    const double dz = std::max({low.z - p.z, p.z - high.z, 0.0});
    return dx * dx + dy * dy + dz * dz;
}

BoxTree::BoxTree(const std::vector<Box3>& boxes) {
    Workers alone;
    *this = BoxTree(boxes, alone);
}

BoxTree::BoxTree(const std::vector<Box3>& boxes, Workers& workers) {
    leaves_.reserve(boxes.size());
    for (const Box3& b : boxes) leaves_.push_back({b, static_cast<std::uint32_t>(leaves_.size())});
    std::size_t nodes = 1;
    for (std::size_t n = leaves_.size(); n > kLeaf; n = n - n / 2) nodes = 2 * nodes + 1;
    nodes_.resize(nodes);
    if (leaves_.empty()) return;
    // Level by level to where there are enough nodes for all threads, then each of these to its leaves.
    struct Node {
        std::size_t node, begin, end;
    };
    std::vector<Node> level{{0, 0, leaves_.size()}};
    for (int depth = 0; depth < 6 && level.front().end - level.front().begin > 64 * kLeaf; ++depth) {
        workers.for_each(level.size(), [&](std::size_t i) { split(level[i].node, level[i].begin, level[i].end); });
        std::vector<Node> next;
        for (const auto& [node, begin, end] : level) {
            const std::size_t middle = begin + (end - begin) / 2;
            next.push_back({2 * node + 1, begin, middle});
            next.push_back({2 * node + 2, middle, end});
        }
        level = std::move(next);
    }
    workers.for_each(level.size(), [&](std::size_t i) { build(level[i].node, level[i].begin, level[i].end); });
}

void BoxTree::build(std::size_t node, std::size_t begin, std::size_t end) {
    split(node, begin, end);
    if (end - begin <= kLeaf) return;
    const std::size_t middle = begin + (end - begin) / 2;
    build(2 * node + 1, begin, middle);
    build(2 * node + 2, middle, end);
}

void BoxTree::split(std::size_t node, std::size_t begin, std::size_t end) {
    Box3& box = nodes_[node];
    box = leaves_[begin].box;
    for (std::size_t i = begin + 1; i < end; ++i) box.grow(leaves_[i].box);
    if (end - begin <= kLeaf) return;
    const Vec3 size = box.high - box.low;
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return leaves_.begin() + static_cast<std::ptrdiff_t>(i); };
    const auto key = [&](const Leaf& l) { return coordinate(l.box.low, axis) / 2 + coordinate(l.box.high, axis) / 2; };
    std::nth_element(at(begin), at(middle), at(end), [&](const Leaf& l, const Leaf& m) {
        const double a = key(l), b = key(m);
        return a != b ? a < b : l.number < m.number;
    });
}

double squared_distance(const Vec3& p, const Corners& triangle) {
    const Vec3 a = triangle[0] - p, b = triangle[1] - p, c = triangle[2] - p;
    const Vec3 n = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
    // The foot of the perpendicular from p is inside if it is on the inner side of all three edges.
    if (dot(cross(n, b - a), -a) >= 0 && dot(cross(n, c - b), -b) >= 0 && dot(cross(n, a - c), -c) >= 0) {
        const double nn = squared_norm(n);
        if (nn > 0) {
            // Measured from the nearest corner, which loses least.
            const double aa = squared_norm(a), bb = squared_norm(b), cc = squared_norm(c);
            const double height = dot(n, aa <= bb && aa <= cc ? a : bb <= cc ? b : c);
            return height * height / nn;
        }
    }
    return std::min({squared_distance_to_edge(a, b), squared_distance_to_edge(b, c), squared_distance_to_edge(c, a)});
}

TriangleTree::TriangleTree(std::vector<Corners> triangles) {
    Workers alone;
    *this = TriangleTree(std::move(triangles), alone);
}

TriangleTree::TriangleTree(std::vector<Corners> triangles, Workers& workers) : triangles_(std::move(triangles)) {
    std::vector<Box3> boxes;
    boxes.reserve(triangles_.size());
    for (const Corners& t : triangles_) {
        boxes.push_back(Box3::of(t.data(), 3));
        if (boxes.size() == 1) box_ = boxes.back();
        box_.grow(boxes.back());
    }
    tree_ = BoxTree(boxes, workers);
}

TriangleTree::Nearest TriangleTree::nearest(const Vec3& p, std::uint32_t hint) const {
    std::uint32_t best = hint < triangles_.size() ? hint : 0;
    double bound = squared_distance(p, triangles_[best]);
    tree_.nearest(p, bound, [&](std::uint32_t i, double& lowest) {
        const double d = squared_distance(p, triangles_[i]);
        if (d < lowest) lowest = d, best = i;
    });
    return {best, std::sqrt(bound)};
}

TriangleTree::Ray TriangleTree::cast(const Vec3& p, const Vec3& far) const {
    const Vec3 direction = far - p;
    bool degenerate = false, on_surface = false, odd = false;
    const auto visit = [&](std::uint32_t i) {
        const auto& [a, b, c] = triangles_[i];
        const Sign near_side = orient3d(a, b, c, p), far_side = orient3d(a, b, c, far);
        if (near_side == far_side && near_side != Sign::zero) return false;
        const std::array<Sign, 3> turns{orient3d(p, far, a, b), orient3d(p, far, b, c), orient3d(p, far, c, a)};
        bool positive = false, negative = false, zero = false;
        for (const Sign s : turns) (s == Sign::positive ? positive : s == Sign::negative ? negative : zero) = true;
        if (positive && negative) return false;  // the line misses the triangle
        if (zero || near_side == far_side) return degenerate = true;
        if (near_side == Sign::zero) return on_surface = true;
        odd = !odd;
        return false;
    };
    tree_.any_admitted([&](const Box3& box) { return may_touch(p, direction, box); }, visit);
    return on_surface ? Ray::on_surface : degenerate ? Ray::degenerate : odd ? Ray::inside : Ray::outside;
}

std::optional<bool> TriangleTree::encloses(const Vec3& p) const {
    if (triangles_.empty()) return false;
    if (!box_.meets({p, p})) return false;
    // Beyond every corner of the box: four diagonals from its centre, in directions that no input has a reason to line up with.
    const Vec3 centre = box_.low + 0.5 * (box_.high - box_.low);
    const double reach = 4 * norm(box_.high - box_.low);
    for (std::uint64_t attempt = 0; attempt < 32; ++attempt) {
        const auto draw = [&](std::uint64_t axis) { return 2 * unit_double(mix64(attempt, axis)) - 1; };
        Vec3 d{draw(0), draw(1), draw(2)};
        const double length = norm(d);
        if (length < 0.1) continue;
        const Vec3 far = centre + (reach / length) * d;
        switch (cast(p, far)) {
            case Ray::inside:
            case Ray::on_surface: return true;
            case Ray::outside: return false;
            case Ray::degenerate: break;
        }
    }
    return std::nullopt;
}

}  // namespace wellmesh::certifying
