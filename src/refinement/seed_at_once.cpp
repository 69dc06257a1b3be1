// SPDX-License-Identifier: Apache-2.0
// Boundary and lattice in one go, where nothing asks for their order.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/infinity.hpp"
#include "core/resident_memory.hpp"
#include "core/shared_guard.hpp"
#include "core/vec3_math.hpp"
#include "delaunay/spatial_order.hpp"
#include "refinement/lattice_filling.hpp"
#include "refinement/lattice_seeding.hpp"

namespace wellmesh {
namespace {

/// Of all seeds, one in so many goes in where tetrahedra are known, too: across an empty space all are neighbours of all.
constexpr std::size_t kScaffold = 64;
/// Vertices that make the boundary whole, over those that it got at once: with more the mesh is worse than one made from coarse to fine.
constexpr double kMostMore = 0.07;
/// Of a ball about an acute vertex, over the greatest circumradius of tetrahedra there.
constexpr double kMostBall = 1.1;
/// Facets at this angle, in degrees, need no copies of each other's vertices.
constexpr double kNoTrouble = 40;
/// Vertices beside sharper ones, over all of the boundary: copies need their order, and refinement pays for what goes without.
constexpr double kMostAcute = 0.02;
constexpr std::size_t kFacesAPiece = std::size_t{1} << 12, kVerticesAPiece = std::size_t{1} << 13;

}  // namespace

/// All at once: boundary and lattice go in together, and the boundary is looked at when they are in. Facets that know nothing of each other may come too near
/// to each other, at acute angles and across gaps; where splitting them for that takes a lot of vertices it is better done from coarse to fine.
/// @return false, the mesh being as it was, if that is so
bool LatticeSeeder::seed_at_once(double base) {
    const std::vector<double> balls = boundary_.acute().balls();
    shrink_balls();
    std::optional<BoundarySample> sample;
    {
        SharedGuard guard(guard_, mesh_.vertex_count(), mesh_.tets().live());
        const auto radius = [&](const Vec3& p, CellId c) { return boundary_radius_at(p, c); };
        sample = sample_boundary(mesh_, boundary_.acute(), radius, sizes_.varies(), boundary_.seed(), workers_, guard);
    }
    if (!sample) return true;
    if (vertices_at_acute_segments() > kMostAcute * static_cast<double>(sample->points.size())) {
        boundary_.acute().set_balls(balls);
        return false;
    }
    std::optional<ConformingMesh> before(mesh_);
    number_points(*sample);
    std::vector<Face> faces = faces_of(*sample);
    std::optional<Lattice> lattice = find_lattice(base, faces);
    if (!lattice) return true;
    std::vector<Seed> seeds = seeds_of(lattice->points);
    std::vector<LatticePoint>().swap(lattice->points);
    std::vector<char> in_bulk;
    std::vector<CellId> cells;
    std::optional<LatticeFilling> filling;
    {
        std::vector<Subsegment> pieces = sample->segments;
        for (const VertexId v : mesh_.plc().isolated_vertices) pieces.push_back({v, v, SegmentId{}});
        const Boundary boundary = find_boundary(std::move(faces), pieces);
        in_bulk = find_clear(boundary, seeds, &cells);
        find_filling(*lattice, boundary, seeds, in_bulk, filling, &*sample);
    }
    return_freed_memory();
    if (!may_go_on(seeds.size())) return true;
    insert_at_once(*sample, seeds, in_bulk, cells);
    std::vector<CellId>().swap(cells);
    if (!make_whole(sample->points.size())) {
        mesh_ = std::move(*before);
        boundary_.forget_waiting();
        boundary_.acute().set_balls(balls);
        tets_are_numbered_ = false;
        return false;
    }
    before.reset();
    for (const Seed& s : seeds) inserted_ += s.vertex.valid() && mesh_.triangulation().is_inserted(s.vertex);
    sample.reset();
    if (!may_go_on(seeds.size()) || !insert_left(seeds, in_bulk)) return true;
    mesh_.pack_records(workers_);
    if (filling && !fill(seeds, in_bulk, std::move(*filling))) return true;
    std::vector<Seed>().swap(seeds);
    lattice.reset();
    return_freed_memory();
    if (!tets_are_numbered_) mesh_.renumber_tets(workers_);
    return true;
}

/// Recovers the boundary, conforms, and splits what is too large still. @param points  that it got at once  @return false, half way, if that takes too many more
bool LatticeSeeder::make_whole(std::size_t points) {
    const std::size_t most = mesh_.vertex_count() + static_cast<std::size_t>(kMostMore * static_cast<double>(points));
    try {
        if (!boundary_.recover_broken(workers_, most)) return false;
        tets_are_numbered_ = true;
        do {
            if (mesh_.vertex_count() > most && may_go_on(0)) return false;  // a run that is to end keeps what it has
        } while (boundary_.step());
        (void)split_boundary(1);
        return true;
    } catch (const MeshError& e) {
        if (e.code() != ErrorCode::budget_exhausted && e.code() != ErrorCode::unsupported_acute) throw;
        return false;
    }
}

/// Vertices at which facets that meet at an acute angle are nearer to each other than vertices of one of them.
double LatticeSeeder::vertices_at_acute_segments() const {
    double sum = 0;
    for (const AcuteFeature& f : mesh_.plc().acute_features) {
        if (f.kind != EntityKind::segment || f.angle_deg >= kNoTrouble) continue;
        const ValidSegment& s = mesh_.plc().segments[f.id];
        const Vec3 &a = mesh_.plc().vertices[s.ends[0].index()], &b = mesh_.plc().vertices[s.ends[1].index()];
        double radius = kInfinity;
        for (const FacetId facet : s.facets)
            for (const CellId c : mesh_.plc().facets[facet.index()].cells)
                if (mesh_.is_filled(c)) radius = std::min(radius, boundary_radius_at(0.5 * (a + b), c));
        sum += distance(a, b) / radius / std::sin(f.angle_deg / 2 * std::numbers::pi / 180);
    }
    return sum;
}

/// Of acute vertices, to what pieces of segments there are to be: splitting pieces in larger ones does that one by one.
void LatticeSeeder::shrink_balls() {
    AcuteGeometry& acute = boundary_.acute();
    for (std::size_t i = 0; i < acute.balls().size(); ++i) {
        const VertexId v{i};
        if (!(acute.ball_radius(v) > 0)) continue;
        double radius = kInfinity;
        for (const FacetId f : acute.facets_at(v))
            for (const CellId c : mesh_.plc().facets[f.index()].cells)
                if (mesh_.is_filled(c)) radius = std::min(radius, boundary_radius_at(mesh_.plc().vertices[i], c));
        while (acute.ball_radius(v) > kMostBall * radius) acute.halve_ball(v);
    }
}

/// Vertices along a curve in space.
void LatticeSeeder::number_points(BoundarySample& sample) {
    std::vector<Vec3> points;
    points.reserve(sample.points.size());
    for (const BoundarySample::Point& p : sample.points) points.push_back(p.at.point);
    const std::vector<std::uint32_t> order = biased_spatial_order(points, workers_);
    const std::size_t first = mesh_.add_vertices(order.size()).index();
    std::vector<VertexId> vertex_of(order.size());
    sample.vertices.resize(order.size());
    workers_.for_ranges(order.size(), kVerticesAPiece, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const BoundarySample::Point& p = sample.points[order[i]];
            vertex_of[order[i]] = sample.vertices[i] = VertexId{first + i};
            mesh_.set_new_vertex(sample.vertices[i], p.at, InsertionReason::boundary_by_size, p.ball);
        }
    });
    const auto rename = [&](VertexId& v) {
        if (v.index() >= first) v = vertex_of[v.index() - first];
    };
    workers_.for_ranges(sample.segments.size(), kFacesAPiece, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            rename(sample.segments[i].a);
            rename(sample.segments[i].b);
        }
    });
    workers_.for_ranges(sample.faces.size(), kFacesAPiece, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) std::for_each(sample.faces[i].corners.begin(), sample.faces[i].corners.end(), rename);
    });
}

/// As list_faces() does it of faces of the mesh.
std::vector<LatticeSeeder::Face> LatticeSeeder::faces_of(const BoundarySample& sample) const {
    std::vector<Face> out(sample.faces.size());
    workers_.for_ranges(out.size(), kFacesAPiece, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i) {
            const Subface& s = sample.faces[i];
            const Vec3 middle = (1.0 / 3) * (mesh_.point(s.corners[0]) + mesh_.point(s.corners[1]) + mesh_.point(s.corners[2]));
            out[i] = {s.corners, kInfinity};
            for (const CellId c : mesh_.plc().facets[s.facet.index()].cells)
                if (mesh_.is_filled(c)) out[i].spacing = std::min(out[i].spacing, spacing_at(middle, c));
        }
    });
    std::erase_if(out, [](const Face& f) { return f.spacing == kInfinity; });
    return out;
}

/// Together with what the boundary gets. What is labelled then is what was asked for, as far as it is there.
void LatticeSeeder::insert_at_once(const BoundarySample& sample, std::span<Seed> seeds, const std::vector<char>& which, std::span<const CellId> cells) {
    const std::size_t scaffold = seeds.size() / kScaffold, sampled = sample.vertices.size();
    const auto is_vertex = [&](std::size_t k) { return which[k] != 0; };
    const auto goes_in = [&](std::size_t k) { return which[k] != 0 && (which[k] != kKnown || k < scaffold); };
    // How many there are before each piece's own is known once all are counted.
    struct Counts {
        std::size_t vertices = 0, to_go_in = 0;
    };
    std::vector<Counts> before((seeds.size() + kVerticesAPiece - 1) / kVerticesAPiece);
    workers_.for_ranges(seeds.size(), kVerticesAPiece, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (std::size_t k = begin; k < end; ++k) {
            before[piece].vertices += is_vertex(k);
            before[piece].to_go_in += goes_in(k);
        }
    });
    Counts all{0, sampled};
    for (Counts& c : before) c = {std::exchange(all.vertices, all.vertices + c.vertices), std::exchange(all.to_go_in, all.to_go_in + c.to_go_in)};
    const std::size_t first = mesh_.add_vertices(all.vertices).index();
    std::vector<std::uint32_t> vertices(all.to_go_in);  // to go in
    std::vector<Vec3> points(all.to_go_in);
    const auto let_in = [&](std::size_t at, VertexId v) {
        vertices[at] = v.value();
        points[at] = mesh_.point(v);
    };
    for (std::size_t i = 0; i < sampled; ++i) let_in(i, sample.vertices[i]);
    workers_.for_ranges(seeds.size(), kVerticesAPiece, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        Counts next = before[piece];
        for (std::size_t k = begin; k < end; ++k) {
            seeds[k].waits = which[k] == 0 && seeds[k].waits != 0;
            if (!is_vertex(k)) continue;
            seeds[k].vertex = VertexId{first + next.vertices++};
            mesh_.set_new_vertex(seeds[k].vertex, {seeds[k].point, CarrierKind::region, cells[k].value()}, InsertionReason::lattice);
            if (goes_in(k)) let_in(next.to_go_in++, seeds[k].vertex);
        }
    });
    std::vector<std::uint32_t> order = biased_spatial_order(points, workers_);
    for (std::uint32_t& k : order) k = vertices[k];
    mesh_.insert_at_once(workers_, order);
    mesh_.relabel(workers_, sample.segments, sample.faces);
}

}  // namespace wellmesh
