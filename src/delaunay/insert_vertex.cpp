// SPDX-License-Identifier: Apache-2.0
// Changes that add: starting simplex, insertion into a found cavity, bulk insertion.
#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/check.hpp"
#include "delaunay/collinear.hpp"
#include "delaunay/local_numbers.hpp"
#include "delaunay/spatial_order.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {

VertexId Triangulation::add_point(const Vec3& p) {
    vertices_.push_back({p});
    return VertexId{vertices_.size() - 1};
}

VertexId Triangulation::add_points(std::size_t n) {
    const std::size_t first = vertices_.size();
    vertices_.resize_as_is(first + n);
    return VertexId{first};
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

void Triangulation::clear_local_numbers(std::size_t most) {
    if (local_.size() < most + 2) local_.resize(2 * most + 2);
    local_[0] = kInfiniteVertex;
    local_count_ = 1;
}

/// Makes sure that there is a stamp for each of so many insertions, if there can be.
void Triangulation::renew_stamps(std::size_t insertions) {
    if (stamp_ + insertions <= StampedNumbers::kLastStamp) return;
    for (Vertex& v : vertices_) v.local = 0;
    stamp_ = 0;
}

/// Reads the boundary, all of it before any tetrahedron is overwritten: new ones take the ids of deleted ones. A ghost's face is turned until infinity comes last.
///
/// Two new tetrahedra meet in a face (v, x, y) iff their boundary faces share the edge xy, which they list in opposite directions: a table over pairs of numbers
/// finds the partner without a search. What it uses stays in the first-level cache.
template <class Numbers>
void Triangulation::read_faces(const Cavity& cavity, Numbers numbers) {
    constexpr std::uint32_t kStride = Numbers::kMost;
    Vertex* const vertices = vertices_.data();
    const auto number = [&](VertexId v) { return numbers(v, vertices[v.index()].local); };
    if (edge_table_.size() < std::size_t{kStride} * kStride) edge_table_.resize(std::size_t{kStride} * kStride);
    // Nothing here makes these move.
    TetFace* const edges = edge_table_.data();
    NewFace* const faces = faces_.data();
    const TetId* const tets = new_tets_.data();
    const BoundaryFace* const boundary = cavity.boundary.data();
    const std::size_t n = faces_.size();
    for (std::size_t i = 0; i < n; ++i) {
        const TetStore::Corners& of = tets_.corners(boundary[i].inside.tet());
        const auto& at = kFaceCorners[boundary[i].inside.face()];
        VertexId x = of[at[0]], y = of[at[1]], z = of[at[2]];
        std::uint32_t a = 0, b = 0, c = 0, ghost = 0;
        if (of[3] == kInfiniteVertex && (x == kInfiniteVertex || y == kInfiniteVertex || z == kInfiniteVertex)) [[unlikely]] {
            while (z != kInfiniteVertex) z = std::exchange(x, std::exchange(y, z));
            a = number(x);
            b = number(y);
            ghost = 1;
        } else {
            a = number(x);
            b = number(y);
            c = number(z);
        }
        const std::uint32_t row_a = a * kStride, row_b = b * kStride, row_c = c * kStride;
        faces[i] = {{x, y, z}, {row_c + b, row_a + c, row_b + a}, boundary[i].outside};
        const TetId t = tets[i];
        edges[row_b + c] = TetFace{t, 0 ^ ghost};  // of a ghost (f1, f0, v, inf): see set_new_tets()
        edges[row_c + a] = TetFace{t, 1 ^ ghost};
        edges[row_a + b] = TetFace{t, 2 ^ ghost};
    }
}

/// Large cavities, where the table would not stay in any near cache.
void Triangulation::read_faces_only(const Cavity& cavity) {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        auto corners = tets_.face_corners(cavity.boundary[i].inside);
        while (corners[0] == kInfiniteVertex || corners[1] == kInfiniteVertex) corners = {corners[1], corners[2], corners[0]};
        faces_[i] = {corners, {0, 0, 0}, cavity.boundary[i].outside};
    }
    if (edge_table_.empty()) edge_table_.resize(1);  // whatever it holds is replaced by join_by_sorting()
}

/// New tetrahedron i is (f0, f1, f2, v) for the boundary face (f0, f1, f2), so that its face k is the one opposite to f_k; (f0, f1, inf, v) is positive, hence so
/// is (f1, f0, v, inf).
void Triangulation::set_new_tets(VertexId v) {
    const TetFace* const edges = edge_table_.data();
    const NewFace* const faces = faces_.data();
    const TetId* const tets = new_tets_.data();
    Vertex* const vertices = vertices_.data();
    const std::size_t n = faces_.size();
    TetId home{};
    for (std::size_t i = 0; i < n; ++i) {
        const NewFace& f = faces[i];
        const TetId t = tets[i];
        const TetFace across0 = edges[f.edges[0]], across1 = edges[f.edges[1]], across2 = edges[f.edges[2]];
        if (f.corners[2] == kInfiniteVertex) [[unlikely]] {
            tets_.set(t, {f.corners[1], f.corners[0], v, kInfiniteVertex}, {across1, across0, f.outside, across2});
            tets_.set_across(f.outside, TetFace{t, 2});
            continue;
        }
        tets_.set(t, {f.corners[0], f.corners[1], f.corners[2], v}, {across0, across1, across2, f.outside});
        tets_.set_across(f.outside, TetFace{t, 3});
        for (const VertexId x : f.corners) vertices[x.index()].tet = t;
        home = t;
    }
    vertices[v.index()].tet = home;
}

/// Sets the adjacencies between new tetrahedra without a table.
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
    const std::size_t n = cavity.boundary.size(), recycled = std::min(n, cavity.tets.size());
    faces_.resize(n);
    new_tets_.assign(cavity.tets.begin(), cavity.tets.begin() + static_cast<std::ptrdiff_t>(recycled));
    while (new_tets_.size() < n) new_tets_.push_back(tets_.allocate());
    // The boundary is a sphere of triangles: n / 2 + 2 vertices; and 0 is taken.
    const std::size_t numbers = n / 2 + 3;
    constexpr std::uint32_t kMany = 128;
    if (numbers <= StampedNumbers::kMost && stamp_ < StampedNumbers::kLastStamp) [[likely]] read_faces(cavity, StampedNumbers(++stamp_));
    else if (numbers <= kMany) read_faces(cavity, ListedNumbers<kMany>());
    else read_faces_only(cavity);
    set_new_tets(v);
    if (numbers > kMany) join_by_sorting();
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
    Answer prepare(VertexId, const Cavity&) override { return Answer::yes; }
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
    vertices_.resize_as_is(order.size());
    constexpr std::size_t kGrain = std::size_t{1} << 14;
    workers.for_ranges(order.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) vertices_[i] = Vertex{points[order[i]]};
    });
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
