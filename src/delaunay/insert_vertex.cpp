// SPDX-License-Identifier: Apache-2.0
// Changes that add: starting simplex, insertion into a found cavity, bulk insertion.
#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>

#include "core/check.hpp"
#include "delaunay/collinear.hpp"
#include "delaunay/spatial_order.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {

VertexId Triangulation::add_point(const Vec3& p) {
    vertices_.push_back({p});
    return VertexId{vertices_.size() - 1};
}

void Triangulation::reserve(std::size_t vertices) {
    vertices_.reserve(vertices);
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
    for (const VertexId v : {a, b, c, d}) vertices_[v.index()].tet = inner;
    last_located_ = inner;
}

TetId Triangulation::create_tet(std::size_t recycled, const std::vector<TetId>& pool) {
    return recycled < pool.size() ? pool[recycled] : tets_.allocate();
}

void Triangulation::clear_local_numbers(std::size_t most) {
    if (local_.size() < most + 2) local_.resize(2 * most + 2);
    local_[0] = kInfiniteVertex;
    local_count_ = 1;
}

/// Two new tetrahedra meet in a face (v, x, y) iff their boundary faces share the edge xy, which they list in opposite directions: a table
/// over pairs of local numbers, usually 4 kB and so in the first-level cache, finds the partner without a search.
///
/// New tetrahedron i is (f0, f1, f2, v) for the boundary face (f0, f1, f2), so that its face k is the one opposite to f_k. At the hull
/// the face is turned until infinity is f2; (f0, f1, inf, v) is positive, hence so is (f1, f0, v, inf).
template <bool kOnHull, bool kByTable>
void Triangulation::create_new_tets(VertexId v, const Cavity& cavity) {
    const std::size_t n = faces_.size();
    const std::size_t stride = kByTable ? std::max<std::size_t>(32, std::bit_ceil(std::size_t{local_count_})) : 1;
    if (edge_table_.size() < stride * stride) edge_table_.resize(stride * stride);
    // Without a table all edges share a cell: whatever it holds is replaced by join_by_sorting().
    const auto cell = [stride](std::uint32_t x, std::uint32_t y) { return kByTable ? x * stride + y : 0; };
    auto face_number = [](const NewFace& f, unsigned k) -> unsigned {
        if (!kOnHull || f.corners[2] != kInfiniteVertex) return k;
        constexpr std::array<std::uint8_t, 3> kGhostFace{1, 0, 3};
        return kGhostFace[k];
    };
    for (std::size_t i = 0; i < n; ++i) {
        const TetId t = create_tet(i, cavity.tets);
        new_tets_[i] = t;
        const NewFace& f = faces_[i];
        const auto [a, b, c] = f.local;
        edge_table_[cell(b, c)] = TetFace{t, face_number(f, 0)};
        edge_table_[cell(c, a)] = TetFace{t, face_number(f, 1)};
        edge_table_[cell(a, b)] = TetFace{t, face_number(f, 2)};
    }
    for (std::size_t i = 0; i < n; ++i) {
        const NewFace& f = faces_[i];
        const TetId t = new_tets_[i];
        const auto [a, b, c] = f.local;
        const TetFace across0 = edge_table_[cell(c, b)], across1 = edge_table_[cell(a, c)], across2 = edge_table_[cell(b, a)];
        if (kOnHull && f.corners[2] == kInfiniteVertex) {
            tets_.set(t, {f.corners[1], f.corners[0], v, kInfiniteVertex}, {across1, across0, f.outside, across2});
            tets_.set_across(f.outside, TetFace{t, 2});
            continue;
        }
        tets_.set(t, {f.corners[0], f.corners[1], f.corners[2], v}, {across0, across1, across2, f.outside});
        tets_.set_across(f.outside, TetFace{t, 3});
        for (const VertexId x : f.corners) vertices_[x.index()].tet = t;
        vertices_[v.index()].tet = t;
    }
}

/// Large cavities, where the table would not stay in the cache: sets the adjacencies between new tetrahedra.
void Triangulation::join_by_sorting() {
    struct Edge {
        VertexId low, high;
        TetFace face;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * new_tets_.size());
    for (const TetId t : new_tets_) {
        const unsigned base = tets_.is_ghost(t) ? 2 : 3;  // the corner v, opposite to the boundary face
        for (unsigned f = 0; f < 4; ++f) {
            if (f == base) continue;
            std::array<VertexId, 2> edge{};
            std::size_t found = 0;
            for (unsigned c = 0; c < 4; ++c)
                if (c != base && c != f) edge[found++] = tets_.corner(t, c);
            edges.push_back({std::min(edge[0], edge[1]), std::max(edge[0], edge[1]), TetFace{t, f}});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& p, const Edge& q) { return std::tie(p.low, p.high) < std::tie(q.low, q.high); });
    for (std::size_t i = 0; i + 1 < edges.size(); i += 2) {
        WELLMESH_CHECK(Stage::delaunay, edges[i].low == edges[i + 1].low && edges[i].high == edges[i + 1].high);
        tets_.connect(edges[i].face, edges[i + 1].face);
    }
}

void Triangulation::insert_vertex(VertexId v, const Cavity& cavity) {
    const std::size_t n = cavity.boundary.size();
    faces_.resize(n);
    new_tets_.resize(n);
    clear_local_numbers(3 * n);
    bool on_hull = false;
    // Read all faces before any tetrahedron is overwritten: new ones take the ids of deleted ones.
    for (std::size_t i = 0; i < n; ++i) {
        auto corners = tets_.face_corners(cavity.boundary[i].inside);
        if (corners[0] == kInfiniteVertex || corners[1] == kInfiniteVertex || corners[2] == kInfiniteVertex) {
            on_hull = true;
            while (corners[2] != kInfiniteVertex) corners = {corners[1], corners[2], corners[0]};
        }
        faces_[i] = {corners, {local_number(corners[0]), local_number(corners[1]), local_number(corners[2])}, cavity.boundary[i].outside};
    }
    constexpr std::size_t kLargestTable = 128;
    if (local_count_ > kLargestTable) {
        create_new_tets<true, false>(v, cavity);
        join_by_sorting();
    } else if (on_hull) {
        create_new_tets<true, true>(v, cavity);
    } else {
        create_new_tets<false, true>(v, cavity);
    }
    for (std::size_t i = n; i < cavity.tets.size(); ++i) tets_.release(cavity.tets[i]);
    last_located_ = new_tets_[0];
}

namespace {

/// Refuses nothing, but passes a checkpoint, which may throw.
class CheckpointPasser : public BulkObserver {
public:
    explicit CheckpointPasser(const Checkpoint& checkpoint) : checkpoint_(checkpoint) {}
    void make_room(std::size_t) override {}
    void split(std::size_t) override {}
    BulkObserver& for_zone(std::size_t) override { return *this; }
    void join() override {}
    bool welcomes(const Vec3&, TetId) override { return true; }
    Answer prepare(const Cavity&) override { return Answer::yes; }
    void made(VertexId, const std::vector<TetId>&) override {}
    bool may_go_on() override {
        pass(checkpoint_);
        return true;
    }

private:
    const Checkpoint& checkpoint_;
};

}  // namespace

bool Triangulation::insert_all(std::span<const Vec3> points, const Checkpoint& checkpoint) {
    vertices_.clear();
    vertices_.reserve(points.size());
    for (const Vec3& p : points) vertices_.push_back({p});
    const std::vector<std::uint32_t> order = biased_spatial_order(points);
    if (!start_from(order)) return false;
    CheckpointPasser passer(checkpoint);
    (void)insert_one_by_one(order, &passer);
    return true;
}

bool Triangulation::insert_all_in_order(std::span<const Vec3> points, std::span<const std::uint32_t> order, Workers& workers) {
    vertices_.clear();
    vertices_.reserve(points.size());
    for (const std::uint32_t i : order) vertices_.push_back({points[i]});
    std::vector<std::uint32_t> identity(order.size());
    std::iota(identity.begin(), identity.end(), 0U);
    if (!start_from(identity)) return false;
    (void)insert_on(workers, identity);
    return true;
}

/// The first tetrahedron, of four points that are not coplanar, early in the order.
bool Triangulation::start_from(std::span<const std::uint32_t> order) {
    tets_.clear();
    tets_.reserve(7 * vertices_.size() + 64);
    duplicates_.clear();
    if (order.size() < 4) return false;
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
    return true;
}

}  // namespace wellmesh
