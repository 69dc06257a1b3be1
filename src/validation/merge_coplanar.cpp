// SPDX-License-Identifier: Apache-2.0
#include "validation/merge_coplanar.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

/// Sets of triangles with their planes.
class Merger {
public:
    Merger(const CleanInput& input, const Soup& soup, const EdgeTable& edges, const Plc& plc, const Rounding& rounding)
        : input_(input), soup_(soup), edges_(edges), plc_(plc), tolerance_(rounding.merging()), sets_(soup.triangles.size()), before_tolerance_(0) {}

    FacetGroups run() {
        join_stated_and_exact();
        before_tolerance_ = sets_;
        collect_sets();
        join_within_tolerance();
        split_folded();
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
    void split_folded();
    std::vector<char> turns(const std::vector<std::uint32_t>& triangles) const;
    bool is_folded(const Set& set) const;
    std::vector<std::uint32_t> turned_out(const Set& set) const;
    FacetGroups take_groups();

    const CleanInput& input_;
    const Soup& soup_;
    const EdgeTable& edges_;
    const Plc& plc_;
    const double tolerance_;
    DisjointSets sets_, before_tolerance_;
    std::vector<std::uint32_t> peeled_;
    std::vector<std::uint32_t> set_of_triangle_;  // after folded ones were split: representatives
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

/// For each of a set's triangles, in order: must it be turned to agree with the first across the edges inside the set?
std::vector<char> Merger::turns(const std::vector<std::uint32_t>& triangles) const {
    std::unordered_map<std::uint32_t, std::uint32_t> place;
    for (std::uint32_t i = 0; i < triangles.size(); ++i) place.emplace(triangles[i], i);
    std::vector<char> turned(triangles.size(), 0), known(triangles.size(), 0);
    std::vector<std::uint32_t> stack{0};
    known[0] = 1;
    while (!stack.empty()) {
        const std::uint32_t i = stack.back(), t = triangles[i];
        stack.pop_back();
        for (std::uint32_t s = 0; s < 3; ++s) {
            const auto around = edges_.around(edges_.edge_of[3 * t + s]);
            if (around.size() != 2) continue;
            const std::uint32_t other = around[0] / 3 == t ? around[1] : around[0];
            const auto it = place.find(other / 3);
            if (it == place.end() || known[it->second]) continue;
            const bool same_direction = soup_.triangles[t].v[s] == soup_.triangles[other / 3].v[other % 3];
            turned[it->second] = turned[i] != (same_direction ? 1 : 0);
            known[it->second] = 1;
            stack.push_back(it->second);
        }
    }
    return turned;
}

/// Does a triangle that is wider than the tolerance turn the wrong way in the set's plane?
bool Merger::is_folded(const Set& set) const {
    const std::vector<char> turned = turns(set.triangles);
    double front = 0, back = 0;  // heights of the highest triangle on each side
    for (std::size_t i = 0; i < set.triangles.size(); ++i) {
        const auto& v = soup_.triangles[set.triangles[i]].v;
        const Vec3 n = cross(point(v[1]) - point(v[0]), point(v[2]) - point(v[0]));
        const double longest = std::sqrt(std::max({squared_distance(point(v[0]), point(v[1])), squared_distance(point(v[1]), point(v[2])), squared_distance(point(v[2]), point(v[0]))}));
        const double height = dot(n, set.plane.normal) / longest * (turned[i] ? -1 : 1);
        front = std::max(front, height);
        back = std::max(back, -height);
    }
    return std::min(front, back) > tolerance_;
}

/// Triangles that turn the wrong way in the set's plane because a vertex inside the set lies outside of its outline there: no facet in that plane would
/// have this vertex.
std::vector<std::uint32_t> Merger::turned_out(const Set& set) const {
    const std::vector<char> turned = turns(set.triangles);
    const auto flat = [&](VertexId v) {
        const Vec3 d = point(v) - set.plane.origin;
        return std::array<double, 2>{dot(d, set.plane.axis_u), dot(d, set.plane.axis_v)};
    };
    const auto twice_area = [](const auto& a, const auto& b, const auto& c) { return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]); };
    std::vector<double> areas;
    double sum = 0;
    for (std::size_t i = 0; i < set.triangles.size(); ++i) {
        const auto& v = soup_.triangles[set.triangles[i]].v;
        areas.push_back((turned[i] ? -1 : 1) * twice_area(flat(v[0]), flat(v[1]), flat(v[2])));
        sum += areas.back();
    }
    if (std::none_of(areas.begin(), areas.end(), [&](double a) { return a * sum <= 0; })) return {};
    std::unordered_set<std::uint32_t> members(set.triangles.begin(), set.triangles.end());
    std::vector<std::array<VertexId, 2>> outline;
    std::unordered_set<std::uint32_t> on_outline;
    for (const std::uint32_t t : set.triangles)
        for (std::uint32_t s = 0; s < 3; ++s) {
            const std::uint32_t edge = edges_.edge_of[3 * t + s];
            const auto around = edges_.around(edge);
            const auto within = static_cast<std::size_t>(std::count_if(around.begin(), around.end(), [&](std::uint32_t c) { return members.contains(c / 3); }));
            if (around.size() == 2 && within == 2) continue;
            const auto& v = soup_.triangles[t].v;
            if (within == 1) outline.push_back({v[s], v[(s + 1) % 3]});
            on_outline.insert(v[s].value());
            on_outline.insert(v[(s + 1) % 3].value());
        }
    // Is there an odd number of outline edges on the ray from the vertex along u?
    const auto is_inside = [&](const std::array<double, 2>& p) {
        bool inside = false;
        for (const auto& e : outline) {
            const auto a = flat(e[0]), b = flat(e[1]);
            if ((a[1] > p[1]) != (b[1] > p[1])) inside = inside != ((twice_area(a, b, p) > 0) == (b[1] > a[1]));
        }
        return inside;
    };
    std::vector<std::uint32_t> out;
    for (std::size_t i = 0; i < set.triangles.size(); ++i) {
        const auto& v = soup_.triangles[set.triangles[i]].v;
        if (areas[i] * sum <= 0 && std::any_of(v.begin(), v.end(), [&](VertexId w) { return !on_outline.contains(w.value()) && !is_inside(flat(w)); }))
            out.push_back(set.triangles[i]);
    }
    return out;
}

void Merger::split_folded() {
    constexpr auto kNone = static_cast<std::uint32_t>(-1);
    set_of_triangle_.resize(soup_.triangles.size());
    enum class Fate : std::uint8_t { stays, splits, peels };
    std::vector<Fate> fate(soup_.triangles.size(), Fate::stays);  // of sets, at representatives
    std::vector<char> peeled(soup_.triangles.size(), 0);
    std::vector<std::uint32_t> rest(soup_.triangles.size(), kNone);  // representative of what stays of a set
    for (std::uint32_t t = 0; t < soup_.triangles.size(); ++t) {
        const std::uint32_t r = sets_.find(t);
        if (r == t) {
            if (is_folded(set_of_[r])) fate[r] = Fate::splits;
            else
                for (const std::uint32_t out : turned_out(set_of_[r])) {
                    fate[r] = Fate::peels;
                    peeled[out] = 1;
                    peeled_.push_back(out);
                }
        }
        if (!peeled[t] && rest[r] == kNone) rest[r] = t;  // r <= t
        set_of_triangle_[t] = fate[r] == Fate::splits ? before_tolerance_.find(t) : peeled[t] ? t : rest[r];
    }
    std::vector<Set> rebuilt(soup_.triangles.size());
    for (std::uint32_t t = 0; t < soup_.triangles.size(); ++t)
        if (fate[sets_.find(t)] != Fate::stays) {
            Set& set = rebuilt[set_of_triangle_[t]];
            set.triangles.push_back(t);
            set.vertices.insert(set.vertices.end(), soup_.triangles[t].v.begin(), soup_.triangles[t].v.end());
        }
    for (std::uint32_t t = 0; t < soup_.triangles.size(); ++t)
        if (!rebuilt[t].triangles.empty()) {
            set_of_[t] = std::move(rebuilt[t]);
            set_of_[t].plane = fit(set_of_[t].vertices);
        }
}

FacetGroups Merger::take_groups() {
    FacetGroups groups;
    groups.peeled = peeled_;
    groups.group_of.resize(soup_.triangles.size());
    groups.is_turned.resize(soup_.triangles.size());
    for (std::uint32_t t = 0; t < soup_.triangles.size(); ++t) {
        const std::uint32_t r = set_of_triangle_[t];
        if (r != t) {
            groups.group_of[t] = groups.group_of[r];  // r < t
            continue;
        }
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
        // the first triangle's turn decides which side is the front, the area vector of all of them where that is
        const std::vector<char> turned = turns(set.triangles);
        Vec3 front{};
        for (std::size_t i = 0; i < set.triangles.size(); ++i) {
            const auto& v = soup_.triangles[set.triangles[i]].v;
            front = front + (turned[i] ? -1.0 : 1.0) * cross(point(v[1]) - point(v[0]), point(v[2]) - point(v[0]));
            groups.is_turned[set.triangles[i]] = turned[i];
        }
        if (dot(plane.normal, front) < 0) plane.flip();
        groups.group_of[t] = static_cast<std::uint32_t>(groups.planes.size());
        groups.planes.push_back(plane);
        groups.triangles.push_back(std::move(set.triangles));
        groups.vertices.push_back(std::move(set.vertices));
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
