// SPDX-License-Identifier: Apache-2.0
// Which lattice: the boundary as fine as it wants it, and the octree that follows the size.
#include "refinement/lattice_seeding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "core/infinity.hpp"
#include "core/resident_memory.hpp"
#include "core/rng.hpp"
#include "core/shared_guard.hpp"
#include "core/vec3_math.hpp"
#include "delaunay/zones.hpp"

namespace wellmesh {
namespace {

/// Volume over surface, in lattice constants, from which on a cell is seeded: a plate two layers thick, a cube of six. In thinner ones the gap
/// between lattice and boundary costs as many vertices as the lattice saves.
constexpr double kLeastThickness = 1;
/// Twice volume over surface, a plate's thickness, in circumradius bounds, from which on both sides can be as fine as that and know nothing of each other.
constexpr double kLeastGap = 1.2;
/// Least part of the spacing allowed at which leaves are worth it where the size varies: the lattice has 0.349 vertices a cubed radius of its own,
/// refinement makes 0.75 of the bound's, and (0.349 / 0.75)^(1/3) / kLatticeScale = 0.82.
constexpr double kLeastUse = 0.82;
/// Ratios of spacings modulo 2 are told apart to a part of 2^(1/64) - 1, one per cent.
constexpr std::size_t kPhases = 64;
constexpr std::size_t kGrain = std::size_t{1} << 14;
/// Of a mesh while its vertices go in at once: six or seven tetrahedra, and what is known of each. And how many there can be.
constexpr double kBytesAVertex = 500, kMostVertices = 4e9;

}  // namespace

/// Lists what is to be looked at in the next round, besides what was too large: what is new.
class LatticeSeeder::Listening {
public:
    Listening(const ConformingMesh& mesh, BoundaryRefiner& boundary, std::vector<TetId>& waiting)
        : hook_(boundary.on_insert), before_(std::exchange(hook_, [&](VertexId) {
              for (const TetId t : mesh.triangulation().new_tets())
                  if (mesh.has_labels(t)) waiting.push_back(t);
          })) {}
    ~Listening() { hook_.swap(before_); }
    Listening(const Listening&) = delete;
    Listening& operator=(const Listening&) = delete;

private:
    std::function<void(VertexId)>& hook_;
    std::function<void(VertexId)> before_;
};

LatticeSeeder::LatticeSeeder(ConformingMesh& view, BoundaryRefiner& boundary, const LatticeSeeder& whole)
    : mesh_(view),
      boundary_(boundary),
      guard_(whole.guard_),
      sizes_(whole.sizes_),
      workers_(whole.workers_),
      radius_(whole.radius_),
      spacing_(whole.spacing_),
      boundary_radius_(whole.boundary_radius_),
      is_thin_(whole.is_thin_),
      is_sampled_(whole.is_sampled_) {}

LatticeSeeder::LatticeSeeder(ConformingMesh& mesh, BoundaryRefiner& boundary, RunGuard& guard, const SizeField& sizes, Workers& workers)
    : mesh_(mesh),
      boundary_(boundary),
      guard_(guard),
      sizes_(sizes),
      workers_(workers),
      radius_(mesh.plc().cells.size(), kInfinity),
      spacing_(radius_.size(), kInfinity),
      boundary_radius_(radius_.size(), kInfinity),
      is_thin_(radius_.size(), 0),
      is_sampled_(radius_.size(), 0) {
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
        is_sampled_[c] = is_thin_[c] == 0 || 2 * mesh.plc().cells[c].volume >= kLeastGap * finest * surface[c];
        boundary_radius_[c] = radius_[c];
        if (is_thin_[c] != 0) radius_[c] = spacing_[c] = kInfinity;
    }
}

double LatticeSeeder::radius_at(const Vec3& p, CellId c) const {
    if (!sizes_.varies()) return radius_[c.index()];
    return is_thin_[c.index()] != 0 ? kInfinity : std::min(radius_[c.index()], kCircumradiusPerEdgeLength * sizes_.edge_length(p, c));
}

double LatticeSeeder::boundary_radius_at(const Vec3& p, CellId c) const {
    if (is_sampled_[c.index()] == 0) return kInfinity;
    const double most = boundary_radius_[c.index()];
    return sizes_.varies() ? std::min(most, kCircumradiusPerEdgeLength * sizes_.edge_length(p, c)) : most;
}

double LatticeSeeder::spacing_at(const Vec3& p, CellId c) const {
    return sizes_.varies() ? kLatticeScale * radius_at(p, c) / kLatticeCircumradius : spacing_[c.index()];
}

double LatticeSeeder::radius_bound(TetId t, const Vec3& p) const {
    return mesh_.tets().is_finite(t) && mesh_.in_domain(t) ? radius_at(p, mesh_.cell(t)) : kInfinity;
}

/// Subsegments and subfaces of a tetrahedron that none within `coarseness` times its bound could have. @return whether there are any
bool LatticeSeeder::list_too_large(TetId t, double coarseness, std::vector<Subsegment>& segments, std::vector<Subface>& faces) const {
    const TetStore& tets = mesh_.tets();
    if (!mesh_.has_labels(t) || !tets.is_finite(t)) return false;  // nearly all have none: few of them need be fetched
    const double bound = sizes_.varies() ? 0 : coarseness * radius_bound(t, {});
    if (bound == kInfinity) return false;
    const auto is_beyond = [&](double squared_radius, const Vec3& p) {
        const double most = sizes_.varies() ? coarseness * radius_bound(t, p) : bound;
        return squared_radius > most * most;
    };
    const TetLabels& l = mesh_.labels(t);
    const auto& c = tets.corners(t);
    const std::size_t before = segments.size() + faces.size();
    for (unsigned e = 0; e < 6; ++e) {
        const VertexId a = c[kEdgeCorners[e][0]], b = c[kEdgeCorners[e][1]];
        if (!l.segments[e].valid()) continue;
        const Vec3 &p = mesh_.point(a), &q = mesh_.point(b);
        if (is_beyond(squared_distance(p, q) / 4, 0.5 * (p + q))) segments.push_back({std::min(a, b), std::max(a, b), l.segments[e]});
    }
    for (unsigned f = 0; f < 4; ++f) {
        if (!l.facets[f].valid()) continue;
        const auto fc = tets.face_corners(TetFace{t, f});
        const Vec3 &p = mesh_.point(fc[0]), &q = mesh_.point(fc[1]), &r = mesh_.point(fc[2]);
        const double squared_double_area = squared_norm(cross(q - p, r - p));
        const double squared_radius = squared_distance(p, q) * squared_distance(q, r) / (4 * squared_double_area) * squared_distance(r, p);
        if (is_beyond(squared_radius, (1.0 / 3) * (p + q + r))) faces.push_back({fc, l.facets[f], t});
    }
    return segments.size() + faces.size() > before;
}

/// The same of some; `which` gets those that have any.
void LatticeSeeder::list_too_large(std::vector<TetId> of, double coarseness, std::vector<TetId>& which, std::vector<Subsegment>& segments,
                                   std::vector<Subface>& faces) const {
    std::sort(of.begin(), of.end());
    of.erase(std::unique(of.begin(), of.end()), of.end());
    for (const TetId t : of)
        if (list_too_large(t, coarseness, segments, faces)) which.push_back(t);
}

/// The same of all tetrahedra; `which` gets those that have any.
void LatticeSeeder::list_all_too_large(double coarseness, std::vector<TetId>& which, std::vector<Subsegment>& segments,
                                       std::vector<Subface>& faces) const {
    struct Found {
        std::vector<TetId> which;
        std::vector<Subsegment> segments;
        std::vector<Subface> faces;
    };
    const std::size_t slots = mesh_.tets().slots();
    std::vector<Found> found((slots + kGrain - 1) / kGrain);
    workers_.for_ranges(slots, kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        Found& here = found[piece];
        for (std::size_t i = begin; i < end; ++i)
            if (list_too_large(TetId{i}, coarseness, here.segments, here.faces)) here.which.emplace_back(i);
    });
    for (const Found& f : found) {
        which.insert(which.end(), f.which.begin(), f.which.end());
        segments.insert(segments.end(), f.segments.begin(), f.segments.end());
        faces.insert(faces.end(), f.faces.begin(), f.faces.end());
    }
}

/// What is too large and all of this zone's: outlines first, then facets, until nothing more can be split here.
void LatticeSeeder::split_in_zone(double coarseness, std::vector<TetId> waiting, const std::function<bool(std::size_t)>& may_go_on) {
    const Listening listening(mesh_, boundary_, waiting);
    Triangulation& tri = mesh_.triangulation();
    const SplitRequest request{InsertionReason::boundary_by_size, VertexId{}};
    std::vector<Subsegment> segments;
    std::vector<Subface> faces;
    std::vector<TetId> with_faces;
    std::unordered_set<std::uint64_t> left;  // what left the zone is not tried again; each is looked up, in no order
    const auto may_try = [&](std::uint64_t key) {
        tri.forget_leaving();
        return !left.contains(key);
    };
    boundary_.conform_in_zone(may_go_on);
    for (const bool outlines_are_done : {false, true}) {
        if (outlines_are_done) waiting = std::move(with_faces);
        while (!waiting.empty()) {
            std::vector<TetId> too_large;
            segments.clear();
            faces.clear();
            list_too_large(std::exchange(waiting, {}), coarseness, too_large, segments, faces);
            if (!outlines_are_done) with_faces.insert(with_faces.end(), too_large.begin(), too_large.end());
            for (const Subsegment& s : segments) {
                if (!may_go_on(segments.size())) return;
                const std::uint64_t key = mix64(s.a.value(), s.b.value());
                if (!may_try(key)) continue;
                if (mesh_.find_subsegment(s).valid()) (void)boundary_.split(s, request);
                if (tri.left_zone()) left.insert(key);
            }
            boundary_.conform_in_zone(may_go_on);
            if (!outlines_are_done) continue;
            for (const Subface& s : faces) {
                if (!may_go_on(faces.size())) return;
                std::array<VertexId, 3> c = s.corners;
                std::sort(c.begin(), c.end());
                const std::uint64_t key = mix64(c[0].value(), mix64(c[1].value(), c[2].value()));
                if (!may_try(key)) continue;
                const BoundaryRefiner::SplitOutcome outcome = boundary_.split(s, request);
                if (tri.left_zone()) left.insert(key);
                boundary_.conform_in_zone(may_go_on);
                // A subsegment was split instead, so it waits, unless that took it away.
                tri.forget_leaving();
                if (outcome != BoundaryRefiner::SplitOutcome::deferred) continue;
                if (const TetFace face = mesh_.find_subface(s); face.valid()) waiting.push_back(face.tet());
            }
        }
    }
}

bool LatticeSeeder::split_boundary_in_zones(double coarseness) {
    constexpr std::size_t kLeastAZone = 256, kSampleAZone = 512;
    // A cut meets few tetrahedra of the boundary: on its way from coarse to fine even a small mesh is worth two zones.
    constexpr std::size_t kLeastTets = 4096;
    // Each subsegment is listed by several tetrahedra, and each vertex makes two faces more: half a vertex per entry is measured at most. One takes
    // seven tetrahedra, or less. Who finds no room waits for the next turn.
    constexpr std::size_t kTetsPerVertex = 8, kMoreVertices = 64;
    // What waits twice lies where nearly all tetrahedra are cut: to try it once more takes longer than to split it.
    constexpr unsigned kTurns = 2;
    for (unsigned turn = 0; turn < kTurns && boundary_.may_work_in_zones() && !guard_.limits_vertices(); ++turn) {
        std::vector<TetId> waiting;
        std::vector<Subsegment> segments;
        std::vector<Subface> faces;
        list_all_too_large(coarseness, waiting, segments, faces);
        const std::size_t work = segments.size() + faces.size(), count = Zones::worth(mesh_.tets().live(), work, kLeastAZone, turn, kLeastTets);
        if (count < 2) break;
        std::vector<Vec3> sample;
        const std::size_t step = std::max<std::size_t>(1, waiting.size() / (kSampleAZone * count));
        for (std::size_t k = 0; k < waiting.size(); k += step) sample.push_back(mesh_.point(mesh_.tets().corner(waiting[k], 0)));
        const std::size_t vertices = work / count + kMoreVertices;
        const ConformingMesh::ZoneRoom room{.tets = kTetsPerVertex * vertices, .vertices = vertices, .records = kTetsPerVertex * vertices};
        ZoneViews parts;
        std::vector<ConformingMesh> views = mesh_.split(workers_, Zones(std::move(sample), count, turn), room, parts);
        std::vector<std::vector<TetId>> shares(count);
        for (const TetId t : waiting)
            if (const std::uint8_t zone = parts.zone_of_tet[t.index()]; zone != ZoneViews::kNone) shares[zone].push_back(t);
        std::deque<BoundaryRefiner> boundaries;
        for (std::size_t z = 0; z < count; ++z) boundaries.emplace_back(views[z], boundary_, parts, static_cast<std::uint8_t>(z));
        SharedGuard guard(guard_, mesh_.vertex_count(), mesh_.tets().live());
        workers_.for_each(count, [&](std::size_t z) {
            guard.watch([&] {
                LatticeSeeder(views[z], boundaries[z], *this).split_in_zone(coarseness, std::move(shares[z]), [&](std::size_t left) {
                    return guard.may_go_on(left);
                });
            });
        });
        mesh_.join(views);
        for (const BoundaryRefiner& b : boundaries) boundary_.join(b);
        if (guard.verdict() != RunGuard::Verdict::go_on) break;
    }
    boundary_.conform();
    return may_go_on(0);
}

bool LatticeSeeder::split_boundary(double coarseness) {
    left_at_last_ = 0;
    keep_last();
    bool goes_on = split_down_to(coarseness);
    if (last_ && guard_.has_too_many(mesh_.vertex_count())) {
        last_->go_back();
        boundary_.forget_waiting();
        goes_on = false;
    }
    last_.reset();
    return goes_on;
}

/// As refinement does (Refiner::keep_last): a cascade may take more vertices than are left. @pre the mesh conforms
void LatticeSeeder::keep_last() {
    const auto left = guard_.vertices_left(mesh_.vertex_count());
    if (!left || *left == 0 || (last_ && *left > left_at_last_ / 2) || !guard_.can_double()) return;
    last_.reset();  // savepoints end in the opposite order of their beginning
    last_.emplace(mesh_);
    left_at_last_ = *left;
}

/// Circumspheres of tetrahedra at a subsegment or subface are at least as large as its own: splitting it is never in vain.
bool LatticeSeeder::split_down_to(double coarseness) {
    if (!split_boundary_in_zones(coarseness)) return false;
    std::vector<TetId> waiting;
    const Listening listening(mesh_, boundary_, waiting);
    std::vector<Subsegment> segments;
    std::vector<Subface> faces;
    const SplitRequest request{InsertionReason::boundary_by_size, VertexId{}};
    for (bool looks_at_all = true;;) {
        const std::size_t vertices_before = mesh_.vertex_count();
        segments.clear();
        faces.clear();
        std::vector<TetId> looked_at = std::exchange(waiting, {});
        if (looks_at_all) {
            list_all_too_large(coarseness, waiting, segments, faces);
        } else {
            list_too_large(std::move(looked_at), coarseness, waiting, segments, faces);
        }
        for (const Subsegment& s : segments) {
            if (!may_go_on(segments.size())) break;
            if (mesh_.find_subsegment(s).valid()) boundary_.split(s, request);
        }
        boundary_.conform();
        if (!may_go_on(faces.size())) return false;
        keep_last();
        if (segments.empty())  // facets once their outlines are done
            for (const Subface& s : faces) {
                if (!may_go_on(faces.size())) return false;
                boundary_.split(s, request);
                boundary_.conform();
                keep_last();
            }
        const bool has_split = mesh_.vertex_count() > vertices_before;
        if (!has_split && looks_at_all) return true;  // what rounding keeps from being split is left to refinement
        looks_at_all = !has_split;
    }
}

std::vector<LatticeSeeder::Face> LatticeSeeder::list_faces() const {
    const TetStore& tets = mesh_.tets();
    const auto list = [&](TetId t, std::vector<Face>& out) {
        if (!mesh_.has_labels(t) || !tets.is_finite(t) || !mesh_.in_domain(t)) return;
        for (unsigned f = 0; f < 4; ++f) {
            if (!mesh_.labels(t).facets[f].valid()) continue;
            const auto fc = tets.face_corners(TetFace{t, f});
            const Vec3 &a = mesh_.point(fc[0]), &b = mesh_.point(fc[1]), &c = mesh_.point(fc[2]);
            const double spacing = spacing_at((1.0 / 3) * (a + b + c), mesh_.cell(t));
            if (spacing == kInfinity) continue;
            out.push_back({fc, spacing});
        }
    };
    const std::size_t slots = tets.slots();
    std::vector<std::vector<Face>> found((slots + kGrain - 1) / kGrain);
    workers_.for_ranges(slots, kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (std::size_t i = begin; i < end; ++i) list(TetId{i}, found[piece]);
    });
    std::vector<Face> out;
    for (const std::vector<Face>& piece : found) out.insert(out.end(), piece.begin(), piece.end());
    return out;
}

std::vector<Box> LatticeSeeder::boxes_of(const std::vector<Face>& faces) const {
    std::vector<Box> boxes(faces.size());
    workers_.for_ranges(faces.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t f = begin; f < end; ++f)
            for (const VertexId v : faces[f].corners) boxes[f].add(mesh_.point(v));
    });
    return boxes;
}

/// Splits until leaves are no larger than the lattice constants of the cells that they meet.
class LatticeSeeder::OctreeBuilder {
public:
    OctreeBuilder(LatticeSeeder& seeder, GradedOctree& tree, std::vector<Face> faces)
        : seeder_(seeder), tree_(tree), faces_(std::move(faces)), boxes_(seeder.boxes_of(faces_)),
          guard_(seeder.guard_, seeder.mesh_.vertex_count(), seeder.mesh_.tets().live()) {}

    /// The first few levels, then what is below on all workers. @return false: stopped
    bool run() {
        std::vector<std::uint32_t> all(faces_.size());
        std::iota(all.begin(), all.end(), 0U);
        std::vector<Part> parts;
        build(tree_, 0, all, TetId{}, &parts);
        std::vector<GradedOctree::Branch> branches;
        for (const Part& part : parts) branches.push_back({part.node, tree_.branch(part.node)});
        seeder_.workers_.for_each(parts.size(), [&](std::size_t i) { build(branches[i].tree, 0, parts[i].faces, parts[i].near, nullptr); });
        tree_ = tree_.with(branches);
        return guard_.verdict() == RunGuard::Verdict::go_on;
    }

private:
    static constexpr unsigned kPartDepth = 2;
    struct Part {
        std::uint32_t node;
        std::vector<std::uint32_t> faces;
        TetId near;
    };

    /// @param faces  that meet the node's parent  @param near  where a search for the node's centre is to begin
    /// @param parts  gets the nodes of kPartDepth, which are left as they are; null: nothing is left
    void build(GradedOctree& tree, std::uint32_t node, const std::vector<std::uint32_t>& faces, TetId near, std::vector<Part>* parts) {
        if (!guard_.may_go_on(0)) return;
        if (parts != nullptr && tree.depth(node) == kPartDepth) {
            parts->push_back({node, faces, near});
            return;
        }
        const ConformingMesh& mesh = seeder_.mesh_;
        const GradedOctree::Box box = tree.box(node);
        const Vec3 hi{box.lo.x + box.side, box.lo.y + box.side, box.lo.z + box.side};
        std::vector<std::uint32_t> here;
        double spacing = kInfinity;
        for (const std::uint32_t f : faces) {
            const auto& [low, high] = boxes_[f];
            if (low.x > hi.x || low.y > hi.y || low.z > hi.z || high.x < box.lo.x || high.y < box.lo.y || high.z < box.lo.z) continue;
            here.push_back(f);
            spacing = std::min(spacing, faces_[f].spacing);
        }
        const TetId at_centre = mesh.triangulation().locate(0.5 * (box.lo + hi), near);
        const double inside =
            mesh.tets().is_finite(at_centre) && mesh.in_domain(at_centre) ? seeder_.spacing_at(0.5 * (box.lo + hi), mesh.cell(at_centre)) : kInfinity;
        spacing = std::min(spacing, inside);
        if (spacing == kInfinity) return;
        if (box.side <= spacing * (1 + 1e-9) || tree.depth(node) == GradedOctree::kMaxDepth) {
            if (!seeder_.sizes_.varies() || box.side >= kLeastUse * (inside < kInfinity ? inside : spacing)) tree.use(node);
            return;
        }
        const std::uint32_t first = tree.split(node);
        for (std::uint32_t k = 0; k < 8; ++k) build(tree, first + k, here, at_centre, parts);
    }

    LatticeSeeder& seeder_;
    GradedOctree& tree_;
    std::vector<Face> faces_;
    std::vector<Box> boxes_;  // of them
    SharedGuard guard_;
};

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

/// Where nobody keeps account of the order, and nothing is to end it half way: a limit on vertices, or on memory that may not be enough.
bool LatticeSeeder::may_seed_at_once() const {
    if (!boundary_.may_work_in_zones() || guard_.limits_vertices() || mesh_.savepoints() > 0) return false;
    return guard_.has_room_for(static_cast<std::uint64_t>(kBytesAVertex * std::min(sizes_.expected_vertices(), kMostVertices)));
}

std::uint64_t LatticeSeeder::seed() {
    const double base = most_used_spacing();
    if (base == kInfinity) return 0;
    went_at_once_ = may_seed_at_once() && seed_at_once(base);
    if (went_at_once_) return inserted_;
    // From coarse to fine: vertices on an empty domain's boundary would all be neighbours of each other.
    constexpr double kCoarsest = 8;
    if (!split_boundary(kCoarsest)) return 0;
    std::optional<Lattice> lattice = find_lattice(base, list_faces());
    if (!lattice) return 0;
    std::vector<Seed> seeds = seeds_of(lattice->points);
    std::vector<LatticePoint>().swap(lattice->points);
    for (double coarseness = kCoarsest; coarseness >= 1; coarseness /= 2) {
        if (!split_boundary(coarseness)) break;
        mesh_.pack_records(workers_);
        // As many as the coarse mesh would have.
        const auto share = static_cast<std::size_t>(static_cast<double>(seeds.size()) / (coarseness * coarseness * coarseness));
        const bool is_last = coarseness == 1;
        const bool goes_on = insert_seeds({seeds.data(), share}, is_last ? &*lattice : nullptr);
        if (is_last) {  // memory is short while tetrahedra are numbered
            std::vector<Seed>().swap(seeds);
            lattice.reset();
        }
        return_freed_memory();
        if (!tets_are_numbered_) mesh_.renumber_tets(workers_);  // what comes next goes by ids
        if (!goes_on) break;
    }
    return inserted_;
}

std::optional<LatticeSeeder::Lattice> LatticeSeeder::find_lattice(double base, std::vector<Face> faces) {
    Vec3 lo, hi;
    bounding_box(mesh_.plc().vertices, lo, hi);
    const double extent = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
    double side = base;
    while (side < extent) side *= 2;
    std::optional<Lattice> out(Lattice{GradedOctree(0.5 * (lo + hi) - 0.5 * Vec3{side, side, side}, side), {}, {}});
    GradedOctree& tree = *out->tree;
    if (!OctreeBuilder(*this, tree, std::move(faces)).run()) return {};
    tree.balance(workers_);
    out->points = tree.lattice(workers_, out->leaves);
    return out;
}

}  // namespace wellmesh
