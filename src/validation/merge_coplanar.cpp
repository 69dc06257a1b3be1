// SPDX-License-Identifier: Apache-2.0
#include "validation/merge_coplanar.hpp"

#include <algorithm>
#include <cmath>

#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

/// Sets of triangles with their planes.
class Merger {
public:
    Merger(const CleanInput& input, const Soup& soup, const EdgeTable& edges, const Plc& plc, const Rounding& rounding)
        : input_(input), soup_(soup), edges_(edges), plc_(plc), tolerance_(rounding.merging()), sets_(soup.triangles.size()) {}

    FacetGroups run() {
        join_stated_and_exact();
        collect_sets();
        join_within_tolerance();
        return take_groups();
    }

private:
    struct Candidate {
        std::uint32_t edge = 0;
        double height = 0;  ///< of the lower of the two triangles over the edge
    };
    struct Set {
        std::vector<std::uint32_t> triangles;
        std::vector<VertexId> vertices;  // a vertex may come several times: it only weighs more in the fit
        FittedPlane plane;
        std::size_t fitted_size = 0;
    };

    [[nodiscard]] const Vec3& point(VertexId v) const { return input_.points[v.index()]; }
    [[nodiscard]] VertexId apex(std::uint32_t corner) const { return soup_.triangles[corner / 3].v[(corner % 3 + 2) % 3]; }
    [[nodiscard]] std::int32_t marker(std::uint32_t triangle) const { return plc_.facets[input_.facets[soup_.triangles[triangle].facet].source].marker; }
    void join_stated_and_exact();
    void consider(std::uint32_t edge);
    void collect_sets();
    void join_within_tolerance();
    bool try_join(std::uint32_t a, std::uint32_t b);
    bool four_points_fit(std::uint32_t edge) const;
    FittedPlane fit(const std::vector<VertexId>& vertices) const;
    FacetGroups take_groups();

    const CleanInput& input_;
    const Soup& soup_;
    const EdgeTable& edges_;
    const Plc& plc_;
    const double tolerance_;
    DisjointSets sets_;
    std::vector<Candidate> candidates_;
    std::vector<Set> set_of_;  // at representatives
};

struct Fold {
    bool folded = false;
    double height = 0;
};

/// Do apexes c and d lie on the same side of the edge ab, seen within their own planes? Heights below `tolerance` have no side.
Fold fold_over(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, double tolerance) {
    const Vec3 u = b - a;
    const double length2 = squared_norm(u);
    const auto offset = [&](const Vec3& p) { return (p - a) - (dot(p - a, u) / length2) * u; };
    const Vec3 h = offset(c), k = offset(d);
    const double height = std::min(norm(h), norm(k));
    return {dot(h, k) > 0 && height > tolerance, height};
}

void Merger::consider(std::uint32_t edge) {
    const auto around = edges_.around(edge);
    if (around.size() != 2 || soup_.hard_edges.contains(edges_.keys[edge])) return;
    const std::uint32_t s = around[0] / 3, t = around[1] / 3;
    if (soup_.triangles[s].facet == soup_.triangles[t].facet) {
        sets_.unite(s, t);
        return;
    }
    if (marker(s) != marker(t)) return;
    const auto ends = edge_ends(edges_.keys[edge]);
    const Vec3 &a = point(ends[0]), &b = point(ends[1]), &c = point(apex(around[0])), &d = point(apex(around[1]));
    const Fold fold = fold_over(a, b, c, d, tolerance_);
    if (orient3d(a, b, c, d) == Sign::zero) {
        // exactly on opposite sides of the edge in some exact projection; the other triangle is not degenerate, so one exists
        const Vec3 n = cross(b - a, c - a);
        const PlaneProjection p(n);
        const Sign left = orient2d(p(a), p(b), p(c)), right = orient2d(p(a), p(b), p(d));
        if (left != Sign::zero && right == -left) {
            sets_.unite(s, t);
            return;
        }
    }
    if (!fold.folded) candidates_.push_back({edge, fold.height});
}

void Merger::join_stated_and_exact() {
    for (std::uint32_t e = 0; e < edges_.keys.size(); ++e) consider(e);
}

FittedPlane Merger::fit(const std::vector<VertexId>& vertices) const {
    std::vector<Vec3> points;
    points.reserve(vertices.size());
    for (const VertexId v : vertices) points.push_back(point(v));
    return fit_plane(points);
}

void Merger::collect_sets() {
    set_of_.resize(soup_.triangles.size());
    for (std::uint32_t t = 0; t < soup_.triangles.size(); ++t) set_of_[sets_.find(t)].triangles.push_back(t);
    for (Set& set : set_of_) {
        for (const std::uint32_t t : set.triangles) set.vertices.insert(set.vertices.end(), soup_.triangles[t].v.begin(), soup_.triangles[t].v.end());
        std::sort(set.vertices.begin(), set.vertices.end());
        set.vertices.erase(std::unique(set.vertices.begin(), set.vertices.end()), set.vertices.end());
        if (!set.vertices.empty()) set.plane = fit(set.vertices);
        set.fitted_size = set.vertices.size();
    }
}

/// Necessary for any join across the edge, and cheap: curved surfaces fail here.
bool Merger::four_points_fit(std::uint32_t edge) const {
    const auto around = edges_.around(edge);
    const auto ends = edge_ends(edges_.keys[edge]);
    const std::array<Vec3, 4> points{point(ends[0]), point(ends[1]), point(apex(around[0])), point(apex(around[1]))};
    return fit_plane(points).residual <= tolerance_;
}

void Merger::join_within_tolerance() {
    std::erase_if(candidates_, [&](const Candidate& c) { return !four_points_fit(c.edge); });
    // wide triangles first: they know their plane; needles, which do not, then join what is there
    std::stable_sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) { return a.height > b.height; });
    constexpr int kPasses = 3;  // a join that failed early can succeed when needles at its edge have found their plane
    for (int pass = 0; pass < kPasses; ++pass) {
        bool changed = false;
        for (const Candidate& c : candidates_) {
            const auto around = edges_.around(c.edge);
            changed |= try_join(around[0] / 3, around[1] / 3);
        }
        if (!changed) break;
    }
}

bool Merger::try_join(std::uint32_t a, std::uint32_t b) {
    a = sets_.find(a);
    b = sets_.find(b);
    if (a == b) return false;
    if (set_of_[a].vertices.size() < set_of_[b].vertices.size()) std::swap(a, b);
    Set &large = set_of_[a], &small = set_of_[b];
    bool close = large.plane.residual <= tolerance_;
    for (const VertexId v : small.vertices) {
        const double off = std::abs(large.plane.distance_of(point(v)));
        close = close && off <= tolerance_;
        // planes that stay within the tolerance of the large set differ by its tilt, tolerance / width, and by a shift
        const double reach = distance(point(v), large.plane.origin);
        if (off * large.plane.width > 4 * tolerance_ * (large.plane.width + reach)) return false;
    }
    if (!close || large.vertices.size() + small.vertices.size() >= 2 * large.fitted_size) {
        std::vector<VertexId> all = large.vertices;
        all.insert(all.end(), small.vertices.begin(), small.vertices.end());
        const FittedPlane plane = fit(all);
        if (plane.residual <= tolerance_) {
            large.plane = plane;
            large.fitted_size = all.size();
        } else if (!close) {
            return false;
        }
    }
    large.vertices.insert(large.vertices.end(), small.vertices.begin(), small.vertices.end());
    large.triangles.insert(large.triangles.end(), small.triangles.begin(), small.triangles.end());
    sets_.unite(a, b);
    if (sets_.find(a) != a) std::swap(set_of_[a], set_of_[b]);
    set_of_[sets_.find(a) == a ? b : a] = {};
    return true;
}

FacetGroups Merger::take_groups() {
    FacetGroups groups;
    groups.group_of.resize(soup_.triangles.size());
    for (std::uint32_t t = 0; t < soup_.triangles.size(); ++t) {
        const std::uint32_t r = sets_.find(t);
        if (r == t) {
            Set& set = set_of_[t];
            std::sort(set.triangles.begin(), set.triangles.end());
            std::sort(set.vertices.begin(), set.vertices.end());
            set.vertices.erase(std::unique(set.vertices.begin(), set.vertices.end()), set.vertices.end());
            FittedPlane plane = fit(set.vertices);
            if (plane.residual > tolerance_ && set.plane.residual <= tolerance_) {
                plane = set.plane;
                plane.residual = 0;
                for (const VertexId v : set.vertices) plane.residual = std::max(plane.residual, std::abs(plane.distance_of(point(v))));
            }
            const auto& v = soup_.triangles[t].v;
            Vec3 front = cross(point(v[1]) - point(v[0]), point(v[2]) - point(v[0]));
            for (const std::uint32_t s : set.triangles) {  // the widest triangle knows best, the first one's turn decides
                if (soup_.triangles[s].facet != soup_.triangles[t].facet) break;
                const auto& w = soup_.triangles[s].v;
                const Vec3 n = cross(point(w[1]) - point(w[0]), point(w[2]) - point(w[0]));
                if (squared_norm(n) > squared_norm(front)) front = n;
            }
            if (dot(plane.normal, front) < 0) plane.flip();
            groups.group_of[t] = static_cast<std::uint32_t>(groups.planes.size());
            groups.planes.push_back(plane);
            groups.triangles.push_back(std::move(set.triangles));
            groups.vertices.push_back(std::move(set.vertices));
        } else {
            groups.group_of[t] = groups.group_of[r];  // r < t
        }
    }
    groups.is_segment.resize(edges_.keys.size());
    for (std::size_t e = 0; e < edges_.keys.size(); ++e) {
        const auto around = edges_.around(e);
        groups.is_segment[e] = around.size() != 2 || groups.group_of[around[0] / 3] != groups.group_of[around[1] / 3] ||
                               soup_.hard_edges.contains(edges_.keys[e]);
    }
    return groups;
}

}  // namespace

FacetGroups merge_coplanar(const CleanInput& input, const Soup& soup, const EdgeTable& edges, const Plc& plc, const Rounding& rounding) {
    return Merger(input, soup, edges, plc, rounding).run();
}

}  // namespace wellmesh
