// SPDX-License-Identifier: Apache-2.0
// How the lattice's vertices get into the mesh: those deep inside in bulk, on all workers, those near the boundary one by one.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>

#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "delaunay/spatial_order.hpp"
#include "refinement/lattice_seeding.hpp"
#include "validation/box_tree.hpp"

namespace wellmesh {
namespace {

/// Vertices keep so far from the boundary, in circumradius bounds.
constexpr double kClearance = 0.5;
/// Of the lattice constant: takes exact symmetry away, costs nothing in shape.
constexpr double kLatticeJitter = 1e-4;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Squared distance from p to the triangle: to its plane if the foot of the perpendicular lies inside, else to the nearest edge.
double squared_distance_to_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 n = cross(b - a, c - a);
    if (dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 && dot(cross(a - c, p - c), n) >= 0) {
        const double height = dot(p - a, n);
        return height * height / squared_norm(n);
    }
    const auto to_edge = [&p](const Vec3& u, const Vec3& v) {
        const Vec3 d = v - u;
        const double t = std::clamp(dot(p - u, d) / squared_norm(d), 0.0, 1.0);
        return squared_distance(p, u + t * d);
    };
    return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

}  // namespace

std::vector<LatticeSeeder::Seed> LatticeSeeder::seeds_of(const std::vector<LatticePoint>& lattice) {
    std::vector<Vec3> points;
    points.reserve(lattice.size());
    for (const LatticePoint& p : lattice) points.push_back(p.point);
    const std::vector<std::uint32_t> order = biased_spatial_order(points, workers_);
    std::vector<Seed> seeds(order.size());
    workers_.for_ranges(order.size(), 1 << 14, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t k = begin; k < end; ++k) {
            const LatticePoint& p = lattice[order[k]];
            seeds[k] = {flush_to_exact_range(p.point + (kLatticeJitter * p.spacing) * picking_point(3, mix64(boundary_.seed(), order[k]), 1)), p.spacing};
        }
    });
    return seeds;
}

/// Seeds deep inside first, on all workers: whether they are clear of the boundary does not depend on what else is there. Then the others, in their order.
bool LatticeSeeder::insert_seeds(std::span<Seed> seeds) {
    // A limit on vertices depends on the order.
    const bool in_bulk = !guard_.has_too_many(mesh_.vertex_count() + seeds.size());
    if (in_bulk && !insert_deep(seeds)) return false;
    TetId near{};
    for (Seed& s : seeds) {
        if (!s.waits) continue;
        if (!may_go_on(seeds.size())) return false;
        const Outcome outcome = insert(s.point, near);
        s.waits = outcome == Outcome::encroaches;  // finer boundaries are encroached by fewer
        inserted_ += outcome == Outcome::inserted;
    }
    return true;
}

/// Which seeds are farther from every face than any may be that is not clear of it, and in no ball about an acute vertex: balls give way one by one.
std::vector<char> LatticeSeeder::find_deep(std::span<const Seed> seeds) const {
    std::vector<Box> boxes;
    for (const Face& f : list_faces()) boxes.push_back({f.box[0], f.box[1]});
    const BoxTree tree(boxes);
    const std::vector<Box> balls = boundary_.acute().boxes_of_balls();
    const BoxTree ball_tree(balls);
    double largest = 0;
    for (const double r : radius_)
        if (r < kInfinity) largest = std::max(largest, r);
    std::vector<char> is_deep(seeds.size(), 0);
    workers_.for_ranges(seeds.size(), 1 << 10, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t k = begin; k < end; ++k) {
            if (!seeds[k].waits) continue;
            // Leaves are at least half as large as they may be.
            const double radius = sizes_.varies() || largest == 0 ? 2 * seeds[k].spacing * kLatticeCircumradius / kLatticeScale : largest;
            const double reach = 1.01 * kClearance * radius;
            bool near = false;
            tree.query([&](const Box& b) { return !near && b.distance_to(seeds[k].point) <= reach; }, [&](std::uint32_t) { near = true; });
            ball_tree.query([&](const Box& b) { return !near && b.distance_to(seeds[k].point) <= 0; }, [&](std::uint32_t) { near = true; });
            is_deep[k] = !near;
        }
    });
    return is_deep;
}

bool LatticeSeeder::insert_deep(std::span<Seed> seeds) {
    const std::vector<char> is_deep = find_deep(seeds);
    std::vector<Vec3> points;
    std::vector<std::uint32_t> numbers;
    const auto deep = static_cast<std::size_t>(std::count(is_deep.begin(), is_deep.end(), 1));
    points.reserve(deep);
    numbers.reserve(deep);
    for (std::size_t k = 0; k < seeds.size(); ++k)
        if (is_deep[k] != 0) {
            points.push_back(seeds[k].point);
            numbers.push_back(static_cast<std::uint32_t>(k));
        }
    const auto caller = std::this_thread::get_id();
    std::atomic<bool> stopped{false};
    const auto goes_on = [&] {
        if (std::this_thread::get_id() == caller && !may_go_on(points.size())) stopped = true;
        return !stopped.load();
    };
    const auto is_welcome = [this](const Vec3& p, CellId c) { return radius_at(p, c) < kInfinity; };
    const std::size_t first = mesh_.vertex_slots(), before = mesh_.vertex_count();
    const std::vector<VertexId> left = mesh_.insert_inside(workers_, points, InsertionReason::lattice, is_welcome, goes_on);
    inserted_ += mesh_.vertex_count() - before;
    for (const std::uint32_t k : numbers) seeds[k].waits = false;
    TetId near{};
    for (const VertexId v : left) {
        if (stopped || !may_go_on(points.size())) return false;
        const Outcome outcome = insert(mesh_.point(v), near, v);
        seeds[numbers[v.index() - first]].waits = outcome == Outcome::encroaches;
        inserted_ += outcome == Outcome::inserted;
    }
    return !stopped;
}

/// The vertex nearest to p is a corner of its cavity; the nearest subface need not be a face of it (p may lie beside an edge or a corner of the
/// boundary), so both are looked at. Beside an edge the distance may come out a little less: no corner is near there, and nothing is encroached.
bool LatticeSeeder::is_clear(const Vec3& p, double clearance) const {
    for (const TetId t : cavity_.tets) {
        for (const VertexId v : mesh_.tets().corners(t))
            if (v != kInfiniteVertex && mesh_.info(v).carrier != CarrierKind::region && squared_distance(p, mesh_.point(v)) < clearance * clearance) return false;
        if (!mesh_.has_labels(t)) continue;
        for (unsigned f = 0; f < 4; ++f) {
            if (!mesh_.labels(t).facets[f].valid()) continue;
            const auto fc = mesh_.tets().face_corners(TetFace{t, f});
            if (squared_distance_to_triangle(p, mesh_.point(fc[0]), mesh_.point(fc[1]), mesh_.point(fc[2])) < clearance * clearance) return false;
        }
    }
    return true;
}

/// @param known  a vertex that is stored at p, to be inserted; invalid: a new one
LatticeSeeder::Outcome LatticeSeeder::insert(const Vec3& p, TetId& near, VertexId known) {
    Triangulation& tri = mesh_.triangulation();
    near = tri.locate(p, near);
    const CellId cell = mesh_.cell(near);
    if (!mesh_.tets().is_finite(near) || !mesh_.in_domain(near)) return Outcome::refused;
    const double radius = radius_at(p, cell);
    if (radius == kInfinity) return Outcome::refused;
    if (!tri.find_conflict_cavity(p, near, cavity_)) return Outcome::refused;
    const Placement where = Placement::in_cell(cell);
    if (!is_clear(p, kClearance * radius)) return Outcome::refused;
    boundary_.find_encroached(cavity_, where, encroached_segments_, encroached_faces_);
    if (!encroached_segments_.empty() || !encroached_faces_.empty()) return Outcome::encroaches;
    if (!boundary_.makes_room(cavity_, InsertionReason::lattice)) return Outcome::refused;
    if (known.valid()) mesh_.insert_known(known, cavity_, where);
    else known = mesh_.insert(cavity_, where, {.reason = InsertionReason::lattice});
    near = tri.tet_of(known);
    return Outcome::inserted;
}

}  // namespace wellmesh
