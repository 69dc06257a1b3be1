// SPDX-License-Identifier: Apache-2.0
#include "adoption/adopt.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "adoption/carrier_finder.hpp"
#include "adoption/given_mesh.hpp"
#include "core/vec3_math.hpp"
#include "quality/tet_shape.hpp"
#include "validation/rounding.hpp"
#include "wellmesh/certificate.hpp"
#include "wellmesh/error.hpp"

namespace wellmesh {
namespace {

constexpr Stage kStage = Stage::delaunay;
constexpr std::uint32_t kBetweenCheckpoints = 1024;  // vertices
constexpr std::size_t kNamed = 20;  // offenders in one message

class Adopter {
public:
    Adopter(const TetMesh& mesh, const ValidPlc& plc, double tolerance, GivenMeshStatistics& statistics, const Checkpoint& checkpoint)
        : mesh_(mesh),
          plc_(plc),
          tolerance_(tolerance),
          statistics_(statistics),
          checkpoint_(checkpoint),
          given_(inspect_given_mesh(mesh)),
          finder_(plc, tolerance) {}

    ConformingMesh adopt() {
        find_carriers();
        refuse_strays();
        refuse_other_volume();
        number_vertices();
        ConformingMesh conforming(plc_, steiner_, checkpoint_);
        count_kept(conforming);
        return conforming;
    }

private:
    void find_carriers();
    void refuse_strays() const;
    void refuse_other_volume() const;
    void number_vertices();
    void count_kept(const ConformingMesh& conforming);
    [[nodiscard]] std::vector<ElementRef> hull_off_facets() const;
    [[nodiscard]] std::vector<ElementRef> missing_input() const;
    [[nodiscard]] bool in_box(const Vec3& p) const {
        return p.x >= low_.x && p.x <= high_.x && p.y >= low_.y && p.y <= high_.y && p.z >= low_.z && p.z <= high_.z;
    }

    const TetMesh& mesh_;
    const ValidPlc& plc_;
    double tolerance_;
    GivenMeshStatistics& statistics_;
    const Checkpoint& checkpoint_;
    GivenMesh given_;
    CarrierFinder finder_;
    Vec3 low_{}, high_{};
    std::vector<Carrier> carriers_;         // per vertex of the mesh
    std::vector<std::uint32_t> strays_;     // vertices of the mesh that can't be of this domain
    std::vector<CarriedPoint> steiner_;
    std::vector<std::uint32_t> number_;     // per vertex of the mesh: its number in the conforming mesh
    static constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
};

void Adopter::find_carriers() {
    bounding_box(plc_.vertices, low_, high_);
    carriers_.resize(mesh_.vertices.size());
    for (std::uint32_t v = 0; v < mesh_.vertices.size(); ++v) {
        if (!given_.used[v]) continue;
        if (v % kBetweenCheckpoints == 0) pass(checkpoint_);
        const Vec3 p = mesh_.vertices[v] + Vec3{0, 0, 0};  // minus zero becomes zero
        if (const auto carrier = finder_.find(p, given_.facet_reference[v], given_.segment_reference[v])) {
            carriers_[v] = *carrier;
            statistics_.farthest_vertex = std::max(statistics_.farthest_vertex, carrier->distance);
            statistics_.moved_onto_input += carrier->point != p;
        } else {
            carriers_[v] = {CarrierKind::region, 0, 0, p};
            if (given_.on_hull[v] || !in_box(p)) strays_.push_back(v);
        }
    }
}

void Adopter::refuse_strays() const {
    if (strays_.empty()) return;
    std::vector<ElementRef> offenders;
    for (std::size_t i = 0; i < std::min(kNamed, strays_.size()); ++i)
        offenders.push_back({EntityKind::vertex, strays_[i] + 1U, mesh_.vertices[strays_[i]]});
    throw MeshError(ErrorCode::bad_input, kStage,
                    fmt::format("the mesh is not one of this domain: {} of its boundary vertices lie on no facet; vertex {} is {:.4g} away from the "
                                "nearest, the tolerance is {:.4g}",
                                strays_.size(), strays_[0] + 1, finder_.distance_to_facets(mesh_.vertices[strays_[0]]), tolerance_),
                    offenders);
}

/// Faces of the hull that lie on no facet, by their first vertices.
std::vector<ElementRef> Adopter::hull_off_facets() const {
    std::vector<std::vector<FacetId>> of_input(plc_.vertices.size());
    for (std::size_t f = 0; f < plc_.facets.size(); ++f)
        for (const VertexId v : plc_.facets[f].vertices) of_input[v.index()].push_back(FacetId{f});
    const auto facets_at = [&](std::uint32_t v) {
        const Carrier& c = carriers_[v];
        if (c.kind == CarrierKind::input_vertex) return of_input[c.id];
        if (c.kind == CarrierKind::segment) return plc_.segments[c.id].facets;
        return c.kind == CarrierKind::facet ? std::vector<FacetId>{FacetId{c.id}} : std::vector<FacetId>{};
    };
    std::vector<ElementRef> found;
    for (const auto& face : given_.hull) {
        const std::vector<FacetId> second = facets_at(face[1]), third = facets_at(face[2]);
        const auto has = [](const std::vector<FacetId>& facets, FacetId f) { return std::find(facets.begin(), facets.end(), f) != facets.end(); };
        const std::vector<FacetId> first = facets_at(face[0]);
        if (std::any_of(first.begin(), first.end(), [&](FacetId f) { return has(second, f) && has(third, f); })) continue;
        found.push_back({EntityKind::vertex, face[0] + 1U, mesh_.vertices[face[0]]});
        if (found.size() == kNamed) break;
    }
    return found;
}

/// Input vertices that the mesh has none for.
std::vector<ElementRef> Adopter::missing_input() const {
    std::vector<char> present(plc_.vertices.size(), 0);
    for (std::size_t v = 0; v < carriers_.size(); ++v)
        if (given_.used[v] && carriers_[v].kind == CarrierKind::input_vertex) present[carriers_[v].id] = 1;
    std::vector<ElementRef> found;
    for (std::size_t v = 0; v < present.size() && found.size() < kNamed; ++v)
        if (!present[v]) found.push_back({EntityKind::vertex, plc_.source_vertex[v] + 1U, plc_.vertices[v]});
    return found;
}

/// Vertices on the boundary are off by the tolerance at most, so the volume is by that times the area (twice, as facets have tolerances, too).
void Adopter::refuse_other_volume() const {
    double wanted = 0, slack = std::numeric_limits<double>::epsilon() * static_cast<double>(mesh_.tets.size()) * given_.volume;
    for (const ValidCell& c : plc_.cells)
        if (c.filled) wanted += c.volume;
    for (const ValidFacet& f : plc_.facets)
        for (const auto& t : f.triangles) {
            const Vec3 &a = plc_.vertices[t[0].index()], &b = plc_.vertices[t[1].index()], &c = plc_.vertices[t[2].index()];
            slack += 2 * (tolerance_ + f.tolerance) * norm(cross(b - a, c - a)) / 2;
        }
    if (std::abs(given_.volume - wanted) <= slack || std::abs(std::abs(given_.signed_volume) - wanted) <= slack) return;
    std::vector<ElementRef> offenders = hull_off_facets();
    const char* where = "faces of its hull, at these vertices, lie on no facet";
    if (offenders.empty()) {
        offenders = missing_input();
        where = offenders.empty() ? "a region is missing, or tetrahedra overlap" : "these vertices of the domain are not in it";
    }
    throw MeshError(ErrorCode::bad_input, kStage,
                    fmt::format("the mesh does not fill this domain: its tetrahedra have a volume of {:.10g}, the domain has {:.10g}; {}",
                                given_.volume, wanted, where),
                    offenders);
}

/// Input vertices first, then the others in the mesh's order, each place once.
void Adopter::number_vertices() {
    const auto inputs = static_cast<std::uint32_t>(plc_.vertices.size());
    std::vector<std::uint32_t> order;
    number_.assign(mesh_.vertices.size(), kUnused);
    std::vector<char> present(inputs, 0);
    for (std::uint32_t v = 0; v < carriers_.size(); ++v) {
        if (!given_.used[v]) {
            ++statistics_.dropped_vertices;
        } else if (carriers_[v].kind == CarrierKind::input_vertex) {
            number_[v] = carriers_[v].id;
            if (present[carriers_[v].id]) ++statistics_.dropped_vertices;
            present[carriers_[v].id] = 1;
        } else {
            order.push_back(v);
        }
    }
    statistics_.added_input_vertices = static_cast<std::uint64_t>(std::count(present.begin(), present.end(), char{0}));
    // Moving vertices onto the input may have brought two to one place: the first one counts, and the input's own before all.
    std::vector<std::pair<Vec3, std::uint64_t>> places;
    for (const Vec3& p : plc_.vertices) places.push_back({p, 0});
    for (const std::uint32_t v : order) places.push_back({carriers_[v].point, std::uint64_t{v} + 1});
    std::sort(places.begin(), places.end(),
              [](const auto& a, const auto& b) { return a.first != b.first ? lexicographically_less(a.first, b.first) : a.second < b.second; });
    std::vector<char> repeats(mesh_.vertices.size(), 0);
    for (std::size_t i = 1; i < places.size(); ++i)
        if (places[i].first == places[i - 1].first) repeats[places[i].second - 1] = 1;
    for (const std::uint32_t v : order) {
        if (repeats[v]) {
            ++statistics_.dropped_vertices;
            continue;
        }
        number_[v] = inputs + static_cast<std::uint32_t>(steiner_.size());
        steiner_.push_back({carriers_[v].point, carriers_[v].kind, carriers_[v].id});
    }
    for (std::size_t v = 0; v < number_.size(); ++v) number_[v] = number_[given_.first_at_place[v]];
}

/// How many of the given tetrahedra the Delaunay triangulation of their vertices has as well.
void Adopter::count_kept(const ConformingMesh& conforming) {
    using Corners = std::array<std::uint32_t, 4>;
    std::vector<Corners> given, now;
    for (const auto& t : mesh_.tets) {
        Corners c{number_[t[0]], number_[t[1]], number_[t[2]], number_[t[3]]};
        std::sort(c.begin(), c.end());
        if (c[3] != kUnused) given.push_back(c);
    }
    const TetStore& tets = conforming.tets();
    for (std::size_t i = 0; i < tets.slots(); ++i) {
        if (!tets.is_finite(TetId{i})) continue;
        const auto& k = tets.corners(TetId{i});
        Corners c{k[0].value(), k[1].value(), k[2].value(), k[3].value()};
        std::sort(c.begin(), c.end());
        now.push_back(c);
    }
    std::sort(given.begin(), given.end());
    std::sort(now.begin(), now.end());
    std::vector<Corners> both;
    std::set_intersection(given.begin(), given.end(), now.begin(), now.end(), std::back_inserter(both));
    statistics_.vertices = mesh_.vertices.size();
    statistics_.tets = mesh_.tets.size();
    statistics_.delaunay_tets = both.size();
    for (const auto& t : mesh_.tets) {
        const Vec3 &a = mesh_.vertices[t[0]], &b = mesh_.vertices[t[1]], &c = mesh_.vertices[t[2]], &d = mesh_.vertices[t[3]];
        const double angle = std::max(min_dihedral_deg(a, b, c, d), min_dihedral_deg(b, a, c, d));  // either orientation
        statistics_.min_dihedral_angle_deg = std::min(statistics_.min_dihedral_angle_deg, angle);
    }
    statistics_.tolerance = tolerance_;
}

}  // namespace

double adoption_tolerance(const TetMesh& mesh, const Plc& plc) {
    Vec3 lo, hi;
    bounding_box(plc.vertices, lo, hi);
    Rounding rounding;
    rounding.relative = std::max(plc.relative_rounding, mesh.relative_rounding);
    for (const auto* points : {&plc.vertices, &mesh.vertices})
        for (const Vec3& p : *points)
            rounding.largest_coordinate = std::max({rounding.largest_coordinate, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return std::max(CertifyOptions{}.tolerance * distance(lo, hi), rounding.on_edge());
}

ConformingMesh adopt_mesh(const TetMesh& mesh, const ValidPlc& plc, double tolerance, GivenMeshStatistics& statistics, const Checkpoint& checkpoint) {
    return Adopter(mesh, plc, tolerance, statistics, checkpoint).adopt();
}

void settle_regions(ConformingMesh& mesh) {
    std::vector<ElementRef> outside;
    std::vector<TetId> star;
    for (std::size_t i = mesh.plc().vertices.size(); i < mesh.vertex_slots(); ++i) {
        const VertexId v{i};
        if (mesh.info(v).carrier != CarrierKind::region || !mesh.triangulation().is_inserted(v)) continue;
        mesh.triangulation().find_star(v, star);
        const auto finite = std::find_if(star.begin(), star.end(), [&](TetId t) { return mesh.tets().is_finite(t) && mesh.in_domain(t); });
        if (finite == star.end()) outside.push_back({EntityKind::vertex, 0, mesh.point(v)});
        else mesh.set_carrier_id(v, mesh.cell(*finite).value());
    }
    if (outside.empty()) return;
    const Vec3 p = *outside[0].where;
    throw MeshError(
        ErrorCode::bad_input, kStage,
        fmt::format("the mesh is not one of this domain: {} of its vertices lie outside, one at ({}, {}, {})", outside.size(), p.x, p.y, p.z), {});
}

}  // namespace wellmesh
