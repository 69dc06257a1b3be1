// SPDX-License-Identifier: Apache-2.0
#include "adoption/carrier_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "conforming/place_point.hpp"
#include "core/infinity.hpp"
#include "core/vec3_math.hpp"
#include "validation/closest_points.hpp"

namespace wellmesh {
CarrierFinder::CarrierFinder(const ValidPlc& plc, double tolerance) : plc_(plc), tolerance_(tolerance), reach_(tolerance) {
    double largest = 0;
    for (const Vec3& p : plc.vertices) {
        boxes_.push_back({p, p});
        largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    // The generator's own points are off by a few ulp; they shall come back as they are.
    constexpr double kKeptUlps = 8;
    kept_ = kKeptUlps * std::numeric_limits<double>::epsilon() * largest;
    for (const ValidSegment& s : plc.segments) {
        Box box;
        for (const VertexId v : s.ends) box.add(plc.vertices[v.index()]);
        boxes_.push_back(box);
    }
    for (std::size_t f = 0; f < plc.facets.size(); ++f) {
        const ValidFacet& facet = plc.facets[f];
        reach_ = std::max(reach_, tolerance + facet.tolerance);
        for (std::size_t t = 0; t < facet.triangles.size(); ++t) {
            triangle_facet_.push_back(FacetId{f});
            triangle_.push_back(static_cast<std::uint32_t>(t));
            Box box;
            for (const VertexId v : facet.triangles[t]) box.add(plc.vertices[v.index()]);
            boxes_.push_back(box);
        }
    }
    tree_.emplace(boxes_);
}

/// Distance of p from the plane of the facet, or infinity if it is not over this triangle of it, to within the tolerance.
double CarrierFinder::distance_within(std::uint32_t triangle, const Vec3& p) const {
    const ValidFacet& facet = plc_.facets[triangle_facet_[triangle].index()];
    const double height = std::abs(dot(p - facet.origin, facet.normal));
    if (height > tolerance_ + facet.tolerance) return kInfinity;
    const auto& corners = facet.triangles[triangle_[triangle]];
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = plc_.vertices[corners[k].index()], &b = plc_.vertices[corners[(k + 1) % 3].index()];
        if (dot(cross(b - a, p - a), facet.normal) < -tolerance_ * distance(a, b)) return kInfinity;
    }
    return height;
}

std::optional<Carrier> CarrierFinder::find(const Vec3& p, std::int32_t facet, std::int32_t segment) const {
    const std::size_t vertices = plc_.vertices.size(), segments = plc_.segments.size();
    Best vertex, line, plane;
    const Box around = Box{p, p}.grown(reach_);
    tree_->query([&](const Box& box) { return box.meets(around); },
                 [&](std::uint32_t i) {
                     if (i < vertices) {
                         if (const double d = distance(plc_.vertices[i], p); d <= tolerance_) vertex.offer(i, d, false);
                     } else if (i < vertices + segments) {
                         const auto s = static_cast<std::uint32_t>(i - vertices);
                         const auto& ends = plc_.segments[s].ends;
                         const double d = distance_to_segment(p, plc_.vertices[ends[0].index()], plc_.vertices[ends[1].index()]);
                         if (d <= tolerance_) line.offer(s, d, segment > 0 && s + 1 == static_cast<std::uint32_t>(segment));
                     } else {
                         const auto t = static_cast<std::uint32_t>(i - vertices - segments);
                         const FacetId f = triangle_facet_[t];
                         const double d = distance_within(t, p);
                         if (d < kInfinity) plane.offer(f.value(), d, facet > 0 && plc_.facets[f.index()].source_facet + 1 == static_cast<std::uint32_t>(facet));
                     }
                 });
    if (vertex.found()) return Carrier{CarrierKind::input_vertex, vertex.id, vertex.distance, plc_.vertices[vertex.id]};
    if (line.found()) return Carrier{CarrierKind::segment, line.id, line.distance, line.distance <= kept_ ? p : project_to_segment(plc_, SegmentId{line.id}, p)};
    if (plane.found()) return Carrier{CarrierKind::facet, plane.id, plane.distance, plane.distance <= kept_ ? p : project_to_facet(plc_.facets[plane.id], p)};
    return std::nullopt;
}

double CarrierFinder::distance_to_facets(const Vec3& p) const {
    double nearest = kInfinity;
    for (const ValidFacet& f : plc_.facets)
        for (const auto& t : f.triangles)
            nearest = std::min(nearest, distance_to_triangle(p, plc_.vertices[t[0].index()], plc_.vertices[t[1].index()], plc_.vertices[t[2].index()]));
    return nearest;
}

}  // namespace wellmesh
