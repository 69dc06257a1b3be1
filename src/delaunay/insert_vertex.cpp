// SPDX-License-Identifier: Apache-2.0
// Changes that add: starting simplex, insertion into a found cavity, bulk insertion.
#include <algorithm>

#include "core/check.hpp"
#include "delaunay/collinear.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {

VertexId Triangulation::add_point(const Vec3& p) {
    points_.push_back(p);
    vertex_tet_.emplace_back();
    slot_of_vertex_.push_back(0);
    return VertexId{points_.size() - 1};
}

void Triangulation::reserve(std::size_t vertices) {
    points_.reserve(vertices);
    vertex_tet_.reserve(vertices);
    slot_of_vertex_.reserve(vertices);
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

unsigned Triangulation::local_slot(VertexId v) {
    if (v == kInfiniteVertex) return 0;  // slot 0 is reserved for it
    std::uint32_t& slot = slot_of_vertex_[v.index()];
    if (slot < local_vertices_.size() && local_vertices_[slot] == v) return slot;
    slot = static_cast<std::uint32_t>(local_vertices_.size());
    local_vertices_.push_back(v);
    return slot;
}

TetId Triangulation::create_tet(std::size_t recycled, const std::vector<TetId>& pool) {
    return recycled < pool.size() ? pool[recycled] : tets_.allocate();
}

void Triangulation::insert_vertex(VertexId v, const Cavity& cavity) {
    const std::size_t n = cavity.boundary.size();
    new_tets_.clear();
    outside_.clear();
    local_vertices_.clear();
    local_vertices_.push_back(kInfiniteVertex);
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
    for (std::size_t i = 0; i < n; ++i)
        for (const VertexId x : faces[i]) local_slot(x);
    const std::size_t m = local_vertices_.size();
    constexpr std::size_t kLargestTable = 128;
    auto face_opposite = [&](std::size_t i, unsigned k) {
        // Face of new tetrahedron i opposite to corner faces[i][k]; see the two layouts above.
        const bool ghost = faces[i][2] == kInfiniteVertex;
        return TetFace{new_tets_[i], ghost ? (k == 0 ? 1U : k == 1 ? 0U : 3U) : k};
    };
    if (m <= kLargestTable) {
        edge_table_.resize(kLargestTable * kLargestTable);
        for (std::size_t i = 0; i < n; ++i) {
            const unsigned s[3] = {local_slot(faces[i][0]), local_slot(faces[i][1]), local_slot(faces[i][2])};
            for (unsigned k = 0; k < 3; ++k) edge_table_[s[(k + 1) % 3] * kLargestTable + s[(k + 2) % 3]] = face_opposite(i, k);
        }
        for (std::size_t i = 0; i < n; ++i) {
            const unsigned s[3] = {local_slot(faces[i][0]), local_slot(faces[i][1]), local_slot(faces[i][2])};
            for (unsigned k = 0; k < 3; ++k) {
                const unsigned from = s[(k + 1) % 3], to = s[(k + 2) % 3];
                if (from < to) tets_.connect(face_opposite(i, k), edge_table_[to * kLargestTable + from]);
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
    vertex_tet_.assign(points.size(), TetId{});
    slot_of_vertex_.assign(points.size(), 0);
    tets_.clear();
    tets_.reserve(7 * points.size());
    duplicates_ = 0;
    const std::vector<std::uint32_t> order = biased_spatial_order(points);
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
        if (!find_conflict_cavity(points_[i], near, cavity)) {
            ++duplicates_;
            continue;
        }
        insert_vertex(v, cavity);
        near = last_located_;
    }
    return true;
}

}  // namespace wellmesh
