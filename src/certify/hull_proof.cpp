// SPDX-License-Identifier: Apache-2.0
#include "certify/hull_proof.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <numeric>
#include <utility>

namespace wellmesh::certifying {
namespace {

/// Vertices on the equatorial sphere of a hull face that are followed up, on average over a range of faces; a square has one, and a disc full of
/// triangles whose corners are all on its rim would take for ever.
constexpr std::size_t kTiesPerFace = 4;

/// Hull faces whose spheres are looked at together.
constexpr std::size_t kFaces = 16;

std::uint32_t root(std::vector<std::uint32_t>& parents, std::uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
}

}  // namespace

bool meet_properly(const SuspectMesh& mesh, const Tet& a, const Tet& b) {
    // Corners by bits: those that may still span a common point. A plane that has those of one triangle on one side and those of the other on the
    // other side, or on itself, leaves those on itself.
    unsigned left_a = 7, left_b = 7, shared_a = 0, shared_b = 0;
    for (unsigned i = 0; i < 3; ++i)
        for (unsigned k = 0; k < 3; ++k)
            if (a[i] == b[k]) shared_a |= 1U << i, shared_b |= 1U << k;
    const auto proper = [&] { return (left_a & ~shared_a) == 0 || (left_b & ~shared_b) == 0; };
    const auto reduce = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
        std::array<unsigned, 3> of_a{}, of_b{};  // negative, zero, positive
        const auto look = [&](const Tet& corners, unsigned left, std::array<unsigned, 3>& sides) {
            for (unsigned i = 0; i < 3; ++i) {
                if ((left >> i & 1) == 0) continue;
                const std::uint32_t v = corners[i];
                const bool on_plane = v == p || v == q || v == r;
                const Sign s = on_plane ? Sign::zero : mesh.predicates().orient3d(mesh.point(p), mesh.point(q), mesh.point(r), mesh.point(v));
                sides[s == Sign::negative ? 0 : s == Sign::zero ? 1 : 2] |= 1U << i;
            }
        };
        look(a, left_a, of_a);
        look(b, left_b, of_b);
        if ((of_a[0] == 0 && of_b[2] == 0) || (of_a[2] == 0 && of_b[0] == 0)) left_a = of_a[1], left_b = of_b[1];
        return proper();
    };
    std::array<std::uint32_t, 6> corners{a[0], a[1], a[2], b[0], b[1], b[2]};
    std::sort(corners.begin(), corners.end());
    const auto end = std::unique(corners.begin(), corners.end());
    if (proper()) return true;
    // Planes across the triangles first: often these lie in one plane.
    for (bool again = true; again;) {
        const unsigned before_a = left_a, before_b = left_b;
        for (auto p = corners.begin(); p != end; ++p)
            for (auto q = p + 1; q != end; ++q) {
                for (const std::uint32_t r : {a[3], b[3]})
                    if (*p != r && *q != r && reduce(*p, *q, r)) return true;
                for (auto r = q + 1; r != end && left_a == before_a && left_b == before_b; ++r)
                    if (reduce(*p, *q, *r)) return true;
            }
        again = left_a != before_a || left_b != before_b;
    }
    return false;
}

HullProof::HullProof(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, bool faces_in_order)
    : mesh_(mesh), triangles_(triangles) {
    if (!faces_in_order) return;
    list_vertices();
    search_.emplace(points_, weights_, mesh_.workers());
    const std::optional<std::vector<Tie>> ties = look_at_spheres();
    if (!ties) return;
    list_faces_at_vertices();
    std::atomic<bool> improper = false;
    mesh_.workers().for_ranges(ties->size(), kSmallGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end && !improper; ++i)
            if (!meet_properly((*ties)[i])) improper = true;
    });
    if (improper) return;
    embedded_ = true;
    components_ = find_components();
}

void HullProof::list_vertices() {
    std::vector<std::uint32_t> places(mesh_.vertex_count(), 0);
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
        if (!triangles_[i].on_hull) continue;
        faces_.push_back(i);
        for (const std::uint32_t v : triangles_[i].v) places[v] = 1;
    }
    for (std::uint32_t v = 0; v < places.size(); ++v) {
        if (places[v] == 0) continue;
        places[v] = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back(v);
        points_.push_back(mesh_.point(v));
        if (mesh_.is_weighted()) weights_.push_back(mesh_.weights()[v]);
    }
    corners_.reserve(faces_.size());
    for (const std::uint32_t i : faces_) {
        const Triangle& v = triangles_[i].v;
        corners_.push_back({places[v[0]], places[v[1]], places[v[2]]});
    }
}

std::optional<std::vector<HullProof::Tie>> HullProof::look_at_spheres() {
    const bool weighted = mesh_.is_weighted();
    struct Part {
        std::vector<Tie> ties;
        bool spheres_are_empty = true, apexes_are_outside = true, many_ties = false;
    };
    const auto side = [&](const Triangle& t, std::uint32_t q) {
        return weighted ? equatorial_power_test(mesh_.weighted(t[0]), mesh_.weighted(t[1]), mesh_.weighted(t[2]), mesh_.weighted(q))
                        : side_of_equatorial_sphere(mesh_.point(t[0]), mesh_.point(t[1]), mesh_.point(t[2]), mesh_.point(q));
    };
    const auto apexes_are_outside = [&](const ConstraintTriangle& t) {
        return std::all_of(t.tets.begin(), t.tets.end(), [&](std::uint32_t tet) {
            return tet == kNone || side(t.v, apex(mesh_.mesh().tets[tet], t.v)) != Sign::positive;
        });
    };
    std::vector<Part> parts((faces_.size() + kSmallGrain - 1) / kSmallGrain);
    mesh_.workers().for_ranges(faces_.size(), kSmallGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        Part& part = parts[piece];
        const auto look = [&](std::size_t i, auto&& any_in) {
            const ConstraintTriangle& t = triangles_[faces_[i]];
            const Triangle& corners = corners_[i];
            part.apexes_are_outside = part.apexes_are_outside && apexes_are_outside(t);
            part.spheres_are_empty = part.spheres_are_empty && !any_in([&](std::uint32_t q) {
                if (q == corners[0] || q == corners[1] || q == corners[2]) return false;
                const Sign s = side(t.v, vertices_[q]);
                if (s == Sign::zero && !part.many_ties) part.ties.push_back({static_cast<std::uint32_t>(i), q});
                part.many_ties = part.ties.size() > kTiesPerFace * kSmallGrain;
                return s == Sign::positive;
            });
        };
        // Faces next to each other in the list are mostly neighbours.
        std::vector<Ball> balls;
        BallSearch::Neighbourhood near;
        for (std::size_t first = begin; first < end && part.spheres_are_empty; first += kFaces) {
            const std::size_t last = std::min(end, first + kFaces);
            balls.clear();
            for (std::size_t i = first; i < last; ++i) {
                const Triangle& v = triangles_[faces_[i]].v;
                balls.push_back(search_->equatorial_ball(mesh_.weighted(v[0]), mesh_.weighted(v[1]), mesh_.weighted(v[2])));
            }
            const bool together = search_->list_near(balls, near);
            for (std::size_t i = first; i < last; ++i)
                look(i, [&](auto&& visit) { return together ? near.any_in(balls[i - first], visit) : search_->any_in(balls[i - first], visit); });
        }
    });
    const bool empty = std::all_of(parts.begin(), parts.end(), [](const Part& p) { return p.spheres_are_empty; });
    if (!empty) return std::nullopt;
    hull_is_clear_ = std::all_of(parts.begin(), parts.end(), [](const Part& p) { return p.apexes_are_outside; });
    std::atomic<bool> clear = true;
    mesh_.workers().for_ranges(triangles_.size(), kSmallGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end && clear; ++i)
            if (const ConstraintTriangle& t = triangles_[i]; !t.on_hull && !(t.is_face && apexes_are_outside(t))) clear = false;
    });
    interfaces_are_clear_ = clear;
    if (std::any_of(parts.begin(), parts.end(), [](const Part& p) { return p.many_ties; })) return std::nullopt;
    std::vector<Tie> ties;
    for (const Part& part : parts) ties.insert(ties.end(), part.ties.begin(), part.ties.end());
    return ties;
}

void HullProof::list_faces_at_vertices() {
    // Counted two places ahead so that, after filling, first_[v] .. first_[v + 1] is what v has.
    first_.assign(vertices_.size() + 2, 0);
    for (const Triangle& t : corners_)
        for (const std::uint32_t v : t) ++first_[std::size_t{v} + 2];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    at_vertex_.resize(first_.back());
    for (std::uint32_t i = 0; i < corners_.size(); ++i)
        for (const std::uint32_t v : corners_[i]) at_vertex_[first_[std::size_t{v} + 1]++] = i;
}

bool HullProof::meet_properly(const Tie& tie) const {
    const auto with_apex = [&](std::uint32_t face) {
        const ConstraintTriangle& t = triangles_[faces_[face]];
        return Tet{t.v[0], t.v[1], t.v[2], apex(mesh_.mesh().tets[t.tets[t.tets[0] == kNone ? 1 : 0]], t.v)};
    };
    const Tet face = with_apex(tie.face);
    const auto begin = at_vertex_.begin() + first_[tie.vertex], end = at_vertex_.begin() + first_[std::size_t{tie.vertex} + 1];
    return std::all_of(begin, end, [&](std::uint32_t other) { return certifying::meet_properly(mesh_, face, with_apex(other)); });
}

std::vector<std::uint32_t> HullProof::find_components() const {
    std::vector<std::uint32_t> parents(faces_.size());
    std::iota(parents.begin(), parents.end(), 0U);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;  // from one vertex: the upper end and the face
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
        edges.clear();
        for (std::uint32_t i = first_[v]; i < first_[std::size_t{v} + 1]; ++i)
            for (const std::uint32_t w : corners_[at_vertex_[i]])
                if (w > v) edges.emplace_back(w, at_vertex_[i]);
        std::sort(edges.begin(), edges.end());
        for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
            while (j < edges.size() && edges[j].first == edges[i].first) ++j;
            if (j - i == 2) parents[root(parents, edges[i].second)] = root(parents, edges[i + 1].second);
        }
    }
    std::vector<std::uint32_t> components;
    for (std::uint32_t i = 0; i < faces_.size(); ++i)
        if (parents[i] == i) components.push_back(faces_[i]);
    return components;
}

bool HullProof::segments_are_clear(const TetsByCorner& stars, const std::vector<ConstraintSegment>& segments) const {
    const bool weighted = mesh_.is_weighted();
    std::atomic<bool> clear = true;
    const auto on_hull = [&](std::uint32_t v) { return std::binary_search(vertices_.begin(), vertices_.end(), v); };
    mesh_.workers().for_ranges(segments.size(), kSmallGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end && clear; ++i) {
            const auto [a, b] = segments[i].v;
            const auto inside = [&, a = a, b = b](std::uint32_t q) {
                if (q == a || q == b) return false;
                return (weighted ? diametral_power_test(mesh_.weighted(a), mesh_.weighted(b), mesh_.weighted(q))
                                 : side_of_diametral_sphere(mesh_.point(a), mesh_.point(b), mesh_.point(q))) == Sign::positive;
            };
            bool is_edge = false, intruded = false;
            for (const std::uint32_t t : stars.of(a)) {
                const Tet& tet = mesh_.mesh().tets[t];
                if (a == b || std::find(tet.begin(), tet.end(), b) == tet.end()) continue;
                is_edge = true;
                intruded = intruded || std::any_of(tet.begin(), tet.end(), inside);
            }
            if (is_edge && !intruded && on_hull(a) && on_hull(b)) {
                const Ball ball = search_->diametral_ball(mesh_.weighted(a), mesh_.weighted(b));
                intruded = search_->any_in(ball, [&](std::uint32_t q) { return inside(vertices_[q]); });
            }
            if (!is_edge || intruded) clear = false;
        }
    });
    return clear;
}

}  // namespace wellmesh::certifying
