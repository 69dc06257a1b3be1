// SPDX-License-Identifier: Apache-2.0
#include "adoption/given_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh {
namespace {

constexpr Stage kGivenStage = Stage::delaunay;

void check_vertices(const TetMesh& mesh) {
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const Vec3& p = mesh.vertices[v];
        if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)))
            throw MeshError(ErrorCode::bad_input, kGivenStage, fmt::format("vertex {} of the mesh is not finite", v + 1), {{EntityKind::vertex, v + 1, p}});
        if (!in_exact_range(p))
            throw MeshError(ErrorCode::coordinate_range, kGivenStage,
                            fmt::format("vertex {} of the mesh, ({}, {}, {}), is outside the range {} to {} in which the predicates are exact", v + 1, p.x, p.y, p.z,
                                        kMinMagnitude, kMaxMagnitude),
                            {{EntityKind::vertex, v + 1, p}});
    }
}

template <std::size_t N>
void check_corners(const std::vector<std::array<std::uint32_t, N>>& elements, std::size_t vertices, EntityKind kind) {
    for (std::size_t i = 0; i < elements.size(); ++i) {
        auto sorted = elements[i];
        std::sort(sorted.begin(), sorted.end());
        if (sorted.back() >= vertices)
            throw MeshError(ErrorCode::bad_input, kGivenStage, fmt::format("{} {} has a corner {}; the mesh has {} vertices", to_string(kind), i + 1, sorted.back() + 1, vertices),
                            {{kind, i + 1, {}}});
        if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
            throw MeshError(ErrorCode::bad_input, kGivenStage, fmt::format("{} {} has a corner twice", to_string(kind), i + 1), {{kind, i + 1, {}}});
    }
}

std::vector<std::uint32_t> first_at_place(const std::vector<Vec3>& points) {
    std::vector<std::uint32_t> order(points.size()), first(points.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return points[a] != points[b] ? lexicographically_less(points[a], points[b]) : a < b; });
    for (std::size_t i = 0; i < order.size(); ++i) first[order[i]] = i > 0 && points[order[i]] == points[order[i - 1]] ? first[order[i - 1]] : order[i];
    return first;
}

template <std::size_t N>
std::vector<std::int32_t> common_references(const std::vector<std::array<std::uint32_t, N>>& elements, const std::vector<std::int32_t>& references,
                                            const std::vector<std::uint32_t>& first_at_place) {
    constexpr std::int32_t kSeveral = -1;
    std::vector<std::int32_t> common(first_at_place.size(), 0);
    for (std::size_t i = 0; i < std::min(elements.size(), references.size()); ++i)
        for (const std::uint32_t corner : elements[i]) {
            std::int32_t& reference = common[first_at_place[corner]];
            reference = reference == 0 || reference == references[i] ? references[i] : kSeveral;
        }
    std::replace(common.begin(), common.end(), kSeveral, 0);
    return common;
}

/// Faces that occur once among the tetrahedra.
std::vector<std::array<std::uint32_t, 3>> find_hull(const std::vector<std::array<std::uint32_t, 4>>& tets, const std::vector<std::uint32_t>& first_at_place) {
    std::vector<std::array<std::uint32_t, 3>> faces;
    faces.reserve(4 * tets.size());
    for (const auto& t : tets)
        for (std::size_t f = 0; f < 4; ++f) {
            std::array<std::uint32_t, 3> face{first_at_place[t[(f + 1) % 4]], first_at_place[t[(f + 2) % 4]], first_at_place[t[(f + 3) % 4]]};
            std::sort(face.begin(), face.end());
            faces.push_back(face);
        }
    std::sort(faces.begin(), faces.end());
    std::vector<std::array<std::uint32_t, 3>> hull;
    for (std::size_t i = 0, next = 0; i < faces.size(); i = next) {
        for (next = i + 1; next < faces.size() && faces[next] == faces[i];) ++next;
        if (next == i + 1) hull.push_back(faces[i]);
    }
    return hull;
}

}  // namespace

GivenMesh inspect_given_mesh(const TetMesh& mesh) {
    if (mesh.tets.empty()) throw MeshError(ErrorCode::bad_input, kGivenStage, "the mesh has no tetrahedra");
    check_vertices(mesh);
    check_corners(mesh.tets, mesh.vertices.size(), EntityKind::tetrahedron);
    check_corners(mesh.subfaces, mesh.vertices.size(), EntityKind::triangle);
    check_corners(mesh.subsegments, mesh.vertices.size(), EntityKind::edge);
    GivenMesh given;
    given.first_at_place = first_at_place(mesh.vertices);
    given.used.assign(mesh.vertices.size(), 0);
    given.on_hull.assign(mesh.vertices.size(), 0);
    for (const auto& t : mesh.tets) {
        for (const std::uint32_t v : t) given.used[given.first_at_place[v]] = 1;
        const Vec3& a = mesh.vertices[t[0]];
        const double volume = determinant(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a, mesh.vertices[t[3]] - a) / 6;
        given.volume += std::abs(volume);
        given.signed_volume += volume;
    }
    given.hull = find_hull(mesh.tets, given.first_at_place);
    for (const auto& face : given.hull)
        for (const std::uint32_t v : face) given.on_hull[v] = 1;
    given.facet_reference = common_references(mesh.subfaces, mesh.subface_facets, given.first_at_place);
    given.segment_reference = common_references(mesh.subsegments, mesh.subsegment_segments, given.first_at_place);
    return given;
}

}  // namespace wellmesh
