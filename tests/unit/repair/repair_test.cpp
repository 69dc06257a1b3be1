// SPDX-License-Identifier: Apache-2.0
// Inputs with one kind of defect each, in many places and sizes.
#include "wellmesh/repair.hpp"

#include <gtest/gtest.h>

#include "../validation/plc_helpers.hpp"

namespace wellmesh::testing {
namespace {

/// Turned about a skew axis, scaled and shifted.
Plc placed(Plc plc, double angle, double scale, const Vec3& shift) {
    const double c = std::cos(angle), s = std::sin(angle);
    for (Vec3& p : plc.vertices) {
        const Vec3 once{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
        const Vec3 twice{once.x, c * once.y - s * once.z, s * once.y + c * once.z};
        p = scale * (twice + shift);
    }
    return plc;
}

struct Placement {
    double angle = 0, scale = 1;
    Vec3 shift{};
};
const Placement kPlacements[] = {{0, 1, {}}, {0.7, 1, {}}, {0.785398163397448, 1e-6, {}}, {1.1, 1e6, {}}, {0.3, 1, {1000, -2000, 500}}};

double filled_volume(const Diagnosis& d) {
    double sum = 0;
    for (const CellSummary& c : d.cells)
        if (c.filled) sum += c.volume;
    return sum;
}

void expect_sound(const RepairResult& r) {
    EXPECT_TRUE(r.resolved) << r.summary;
    EXPECT_FALSE(r.diagnosis.has_errors()) << listing(r.diagnosis);
    EXPECT_LE(r.max_displacement, 2 * r.tolerance) << r.summary;
}

template <class Make>
void expect_repaired_everywhere(Make&& make, double volume) {
    for (const Placement& where : kPlacements) {
        SCOPED_TRACE(::testing::Message() << "angle " << where.angle << " scale " << where.scale << " shift " << where.shift.x);
        const Plc broken = placed(make(), where.angle, where.scale, where.shift);
        const RepairResult r = repair(broken);
        expect_sound(r);
        EXPECT_NEAR(filled_volume(r.diagnosis) / std::pow(where.scale, 3), volume, 1e-5 * volume);
    }
}

TEST(Repair, LeavesAValidInputAlone) {
    const Plc box = triangulated_box();
    const RepairResult r = repair(box);
    expect_sound(r);
    EXPECT_EQ(r.plc.vertices, box.vertices);
    ASSERT_EQ(r.plc.facets.size(), box.facets.size());
    for (std::size_t f = 0; f < box.facets.size(); ++f) EXPECT_EQ(r.plc.facets[f].polygons, box.facets[f].polygons);
    EXPECT_EQ(r.max_displacement, 0);
    EXPECT_EQ(r.rounds, 1U);
}

TEST(Repair, CutsOverlappingBoxes) {
    expect_repaired_everywhere(
        [] {
            Plc plc = surface();
            add_box(plc, {0, 0, 0}, {2, 2, 2});
            add_box(plc, {1, 1, 1}, {3, 3, 3});
            return plc;
        },
        15);
}

TEST(Repair, ImprintsTouchingBoxes) {
    expect_repaired_everywhere(
        [] {
            Plc plc = surface();
            add_box(plc, {0, 0, 0}, {2, 2, 2});
            add_box(plc, {0.5, 0.7, 2}, {2.5, 1.5, 3});  // hangs over
            add_box(plc, {-1, 0, 0}, {0, 2, 2});         // shares a whole face
            return plc;
        },
        8 + 1.6 + 4);
}

TEST(Repair, TurnsFacets) {
    expect_repaired_everywhere(
        [] {
            Plc plc = triangulated_box();
            for (const std::size_t f : {3U, 7U}) std::swap(plc.facets[f].polygons[0][0], plc.facets[f].polygons[0][1]);
            return plc;
        },
        1);
    Plc plc = triangulated_box();
    std::swap(plc.facets[3].polygons[0][0], plc.facets[3].polygons[0][1]);
    EXPECT_EQ(repair(plc).actions.facets_turned, 1U);
}

TEST(Repair, MergesVerticesThatAreApart) {
    for (const double gap : {1e-9, 1e-7}) {
        Plc plc = triangulated_box();
        plc.vertices.push_back(plc.vertices[7] + gap * Vec3{1, 0.3, -0.2});
        plc.facets[3].polygons[0] = plc.facets[3].polygons[0];
        for (std::uint32_t& v : plc.facets[3].polygons[0])
            if (v == 7) v = 8;
        EXPECT_TRUE(diagnose(plc).has_errors());
        const RepairResult r = repair(plc, {.tolerance = 1e-6});
        expect_sound(r);
        EXPECT_EQ(r.actions.vertices_merged, 1U);
        EXPECT_NEAR(r.max_displacement, gap * std::sqrt(1.13), 1e-15);
        const RepairResult tight = repair(plc, {.tolerance = 1e-10});  // wider than the tolerance: stays open
        EXPECT_TRUE(tight.diagnosis.has_errors());
        EXPECT_GT(count(tight.diagnosis, DefectKind::open_edge), 0U);
    }
}

TEST(Repair, SplitsTJunctionsAndDropsDuplicatesAndNeedles) {
    Plc plc = triangulated_box();
    // the first triangle becomes two that meet in the middle of an edge of which the neighbour knows nothing
    const auto t = plc.facets[0].polygons[0];
    plc.vertices.push_back(0.5 * (plc.vertices[t[0]] + plc.vertices[t[1]]));
    plc.facets[0].polygons = {{t[0], 8, t[2]}};
    PlcFacet second;
    second.polygons = {{8, t[1], t[2]}};
    plc.facets.push_back(second);
    PlcFacet copy = plc.facets[5];
    plc.facets.push_back(copy);
    EXPECT_TRUE(diagnose(plc).has_errors());
    const RepairResult r = repair(plc);
    expect_sound(r);
    EXPECT_EQ(r.actions.vertices_joined_to_edges, 1U);
    EXPECT_NEAR(filled_volume(r.diagnosis), 1, 1e-12);
}

TEST(Repair, UnionHasNoWallsInside) {
    Plc plc = surface();
    add_box(plc, {0, 0, 0}, {2, 2, 2});
    add_box(plc, {1, 1, 1}, {3, 3, 3});
    add_box(plc, {2, 0, 0}, {4, 2, 1});  // touches the first, and the second along an edge
    const RepairResult r = repair(plc, {.drop_inner_facets = true});
    expect_sound(r);
    std::size_t filled = 0;
    for (const CellSummary& c : r.diagnosis.cells) filled += c.filled;
    EXPECT_EQ(filled, 1U);
    EXPECT_NEAR(filled_volume(r.diagnosis), 19, 1e-9);
    EXPECT_GT(r.actions.inner_dropped, 0U);
    EXPECT_EQ(count(r.diagnosis, DefectKind::duplicate_facet), 0U);
}

TEST(Repair, KeepsCavities) {
    Plc plc = surface();
    add_box(plc, {0, 0, 0}, {4, 4, 4});
    add_box(plc, {1, 1, 1}, {2, 2, 2}, true);
    add_box(plc, {3, 3, 3}, {5, 5, 5});
    for (const bool drop : {false, true}) {
        const RepairResult r = repair(plc, {.drop_inner_facets = drop});
        expect_sound(r);
        EXPECT_NEAR(filled_volume(r.diagnosis), 64 - 1 + 8 - 1, 1e-9);
    }
}

TEST(Repair, KeepsPolygonsMarkersSegmentsAndSeeds) {
    Plc plc;
    for (unsigned i = 0; i < 8; ++i) plc.vertices.push_back({i & 1 ? 2.0 : 0.0, i & 2 ? 2.0 : 0.0, i & 4 ? 2.0 : 0.0});
    const std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (std::int32_t q = 0; q < 6; ++q) {
        PlcFacet f;
        f.polygons = {{quads[q][0], quads[q][1], quads[q][2], quads[q][3]}};
        f.marker = 10 + q;
        plc.facets.push_back(f);
    }
    plc.vertices.push_back({1, 1, -1});
    plc.vertices.push_back({1, 1, 1});
    plc.segments.push_back({{8, 9}, 77});  // a wire through the bottom
    plc.region_seeds.push_back({{0.5, 0.5, 0.5}, 5, 0});
    EXPECT_TRUE(diagnose(plc).has_errors());
    const RepairResult r = repair(plc);
    expect_sound(r);
    EXPECT_EQ(r.plc.region_seeds.size(), 1U);
    std::size_t quads_kept = 0, wires = 0;
    for (const PlcFacet& f : r.plc.facets) quads_kept += f.polygons[0].size() == 4;
    for (const PlcSegment& s : r.plc.segments) wires += s.marker == 77;
    EXPECT_EQ(quads_kept, 5U);
    EXPECT_EQ(wires, 2U);
    EXPECT_EQ(r.actions.intersection_points, 1U);
}

TEST(Repair, RefusesTolerancesOutOfRange) {
    const Plc box = triangulated_box();
    for (const double tolerance : {0.0, 1e-18, 10.0, -1.0, std::nan("")}) EXPECT_THROW((void)repair(box, {.tolerance = tolerance}), MeshError) << tolerance;
    EXPECT_THROW((void)repair(Plc{}), MeshError);
    Plc poly = box;
    poly.fill = FillRule::bounded_cells;
    EXPECT_THROW((void)repair(poly, {.drop_inner_facets = true}), MeshError);
}

TEST(Repair, ObeysAStop) {
    std::stop_source source;
    source.request_stop();
    EXPECT_THROW((void)repair(triangulated_box(), {}, source.get_token()), MeshError);
}

}  // namespace
}  // namespace wellmesh::testing
