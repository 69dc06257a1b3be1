// SPDX-License-Identifier: Apache-2.0
#include "validation/examine.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "validation/box_tree.hpp"

namespace wellmesh {
namespace {

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

std::string describe_edge(const Complexes& complex, const Report& report, const std::array<VertexId, 2>& ends) {
    return fmt::format("the edge from {} at {} to {} at {}", report.name_vertex(complex.input.source_vertex[ends[0].index()]), format_point(complex.point(ends[0])),
                       report.name_vertex(complex.input.source_vertex[ends[1].index()]), format_point(complex.point(ends[1])));
}

std::vector<ElementRef> elements_at(const Complexes& complex, const Report& report, std::size_t edge) {
    std::vector<ElementRef> elements;
    for (const VertexId v : edge_ends(complex.edges.keys[edge])) elements.push_back(report.vertex(complex.input.source_vertex[v.index()]));
    for (const std::uint32_t c : complex.edges.around(edge)) elements.push_back(report.facet(complex.input.facets[complex.soup.triangles[c / 3].facet].source));
    return elements;
}

/// Smallest angle between half planes about an edge, in radians.
double smallest_between(const Complexes& complex, std::size_t edge) {
    const auto ends = edge_ends(complex.edges.keys[edge]);
    const Vec3 a = complex.point(ends[0]), along = complex.point(ends[1]) - a;
    const Vec3 u = (1 / norm(along)) * along;
    std::vector<double> angles;
    Vec3 x{}, y{};
    for (const std::uint32_t c : complex.edges.around(edge)) {
        const Vec3 to_apex = complex.point(complex.soup.triangles[c / 3].v[(c % 3 + 2) % 3]) - a;
        const Vec3 across = to_apex - dot(to_apex, u) * u;
        if (angles.empty()) {
            x = across;
            y = cross(u, across);
        }
        angles.push_back(std::atan2(dot(across, y), dot(across, x)));
    }
    std::sort(angles.begin(), angles.end());
    double smallest = 2 * std::numbers::pi + angles.front() - angles.back();
    for (std::size_t i = 0; i + 1 < angles.size(); ++i) smallest = std::min(smallest, angles[i + 1] - angles[i]);
    return smallest;
}

}  // namespace

void find_surface_defects(const Complexes& complex, Report& report) {
    const bool surface = report.plc().fill == FillRule::nonzero_winding;
    for (std::size_t e = 0; e < complex.edges.keys.size(); ++e) {
        const auto around = complex.edges.around(e);
        const auto ends = edge_ends(complex.edges.keys[e]);
        const std::vector<Vec3> points{complex.point(ends[0]), complex.point(ends[1])};
        if (surface && around.size() > 2)
            report.add(DefectKind::non_manifold_edge, Severity::warning, elements_at(complex, report, e),
                       fmt::format("{} bounds {} triangles", describe_edge(complex, report, ends), around.size()), static_cast<double>(around.size()), points);
        const auto starts_at = [&](std::uint32_t c) { return complex.soup.triangles[c / 3].v[c % 3]; };
        if (surface && around.size() == 2 && starts_at(around[0]) == starts_at(around[1]))
            report.add(DefectKind::inconsistent_orientation, Severity::warning, elements_at(complex, report, e),
                       fmt::format("{} and {} run in the same direction along {}", report.name_facet(complex.input.facets[complex.soup.triangles[around[0] / 3].facet].source),
                                   report.name_facet(complex.input.facets[complex.soup.triangles[around[1] / 3].facet].source), describe_edge(complex, report, ends)),
                       0, points);
        if (!surface && around.size() == 1)
            report.add(DefectKind::open_edge, Severity::note, elements_at(complex, report, e),
                       fmt::format("{} bounds only one facet: the facet dangles there", describe_edge(complex, report, ends)), 0, points);
    }
}

std::vector<PlacedAngle> placed_angles(const Complexes& complex) {
    std::vector<PlacedAngle> found;
    std::vector<double> at_vertex(complex.input.points.size(), 2 * std::numbers::pi);
    for (std::uint32_t t = 0; t < complex.soup.triangles.size(); ++t)
        for (std::uint32_t i = 0; i < 3; ++i) {
            if (!complex.groups.is_segment[complex.edges.edge_of[3 * t + i]] || !complex.groups.is_segment[complex.edges.edge_of[3 * t + (i + 2) % 3]]) continue;
            const auto& v = complex.soup.triangles[t].v;
            const Vec3 a = complex.point(v[(i + 1) % 3]) - complex.point(v[i]), b = complex.point(v[(i + 2) % 3]) - complex.point(v[i]);
            double& smallest = at_vertex[v[i].index()];
            smallest = std::min(smallest, std::atan2(norm(cross(a, b)), dot(a, b)));
        }
    for (std::size_t v = 0; v < at_vertex.size(); ++v)
        if (at_vertex[v] < std::numbers::pi) found.push_back({at_vertex[v] * kDegreesPerRadian, {VertexId{v}}});
    for (std::size_t e = 0; e < complex.edges.keys.size(); ++e)
        if (complex.groups.is_segment[e] && complex.edges.around(e).size() > 1) {
            const auto ends = edge_ends(complex.edges.keys[e]);
            found.push_back({smallest_between(complex, e) * kDegreesPerRadian, {ends[0], ends[1]}});
        }
    std::sort(found.begin(), found.end(), [](const PlacedAngle& a, const PlacedAngle& b) { return a.degrees != b.degrees ? a.degrees < b.degrees : a.at < b.at; });
    return found;
}

void find_acute_angles(const Complexes& complex, const Rounding& rounding, Report& report) {
    const double displacement = rounding.ulps(Rounding::kUlps) + rounding.source();
    for (const PlacedAngle& angle : placed_angles(complex)) {
        const std::uint32_t first = complex.input.source_vertex[angle.at[0].index()];
        if (angle.at.size() == 1) {
            if (angle.degrees >= 90) continue;
            report.add(DefectKind::acute_segment_angle, Severity::warning, {report.vertex(first)},
                       fmt::format("segments meet at {:.6g} degrees in {} at {}", angle.degrees, report.name_vertex(first), format_point(complex.point(angle.at[0]))),
                       angle.degrees);
            continue;
        }
        const double length = distance(complex.point(angle.at[0]), complex.point(angle.at[1]));
        if (angle.degrees >= 90 - displacement / length * kDegreesPerRadian) continue;
        report.add(DefectKind::acute_dihedral_angle, Severity::warning, {report.vertex(first), report.vertex(complex.input.source_vertex[angle.at[1].index()])},
                   fmt::format("facets meet at {:.6g} degrees along {}", angle.degrees, describe_edge(complex, report, {angle.at[0], angle.at[1]})), angle.degrees);
    }
}

void find_seeds_beyond(const Complexes& complex, Report& report) {
    Box box;
    for (const Vec3& p : complex.input.points) box.add(p);
    const auto check = [&](const Vec3& p, std::size_t number, const std::string& what, Severity severity) {
        Box place;
        place.add(p);
        if (!std::isfinite(p.x + p.y + p.z) || !box.meets(place))
            report.add(DefectKind::seed_outside, severity, {{EntityKind::region, number, p}},
                       fmt::format("{} {} at {} lies outside of the whole complex", what, number, format_point(p)));
    };
    const Plc& plc = report.plc();
    for (std::size_t r = 0; r < plc.region_seeds.size(); ++r) check(plc.region_seeds[r].point, r + 1, "region seed", Severity::error);
    for (std::size_t h = 0; h < plc.hole_seeds.size(); ++h) check(plc.hole_seeds[h], h + 1, "hole seed", Severity::warning);
}

}  // namespace wellmesh
