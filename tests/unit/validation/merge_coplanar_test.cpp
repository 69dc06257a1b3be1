// SPDX-License-Identifier: Apache-2.0
// Which triangles become one facet: rounding may be forgiven, shape may not.
#include "plc_helpers.hpp"

#include <cmath>
#include <numbers>

#include "core/rng.hpp"

namespace wellmesh::testing {
namespace {

/// A box whose six sides are grids of n x n squares of two triangles each.
Plc gridded_box(unsigned n, const Vec3& size) {
    Plc plc = surface();
    const std::array<double, 3> extent{size.x, size.y, size.z};
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (unsigned side = 0; side < 2; ++side) {
            const auto first = static_cast<std::uint32_t>(plc.vertices.size());
            for (unsigned i = 0; i <= n; ++i)
                for (unsigned j = 0; j <= n; ++j) {
                    std::array<double, 3> c{};
                    c[axis] = side * extent[axis];
                    c[(axis + 1) % 3] = extent[(axis + 1) % 3] * i / n;
                    c[(axis + 2) % 3] = extent[(axis + 2) % 3] * j / n;
                    plc.vertices.push_back({c[0], c[1], c[2]});
                }
            for (unsigned i = 0; i < n; ++i)
                for (unsigned j = 0; j < n; ++j) {
                    const std::uint32_t a = first + i * (n + 1) + j, b = a + n + 1;
                    for (std::array<std::uint32_t, 3> t : {std::array{a, b, b + 1}, std::array{a, b + 1, a + 1}}) {
                        if (side == 0) std::swap(t[1], t[2]);
                        PlcFacet f;
                        f.polygons = {{t[0], t[1], t[2]}};
                        plc.facets.push_back(f);
                    }
                }
        }
    return plc;
}

TEST(MergeCoplanar, RotatedAndShiftedGridsBecomeSixFacets) {
    for (const Vec3& size : {Vec3{1, 1, 1}, Vec3{1, 0.01, 3}})
        for (const std::uint64_t rotation : {1U, 2U})
            for (const double shift : {0.0, 1e3, 1e6}) {
                Plc plc = gridded_box(9, size);
                plc = transformed(plc, rotation, shift, 1);
                const ValidPlc valid = validate(plc);
                EXPECT_EQ(valid.facets.size(), 6U) << shift << " " << size.y;
                EXPECT_EQ(valid.segments.size(), 12U * 9U);
                EXPECT_EQ(valid.vertices.size(), 6U * 64 + 12 * 8 + 8);
                EXPECT_TRUE(valid.acute_features.empty()) << shift << ' ' << size.y << ' ' << listing(valid.diagnosis);
                EXPECT_LE(valid.coplanar_tolerance, 1e-15 * (4 + 2 * shift * diagonal(gridded_box(1, size))));
                expect_consistent(valid);
            }
}

TEST(MergeCoplanar, SinglePrecisionNeedsToBeStated) {
    Plc plc = transformed(gridded_box(5, {1, 2, 3}), 3, 0, 1);
    for (Vec3& p : plc.vertices) p = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    EXPECT_GT(validate(plc).facets.size(), 100U);
    plc.relative_rounding = 0x1p-24;
    const ValidPlc valid = validate(plc);
    EXPECT_EQ(valid.facets.size(), 6U);
    EXPECT_LT(valid.coplanar_tolerance, 1e-6);
    EXPECT_TRUE(valid.acute_features.empty());
}

TEST(MergeCoplanar, CurvedSurfacesKeepTheirShapeHoweverFine) {
    // a prism over a regular polygon of many sides: neighbours bend by 2 pi / n, each side is 1 / n wide
    std::size_t fewest = 1000000;
    for (const unsigned n : {100U, 1000U, 4000U}) {
        Plc plc = surface();
        for (unsigned i = 0; i < n; ++i)
            for (const double z : {0.0, 1.0}) {
                const double a = 2 * std::numbers::pi * i / n;
                plc.vertices.push_back({std::cos(a), std::sin(a), z});
            }
        for (unsigned i = 0; i < n; ++i) {
            const std::uint32_t a = 2 * i, b = 2 * ((i + 1) % n);
            for (const std::array<std::uint32_t, 3>& t : {std::array{a, b, b + 1}, std::array{a, b + 1, a + 1}}) {
                PlcFacet f;
                f.polygons = {{t[0], t[1], t[2]}};
                plc.facets.push_back(f);
            }
        }
        PlcFacet low, high;
        low.polygons.resize(1);
        high.polygons.resize(1);
        for (unsigned i = 0; i < n; ++i) {
            low.polygons[0].push_back(2 * (n - 1 - i));
            high.polygons[0].push_back(2 * i + 1);
        }
        plc.facets.push_back(low);
        plc.facets.push_back(high);
        const ValidPlc valid = validate(plc);
        EXPECT_EQ(valid.facets.size(), n + 2);
        EXPECT_TRUE(valid.acute_features.empty());
        for (const double rounding : {1e-7, 1e-6, 1e-5}) {
            plc.relative_rounding = rounding;
            const ValidPlc rounded = validate(plc);
            EXPECT_LE(rounded.coplanar_tolerance, 3.5 * rounding + 1e-14);  // fewer facets, but none leaves the input by more than its rounding
            fewest = std::min(fewest, rounded.facets.size());
            expect_consistent(rounded);
        }
        if (n == 4000) {
            EXPECT_LT(fewest, 1000U);  // the bound was put to the test
        }
    }
}

}  // namespace
}  // namespace wellmesh::testing
