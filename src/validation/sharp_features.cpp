// SPDX-License-Identifier: Apache-2.0
#include "validation/sharp_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "core/compressed_rows.hpp"
#include "core/vec3_math.hpp"
#include "validation/working_complex.hpp"

namespace wellmesh {
namespace {

constexpr double kRight = std::numbers::pi / 2;
/// What is meshed are the coordinates as they are: an angle of a feature as small as their rounding may have been right once, but refinement would not end at it.
constexpr double kMostSlack = 10 * std::numbers::pi / 180;
constexpr double kDegrees = 180 / std::numbers::pi;

double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(norm(cross(a, b)), dot(a, b)); }
Vec3 unit(const Vec3& a) { return (1 / norm(a)) * a; }

/// Or obtuse, but for rounding.
bool is_right(double angle, double slack) { return angle >= kRight - std::min(slack, kMostSlack); }

/// A segment as seen from one of its ends.
struct Ray {
    std::uint32_t segment = 0;
    Vec3 direction{};
    double slack = 0;  ///< angle by which rounding may have turned it
};

class SharpFeatureFinder {
public:
    SharpFeatureFinder(const ValidPlc& plc, const Rounding& rounding, Report& report)
        : plc_(plc), report_(report), displacement_(rounding.ulps(Rounding::kUlps) + rounding.source()), facet_slack_(plc.facets.size()) {
        for (std::size_t f = 0; f < plc.facets.size(); ++f) facet_slack_[f] = slack_of(plc.facets[f]);
    }

    std::vector<AcuteFeature> run() {
        at_segments();
        at_vertices();
        std::sort(found_.begin(), found_.end(), [](const AcuteFeature& a, const AcuteFeature& b) {
            if (a.angle_deg != b.angle_deg) return a.angle_deg < b.angle_deg;
            return a.kind != b.kind ? a.kind < b.kind : a.id < b.id;
        });
        for (const AcuteFeature& f : found_) describe(f);
        return std::move(found_);
    }

private:
    struct HalfPlane {
        double angle = 0;  ///< about the segment
        double slack = 0;
        std::uint32_t facet = 0;
        Vec3 direction{};
    };
    [[nodiscard]] double slack_of(const ValidFacet& facet) const;
    void at_segments();
    void at_segment(std::uint32_t s, std::span<const std::uint32_t> corners, std::span<const SoupTriangle> triangles);
    void at_vertices();
    [[nodiscard]] std::vector<Ray> rays_at(VertexId v, std::span<const std::uint32_t> segments) const;
    [[nodiscard]] double smallest_between_rays(std::vector<Ray>& rays) const;
    [[nodiscard]] double smallest_to_facets(VertexId v, const std::vector<Ray>& rays, std::span<const std::uint32_t> corners,
                                            std::span<const SoupTriangle> triangles, double bound) const;
    void describe(const AcuteFeature& feature);
    [[nodiscard]] const Vec3& point(VertexId v) const { return plc_.vertices[v.index()]; }

    const ValidPlc& plc_;
    Report& report_;
    const double displacement_;
    std::vector<double> facet_slack_;  ///< angle by which rounding may have tilted each facet
    std::vector<AcuteFeature> found_;
    std::vector<std::pair<std::uint32_t, bool>> inside_;  ///< for each acute segment, whether in a filled cell
};

/// Displacement over the facet's width: one of its axes runs along its longest direction, the other across.
double SharpFeatureFinder::slack_of(const ValidFacet& facet) const {
    double width = std::numeric_limits<double>::infinity();
    for (const Vec3& axis : {facet.axis_u, facet.axis_v}) {
        double low = 0, high = 0;
        for (const VertexId v : facet.vertices) {
            const double w = dot(point(v) - facet.origin, axis);
            low = std::min(low, w);
            high = std::max(high, w);
        }
        width = std::min(width, high - low);
    }
    return width > 0 ? std::max(displacement_, facet.tolerance) / width : kRight;
}

std::vector<SoupTriangle> all_triangles(const ValidPlc& plc) {
    std::vector<SoupTriangle> triangles;
    for (std::uint32_t f = 0; f < plc.facets.size(); ++f)
        for (const auto& t : plc.facets[f].triangles) triangles.push_back({t, f});
    return triangles;
}

void SharpFeatureFinder::at_segments() {
    const std::vector<SoupTriangle> triangles = all_triangles(plc_);
    const EdgeTable edges = make_edge_table(triangles);
    for (std::uint32_t s = 0; s < plc_.segments.size(); ++s) {
        const std::size_t e = edges.find(edge_key(plc_.segments[s].ends[0], plc_.segments[s].ends[1]));
        if (e != EdgeTable::kNotFound() && edges.around(e).size() > 1) at_segment(s, edges.around(e), triangles);
    }
}

void SharpFeatureFinder::at_segment(std::uint32_t s, std::span<const std::uint32_t> corners, std::span<const SoupTriangle> triangles) {
    const Vec3& a = point(plc_.segments[s].ends[0]);
    const Vec3 u = unit(point(plc_.segments[s].ends[1]) - a);
    std::vector<HalfPlane> planes;
    for (const std::uint32_t c : corners) {
        const std::uint32_t f = triangles[c / 3].facet;
        const Vec3& apex = point(triangles[c / 3].v[(c % 3 + 2) % 3]);
        Vec3 w = cross(plc_.facets[f].normal, u);
        if (dot(w, apex - a) < 0) w = -w;
        planes.push_back({0, facet_slack_[f], f, unit(w)});
    }
    const Vec3 x = planes[0].direction, y = cross(u, x);
    for (HalfPlane& p : planes) p.angle = std::atan2(dot(p.direction, y), dot(p.direction, x));
    std::sort(planes.begin(), planes.end(), [](const HalfPlane& p, const HalfPlane& q) { return p.angle != q.angle ? p.angle < q.angle : p.facet < q.facet; });
    double smallest = kRight;
    bool inside = false;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        const HalfPlane &p = planes[i], &q = planes[(i + 1) % planes.size()];
        if (&p == &q) continue;
        double angle = q.angle - p.angle;
        if (angle < 0) angle += 2 * std::numbers::pi;
        if (angle >= smallest || is_right(angle, p.slack + q.slack)) continue;
        smallest = angle;
        const ValidFacet& f = plc_.facets[p.facet];
        const CellId between = f.cells[dot(f.normal, cross(u, p.direction)) > 0 ? 0 : 1];
        inside = between.valid() && plc_.cells[between.index()].filled;
    }
    if (smallest >= kRight) return;
    found_.push_back({EntityKind::segment, s, smallest * kDegrees});
    inside_.emplace_back(s, inside);
}

std::vector<Ray> SharpFeatureFinder::rays_at(VertexId v, std::span<const std::uint32_t> segments) const {
    std::vector<Ray> rays;
    for (const std::uint32_t s : segments) {
        const auto& ends = plc_.segments[s].ends;
        const Vec3 d = point(ends[0] == v ? ends[1] : ends[0]) - point(v);
        const double length = norm(d);
        rays.push_back({s, (1 / length) * d, displacement_ / length});
    }
    return rays;
}

/// Closest pair of directions by a sweep along x: only pairs nearer in x than the best chord so far are looked at.
double SharpFeatureFinder::smallest_between_rays(std::vector<Ray>& rays) const {
    std::sort(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) {
        return a.direction == b.direction ? a.segment < b.segment : lexicographically_less(a.direction, b.direction);
    });
    double smallest = kRight, chord = std::numbers::sqrt2;
    for (std::size_t i = 0; i < rays.size(); ++i)
        for (std::size_t j = i + 1; j < rays.size() && rays[j].direction.x - rays[i].direction.x <= chord; ++j) {
            if (squared_distance(rays[i].direction, rays[j].direction) > chord * chord) continue;
            const double angle = angle_between(rays[i].direction, rays[j].direction);
            if (angle >= smallest || is_right(angle, rays[i].slack + rays[j].slack)) continue;
            smallest = angle;
            chord = std::min(chord, 2 * std::sin(angle / 2) * (1 + 1e-9));
        }
    return smallest;
}

/// Rays that stand over a triangle at v lower than `bound`. @pre rays sorted by direction.x.
double SharpFeatureFinder::smallest_to_facets(VertexId v, const std::vector<Ray>& rays, std::span<const std::uint32_t> corners,
                                              std::span<const SoupTriangle> triangles, double bound) const {
    double smallest = bound;
    for (const std::uint32_t c : corners) {
        const SoupTriangle& t = triangles[c / 3];
        const ValidFacet& facet = plc_.facets[t.facet];
        const Vec3 a = unit(point(t.v[(c % 3 + 1) % 3]) - point(v)), b = unit(point(t.v[(c % 3 + 2) % 3]) - point(v));
        // a ray at angle phi from the wedge is within the chord 2 sin(phi / 2) of a unit vector of the wedge; the wedge may bulge beyond
        // the x of its two ends, up to where it meets the unit circle: bounded by its own angle
        const double reach = 2 * std::sin(smallest / 2) + 2 * std::sin(angle_between(a, b) / 2);
        const double low = std::min(a.x, b.x) - reach, high = std::max(a.x, b.x) + reach;
        auto ray = std::lower_bound(rays.begin(), rays.end(), low, [](const Ray& r, double x) { return r.direction.x < x; });
        for (; ray != rays.end() && ray->direction.x <= high; ++ray) {
            const double up = dot(ray->direction, facet.normal);
            const Vec3 foot = ray->direction - up * facet.normal;
            if (dot(cross(a, foot), facet.normal) <= 0 || dot(cross(foot, b), facet.normal) <= 0) continue;  // not over the wedge
            const double angle = std::atan2(std::abs(up), norm(foot));
            if (angle >= smallest || is_right(angle, ray->slack + facet_slack_[t.facet])) continue;
            if (std::binary_search(facet.segments.begin(), facet.segments.end(), SegmentId{ray->segment})) continue;
            smallest = angle;
        }
    }
    return smallest;
}

void SharpFeatureFinder::at_vertices() {
    std::vector<std::array<std::uint32_t, 2>> pairs;
    for (std::uint32_t s = 0; s < plc_.segments.size(); ++s)
        for (const VertexId v : plc_.segments[s].ends) pairs.push_back({v.value(), s});
    const CompressedRows<std::uint32_t> segments(plc_.vertices.size(), pairs);
    const std::vector<SoupTriangle> triangles = all_triangles(plc_);
    pairs = {};
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
        for (std::uint32_t i = 0; i < 3; ++i) pairs.push_back({triangles[t].v[i].value(), 3 * t + i});
    const CompressedRows<std::uint32_t> corners(plc_.vertices.size(), pairs);
    for (std::size_t i = 0; i < plc_.vertices.size(); ++i) {
        const VertexId v{i};
        std::vector<Ray> rays = rays_at(v, segments[i]);
        if (rays.empty()) continue;
        double smallest = smallest_between_rays(rays);
        smallest = smallest_to_facets(v, rays, corners[i], triangles, smallest);
        if (smallest < kRight) found_.push_back({EntityKind::vertex, v.value(), smallest * kDegrees});
    }
}

void SharpFeatureFinder::describe(const AcuteFeature& feature) {
    const auto source = [&](VertexId v) { return plc_.source_vertex[v.index()]; };
    if (feature.kind == EntityKind::vertex) {
        const VertexId v{feature.id};
        report_.add(DefectKind::acute_segment_angle, Severity::warning, {report_.vertex(source(v))},
                    fmt::format("segments or a segment and a facet meet at {:.6g} degrees in {} at {}", feature.angle_deg, report_.name_vertex(source(v)),
                                format_point(point(v))),
                    feature.angle_deg);
        return;
    }
    const auto at = std::lower_bound(inside_.begin(), inside_.end(), std::pair{feature.id, false});
    const auto& ends = plc_.segments[feature.id].ends;
    report_.add(DefectKind::acute_dihedral_angle, Severity::warning, {report_.vertex(source(ends[0])), report_.vertex(source(ends[1]))},
                fmt::format("facets meet at {:.6g} degrees ({} the domain) along the segment from {} to {}, {} to {}", feature.angle_deg,
                            at != inside_.end() && at->first == feature.id && at->second ? "inside" : "outside", report_.name_vertex(source(ends[0])),
                            report_.name_vertex(source(ends[1])), format_point(point(ends[0])), format_point(point(ends[1]))),
                feature.angle_deg);
}

}  // namespace

std::vector<AcuteFeature> find_sharp_features(const ValidPlc& plc, const Rounding& rounding, Report& report) {
    return SharpFeatureFinder(plc, rounding, report).run();
}

}  // namespace wellmesh
