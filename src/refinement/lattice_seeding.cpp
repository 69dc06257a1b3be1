// SPDX-License-Identifier: Apache-2.0
#include "refinement/lattice_seeding.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>

#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "delaunay/spatial_order.hpp"
#include "validation/box_tree.hpp"

namespace wellmesh {
namespace {

/// Circumradius of the tetrahedra of the bcc lattice, over the lattice constant.
const double kLatticeCircumradius = std::sqrt(5.0) / 4;
/// The lattice's circumradii over the bound: at 1 the jitter makes every second one too large, and below 0.95 vertices are wasted (docs/decisions/0011).
constexpr double kLatticeScale = 0.95;
/// Vertices keep so far from the boundary, in circumradius bounds.
constexpr double kClearance = 0.5;
/// Volume over surface, in lattice constants, from which on a cell is seeded: a plate two layers thick, a cube of six. In thinner ones the gap
/// between lattice and boundary costs as many vertices as the lattice saves.
constexpr double kLeastThickness = 1;
/// Of the lattice constant: takes exact symmetry away, costs nothing in shape.
constexpr double kLatticeJitter = 1e-4;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Least part of the spacing allowed at which leaves are worth it where the size varies: the lattice has 0.349 vertices a cubed radius of its own, refinement
/// makes 0.75 of the bound's, and (0.349 / 0.75)^(1/3) / kLatticeScale = 0.82.
constexpr double kLeastUse = 0.82;
/// Ratios of spacings modulo 2 are told apart to a part of 2^(1/64) - 1, one per cent.
constexpr std::size_t kPhases = 64;

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

LatticeSeeder::LatticeSeeder(ConformingMesh& mesh, BoundaryRefiner& boundary, RunGuard& guard, const SizeField& sizes, Workers& workers)
    : mesh_(mesh), boundary_(boundary), guard_(guard), sizes_(sizes), workers_(workers), radius_(mesh.plc().cells.size(), kInfinity), spacing_(radius_.size(), kInfinity), is_thin_(radius_.size(), 0) {
    std::vector<double> surface(radius_.size(), 0);
    for (const ValidFacet& f : mesh.plc().facets) {
        double area = 0;
        for (const auto& t : f.triangles) {
            const Vec3 &a = mesh.plc().vertices[t[0].index()], &b = mesh.plc().vertices[t[1].index()], &c = mesh.plc().vertices[t[2].index()];
            area += norm(cross(b - a, c - a)) / 2;
        }
        for (const CellId c : f.cells) surface[c.index()] += area;
    }
    for (std::size_t c = 0; c < radius_.size(); ++c) {
        if (!mesh.is_filled(CellId{c})) continue;
        // Twelve tetrahedra share the lattice's cube.
        const TetSize& size = sizes.of_cell(CellId{c});
        const double by_volume = std::cbrt(12 * size.max_volume);
        radius_[c] = std::min(std::sqrt(size.max_squared_circumradius), kLatticeCircumradius * by_volume);
        spacing_[c] = kLatticeScale * radius_[c] / kLatticeCircumradius;
        // Where sizes vary the finest decide whether the cell is thick: a lattice that has no room keeps away from the boundary by itself.
        const double finest = sizes.varies() ? std::min(radius_[c], kCircumradiusPerEdgeLength * sizes.smallest()) : radius_[c];
        is_thin_[c] = !(mesh.plc().cells[c].volume >= kLeastThickness * (kLatticeScale * finest / kLatticeCircumradius) * surface[c]);
        if (is_thin_[c] != 0) radius_[c] = spacing_[c] = kInfinity;
    }
}

double LatticeSeeder::radius_at(const Vec3& p, CellId c) const {
    if (!sizes_.varies()) return radius_[c.index()];
    return is_thin_[c.index()] != 0 ? kInfinity : std::min(radius_[c.index()], kCircumradiusPerEdgeLength * sizes_.edge_length(p, c));
}

double LatticeSeeder::spacing_at(const Vec3& p, CellId c) const {
    return sizes_.varies() ? kLatticeScale * radius_at(p, c) / kLatticeCircumradius : spacing_[c.index()];
}

double LatticeSeeder::radius_bound(TetId t, const Vec3& p) const {
    return mesh_.tets().is_finite(t) && mesh_.in_domain(t) ? radius_at(p, mesh_.cell(t)) : kInfinity;
}

/// Circumspheres of tetrahedra at a subsegment or subface are at least as large as its own: splitting it is never in vain.
bool LatticeSeeder::split_boundary(double coarseness) {
    const TetStore& tets = mesh_.tets();
    std::vector<Subsegment> segments;
    std::vector<Subface> faces;
    std::size_t vertices_before = 0;
    do {
        vertices_before = mesh_.vertex_count();
        segments.clear();
        faces.clear();
        for (std::size_t i = 0; i < tets.slots(); ++i) {
            const TetId t{i};
            if (!tets.is_finite(t) || !mesh_.has_labels(t)) continue;
            const double bound = sizes_.varies() ? 0 : coarseness * radius_bound(t, {});
            if (bound == kInfinity) continue;
            const auto is_beyond = [&](double radius, const Vec3& p) { return radius > (sizes_.varies() ? coarseness * radius_bound(t, p) : bound); };
            const TetLabels& l = mesh_.labels(t);
            const auto& c = tets.corners(t);
            for (unsigned e = 0; e < 6; ++e) {
                const VertexId a = c[kEdgeCorners[e][0]], b = c[kEdgeCorners[e][1]];
                if (!l.segments[e].valid()) continue;
                const Vec3 &p = mesh_.point(a), &q = mesh_.point(b);
                if (is_beyond(distance(p, q) / 2, 0.5 * (p + q))) segments.push_back({std::min(a, b), std::max(a, b), l.segments[e]});
            }
            for (unsigned f = 0; f < 4; ++f) {
                if (!l.facets[f].valid()) continue;
                const auto fc = tets.face_corners(TetFace{t, f});
                double radius = 0;
                const Vec3 &p = mesh_.point(fc[0]), &q = mesh_.point(fc[1]), &r = mesh_.point(fc[2]);
                circumcentre(p, q, r, &radius);
                if (is_beyond(radius, (1.0 / 3) * (p + q + r))) faces.push_back({fc, l.facets[f]});
            }
        }
        const SplitRequest request{InsertionReason::boundary_by_size, VertexId{}};
        for (const Subsegment& s : segments) {
            if (!may_go_on(segments.size())) break;
            if (mesh_.find_subsegment(s).valid()) boundary_.split(s, request);
        }
        boundary_.conform();
        if (!may_go_on(faces.size())) return false;
        if (!segments.empty()) continue;  // facets once their outlines are done
        for (const Subface& s : faces) {
            if (!may_go_on(faces.size())) return false;
            boundary_.split(s, request);
            boundary_.conform();
        }
    } while (mesh_.vertex_count() > vertices_before);  // what rounding keeps from being split is left to refinement
    return true;
}

std::vector<LatticeSeeder::Face> LatticeSeeder::list_faces() const {
    const TetStore& tets = mesh_.tets();
    std::vector<Face> out;
    for (std::size_t i = 0; i < tets.slots(); ++i) {
        const TetId t{i};
        if (!tets.is_finite(t) || !mesh_.has_labels(t)) continue;
        if (!mesh_.in_domain(t)) continue;
        for (unsigned f = 0; f < 4; ++f) {
            if (!mesh_.labels(t).facets[f].valid()) continue;
            const auto fc = tets.face_corners(TetFace{t, f});
            const Vec3 &a = mesh_.point(fc[0]), &b = mesh_.point(fc[1]), &c = mesh_.point(fc[2]);
            const double spacing = spacing_at((1.0 / 3) * (a + b + c), mesh_.cell(t));
            if (spacing == kInfinity) continue;
            out.push_back({{Vec3{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})},
                            Vec3{std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})}},
                           spacing});
        }
    }
    return out;
}

/// Splits until leaves are no larger than the lattice constants of the cells that they meet.
void LatticeSeeder::build(GradedOctree& tree, std::uint32_t node, const std::vector<std::uint32_t>& faces, TetId near) {
    if (stopped_ || !may_go_on(0)) {
        stopped_ = true;
        return;
    }
    const GradedOctree::Box box = tree.box(node);
    const Vec3 hi{box.lo.x + box.side, box.lo.y + box.side, box.lo.z + box.side};
    std::vector<std::uint32_t> here;
    double spacing = kInfinity;
    for (const std::uint32_t f : faces) {
        const auto& [low, high] = faces_[f].box;
        if (low.x > hi.x || low.y > hi.y || low.z > hi.z || high.x < box.lo.x || high.y < box.lo.y || high.z < box.lo.z) continue;
        here.push_back(f);
        spacing = std::min(spacing, faces_[f].spacing);
    }
    const TetId at_centre = mesh_.triangulation().locate(0.5 * (box.lo + hi), near);
    const double inside = mesh_.tets().is_finite(at_centre) && mesh_.in_domain(at_centre) ? spacing_at(0.5 * (box.lo + hi), mesh_.cell(at_centre)) : kInfinity;
    spacing = std::min(spacing, inside);
    if (spacing == kInfinity) return;
    if (box.side <= spacing * (1 + 1e-9) || tree.depth(node) == GradedOctree::kMaxDepth) {
        if (!sizes_.varies() || box.side >= kLeastUse * (inside < kInfinity ? inside : spacing)) tree.use(node);
        return;
    }
    const std::uint32_t first = tree.split(node);
    for (std::uint32_t k = 0; k < 8; ++k) build(tree, first + k, here, at_centre);
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

/// The lattice constant that most vertices will have is realised exactly, the others up to a power of two.
double LatticeSeeder::most_used_spacing() const {
    double base = kInfinity, most = 0;
    if (!sizes_.varies()) {
        for (std::size_t c = 0; c < spacing_.size(); ++c) {
            if (spacing_[c] == kInfinity) continue;
            const double expected = mesh_.plc().cells[c].volume / (spacing_[c] * spacing_[c] * spacing_[c]);
            if (expected > most) {
                most = expected;
                base = spacing_[c];
            }
        }
        return base;
    }
    // Spacings modulo 2: each allows lattices a little finer, for so many vertices less.
    std::array<double, kPhases> vertices{}, coarsest{};
    coarsest.fill(kInfinity);
    for (const SizeField::Share& share : sizes_.shares()) {
        if (!(share.edge_length < kInfinity)) continue;
        const double spacing = kLatticeScale * kCircumradiusPerEdgeLength * share.edge_length / kLatticeCircumradius;
        const double octave = std::log2(spacing);
        const auto phase = static_cast<std::size_t>((octave - std::floor(octave)) * kPhases) % kPhases;
        vertices[phase] += share.vertices;
        coarsest[phase] = std::min(coarsest[phase], spacing);
    }
    for (std::size_t phase = 0; phase < kPhases; ++phase) {
        double saved = 0;
        for (std::size_t finer = 0; finer < kPhases; ++finer) {
            const double ratio = std::exp2(-static_cast<double>(finer) / kPhases);  // of this lattice's spacing to one allowed
            if (ratio < kLeastUse) break;
            saved += vertices[(phase + finer) % kPhases] * (1 - std::pow(kLeastUse / ratio, 3));
        }
        if (saved > most && coarsest[phase] < kInfinity) {
            most = saved;
            base = coarsest[phase];
        }
    }
    return base;
}

std::uint64_t LatticeSeeder::seed() {
    const double base = most_used_spacing();
    if (base == kInfinity) return 0;
    // From coarse to fine: vertices on an empty domain's boundary would all be neighbours of each other.
    constexpr double kCoarsest = 8;
    if (!split_boundary(kCoarsest)) return 0;
    std::vector<Seed> seeds = seeds_of(find_lattice(base));
    for (double coarseness = kCoarsest; coarseness >= 1; coarseness /= 2) {
        if (!split_boundary(coarseness)) break;
        // As many as the coarse mesh would have.
        const auto share = static_cast<std::size_t>(static_cast<double>(seeds.size()) / (coarseness * coarseness * coarseness));
        const bool goes_on = insert_seeds({seeds.data(), share});
        mesh_.renumber_tets(workers_);  // what comes next goes by ids
        if (!goes_on) break;
    }
    return inserted_;
}

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
    // Limits on vertices, and balls about acute vertices that give way, depend on the order.
    const bool in_bulk = !boundary_.acute().any() && !guard_.has_too_many(mesh_.vertex_count() + seeds.size());
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

bool LatticeSeeder::insert_deep(std::span<Seed> seeds) {
    std::vector<Box> boxes;
    for (const Face& f : list_faces()) boxes.push_back({f.box[0], f.box[1]});
    const BoxTree tree(boxes);
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
            is_deep[k] = !near;
        }
    });
    std::vector<Vec3> points;
    std::vector<std::size_t> numbers;
    for (std::size_t k = 0; k < seeds.size(); ++k)
        if (is_deep[k] != 0) {
            points.push_back(seeds[k].point);
            numbers.push_back(k);
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
    for (const std::size_t k : numbers) seeds[k].waits = false;
    TetId near{};
    for (const VertexId v : left) {
        if (stopped || !may_go_on(points.size())) return false;
        const Outcome outcome = insert(mesh_.point(v), near, v);
        seeds[numbers[v.index() - first]].waits = outcome == Outcome::encroaches;
        inserted_ += outcome == Outcome::inserted;
    }
    return !stopped;
}

std::vector<LatticePoint> LatticeSeeder::find_lattice(double base) {
    Vec3 lo, hi;
    bounding_box(mesh_.plc().vertices, lo, hi);
    const double extent = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
    double side = base;
    while (side < extent) side *= 2;
    GradedOctree tree(0.5 * (lo + hi) - 0.5 * Vec3{side, side, side}, side);
    faces_ = list_faces();
    std::vector<std::uint32_t> all(faces_.size());
    std::iota(all.begin(), all.end(), 0U);
    build(tree, 0, all, TetId{});
    if (stopped_) return {};
    tree.balance();
    return tree.lattice();
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
