// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <unordered_set>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "validation/box_tree.hpp"
#include "validation/closest_points.hpp"
#include "validation/find_intersections.hpp"
#include "validation/triangle_contact.hpp"

namespace wellmesh {

void find_thin_features(const CleanInput& input, const Soup& soup, const EdgeTable& edges, const FacetGroups& groups, const Rounding& rounding,
                        Report& report) {
    const double limit = rounding.contact();
    const auto point = [&](VertexId v) -> const Vec3& { return input.points[v.index()]; };
    std::vector<Box> boxes(soup.triangles.size());
    for (std::size_t t = 0; t < boxes.size(); ++t)
        for (const VertexId v : soup.triangles[t].v) boxes[t].add(point(v));
    const BoxTree tree(boxes);
    std::unordered_set<std::uint64_t> seen;
    const auto add = [&](VertexId v, std::uint32_t t, const std::string& what, double gap) {
        const std::uint32_t facet = input.facets[soup.triangles[t].facet].source;
        if (!seen.insert(std::uint64_t{v.value()} << 32 | groups.group_of[t]).second) return;
        const std::uint32_t number = input.source_vertex[v.index()];
        report.add(DefectKind::feature_too_thin, Severity::error, {report.vertex(number), report.facet(facet, point(v))},
                   fmt::format("{} at {} is {:.2g} away from {}{}, less than its coordinates can resolve ({:.2g}): merge or move it", report.name_vertex(number),
                               format_point(point(v)), gap, what, report.name_facet(facet), limit),
                   gap);
    };
    // Both ends of its width may be off the plane of the facet beside it by that facet's rounding: below that no mesh can have both.
    for (const std::uint32_t t : groups.peeled)
        for (std::uint32_t s = 0; s < 3; ++s) {
            const auto& c = soup.triangles[t].v;
            const Vec3 edge = point(c[(s + 1) % 3]) - point(c[s]);
            const double height = norm(cross(edge, point(c[(s + 2) % 3]) - point(c[s]))) / norm(edge);
            for (const std::uint32_t corner : edges.around(edges.edge_of[3 * t + s])) {
                const double residual = groups.planes[groups.group_of[corner / 3]].residual;
                if (corner / 3 == t || height > 2 * residual) continue;
                const VertexId apex = c[(s + 2) % 3];
                const std::uint32_t facet = input.facets[soup.triangles[corner / 3].facet].source, number = input.source_vertex[apex.index()];
                report.add(DefectKind::feature_too_thin, Severity::error, {report.vertex(number), report.facet(facet, point(apex))},
                           fmt::format("{} at {} is {:.2g} away from an edge of {}, which is off its plane by {:.2g}: merge or move it", report.name_vertex(number),
                                       format_point(point(apex)), height, report.name_facet(facet), residual),
                           height);
            }
        }
    for (std::size_t i = 0; i < input.points.size(); ++i) {
        const VertexId v{i};
        Box around;
        around.add(input.points[i]);
        around = around.grown(limit);
        tree.query([&](const Box& b) { return b.meets(around); },
                   [&](std::uint32_t t) {
                       const auto& corners = soup.triangles[t].v;
                       if (std::find(corners.begin(), corners.end(), v) != corners.end()) return;
                       const std::array<Vec3, 3> triangle{point(corners[0]), point(corners[1]), point(corners[2])};
                       const auto& own = groups.vertices[groups.group_of[t]];
                       if (!std::binary_search(own.begin(), own.end(), v)) {
                           const double gap = distance_to_triangle(input.points[i], triangle);
                           if (gap <= limit && !is_on(input.points[i], triangle)) add(v, t, "", gap);
                           return;
                       }
                       for (std::uint32_t s = 0; s < 3; ++s) {
                           if (!groups.is_segment[edges.edge_of[3 * t + s]]) continue;
                           const double gap = distance_to_segment(input.points[i], triangle[s], triangle[(s + 1) % 3]);
                           if (gap <= limit) add(v, t, "an edge of ", gap);
                       }
                   });
    }
}

}  // namespace wellmesh
