// SPDX-License-Identifier: Apache-2.0
#include "validation/gap_demand.hpp"

#include <vector>

namespace wellmesh {
namespace {

/// The middle of a facet may be beside a gap though its corners are not. An eighth of its size is looked at; the facet across a smaller gap has
/// corners there.
constexpr Halvings kThorough{6, 8};

}  // namespace

double vertices_for_gaps(const ValidPlc& plc, double enough) {
    const LocalFeatureSize size(plc);
    std::vector<double> at_vertex;
    for (const Vec3& p : plc.vertices) at_vertex.push_back(size(p));
    double sum = 0;
    for (const ValidFacet& f : plc.facets)
        for (const auto& t : f.triangles) {
            const std::array<Vec3, 3> corners{plc.vertices[t[0].index()], plc.vertices[t[1].index()], plc.vertices[t[2].index()]};
            sample_gap(size, corners, {at_vertex[t[0].index()], at_vertex[t[1].index()], at_vertex[t[2].index()]}, [&](double area, double width) {
                if (area > kSlender * kSlender * width * width) sum += vertices_beside_facet(area, width);
            }, kThorough);
            if (sum > enough) return sum;
        }
    for (const ValidSegment& s : plc.segments) {
        const Vec3 &a = plc.vertices[s.ends[0].index()], &b = plc.vertices[s.ends[1].index()];
        const double whole = distance(a, b);
        sample_gap(size, std::array{a, b}, std::array{at_vertex[s.ends[0].index()], at_vertex[s.ends[1].index()]}, [&](double length, double width) {
            if (whole > kSlender * width) sum += vertices_beside_segment(length, width);
        });
        if (sum > enough) return sum;
    }
    return sum;
}

}  // namespace wellmesh
