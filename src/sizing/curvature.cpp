// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "core/edge_key.hpp"
#include "core/vec3_math.hpp"
#include "sizing/entity_sizes.hpp"

namespace wellmesh {
namespace {

constexpr double kSmoothTurn = kSmoothTurnDeg * std::numbers::pi / 180;

/// A symmetric tensor in the plane of a facet.
struct Tensor {
    double uu = 0, uv = 0, vv = 0;
    [[nodiscard]] double largest() const { return std::abs(uu + vv) / 2 + std::hypot((uu - vv) / 2, uv); }
};

class SmoothSurface {
public:
    explicit SmoothSurface(const ValidPlc& plc) : plc_(plc), tensors_(plc.facets.size()), areas_(plc.facets.size(), 0), is_smooth_(plc.segments.size(), 0) {
        for (std::size_t s = 0; s < plc.segments.size(); ++s) segment_at_.try_emplace(edge_key(plc.segments[s].ends[0], plc.segments[s].ends[1]), s);
        sides_.resize(plc.segments.size());
        for (std::size_t f = 0; f < plc.facets.size(); ++f)
            for (const auto& t : plc.facets[f].triangles) {
                areas_[f] += norm(cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0]))) / 2;
                for (unsigned k = 0; k < 3; ++k)
                    if (const auto s = segment_at_.find(edge_key(t[k], t[(k + 1) % 3])); s != segment_at_.end())
                        sides_[s->second].push_back({FacetId{f}, t[(k + 2) % 3]});
            }
        for (std::size_t s = 0; s < plc.segments.size(); ++s) add_turn(s);
    }
    /// Both ways, where facets go on smoothly across the segment.
    [[nodiscard]] bool is_smooth(std::size_t segment) const { return is_smooth_[segment] != 0; }
    [[nodiscard]] double curvature(std::size_t facet) const { return areas_[facet] > 0 ? tensors_[facet].largest() / areas_[facet] : 0; }

private:
    struct Side {
        FacetId facet{};
        VertexId across{};  // the corner of the facet's triangle that is not on the segment
    };
    [[nodiscard]] const Vec3& at(VertexId v) const { return plc_.vertices[v.index()]; }

    void add_turn(std::size_t s) {
        const std::vector<Side>& sides = sides_[s];
        if (sides.size() != 2 || sides[0].facet == sides[1].facet) return;  // a slit, an edge of the surface, or where more than two meet
        const Vec3 &a = at(plc_.segments[s].ends[0]), along = at(plc_.segments[s].ends[1]) - a;
        const double length = norm(along);
        const auto inwards = [&](const Side& side) {
            const Vec3 to = at(side.across) - a, in = to - (dot(to, along) / (length * length)) * along;
            return (1 / norm(in)) * in;
        };
        const Vec3 first = inwards(sides[0]), second = inwards(sides[1]);
        // Of facets that go straight on these are opposite; the angle between them and that is well conditioned as a chord.
        const double turn = 2 * std::asin(std::min(1.0, norm(first + second) / 2));
        if (!(turn <= kSmoothTurn)) return;
        is_smooth_[s] = 1;
        for (unsigned k = 0; k < 2; ++k) {
            const ValidFacet& f = plc_.facets[sides[k].facet.index()];
            const double sign = dot(k == 0 ? second : first, f.normal) < 0 ? 1 : -1;
            const double u = dot(along, f.axis_u) / length, v = dot(along, f.axis_v) / length, share = sign * turn * length / 2;
            Tensor& t = tensors_[sides[k].facet.index()];
            t.uu += share * u * u;
            t.uv += share * u * v;
            t.vv += share * v * v;
        }
    }

    const ValidPlc& plc_;
    std::unordered_map<std::uint64_t, std::size_t> segment_at_;  // only looked up
    std::vector<std::vector<Side>> sides_;
    std::vector<Tensor> tensors_;
    std::vector<double> areas_;
    std::vector<char> is_smooth_;
};

/// Sum of the turns at the ends of each segment that is no part of a smooth surface.
std::vector<double> turns_of_curves(const ValidPlc& plc, const SmoothSurface& surface) {
    std::vector<std::vector<std::size_t>> around(plc.vertices.size());
    for (std::size_t s = 0; s < plc.segments.size(); ++s)
        if (!surface.is_smooth(s))
            for (const VertexId v : plc.segments[s].ends) around[v.index()].push_back(s);
    std::vector<double> turns(plc.segments.size(), 0);
    for (std::size_t v = 0; v < around.size(); ++v) {
        if (around[v].size() != 2) continue;
        std::array<Vec3, 2> away;
        for (std::size_t k = 0; k < 2; ++k) {
            const auto& ends = plc.segments[around[v][k]].ends;
            const Vec3 to = plc.vertices[(ends[0].index() == v ? ends[1] : ends[0]).index()] - plc.vertices[v];
            away[k] = (1 / norm(to)) * to;
        }
        const double turn = 2 * std::asin(std::min(1.0, norm(away[0] + away[1]) / 2));
        if (!(turn <= kSmoothTurn)) continue;
        for (const std::size_t s : around[v]) turns[s] += turn;
    }
    return turns;
}

}  // namespace

void add_curvature_sizes(const ValidPlc& plc, double elements, EntitySizes& sizes) {
    const SmoothSurface surface(plc);
    // A circle of radius 1 / curvature.
    const auto lower = [elements](double curvature, double& size) {
        if (curvature > 0) size = std::min(size, 2 * std::numbers::pi / (elements * curvature));
    };
    for (std::size_t f = 0; f < plc.facets.size(); ++f) lower(surface.curvature(f), sizes.facets[f]);
    const std::vector<double> turns = turns_of_curves(plc, surface);
    for (std::size_t s = 0; s < plc.segments.size(); ++s)
        lower(turns[s] / 2 / distance(plc.vertices[plc.segments[s].ends[0].index()], plc.vertices[plc.segments[s].ends[1].index()]), sizes.segments[s]);
}

}  // namespace wellmesh
