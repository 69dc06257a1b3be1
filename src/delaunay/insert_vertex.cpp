// SPDX-License-Identifier: Apache-2.0
// Changes that add: starting simplex, insertion into a found cavity, bulk insertion.
#include <algorithm>
#include <bit>
#include <numeric>

#include "core/check.hpp"
#include "delaunay/collinear.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {

VertexId Triangulation::add_point(const Vec3& p) {
    points_.push_back(p);
    vertex_tet_.emplace_back();
    return VertexId{points_.size() - 1};
}

void Triangulation::reserve(std::size_t vertices) {
    points_.reserve(vertices);
    vertex_tet_.reserve(vertices);
    tets_.reserve(7 * vertices);  // 6.77 tetrahedra a vertex for random points
}

void Triangulation::start(VertexId a, VertexId b, VertexId c, VertexId d) {
    if (orient3d(point(a), point(b), point(c), point(d)) == Sign::negative) std::swap(a, b);
    const TetId inner = tets_.allocate();
    tets_.set_corners(inner, {a, b, c, d});
    std::array<TetId, 4> ghosts;
    for (unsigned f = 0; f < 4; ++f) {
        // Seen from outside, the face is listed the other way round.
        const auto face = tets_.face_corners(TetFace{inner, f});
        ghosts[f] = tets_.allocate();
        tets_.set_corners(ghosts[f], {face[0], face[2], face[1], kInfiniteVertex});
        tets_.connect(TetFace{inner, f}, TetFace{ghosts[f], 3});
    }
    for (unsigned f = 0; f < 4; ++f)
        for (unsigned g = f + 1; g < 4; ++g) {
            // Ghosts f and g meet in the edge of the two corners other than f and g; in ghost f the corner g is opposite to it.
            const auto& corners = tets_.corners(inner);
            tets_.connect(TetFace{ghosts[f], tets_.find_corner(ghosts[f], corners[g])}, TetFace{ghosts[g], tets_.find_corner(ghosts[g], corners[f])});
        }
    for (const VertexId v : {a, b, c, d}) vertex_tet_[v.index()] = inner;
    last_located_ = inner;
}

TetId Triangulation::create_tet(std::size_t recycled, const std::vector<TetId>& pool) {
    return recycled < pool.size() ? pool[recycled] : tets_.allocate();
}

void Triangulation::insert_vertex(VertexId v, const Cavity& cavity) {
    const std::size_t n = cavity.boundary.size();
    new_tets_.clear();
    outside_.clear();
    local_.clear();
    // Read all faces before any tetrahedron is overwritten: new ones take the ids of deleted ones.
    static_assert(sizeof(std::array<VertexId, 3>) == 12);
    thread_local std::vector<std::array<VertexId, 3>> faces;
    faces.clear();
    for (const BoundaryFace& b : cavity.boundary) {
        faces.push_back(tets_.face_corners(b.inside));
        outside_.push_back(b.outside);
    }
    for (std::size_t i = 0; i < n; ++i) {
        const TetId t = create_tet(i, cavity.tets);
        new_tets_.push_back(t);
        auto& f = faces[i];
        if (f[2] == kInfiniteVertex || f[1] == kInfiniteVertex || f[0] == kInfiniteVertex) {
            // Turn the face until infinity is last; (f0, f1, inf, v) is positive, hence so is (f1, f0, v, inf).
            while (f[2] != kInfiniteVertex) f = {f[1], f[2], f[0]};
            tets_.set_corners(t, {f[1], f[0], v, kInfiniteVertex});
            tets_.connect(TetFace{t, 2}, outside_[i]);
        } else {
            tets_.set_corners(t, {f[0], f[1], f[2], v});
            tets_.connect(TetFace{t, 3}, outside_[i]);
            vertex_tet_[f[0].index()] = vertex_tet_[f[1].index()] = vertex_tet_[f[2].index()] = t;
            vertex_tet_[v.index()] = t;
        }
    }
    for (std::size_t i = n; i < cavity.tets.size(); ++i) tets_.release(cavity.tets[i]);

    // Two new tetrahedra meet in a face (v, x, y) iff their boundary faces share the edge xy, which they list in opposite directions.
    thread_local std::vector<std::array<std::uint32_t, 3>> slots;
    slots.resize(n);
    for (std::size_t i = 0; i < n; ++i) slots[i] = {local_(faces[i][0]), local_(faces[i][1]), local_(faces[i][2])};
    const std::size_t m = local_.size();
    constexpr std::size_t kLargestTable = 128;
    const std::size_t stride = std::max<std::size_t>(32, std::bit_ceil(m));  // usually 32: 4 kB, in the first-level cache
    auto face_opposite = [&](std::size_t i, unsigned k) {
        // Face of new tetrahedron i opposite to corner faces[i][k]; see the two layouts above.
        const bool ghost = faces[i][2] == kInfiniteVertex;
        return TetFace{new_tets_[i], ghost ? (k == 0 ? 1U : k == 1 ? 0U : 3U) : k};
    };
    if (m <= kLargestTable) {
        edge_table_.resize(std::max(edge_table_.size(), stride * stride));
        for (std::size_t i = 0; i < n; ++i) {
            const auto& s = slots[i];
            for (unsigned k = 0; k < 3; ++k) edge_table_[s[(k + 1) % 3] * stride + s[(k + 2) % 3]] = face_opposite(i, k);
        }
        for (std::size_t i = 0; i < n; ++i) {
            const auto& s = slots[i];
            for (unsigned k = 0; k < 3; ++k) {
                const unsigned from = s[(k + 1) % 3], to = s[(k + 2) % 3];
                if (from < to) tets_.connect(face_opposite(i, k), edge_table_[to * stride + from]);
            }
        }
    } else {
        // Large cavities: sort the edges instead.
        std::vector<std::pair<std::array<std::uint32_t, 2>, TetFace>> edges;
        edges.reserve(3 * n);
        for (std::size_t i = 0; i < n; ++i)
            for (unsigned k = 0; k < 3; ++k) {
                const std::uint32_t x = faces[i][(k + 1) % 3].value(), y = faces[i][(k + 2) % 3].value();
                edges.push_back({{std::min(x, y), std::max(x, y)}, face_opposite(i, k)});
            }
        std::sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
        for (std::size_t i = 0; i + 1 < edges.size(); i += 2) {
            WELLMESH_CHECK(Stage::delaunay, edges[i].first == edges[i + 1].first);
            tets_.connect(edges[i].second, edges[i + 1].second);
        }
    }
    last_located_ = new_tets_[0];
}

bool Triangulation::insert_all(std::span<const Vec3> points) {
    points_.assign(points.begin(), points.end());
    return insert_order(biased_spatial_order(points));
}

bool Triangulation::insert_all_in_order(std::span<const Vec3> points) {
    points_.assign(points.begin(), points.end());
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0U);
    return insert_order(order);
}

bool Triangulation::insert_order(std::span<const std::uint32_t> order) {
    vertex_tet_.assign(points_.size(), TetId{});
    tets_.clear();
    tets_.reserve(7 * points_.size());
    duplicates_ = 0;
    if (order.size() < 4) return false;

    // Four points that are not coplanar, early in the order.
    std::array<VertexId, 4> first{VertexId{order[0]}, {}, {}, {}};
    std::size_t found = 1;
    for (std::size_t i = 1; i < order.size() && found < 4; ++i) {
        const VertexId v{order[i]};
        if (found == 1 && point(v) != point(first[0])) first[found++] = v;
        else if (found == 2 && !collinear(point(first[0]), point(first[1]), point(v))) first[found++] = v;
        else if (found == 3 && orient3d(point(first[0]), point(first[1]), point(first[2]), point(v)) != Sign::zero) first[found++] = v;
    }
    if (found < 4) return false;
    start(first[0], first[1], first[2], first[3]);
    Cavity cavity;
    TetId near = last_located_;
    for (const std::uint32_t i : order) {
        const VertexId v{i};
        if (is_inserted(v)) continue;
        if (!find_conflict_cavity(point(v), near, cavity)) {
            ++duplicates_;
            continue;
        }
        insert_vertex(v, cavity);
        near = last_located_;
    }
    return true;
}

}  // namespace wellmesh
