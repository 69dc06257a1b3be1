// SPDX-License-Identifier: Apache-2.0
// How the lattice's vertices get into the mesh: in bulk, on all workers, but for those in balls about acute vertices.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <thread>

#include "conforming/place_point.hpp"
#include "core/check.hpp"
#include "core/huge_pages.hpp"
#include "core/infinity.hpp"
#include "core/resident_memory.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "delaunay/spatial_order.hpp"
#include "refinement/lattice_filling.hpp"
#include "refinement/lattice_seeding.hpp"

namespace wellmesh {
namespace {

/// Vertices keep so far from the boundary, in circumradius bounds.
constexpr double kClearance = 0.5;
/// Of the lattice constant: takes exact symmetry away, costs nothing in shape.
constexpr double kLatticeJitter = 1e-4;
/// Of known tetrahedra while they are put in: corners and neighbours, cell, number of labels, and what arrays have to spare.
constexpr std::size_t kBytesATet = 48;
/// The lattice's margin is a third of its constant; rounded to so many steps of the coordinates it is the lattice still.
constexpr double kLeastSteps = 4096;
constexpr std::size_t kBoxGrain = std::size_t{1} << 12;

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
    constexpr std::size_t kGrain = std::size_t{1} << 14;
    WELLMESH_CHECK(Stage::refine, lattice.size() < std::size_t{1} << 31);  // Seed::number
    auto points = make_on_huge_pages<Vec3>(lattice.size(), workers_);
    workers_.for_ranges(lattice.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t k = begin; k < end; ++k) points[k] = lattice[k].point;
    });
    const std::vector<std::uint32_t> order = biased_spatial_order(points, workers_);
    auto seeds = make_on_huge_pages<Seed>(order.size(), workers_);
    workers_.for_ranges(order.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t k = begin; k < end; ++k) {
            const LatticePoint& p = lattice[order[k]];
            const Vec3 jitter = (kLatticeJitter * p.spacing) * picking_point(3, mix64(boundary_.seed(), order[k]), 1);
            seeds[k] = {flush_to_exact_range(p.point + jitter), {}, order[k] & 0x7fffffffU};
        }
    });
    return seeds;
}

/// On all workers first: whether seeds are clear of the boundary, and encroach upon it, does not depend on what else is there. Then those in balls,
/// in their order.
/// @param lattice  when all seeds are to go in: those far from everything else need not be inserted, as their tetrahedra are known
bool LatticeSeeder::insert_seeds(std::span<Seed> seeds, Lattice* lattice) {
    // A limit on vertices depends on the order.
    std::vector<char> in_bulk(seeds.size(), 0);
    std::optional<LatticeFilling> filling;
    if (!guard_.has_too_many(mesh_.vertex_count() + seeds.size())) {
        const Boundary boundary = find_boundary(list_faces());
        in_bulk = find_clear(boundary, seeds);
        if (lattice != nullptr) find_filling(*lattice, boundary, seeds, in_bulk, filling);
        return_freed_memory();
        if (!insert_in_bulk(seeds, in_bulk)) return false;
    }
    if (!insert_left(seeds, in_bulk)) return false;
    return !filling || fill(seeds, in_bulk, std::move(*filling));
}

/// Of tetrahedra that need not be searched for; none if the lattice is too fine for its coordinates. Takes the lattice's octree.
/// @param in_bulk  gets which seeds they are those of
void LatticeSeeder::find_filling(Lattice& lattice, const Boundary& boundary, std::span<const Seed> seeds, std::vector<char>& in_bulk, std::optional<LatticeFilling>& filling,
                                 const BoundarySample* sample) {
    const Vec3 &low = mesh_.triangulation().low(), &high = mesh_.triangulation().high();
    const double largest = std::max({std::abs(low.x), std::abs(low.y), std::abs(low.z), std::abs(high.x), std::abs(high.y), std::abs(high.z)});
    const double step = std::numeric_limits<double>::epsilon() * largest;
    if (!(lattice.tree->smallest_side() >= kLeastSteps * step)) return;
    filling.emplace(*lattice.tree, lattice.leaves, occupied(boundary, lattice.tree->smallest_side(), sample), workers_);
    lattice.tree.reset();  // memory is short when all tetrahedra are there
    std::vector<std::uint32_t>().swap(lattice.leaves.of_node);
    const std::vector<char> is_far = filling->far_points(seeds.size());
    for (std::size_t k = 0; k < seeds.size(); ++k)
        if (in_bulk[k] != 0 && is_far[seeds[k].number] != 0) in_bulk[k] = kKnown;
}

/// One by one.
bool LatticeSeeder::insert_left(std::span<Seed> seeds, const std::vector<char>& in_bulk) {
    TetId near{};
    for (std::size_t k = 0; k < seeds.size(); ++k) {
        Seed& s = seeds[k];
        if (!s.waits || in_bulk[k] != 0) continue;
        if (!may_go_on(seeds.size())) return false;
        s.vertex = VertexId{};
        const Outcome outcome = insert(s.point, near, s.vertex);
        s.waits = outcome == Outcome::encroaches;  // finer boundaries are encroached by fewer
        inserted_ += outcome == Outcome::inserted;
    }
    return true;
}

/// @param pieces  of segments, whose and the faces' spheres are to be kept free, if any; else those of the mesh are
LatticeSeeder::Boundary LatticeSeeder::find_boundary(std::vector<Face> faces, std::span<const Subsegment> pieces) {
    std::vector<Box> boxes = boxes_of(faces);
    std::vector<Boundary::Sphere> spheres;
    if (pieces.empty()) {
        for (std::size_t v = 0; v < mesh_.vertex_slots(); ++v)  // those of facets lie in them
            if (mesh_.info(VertexId{v}).carrier == CarrierKind::segment || mesh_.info(VertexId{v}).carrier == CarrierKind::input_vertex)
                boxes.push_back({mesh_.point(VertexId{v}), mesh_.point(VertexId{v})});
    } else {
        boxes.resize(faces.size() + pieces.size());
        spheres.resize(boxes.size());
        workers_.for_ranges(boxes.size(), kBoxGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i) {
                double radius = 0;
                if (i < faces.size()) {
                    const auto& [a, b, c] = faces[i].corners;
                    spheres[i].centre = circumcentre(mesh_.point(a), mesh_.point(b), mesh_.point(c), &radius);
                } else {
                    const Subsegment& s = pieces[i - faces.size()];
                    for (const VertexId v : {s.a, s.b}) boxes[i].add(mesh_.point(v));
                    spheres[i].centre = 0.5 * (mesh_.point(s.a) + mesh_.point(s.b));
                    radius = distance(mesh_.point(s.a), mesh_.point(s.b)) / 2;
                }
                spheres[i].squared_radius = radius < kInfinity ? radius * radius : 0;
            }
        });
    }
    BoxTree tree(boxes, workers_);
    Boundary boundary{std::move(faces), pieces, std::move(boxes), std::move(spheres), std::move(tree), {}, 0};
    const double clearance = boundary.spheres.empty() ? kClearance : 1;
    for (const double radius : radius_) boundary.widest = std::max(boundary.widest, sizes_.varies() ? kInfinity : radius < kInfinity ? clearance * radius : 0);
    boundary.balls = boundary_.acute().boxes_of_balls();
    return boundary;
}

/// Boxes around all that must not come near a star of the lattice's: what is no seed, and the space in which a seed would encroach.
/// @param sample  what the boundary is going to be; null: it is that of the mesh
std::vector<Box> LatticeSeeder::occupied(const Boundary& boundary, double least_spacing, const BoundarySample* sample) const {
    std::vector<Box> out = boundary.boxes;
    out.insert(out.end(), boundary.balls.begin(), boundary.balls.end());
    workers_.for_ranges(boundary.faces.size(), kBoxGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t f = begin; f < end; ++f) {
            const auto& [a, b, c] = boundary.faces[f].corners;
            out[f] = space_of(a, b, c, least_spacing);
        }
    });
    for (std::size_t v = 0; v < mesh_.vertex_slots(); ++v) {
        const VertexInfo& info = mesh_.info(VertexId{v});
        if (info.carrier == CarrierKind::region && info.reason != InsertionReason::lattice) out.push_back({mesh_.point(VertexId{v}), mesh_.point(VertexId{v})});
    }
    // Subsegments without facets are on no face; and where sizes vary there are faces that no seed keeps away from, as no size is asked for beside them.
    const auto& segments = mesh_.plc().segments;
    const bool has_wires = std::any_of(segments.begin(), segments.end(), [](const auto& s) { return s.facets.empty(); });
    if (!has_wires && !sizes_.varies()) return out;
    const auto add_segment = [&](VertexId a, VertexId b) {
        Box box{mesh_.point(a), mesh_.point(a)};
        box.add(mesh_.point(b));
        out.push_back(box.grown(distance(mesh_.point(a), mesh_.point(b)) / 2));
    };
    if (sample != nullptr) {
        for (const Subsegment& s : sample->segments) add_segment(s.a, s.b);
        for (const Subface& s : sample->faces) out.push_back(space_of(s.corners[0], s.corners[1], s.corners[2], least_spacing));
        return out;
    }
    for (std::size_t i = 0; i < mesh_.tets().slots(); ++i) {
        const TetId t{i};
        if (!mesh_.has_labels(t) || !mesh_.tets().is_finite(t)) continue;
        const TetLabels& l = mesh_.labels(t);
        for (unsigned e = 0; e < 6; ++e)
            if (l.segments[e].valid()) add_segment(mesh_.tets().corner(t, kEdgeCorners[e][0]), mesh_.tets().corner(t, kEdgeCorners[e][1]));
        for (unsigned f = 0; f < 4; ++f) {
            if (!l.facets[f].valid()) continue;
            const auto c = mesh_.tets().face_corners(TetFace{t, f});
            out.push_back(space_of(c[0], c[1], c[2], least_spacing));
        }
    }
    return out;
}

/// Around a subface and the points that encroach upon it, but for those that a lattice constant keeps away anyhow. Not all of its equatorial sphere is
/// within that: what encroaches there encroaches also upon the subface that it projects onto, and is within the radius of that one.
Box LatticeSeeder::space_of(VertexId a, VertexId b, VertexId c, double least_spacing) const {
    Box box;
    for (const VertexId v : {a, b, c}) box.add(mesh_.point(v));
    double radius = 0;
    (void)circumcentre(mesh_.point(a), mesh_.point(b), mesh_.point(c), &radius);
    return radius > least_spacing && radius < kInfinity ? box.grown(radius) : box;  // a flat one has no sphere
}

/// Which seeds are in a cell that wants them, clear of the boundary, and in no ball about an acute vertex: balls give way one by one. Those that are
/// not clear wait no longer. @param cells  gets that of each
std::vector<char> LatticeSeeder::find_clear(const Boundary& boundary, std::span<Seed> seeds, std::vector<CellId>* cells) {
    // Neighbours along the curve are looked at together: most of them are far from the boundary, all at once.
    constexpr std::size_t kBlock = 32, kBlocks = 32;
    const BoxTree ball_tree(boundary.balls, workers_);
    std::vector<char> is_clear(seeds.size(), 0);
    if (cells != nullptr) cells->assign(seeds.size(), CellId{0});
    workers_.for_ranges(seeds.size(), kBlock * kBlocks, [&](std::size_t begin, std::size_t end, std::size_t) {
        TetId near{};
        std::vector<std::uint32_t> candidates;
        for (; begin < end; begin += kBlock) {
            const std::span<Seed> block = seeds.subspan(begin, std::min(kBlock, end - begin));
            find_clear_of(boundary, block, cells == nullptr ? std::span<CellId>{} : std::span(*cells).subspan(begin, block.size()), near, candidates);
            for (std::size_t k = 0; k < block.size(); ++k) {
                bool in_ball = false;
                if (block[k].waits)
                    ball_tree.query([&](const Box& b) { return !in_ball && b.squared_distance_to(block[k].point) <= 0; },
                                    [&](std::uint32_t) { in_ball = true; });
                is_clear[begin + k] = block[k].waits && !in_ball;
            }
        }
    });
    return is_clear;
}

/// Those that are not, or in no cell that wants them, wait no longer.
void LatticeSeeder::find_clear_of(const Boundary& boundary, std::span<Seed> block, std::span<CellId> cells, TetId& near,
                                  std::vector<std::uint32_t>& candidates) const {
    Box around;
    for (const Seed& s : block)
        if (s.waits) around.add(s.point);
    if (around.empty()) return;
    const auto radius_of = [&](const Vec3& p) {
        near = mesh_.triangulation().locate(p, near);
        return mesh_.tets().is_finite(near) && mesh_.in_domain(near) ? radius_at(p, mesh_.cell(near)) : kInfinity;
    };
    const auto list_candidates = [&](double reach) {
        candidates.clear();
        const Box reached = around.grown(reach * (1 + 1e-9));  // rounded up
        boundary.tree.query([&](const Box& b) { return b.meets(reached); }, [&](std::uint32_t i) { candidates.push_back(i); });
    };
    if (boundary.widest < kInfinity) {
        list_candidates(boundary.widest);
        if (candidates.empty()) {  // no face between them: all are in the same cell, or in cells that want none
            const bool wanted = radius_of(around.low) < kInfinity;
            std::fill(cells.begin(), cells.end(), mesh_.cell(near));
            for (Seed& s : block) s.waits = s.waits && wanted;
            return;
        }
    }
    std::vector<double> reach(block.size(), 0);
    for (std::size_t k = 0; k < block.size(); ++k) {
        if (!block[k].waits) continue;
        const double radius = radius_of(block[k].point);
        block[k].waits = radius < kInfinity;
        if (block[k].waits) reach[k] = kClearance * radius;
        if (!cells.empty()) cells[k] = mesh_.cell(near);
    }
    const bool has_spheres = !boundary.spheres.empty();
    // What is within the bound has its sphere within it; what is larger will be split anyhow.
    const double spheres_reach = has_spheres ? 1 / kClearance : 1;
    if (boundary.widest == kInfinity) list_candidates(spheres_reach * *std::max_element(reach.begin(), reach.end()));
    const auto is_clear = [&](const Vec3& p, double distance, std::uint32_t i) {
        if (has_spheres && squared_distance(boundary.spheres[i].centre, p) < boundary.spheres[i].squared_radius) return false;
        if (!(boundary.boxes[i].squared_distance_to(p) < distance * distance)) return true;
        if (i >= boundary.faces.size()) {
            const auto is_near = [&](VertexId v) { return squared_distance(mesh_.point(v), p) < distance * distance; };
            return has_spheres && !is_near(boundary.pieces[i - boundary.faces.size()].a) && !is_near(boundary.pieces[i - boundary.faces.size()].b);
        }
        const auto& [a, b, c] = boundary.faces[i].corners;
        return !(squared_distance_to_triangle(p, mesh_.point(a), mesh_.point(b), mesh_.point(c)) < distance * distance);
    };
    // A few of the block at once need look at a few of the candidates only.
    constexpr std::size_t kFew = 4;
    std::vector<std::uint32_t> near_these(candidates.size());
    for (std::size_t first = 0; first < block.size(); first += kFew) {
        const std::size_t end = std::min(first + kFew, block.size());
        Box few;
        double farthest = 0;
        for (std::size_t k = first; k < end; ++k) {
            if (!block[k].waits) continue;
            few.add(block[k].point);
            farthest = std::max(farthest, spheres_reach * reach[k]);
        }
        if (few.empty()) continue;
        few = few.grown(farthest * (1 + 1e-9));
        std::size_t count = 0;
        for (const std::uint32_t i : candidates) {
            near_these[count] = i;
            count += boundary.boxes[i].meets(few) ? 1U : 0U;
        }
        const std::span<const std::uint32_t> these(near_these.data(), count);
        for (std::size_t k = first; k < end; ++k)
            block[k].waits = block[k].waits && std::all_of(these.begin(), these.end(), [&](std::uint32_t i) { return is_clear(block[k].point, reach[k], i); });
    }
}

/// @param which  0: not in bulk; kKnown: gets a number only
bool LatticeSeeder::insert_in_bulk(std::span<Seed> seeds, const std::vector<char>& which) {
    std::vector<Vec3> points;
    std::vector<char> waits;
    std::vector<std::uint32_t> numbers;
    const auto count = seeds.size() - static_cast<std::size_t>(std::count(which.begin(), which.end(), 0));
    points.reserve(count);
    waits.reserve(count);
    numbers.reserve(count);
    for (std::size_t k = 0; k < seeds.size(); ++k) {
        if (which[k] == 0) continue;
        seeds[k].vertex = VertexId{mesh_.vertex_slots() + points.size()};
        points.push_back(seeds[k].point);
        waits.push_back(which[k] == kKnown);
        numbers.push_back(static_cast<std::uint32_t>(k));
    }
    return insert_in_bulk(seeds, numbers, [&](const Welcomes& is_welcome, const GoesOn& goes_on, std::vector<VertexId>& encroaching) {
        return mesh_.insert_inside(workers_, points, waits, InsertionReason::lattice, is_welcome, goes_on, encroaching);
    });
}

/// @param numbers  of the seeds, ascending by vertex  @param insert_all  calls insert_inside() of the mesh
template <class InsertAll>
bool LatticeSeeder::insert_in_bulk(std::span<Seed> seeds, std::span<const std::uint32_t> numbers, InsertAll&& insert_all) {
    const auto caller = std::this_thread::get_id();
    std::atomic<bool> stopped{false};
    const GoesOn goes_on = [&] {
        if (std::this_thread::get_id() == caller && !may_go_on(numbers.size())) stopped = true;
        return !stopped.load();
    };
    const Welcomes is_welcome = [this](const Vec3& p, CellId c) { return radius_at(p, c) < kInfinity; };
    const std::size_t before = mesh_.vertex_count();
    std::vector<VertexId> encroaching;
    tets_are_numbered_ = false;
    const std::vector<VertexId> left = insert_all(is_welcome, goes_on, encroaching);
    inserted_ += mesh_.vertex_count() - before;
    const auto seed_of = [&](VertexId v) -> Seed& {
        return seeds[*std::lower_bound(numbers.begin(), numbers.end(), v, [&](std::uint32_t k, VertexId w) { return seeds[k].vertex < w; })];
    };
    for (const std::uint32_t k : numbers) seeds[k].waits = false;
    for (const VertexId v : encroaching) seed_of(v).waits = true;
    TetId near{};
    for (const VertexId v : left) {
        if (stopped || !may_go_on(numbers.size())) return false;
        Seed& s = seed_of(v);
        const Outcome outcome = insert(s.point, near, s.vertex);
        s.waits = outcome == Outcome::encroaches;
        inserted_ += outcome == Outcome::inserted;
    }
    return !stopped;
}

/// Puts the lattice's tetrahedra where they are known. @param in_bulk  by seed: those that are kKnown were left for this
bool LatticeSeeder::fill(std::span<Seed> seeds, const std::vector<char>& in_bulk, LatticeFilling&& known) {
    std::optional<LatticeFilling> filling(std::move(known));
    std::vector<VertexId> vertex_of(seeds.size());
    std::vector<std::uint32_t> seed_of(seeds.size());
    std::vector<char> is_known = filling->far_points(seeds.size()), is_there(seeds.size());
    const auto is_inserted = [&](const Seed& s) { return s.vertex.valid() && mesh_.triangulation().is_inserted(s.vertex); };
    for (std::uint32_t k = 0; k < seeds.size(); ++k) {
        const std::uint32_t p = seeds[k].number;
        vertex_of[p] = seeds[k].vertex;
        seed_of[p] = k;
        is_there[p] = in_bulk[k] == kKnown || is_inserted(seeds[k]);
        is_known[p] = is_known[p] != 0 && is_there[p] != 0;
    }
    const auto insert_these = [&](std::vector<std::uint32_t> numbers) {
        std::sort(numbers.begin(), numbers.end(), [&](std::uint32_t a, std::uint32_t b) { return seeds[a].vertex < seeds[b].vertex; });
        std::vector<VertexId> vertices;
        for (const std::uint32_t k : numbers) vertices.push_back(seeds[k].vertex);
        return insert_in_bulk(seeds, numbers, [&](const Welcomes& is_welcome, const GoesOn& goes_on, std::vector<VertexId>& encroaching) {
            return mesh_.insert_inside(workers_, vertices, is_welcome, goes_on, encroaching);
        });
    };
    while (true) {
        const std::vector<std::uint32_t> lack = filling->short_of_neighbours(is_known, is_there);
        if (lack.empty()) break;
        std::vector<std::uint32_t> numbers;
        for (const std::uint32_t p : lack) {
            is_known[p] = 0;
            if (!is_inserted(seeds[seed_of[p]])) numbers.push_back(seed_of[p]);
        }
        if (!insert_these(numbers)) return false;
        for (const std::uint32_t k : numbers) is_there[seeds[k].number] = is_inserted(seeds[k]);
    }
    std::vector<VertexId> fresh;
    const auto is_fresh = [&](const Seed& s) { return is_known[s.number] != 0 && !is_inserted(s); };
    for (const Seed& s : seeds)
        if (is_fresh(s)) fresh.push_back(s.vertex);
    if (fresh.empty()) return true;
    if (!may_go_on(fresh.size())) return false;
    std::vector<std::uint32_t>().swap(seed_of);
    std::vector<char>().swap(is_there);
    return_freed_memory();
    // Numbers first, while there are few: known tetrahedra come after all others, or in the places of those that they replace.
    if (!tets_are_numbered_) mesh_.renumber_tets(workers_);
    if (!may_go_on(fresh.size())) return false;
    filling->know(is_known, vertex_of, mesh_.vertex_slots());
    const auto goes_on = [&] { return may_go_on(fresh.size()); };
    const bool may_all_be_there = filling->count() < KnownTets::kMost && guard_.has_room_for(kBytesATet * filling->count());
    if (may_all_be_there && mesh_.put_known_tets(workers_, *filling, fresh, goes_on)) {
        tets_are_numbered_ = true;
        inserted_ += fresh.size();
        known_ += fresh.size();
        return true;
    }
    filling.reset();
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t k = 0; k < seeds.size(); ++k)
        if (is_fresh(seeds[k])) numbers.push_back(k);
    return insert_these(std::move(numbers));
}

/// The vertex nearest to p is a corner of its cavity; the nearest subface need not be a face of it (p may lie beside an edge or a corner of the
/// boundary), so both are looked at. Beside an edge the distance may come out a little less: no corner is near there, and nothing is encroached.
bool LatticeSeeder::is_clear(const Vec3& p, double clearance) const {
    for (const TetId t : cavity_.tets) {
        for (const VertexId v : mesh_.tets().corners(t))
            if (v != kInfiniteVertex && mesh_.info(v).carrier != CarrierKind::region && squared_distance(p, mesh_.point(v)) < clearance * clearance)
                return false;
        if (!mesh_.has_labels(t)) continue;
        for (unsigned f = 0; f < 4; ++f) {
            if (!mesh_.labels(t).facets[f].valid()) continue;
            const auto fc = mesh_.tets().face_corners(TetFace{t, f});
            if (squared_distance_to_triangle(p, mesh_.point(fc[0]), mesh_.point(fc[1]), mesh_.point(fc[2])) < clearance * clearance) return false;
        }
    }
    return true;
}

/// @param vertex  one that is stored at p, to be inserted; invalid: a new one, which this becomes
LatticeSeeder::Outcome LatticeSeeder::insert(const Vec3& p, TetId& near, VertexId& vertex) {
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
    if (vertex.valid()) mesh_.insert_known(vertex, cavity_, where);
    else vertex = mesh_.insert(cavity_, where, {.reason = InsertionReason::lattice});
    near = tri.tet_of(vertex);
    return Outcome::inserted;
}

}  // namespace wellmesh
