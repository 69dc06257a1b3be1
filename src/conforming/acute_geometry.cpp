// SPDX-License-Identifier: Apache-2.0
#include "conforming/acute_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>
#include <tuple>

#include "conforming/place_point.hpp"
#include "core/check.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

/// Copies of copies between facets that share a vertex only need not close (two such rotations have no common axis): after so many, splits
/// go to other places.
constexpr std::uint8_t kMostGenerations = 2;
/// Part of the room that copies have (stretch()).
constexpr double kStretch = 0.2;

}  // namespace

AcuteGeometry::AcuteGeometry(const ValidPlc& plc, Workers& workers, bool has_narrow_gaps, const Checkpoint& checkpoint)
    : plc_(&plc), any_(!plc.acute_features.empty()), copies_(any_ || has_narrow_gaps) {
    if (!copies_) return;
    acute_deg_.assign(plc.vertices.size(), 180);
    const auto note = [&](std::uint32_t v, double angle) { acute_deg_[v] = std::min(acute_deg_[v], angle); };
    for (const AcuteFeature& f : plc.acute_features) {
        if (f.kind == EntityKind::vertex) note(f.id, f.angle_deg);
        else
            for (const VertexId v : plc.segments[f.id].ends) note(v.value(), f.angle_deg);
    }
    find_balls(workers, checkpoint);
    list_incidences();
    list_shared_segments();
}

void AcuteGeometry::list_incidences() {
    std::vector<std::pair<std::uint32_t, FacetId>> facets;
    for (std::size_t f = 0; f < plc_->facets.size(); ++f) {
        ids_.emplace_back(f);
        for (const VertexId v : plc_->facets[f].vertices) facets.emplace_back(v.value(), f);
    }
    facets_at_ = CompressedRows<FacetId>(plc_->vertices.size(), facets);
    std::vector<std::pair<std::uint32_t, SegmentId>> segments;
    for (std::size_t s = 0; s < plc_->segments.size(); ++s) {
        segment_ids_.emplace_back(s);
        for (const VertexId v : plc_->segments[s].ends) segments.emplace_back(v.value(), s);
    }
    segments_at_ = CompressedRows<SegmentId>(plc_->vertices.size(), segments);
}

void AcuteGeometry::list_shared_segments() {
    std::vector<std::tuple<FacetPair, SegmentId>> all;
    for (std::size_t s = 0; s < plc_->segments.size(); ++s) {
        const auto& facets = plc_->segments[s].facets;  // ascending
        for (std::size_t i = 0; i < facets.size(); ++i)
            for (std::size_t j = i + 1; j < facets.size(); ++j) all.push_back({{facets[i].value(), facets[j].value()}, SegmentId{s}});
    }
    std::sort(all.begin(), all.end());
    std::vector<std::pair<std::size_t, SegmentId>> entries;
    for (const auto& [pair, segment] : all) {
        if (pairs_.empty() || pairs_.back() != pair) pairs_.push_back(pair);
        entries.emplace_back(pairs_.size() - 1, segment);
    }
    pair_segments_ = CompressedRows<SegmentId>(pairs_.size(), entries);
}

std::span<const SegmentId> AcuteGeometry::shared_segments(FacetId f, FacetId g) const {
    const FacetPair wanted{std::min(f, g).value(), std::max(f, g).value()};
    const auto it = std::lower_bound(pairs_.begin(), pairs_.end(), wanted);
    if (it == pairs_.end() || *it != wanted) return {};
    return pair_segments_[static_cast<std::size_t>(it - pairs_.begin())];
}

std::span<const FacetId> AcuteGeometry::facets_of(CarrierKind carrier, std::uint32_t id) const {
    switch (carrier) {
        case CarrierKind::input_vertex: return facets_at(VertexId{id});
        case CarrierKind::segment: return plc_->segments[id].facets;
        case CarrierKind::facet: return {ids_.data() + id, 1};
        case CarrierKind::region: break;
    }
    return {};
}

std::span<const SegmentId> AcuteGeometry::segments_of(CarrierKind carrier, std::uint32_t id) const {
    if (carrier == CarrierKind::input_vertex) return segments_at(VertexId{id});
    if (carrier == CarrierKind::segment) return {segment_ids_.data() + id, 1};
    return {};
}

bool AcuteGeometry::is_on_facet(VertexId input_vertex, FacetId f) const {
    const auto& on = plc_->facets[f.index()].vertices;
    return std::binary_search(on.begin(), on.end(), input_vertex);
}

void AcuteGeometry::find_balls(Workers& workers, const Checkpoint& checkpoint) {
    ball_.assign(plc_->vertices.size(), 0);
    if (!any_) return;
    feature_size_ = std::make_unique<const LocalFeatureSize>(*plc_);
    pass(checkpoint);
    constexpr std::size_t kGrain = 64;
    const std::thread::id caller = std::this_thread::get_id();
    workers.for_ranges(ball_.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        if (std::this_thread::get_id() == caller) pass(checkpoint);
        for (std::size_t v = begin; v < end; ++v) {
            if (acute_deg_[v] == 180) continue;
            const double r = (*feature_size_)(plc_->vertices[v]) / 3;
            if (std::isfinite(r)) ball_[v] = r;
        }
    });
}

std::vector<Box> AcuteGeometry::boxes_of_balls() const {
    std::vector<Box> out;
    for (std::size_t v = 0; v < acute_deg_.size(); ++v) {
        const double r = ball_radius(VertexId{v});
        if (!(r > 0)) continue;
        const Vec3& p = point(VertexId{v});
        out.push_back(Box{p, p}.grown(r));
    }
    return out;
}

bool AcuteGeometry::in_ball_of_segment(SegmentId s, const Vec3& p) const {
    if (!any_) return false;
    const auto& ends = plc_->segments[s.index()].ends;
    return std::any_of(ends.begin(), ends.end(), [&](VertexId v) {
        const double r = ball_radius(v);
        return squared_distance(p, point(v)) < r * r;
    });
}

/// Copies at exactly the same distance lie on one circle with what they are copies of, four at a time, and leave flat tetrahedra. So each
/// segment at v has its own scale. A copy at d (1 + e) still encroaches nothing at d on a segment at the angle a as long as e < 1 - cos a.
double AcuteGeometry::stretch(VertexId v, SegmentId s) const {
    const double angle = acute_deg_[v.index()];
    if (angle == 180) return 1;
    const double half = std::sin(angle * (std::numbers::pi / 360));
    return 1 + kStretch * 2 * half * half * (2 * unit_double(mix64(v.value(), s.value())) - 1);
}

std::optional<AcuteGeometry::SegmentCopy> AcuteGeometry::copy_on_segment(SegmentId s, const CarriedWitness& q) const {
    std::optional<SegmentCopy> best;
    double least = std::numeric_limits<double>::infinity();
    for (const VertexId end : plc_->segments[s.index()].ends) {
        if (q.carrier == CarrierKind::input_vertex && q.carrier_id == end.value()) continue;
        const auto segments = segments_of(q.carrier, q.carrier_id);
        const auto same_end = std::find_if(segments.begin(), segments.end(), [&](SegmentId o) {
            const auto& ends = plc_->segments[o.index()].ends;
            return o != s && (ends[0] == end || ends[1] == end);
        });
        bool related = same_end != segments.end();
        const double scale = related && q.carrier == CarrierKind::segment ? stretch(end, s) / stretch(end, *same_end) : 1;
        const auto facets = facets_of(q.carrier, q.carrier_id);
        const auto& own = plc_->segments[s.index()].facets;
        related = related || std::any_of(facets.begin(), facets.end(), [&](FacetId f) { return !std::binary_search(own.begin(), own.end(), f) && is_on_facet(end, f); });
        if (!related) continue;
        const Vec3 &v = point(end), &other = point(plc_->segments[s.index()].ends[plc_->segments[s.index()].ends[0] == end ? 1 : 0]);
        const double d = scale * distance(q.point, v);
        const double moved = squared_distance(q.point, v + (d / distance(v, other)) * (other - v));
        if (moved >= least) continue;
        least = moved;
        best = SegmentCopy{end, d};
    }
    return best;
}

/// Rotation about the segment into the half of the facet's plane that holds the centre, if that is less than 90 degrees away.
std::optional<Vec3> AcuteGeometry::rotated_about(SegmentId s, FacetId f, const Vec3& q, const Vec3& centre) const {
    const auto& ends = plc_->segments[s.index()].ends;
    const Vec3 &a = point(ends[0]), &b = point(ends[1]);
    const Vec3 along = (1 / distance(a, b)) * (b - a);
    // From the nearer end, so that copies do not inherit the rounding of far ones.
    const Vec3& from = squared_distance(q, a) < squared_distance(q, b) ? a : b;
    const Vec3 offset = (q - from) - dot(q - from, along) * along;
    Vec3 inward = cross(plc_->facets[f.index()].normal, along);
    inward = (1 / norm(inward)) * inward;
    if (dot(inward, centre - a) < 0) inward = -inward;
    if (!(dot(inward, offset) > 0)) return std::nullopt;
    return (q - offset) + norm(offset) * inward;
}

std::optional<Vec3> AcuteGeometry::swung_about(VertexId v, FacetId f, const Vec3& q) const {
    const Vec3& n = plc_->facets[f.index()].normal;
    const Vec3 d = q - point(v), flat = d - dot(d, n) * n;
    const double length = norm(flat);
    if (!(length > 0)) return std::nullopt;
    return point(v) + (norm(d) / length) * flat;
}

std::optional<AcuteGeometry::FacetCopy> AcuteGeometry::copy_on_facet(FacetId f, const CarriedWitness& q, const Vec3& centre, double radius) const {
    std::optional<FacetCopy> best;
    double least = std::numeric_limits<double>::infinity();
    const auto offer = [&](const std::optional<Vec3>& p, std::uint8_t generation, double lever = std::numeric_limits<double>::infinity()) {
        if (!p || !(squared_distance(*p, centre) < radius * radius)) return;
        const double moved = squared_distance(*p, q.point);
        if (moved >= least) return;
        least = moved;
        best = FacetCopy{project_to_facet(plc_->facets[f.index()], *p), generation, lever};
    };
    const auto facets = facets_of(q.carrier, q.carrier_id);
    if (std::find(facets.begin(), facets.end(), f) != facets.end()) return best;  // it lies on f itself
    for (const FacetId g : facets)
        for (const SegmentId s : shared_segments(f, g)) offer(rotated_about(s, f, q.point, centre), q.generation, distance(centre, project_to_segment(*plc_, s, centre)));
    if (best) return best;
    for (const SegmentId s : segments_of(q.carrier, q.carrier_id))
        for (const VertexId v : plc_->segments[s.index()].ends)
            if (is_on_facet(v, f)) offer(swung_about(v, f, q.point), q.generation);
    if (best || q.generation >= kMostGenerations) return best;
    for (const FacetId g : facets) {
        const auto &few = plc_->facets[f.index()].vertices, &many = plc_->facets[g.index()].vertices;
        const bool swap = few.size() > many.size();
        for (const VertexId v : swap ? many : few)
            if (is_on_facet(v, swap ? f : g)) offer(swung_about(v, f, q.point), static_cast<std::uint8_t>(q.generation + 1));
    }
    return best;
}

std::optional<Vec3> AcuteGeometry::direction_on_facet(FacetId f, VertexId v, const CarriedWitness& q, const Vec3& centre) const {
    for (const FacetId g : facets_of(q.carrier, q.carrier_id)) {
        if (g == f) continue;
        for (const SegmentId s : shared_segments(f, g)) {
            const auto& ends = plc_->segments[s.index()].ends;
            if (ends[0] != v && ends[1] != v) continue;
            if (const auto p = rotated_about(s, f, q.point, centre)) return (1 / distance(*p, point(v))) * (*p - point(v));
        }
    }
    const auto p = swung_about(v, f, q.point);
    if (!p) return std::nullopt;
    return (1 / distance(*p, point(v))) * (*p - point(v));
}

}  // namespace wellmesh
