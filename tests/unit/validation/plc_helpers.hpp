// SPDX-License-Identifier: Apache-2.0
// Small inputs and laws for the validation tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/vec3_math.hpp"
#include "support/synthetic_plcs.hpp"
#include "validation/valid_plc.hpp"

namespace wellmesh::testing {

/// A closed triangulated box, normals outwards (inwards if `inverted`), appended to `plc`.
inline void add_box(Plc& plc, const Vec3& low, const Vec3& high, bool inverted = false) {
    const auto first = static_cast<std::uint32_t>(plc.vertices.size());
    for (unsigned i = 0; i < 8; ++i) plc.vertices.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    const std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& q : quads)
        for (unsigned k = 1; k < 3; ++k) {
            PlcFacet f;
            f.polygons = {{first + q[0], first + q[k], first + q[k + 1]}};
            if (inverted) std::swap(f.polygons[0][1], f.polygons[0][2]);
            plc.facets.push_back(std::move(f));
        }
}

inline Plc surface() {
    Plc plc;
    plc.fill = FillRule::nonzero_winding;
    return plc;
}

inline Plc triangulated_box(const Vec3& low = {0, 0, 0}, const Vec3& high = {1, 1, 1}) {
    Plc plc = surface();
    add_box(plc, low, high);
    return plc;
}

inline std::size_t count(const Diagnosis& d, DefectKind kind) {
    return static_cast<std::size_t>(std::count_if(d.defects.begin(), d.defects.end(), [&](const Defect& x) { return x.kind == kind; }));
}

inline std::string listing(const Diagnosis& d) {
    std::string all;
    for (const Defect& x : d.defects) all += std::string(to_string(x.kind)) + ": " + x.message + "\n";
    return all;
}

/// What holds for every ValidPlc.
inline void expect_consistent(const ValidPlc& plc) {
    ASSERT_EQ(plc.vertices.size(), plc.source_vertex.size());
    ASSERT_FALSE(plc.cells.empty());
    EXPECT_FALSE(plc.diagnosis.has_errors());
    const auto point = [&](VertexId v) { return plc.vertices.at(v.index()); };
    std::set<std::pair<VertexId, VertexId>> segment_ends;
    for (const ValidSegment& s : plc.segments) {
        EXPECT_TRUE(segment_ends.insert(std::minmax(s.ends[0], s.ends[1])).second) << "segment listed twice";
        EXPECT_TRUE(std::is_sorted(s.facets.begin(), s.facets.end()));
    }
    std::vector<double> volume(plc.cells.size(), 0);
    for (std::size_t f = 0; f < plc.facets.size(); ++f) {
        const ValidFacet& facet = plc.facets[f];
        EXPECT_NEAR(norm(facet.normal), 1, 1e-14);
        EXPECT_NEAR(determinant(facet.axis_u, facet.axis_v, facet.normal), 1, 1e-12);
        ASSERT_FALSE(facet.triangles.empty());
        std::set<VertexId> covered;
        for (const auto& t : facet.triangles) {
            EXPECT_GT(dot(cross(point(t[1]) - point(t[0]), point(t[2]) - point(t[0])), facet.normal), 0);
            const Vec3& o = plc.vertices.at(0);
            const double v = determinant(point(t[0]) - o, point(t[1]) - o, point(t[2]) - o) / 6;
            volume.at(facet.cells[0].index()) -= v;
            volume.at(facet.cells[1].index()) += v;
            covered.insert(t.begin(), t.end());
        }
        EXPECT_EQ(std::vector<VertexId>(covered.begin(), covered.end()), facet.vertices) << "triangles must use every vertex of the facet";
        for (const VertexId v : facet.vertices) EXPECT_LE(std::abs(dot(point(v) - facet.origin, facet.normal)), facet.tolerance);
        for (const SegmentId s : facet.segments) {
            const auto& facets = plc.segments.at(s.index()).facets;
            EXPECT_TRUE(std::binary_search(facets.begin(), facets.end(), FacetId{f}));
        }
    }
    for (std::size_t c = 1; c < plc.cells.size(); ++c) {
        EXPECT_NEAR(volume[c] / plc.cells[c].volume, 1, 1e-9);
        if (!plc.cells[c].filled) { EXPECT_EQ(plc.cells[c].region, 0); }
    }
    EXPECT_FALSE(plc.cells[0].filled);
    EXPECT_TRUE(std::isinf(plc.cells[0].volume));
}

}  // namespace wellmesh::testing
