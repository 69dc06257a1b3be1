// SPDX-License-Identifier: Apache-2.0
// Random changes to a conforming mesh that leave it conforming.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "support/staged_mesh.hpp"

namespace wellmesh::testing {

inline constexpr std::array kKinds{CarrierKind::segment, CarrierKind::facet, CarrierKind::region};

struct Spot {
    Vec3 point{};
    TetId near{};
    Placement where{};
};

/// Random places for new vertices and random vertices, by the kind of what carries them.
class Workshop {
public:
    Workshop(StagedMesh& staged, std::uint64_t seed) : staged_(staged), mesh_(staged.mesh), seed_(seed) {}

    std::size_t below(std::size_t n) { return mix64(seed_, ++draws_) % n; }

    /// @return false if the draw is of no use.
    bool propose(CarrierKind kind, Spot& spot) {
        const TetStore& tets = mesh_.tets();
        for (std::size_t start = below(tets.slots()), i = 0; i < tets.slots(); ++i) {
            const TetId t{(start + i) % tets.slots()};
            if (!tets.is_finite(t) || !mesh_.in_domain(t)) continue;
            const auto& c = tets.corners(t);
            const double u = 0.2 + 0.6 * random(), v = random(), w = random();
            if (kind == CarrierKind::region) {
                const double sum = 1 + u + v + w;
                spot.point = mesh_.point(c[0]) + (u / sum) * (mesh_.point(c[1]) - mesh_.point(c[0])) + (v / sum) * (mesh_.point(c[2]) - mesh_.point(c[0])) +
                             (w / sum) * (mesh_.point(c[3]) - mesh_.point(c[0]));
                spot.where = Placement::in_cell(mesh_.cell(t));
                spot.near = t;
                return true;
            }
            if (!mesh_.has_labels(t)) continue;
            const TetLabels& l = mesh_.labels(t);
            if (kind == CarrierKind::facet) {
                for (unsigned f = 0; f < 4; ++f) {
                    if (!l.facets[f].valid()) continue;
                    const auto fc = tets.face_corners(TetFace{t, f});
                    const double sum = 1 + u + v;
                    spot.point = project_to_facet(staged_.plc.facets[l.facets[f].index()], mesh_.point(fc[0]) + (u / sum) * (mesh_.point(fc[1]) - mesh_.point(fc[0])) +
                                                                                               (v / sum) * (mesh_.point(fc[2]) - mesh_.point(fc[0])));
                    spot.where = Placement::on_facet(l.facets[f]);
                    spot.near = t;
                    return true;
                }
                continue;
            }
            for (unsigned e = 0; e < 6; ++e) {
                if (!l.segments[e].valid()) continue;
                const VertexId a = c[kEdgeCorners[e][0]], b = c[kEdgeCorners[e][1]];
                spot.point = project_to_segment(staged_.plc, l.segments[e], mesh_.point(a) + u * (mesh_.point(b) - mesh_.point(a)));
                spot.where = Placement::on_segment({a, b, l.segments[e]});
                spot.near = t;
                return true;
            }
        }
        return false;
    }

    /// A legal place: its insertion breaks nothing that the point does not lie on.
    bool find(CarrierKind kind, Spot& spot, Cavity& cavity) {
        for (int attempt = 0; attempt < 20; ++attempt) {
            if (!propose(kind, spot) || !mesh_.triangulation().find_conflict_cavity(spot.point, spot.near, cavity)) continue;
            if (kind == CarrierKind::region && mesh_.cell(cavity.tets[0]).value() != spot.where.carrier_id) continue;
            if (!mesh_.holds_carrier(cavity, spot.where) || mesh_.would_break(cavity, spot.where)) continue;
            staged_.boundary.find_encroached(cavity, spot.where, segments_, faces_);
            if (segments_.empty() && faces_.empty()) return true;
        }
        return false;
    }

    VertexId insert(const Spot& spot, const Cavity& cavity) {
        return mesh_.insert(cavity, spot.where, {.reason = InsertionReason::radius_edge});
    }

    VertexId steiner_vertex(CarrierKind kind) {
        for (std::size_t start = below(mesh_.vertex_slots()), i = 0; i < mesh_.vertex_slots(); ++i) {
            const VertexId v{(start + i) % mesh_.vertex_slots()};
            if (mesh_.info(v).carrier == kind && mesh_.triangulation().is_inserted(v)) return v;
        }
        return {};
    }

    /// Where v stands, with the ends of the subsegments at it. @return false if it is the end of a segment's label.
    bool placement_of(VertexId v, const std::vector<TetId>& star, Placement& where) const {
        where = {mesh_.info(v).carrier, mesh_.info(v).carrier_id, {}, {}};
        if (where.carrier != CarrierKind::segment) return true;
        std::set<VertexId> ends;
        for (const TetId t : star)
            for (unsigned e = 0; e < 6; ++e) {
                const VertexId a = mesh_.tets().corner(t, kEdgeCorners[e][0]), b = mesh_.tets().corner(t, kEdgeCorners[e][1]);
                if ((a == v || b == v) && mesh_.segment_at(t, e).value() == where.carrier_id) ends.insert(a == v ? b : a);
            }
        if (ends.size() != 2) return false;
        where.a = *ends.begin();
        where.b = *ends.rbegin();
        return true;
    }

private:
    double random() { return unit_double(mix64(seed_, ++draws_)); }

    StagedMesh& staged_;
    ConformingMesh& mesh_;
    std::uint64_t seed_, draws_ = 0;
    std::vector<Subsegment> segments_;
    std::vector<Subface> faces_;
};

}  // namespace wellmesh::testing
