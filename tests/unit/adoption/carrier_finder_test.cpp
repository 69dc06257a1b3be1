// SPDX-License-Identifier: Apache-2.0
#include "adoption/carrier_finder.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "conforming/place_point.hpp"
#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "support/synthetic_plcs.hpp"

namespace wellmesh::testing {
namespace {

Vec3 random_offset(std::uint64_t key, double length) {
    const Vec3 d{unit_double(mix64(key, 1)) - 0.5, unit_double(mix64(key, 2)) - 0.5, unit_double(mix64(key, 3)) - 0.5};
    return (length / norm(d)) * d;
}

TEST(CarrierFinder, FindsWhatPointsWereMadeOn) {
    for (const NamedPlc& named : all_synthetic_plcs())
        for (const double shift : {0.0, 1e3}) {
            SCOPED_TRACE(named.name);
            const ValidPlc plc = validate(transformed(named.plc, 5, shift, 1));
            const double tolerance = 1e-9 * diagonal(named.plc);
            const CarrierFinder finder(plc, tolerance);
            std::uint64_t key = 0;
            const auto expect = [&](const Vec3& on, CarrierKind kind, std::uint32_t id) {
                for (const double off : {0.0, 0.9, 3.0}) {
                    const Vec3 p = on + random_offset(++key, off * tolerance);
                    const auto found = finder.find(p, 0, 0);
                    if (off > 1) {
                        if (found) { EXPECT_LE(found->distance, tolerance * 1.01); }  // it may have slid along a neighbour
                        continue;
                    }
                    ASSERT_TRUE(found.has_value());
                    EXPECT_EQ(found->kind, kind);
                    EXPECT_EQ(found->id, id);
                    EXPECT_LE(distance(found->point, p), tolerance * 1.01);
                    if (off == 0) { EXPECT_EQ(found->point, on); }
                }
            };
            for (std::uint32_t v = 0; v < plc.vertices.size(); ++v) expect(plc.vertices[v], CarrierKind::input_vertex, v);
            for (std::uint32_t s = 0; s < plc.segments.size(); ++s) {
                const auto& ends = plc.segments[s].ends;
                const Vec3 &a = plc.vertices[ends[0].index()], &b = plc.vertices[ends[1].index()];
                expect(project_to_segment(plc, SegmentId{s}, a + 0.3 * (b - a)), CarrierKind::segment, s);
            }
            for (std::uint32_t f = 0; f < plc.facets.size(); ++f)
                for (const auto& t : plc.facets[f].triangles) {
                    const Vec3 &a = plc.vertices[t[0].index()], &b = plc.vertices[t[1].index()], &c = plc.vertices[t[2].index()];
                    expect(project_to_facet(plc.facets[f], a + 0.3 * (b - a) + 0.2 * (c - a)), CarrierKind::facet, f);
                }
            for (const ValidCell& c : plc.cells)
                if (c.filled) {
                    EXPECT_FALSE(finder.find(c.inside, 0, 0).has_value());
                    EXPECT_GT(finder.distance_to_facets(c.inside), tolerance);
                }
        }
}

TEST(CarrierFinder, ReferencesDecideOnlyWhereSeveralAreNear) {
    Plc plate = cube();
    for (Vec3& p : plate.vertices) p.z *= 0.1;
    const ValidPlc plc = validate(plate);
    const CarrierFinder finder(plc, 0.06);
    const Vec3 nearer_below{0.5, 0.5, 0.045};
    const auto facet_at = [&](double z) {
        const auto f = std::find_if(plc.facets.begin(), plc.facets.end(), [&](const ValidFacet& x) {
            return std::all_of(x.vertices.begin(), x.vertices.end(), [&](VertexId v) { return plc.vertices[v.index()].z == z; });
        });
        return static_cast<std::uint32_t>(f - plc.facets.begin());
    };
    const std::uint32_t bottom = facet_at(0), top = facet_at(0.1);
    ASSERT_LT(std::max(bottom, top), plc.facets.size());
    const auto named = [&](std::uint32_t f) { return static_cast<std::int32_t>(plc.facets[f].source_facet + 1); };
    EXPECT_EQ(finder.find(nearer_below, 0, 0)->id, bottom);
    EXPECT_EQ(finder.find(nearer_below, named(top), 0)->id, top);
    EXPECT_EQ(finder.find(nearer_below, 99, 0)->id, bottom);
    EXPECT_EQ(finder.find({0.5, 0.5, 0.02}, named(top), 0)->id, bottom);  // the top is too far
    EXPECT_NEAR(finder.find(nearer_below, named(top), 0)->point.z, 0.1, 1e-15);
}

}  // namespace
}  // namespace wellmesh::testing
