// SPDX-License-Identifier: Apache-2.0
#include "repair/taper_edges.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <limits>

#include "core/vec3_math.hpp"
#include "validation/working_complex.hpp"

namespace wellmesh {
namespace {

using Vertex = std::uint32_t;
using Polygon = std::vector<Vertex>;

constexpr double kReach = 2;       // of a taper, over the length of the edge: facets meet at an angle of arctan(1/2) there
constexpr double kLeastUlps = 1024;  // of the edge: new vertices are off the edges that they are on by an ulp

class Taper {
public:
    explicit Taper(JoinedPlc& joined) : joined_(joined), plc_(joined.plc) {}

    bool run() {
        if (!find_clusters()) return false;
        if (reach_.empty()) return true;
        const auto facets = static_cast<std::uint32_t>(plc_.facets.size());
        std::vector<char> changed(facets, 0);
        for (std::uint32_t f = 0; f < facets; ++f)
            for (Polygon& polygon : plc_.facets[f].polygons) changed[f] = cut_corners(f, polygon) || changed[f];
        cut_segments();
        for (std::uint32_t f = 0; f < facets && !blocked_; ++f) lead_through_cuts(plc_.facets[f], changed[f]);
        return !blocked_;
    }

private:
    [[nodiscard]] Vertex root(Vertex v) const { return root_[v]; }
    [[nodiscard]] const Vec3& point(Vertex v) const { return plc_.vertices[v]; }
    bool find_clusters();
    void note_edges(DisjointSets& sets) const;
    Vertex cut(Vertex v, Vertex towards);
    bool cut_corners(std::uint32_t f, Polygon& polygon);
    void add_fan(std::uint32_t f, const Polygon& piece, std::size_t apex);
    Polygon chain(Vertex a, Vertex b);
    void cut_segments();
    void append_cuts(Vertex a, Vertex b, Polygon& out) const;
    void lead_through_cuts(PlcFacet& facet, bool changed);

    JoinedPlc& joined_;
    Plc& plc_;
    std::vector<Vertex> root_;
    std::map<Vertex, double> reach_;                      // of the clusters that are tapered, by their roots
    std::map<std::pair<Vertex, Vertex>, Vertex> cuts_;    // on the edge from .first, a root, to .second
    std::map<Vertex, std::pair<Vertex, Vertex>> edge_of_; // of each cut
    bool blocked_ = false;
};

void Taper::note_edges(DisjointSets& sets) const {
    const double most = joined_.statistics.tolerance;
    const auto add = [&](Vertex a, Vertex b) {
        if (a != b && distance(point(a), point(b)) <= most) sets.unite(a, b);
    };
    for (const PlcFacet& f : plc_.facets)
        for (const Polygon& p : f.polygons)
            for (std::size_t i = 0; i < p.size(); ++i) add(p[i], p[(i + 1) % p.size()]);
    for (const PlcSegment& s : plc_.segments) add(s.vertices[0], s.vertices[1]);
}

bool Taper::find_clusters() {
    const auto n = static_cast<Vertex>(plc_.vertices.size());
    DisjointSets sets(n);
    note_edges(sets);
    double largest = 0;
    for (const Vec3& p : plc_.vertices) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    const double least = kLeastUlps * std::numeric_limits<double>::epsilon() * largest;
    std::set<Vertex> too_short;
    for (Vertex v = 0; v < n; ++v) {
        root_.push_back(sets.find(v));
        if (root(v) == v) continue;
        const double apart = distance(point(v), point(root(v)));
        if (apart > joined_.statistics.tolerance) return false;
        if (apart < least) too_short.insert(root(v));
        double& reach = reach_[root(v)];
        reach = std::max(reach, kReach * apart);
    }
    for (const Vertex r : too_short) reach_.erase(r);
    for (Vertex v = 0; v < n; ++v) {
        if (!reach_.contains(root(v))) root_[v] = v;
        if (root(v) == v) continue;
        const double apart = distance(point(v), point(root(v)));
        const auto ref = [&](Vertex i) { return ElementRef{EntityKind::vertex, std::uint64_t{joined_.source.vertex[i]} + plc_.first_number, point(i)}; };
        joined_.statistics.joined.push_back({ref(v), ref(root(v)), apart});
        joined_.statistics.largest_move = std::max(joined_.statistics.largest_move, apart);
    }
    return true;
}

/// The vertex at which what comes from `towards` to the cluster of the root v parts into its facets.
Vertex Taper::cut(Vertex v, Vertex towards) {
    const auto [known, fresh] = cuts_.try_emplace({v, towards}, static_cast<Vertex>(plc_.vertices.size()));
    if (!fresh) return known->second;
    const Vec3 a = point(v), along = point(towards) - a;
    const double length = norm(along), reach = reach_.at(v);
    const auto other = reach_.find(towards);
    blocked_ = blocked_ || !(length > 1.5 * (reach + (other == reach_.end() ? reach : other->second)));
    edge_of_[known->second] = {v, towards};
    plc_.vertices.push_back(a + (reach / length) * along);
    root_.push_back(known->second);
    joined_.source.vertex.push_back(joined_.source.vertex[v]);
    if (!plc_.vertex_markers.empty()) plc_.vertex_markers.push_back(0);
    if (!plc_.vertex_sizes.empty()) plc_.vertex_sizes.push_back(plc_.vertex_sizes[v]);
    return known->second;
}

void Taper::add_fan(std::uint32_t f, const Polygon& piece, std::size_t apex) {
    const std::size_t n = piece.size();
    for (std::size_t i = 1; i + 1 < n; ++i) {
        const Vertex a = piece[apex], b = piece[(apex + i) % n], c = piece[(apex + i + 1) % n];
        if (a == b || b == c || c == a) continue;
        PlcFacet facet;
        facet.polygons = {{a, b, c}};
        facet.marker = plc_.facets[f].marker;
        plc_.facets.push_back(std::move(facet));
        joined_.source.facet.push_back(joined_.source.facet[f]);
    }
}

/// True if the polygon changed. Runs of neighbours in one cluster are replaced by its root, or by the cuts before and after it.
bool Taper::cut_corners(std::uint32_t f, Polygon& polygon) {
    const std::size_t n = polygon.size();
    if (n < 3) return false;
    std::size_t start = 0;
    while (start < n && root(polygon[start]) == root(polygon[(start + n - 1) % n])) ++start;
    if (start == n) return false;  // within one cluster
    Polygon rest, corners;
    bool changed = false;
    for (std::size_t i = 0; i < n;) {
        const auto at = [&](std::size_t k) { return polygon[(start + k + n) % n]; };
        const Vertex r = root(at(i));
        Polygon run;
        const Vertex before = root(at(i + n - 1));
        while (i < n && root(at(i)) == r) run.push_back(at(i++));
        corners.push_back(r);
        if (run.size() == 1 && run[0] == r) {
            rest.push_back(r);
            continue;
        }
        changed = true;
        const Vertex in = cut(r, before), out = cut(r, root(at(i)));
        const auto own = std::find(run.begin(), run.end(), r);
        if (own == run.end()) {
            Polygon piece{in};
            piece.insert(piece.end(), run.begin(), run.end());
            if (out != in) piece.push_back(out);
            add_fan(f, piece, 0);
            rest.push_back(in);
            rest.push_back(out);
            continue;
        }
        Polygon first{in}, second(own, run.end());
        first.insert(first.end(), run.begin(), own + 1);
        second.push_back(out);
        add_fan(f, first, first.size() - 1);
        add_fan(f, second, 0);
        rest.push_back(r);
    }
    if (!changed) return false;
    drop_spurs(corners);
    polygon = corners.size() < 3 ? Polygon{} : std::move(rest);
    return true;
}

/// The way from a to b.
Polygon Taper::chain(Vertex a, Vertex b) {
    Polygon out{a};
    if (root(a) != root(b)) {
        if (root(a) != a) out.push_back(cut(root(a), root(b)));
        if (root(b) != b) out.push_back(cut(root(b), root(a)));
    }
    out.push_back(b);
    return out;
}

void Taper::cut_segments() {
    std::vector<PlcSegment> pieces;
    for (const PlcSegment& s : plc_.segments) {
        const Polygon stops = chain(s.vertices[0], s.vertices[1]);
        for (std::size_t i = 0; i + 1 < stops.size(); ++i) pieces.push_back({{stops[i], stops[i + 1]}, s.marker});
    }
    plc_.segments = std::move(pieces);
    for (PlcFacet& f : plc_.facets)
        for (std::size_t p = 0; p < f.polygons.size(); ++p) {
            if (f.polygons[p].size() != 2) continue;
            const Polygon stops = chain(f.polygons[p][0], f.polygons[p][1]);
            f.polygons[p] = {stops[0], stops[1]};
            for (std::size_t i = 1; i + 1 < stops.size(); ++i) f.polygons.push_back({stops[i], stops[i + 1]});
        }
}

/// The cuts strictly between two neighbours of a polygon.
void Taper::append_cuts(Vertex a, Vertex b, Polygon& out) const {
    const auto edge_a = edge_of_.find(a), edge_b = edge_of_.find(b);
    const Vertex from = edge_a == edge_of_.end() ? a : edge_a->second.first, to = edge_b == edge_of_.end() ? b : edge_b->second.first;
    if (from == to) return;
    for (const auto& edge : {std::pair{from, to}, std::pair{to, from}})
        if (const auto found = cuts_.find(edge); found != cuts_.end() && found->second != a && found->second != b) out.push_back(found->second);
}

void Taper::lead_through_cuts(PlcFacet& facet, bool changed) {
    std::vector<Polygon> kept;
    for (const Polygon& polygon : facet.polygons) {
        Polygon longer;
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            longer.push_back(polygon[i]);
            if (polygon.size() >= 3) append_cuts(polygon[i], polygon[(i + 1) % polygon.size()], longer);
        }
        if (changed) drop_spurs(longer);
        if (!longer.empty()) kept.push_back(std::move(longer));
    }
    facet.polygons = std::move(kept);
}

}  // namespace

void drop_spurs(std::vector<std::uint32_t>& polygon) {
    for (std::size_t i = 0; i < polygon.size() && polygon.size() > 1;) {
        const std::size_t n = polygon.size();
        const bool again = polygon[i] == polygon[(i + 1) % n], back = n > 2 && polygon[i] == polygon[(i + 2) % n];
        if (!again && !back) {
            ++i;
            continue;
        }
        polygon.erase(polygon.begin() + static_cast<std::ptrdiff_t>((i + 1) % n));
        i = 0;
    }
}

bool taper_short_edges(JoinedPlc& joined) { return Taper(joined).run(); }

}  // namespace wellmesh
