// SPDX-License-Identifier: Apache-2.0
#include "certify/mesh_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

struct EdgeWithOpposite {
    Edge v{};
    std::uint32_t opposite = 0;
};

Edge sorted(Edge e) {
    if (e[0] > e[1]) std::swap(e[0], e[1]);
    return e;
}

/// See find_constraint_segments. The bend is measured by rounded arithmetic: it is a tolerance, not a predicate.
bool flat_together(const SuspectMesh& mesh, const Edge& e, std::uint32_t o0, std::uint32_t o1, double flat_angle) {
    const Vec3 &p = mesh.point(e[0]), along = mesh.point(e[1]) - p;
    const Vec3 n0 = cross(along, mesh.point(o0) - p), n1 = cross(mesh.point(o1) - p, along);
    const double height = std::sqrt(std::min(squared_norm(n0), squared_norm(n1))) / norm(along);
    const double rounding = 32 * std::numeric_limits<double>::epsilon() * mesh.largest_coordinate() / height;
    return std::atan2(norm(cross(n0, n1)), dot(n0, n1)) < std::max(flat_angle, rounding);
}

}  // namespace

std::vector<ConstraintSegment> find_constraint_segments(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, double flat_angle) {
    // Sorted into their lower ends' places, then each of those by itself.
    std::vector<std::uint32_t> first(mesh.vertex_count() + 2, 0);
    const auto for_edges = [&](auto&& visit) {
        for (const ConstraintTriangle& t : triangles)
            for (std::size_t i = 0; i < 3; ++i) visit(EdgeWithOpposite{sorted(Edge{t.v[i], t.v[(i + 1) % 3]}), t.v[(i + 2) % 3]});
    };
    for_edges([&](const EdgeWithOpposite& e) { ++first[std::size_t{e.v[0]} + 2]; });
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<EdgeWithOpposite> edges(3 * triangles.size());
    for_edges([&](const EdgeWithOpposite& e) { edges[first[std::size_t{e.v[0]} + 1]++] = e; });
    for (std::size_t v = 0; v + 2 < first.size(); ++v)
        std::sort(edges.begin() + first[v], edges.begin() + first[v + 1], [](const EdgeWithOpposite& a, const EdgeWithOpposite& b) {
            return a.v[1] != b.v[1] ? a.v[1] < b.v[1] : a.opposite < b.opposite;
        });
    std::vector<ConstraintSegment> segments;
    for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
        while (j < edges.size() && edges[j].v == edges[i].v) ++j;
        if (j - i == 2 && flat_together(mesh, edges[i].v, edges[i].opposite, edges[i + 1].opposite, flat_angle)) continue;
        segments.push_back({edges[i].v, kNone});
    }
    const auto& listed = mesh.mesh().subsegments;
    for (std::size_t i = 0; i < listed.size(); ++i) segments.push_back({sorted(listed[i]), static_cast<std::uint32_t>(i)});
    std::sort(segments.begin(), segments.end(), [](const ConstraintSegment& a, const ConstraintSegment& b) { return a.v != b.v ? a.v < b.v : a.listed < b.listed; });
    segments.erase(std::unique(segments.begin(), segments.end(), [](const ConstraintSegment& a, const ConstraintSegment& b) { return a.v == b.v; }), segments.end());
    return segments;
}

Claim claim_listed_subsegments_exist(const SuspectMesh& mesh, const TetsByCorner& stars) {
    ClaimBuilder claim("listed_subsegments_exist", "Every listed edge is an edge of a tetrahedron.");
    const auto& listed = mesh.mesh().subsegments;
    claim.checked(listed.size());
    look_in_ranges(mesh.workers(), listed.size(), kSmallGrain, claim, [&](std::size_t begin, std::size_t end, ClaimBuilder& part) {
        for (std::size_t i = begin; i < end; ++i)
            if (!has_edge(mesh, stars, sorted(listed[i])))
                part.violated(EntityKind::edge, i + 1, mesh.centroid(listed[i].data(), 2),
                              [&] { return fmt::format("vertices {} {} are not joined by an edge of a tetrahedron", listed[i][0] + 1, listed[i][1] + 1); });
    });
    return claim.decided();
}

}  // namespace wellmesh::certifying
