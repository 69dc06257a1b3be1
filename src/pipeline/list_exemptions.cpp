// SPDX-License-Identifier: Apache-2.0
#include "pipeline/list_exemptions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "quality/shape_lanes.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh {
namespace {

constexpr double kGapAngle = 0;  // the sides of a gap do not meet

/// The feature of the input that carries a vertex on the boundary, in the source's numbers.
ElementRef feature_of(const ConformingMesh& mesh, VertexId v, std::uint32_t first_number) {
    const VertexInfo& i = mesh.info(v);
    const ValidPlc& plc = mesh.plc();
    if (i.carrier == CarrierKind::input_vertex) return {EntityKind::vertex, plc.source_vertex[i.carrier_id] + first_number, mesh.point(v)};
    if (i.carrier == CarrierKind::segment) return {EntityKind::segment, i.carrier_id + 1U, mesh.point(v)};
    return {EntityKind::facet, plc.facets[i.carrier_id].source_facet + 1U, mesh.point(v)};
}

std::array<std::uint32_t, 4> sorted(std::array<std::uint32_t, 4> corners) {
    std::sort(corners.begin(), corners.end());
    return corners;
}

/// Tells of most tetrahedra that meet the bounds, several at once and without trigonometry.
class GoodTets {
public:
    GoodTets(const ConformingMesh& mesh, double max_radius_edge, double min_dihedral_deg)
        : mesh_(mesh),
          squared_radius_edge_(max_radius_edge * max_radius_edge * (1 - kLaneSlack)),
          signed_squared_cosine_(signed_square(min_dihedral_deg > 0 ? std::cos(min_dihedral_deg * (std::numbers::pi / 180)) : 2) - kLaneSlack) {}

    /// Calls use(place, tetrahedron) for those of which it can't tell, by and by.
    template <class Use>
    void add(std::size_t place, TetId t, Use&& use) {
        const auto& c = mesh_.tets().corners(t);
        batch_.add({place, t}, mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]), telling(use));
    }
    template <class Use>
    void finish(Use&& use) {
        batch_.finish(telling(use));
    }

private:
    static double signed_square(double x) { return x * std::abs(x); }
    template <class Use>
    [[nodiscard]] auto telling(Use& use) const {
        return [this, &use](const Placed& p, const SquaredShapes& shapes, std::size_t lane) {
            const bool is_good = may_trust(shapes, lane) && shapes.six_volumes[lane] > 0 && shapes.radius_edge[lane] < squared_radius_edge_ &&
                                 shapes.largest_cosine[lane] < signed_squared_cosine_;
            if (!is_good) use(p.place, p.tet);
        };
    }

    struct Placed {
        std::size_t place = 0;
        TetId tet{};
    };
    const ConformingMesh& mesh_;
    double squared_radius_edge_, signed_squared_cosine_;
    ShapeBatch<Placed> batch_;
};

}  // namespace

std::vector<Exemption> list_exemptions(const ConformingMesh& mesh, std::span<const TetId> order, Refiner& refiner, const MeshOptions& options,
                                       std::uint32_t first_number, Workers& workers) {
    std::vector<Exemption> out;
    const ValidPlc& plc = mesh.plc();
    if (!refiner.may_excuse()) return out;
    const QualityGoals& goals = options.quality;
    const double angle = std::max(goals.min_dihedral_angle_deg, goals.min_dihedral_boundary_deg.value_or(0));
    // Who forces them is found by searching the mesh: not by several threads at once. It matters to few.
    constexpr std::size_t kTetsAPiece = std::size_t{1} << 13;
    std::vector<std::vector<std::size_t>> missing((order.size() + kTetsAPiece - 1) / kTetsAPiece);
    workers.for_ranges(order.size(), kTetsAPiece, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        GoodTets good(mesh, goals.max_radius_edge_ratio, angle);
        const auto look = [&](std::size_t place, TetId t) {
            const auto& c = mesh.tets().corners(t);
            const TetShape shape = shape_of(mesh.point(c[0]), mesh.point(c[1]), mesh.point(c[2]), mesh.point(c[3]));
            if (!(shape.radius_edge <= goals.max_radius_edge_ratio && (angle <= 0 || shape.min_dihedral_deg >= angle))) missing[piece].push_back(place);
        };
        for (std::size_t i = begin; i < end; ++i)
            if (Refiner::may_be_excused(mesh, order[i])) good.add(i, order[i], look);
        good.finish(look);
    });
    for (const std::vector<std::size_t>& piece : missing)
        for (const std::size_t i : piece) {
            const auto by = refiner.forced_by(order[i]);
            if (!by) {
                if (const auto sides = refiner.gaps().sides_joined_by(mesh, order[i])) out.push_back({i, feature_of(mesh, (*sides)[0], first_number), kGapAngle});
                continue;
            }
            const bool segment = by->kind == EntityKind::segment;
            const Vec3 where = segment ? plc.vertices[plc.segments[by->id].ends[0].index()] : plc.vertices[by->id];
            out.push_back({i, {by->kind, segment ? by->id + 1U : plc.source_vertex[by->id] + first_number, where}, by->angle_deg});
        }
    return out;
}

std::optional<GapStatistics> gaps_left(const std::vector<Exemption>& exemptions, const ConformingMesh& mesh, const Refiner& refiner, std::uint32_t first_number) {
    const auto& left = refiner.gaps().left();
    if (!left) return std::nullopt;
    const auto tets = std::count_if(exemptions.begin(), exemptions.end(), [](const Exemption& e) { return e.angle_deg == kGapAngle; });
    if (tets == 0) return std::nullopt;  // the goals ask for no filling
    return GapStatistics{feature_of(mesh, left->sides[0], first_number),
                         feature_of(mesh, left->sides[1], first_number),
                         left->width,
                         left->narrowest,
                         left->filled_from,
                         left->vertices,
                         static_cast<std::uint64_t>(tets)};
}

ExemptionKeeper::ExemptionKeeper(const TetMesh& mesh, std::vector<Exemption> exemptions) {
    for (Exemption& e : exemptions) by_corners_.emplace(sorted(mesh.tets[e.tet]), std::move(e));
}

std::vector<Exemption> ExemptionKeeper::of(const TetMesh& mesh) const {
    std::vector<Exemption> out;
    if (by_corners_.empty()) return out;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        const auto at = by_corners_.find(sorted(mesh.tets[t]));
        if (at == by_corners_.end()) continue;
        out.push_back(at->second);
        out.back().tet = t;
    }
    return out;
}

}  // namespace wellmesh
