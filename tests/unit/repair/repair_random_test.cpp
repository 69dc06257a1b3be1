// SPDX-License-Identifier: Apache-2.0
// Laws on random inputs: the result is a valid complex (but for open edges) or says that it is not, and covers the input within the bound.
#include <gtest/gtest.h>

#include <array>
#include <map>

#include "../validation/plc_helpers.hpp"
#include "core/rng.hpp"
#include "validation/closest_points.hpp"
#include "wellmesh/repair.hpp"

namespace wellmesh::testing {
namespace {

double draw(std::uint64_t seed, std::uint64_t k) { return unit_double(mix64(seed, k)); }

/// Largest distance of a sample of the first's triangles from the second's.
double one_sided_distance(const Plc& from, const Plc& to, std::uint64_t seed) {
    double farthest = 0;
    std::uint64_t k = 0;
    for (const PlcFacet& f : from.facets) {
        const auto& v = f.polygons[0];
        double a = draw(seed, k), b = draw(seed, k + 1);
        k += 2;
        if (a + b > 1) {
            a = 1 - a;
            b = 1 - b;
        }
        const Vec3& o = from.vertices[v[0]];
        const Vec3 p = o + a * (from.vertices[v[1]] - o) + b * (from.vertices[v[2]] - o);
        double nearest = 1e300;
        for (const PlcFacet& g : to.facets) {
            const auto& w = g.polygons[0];
            nearest = std::min(nearest, distance_to_triangle(p, to.vertices[w[0]], to.vertices[w[1]], to.vertices[w[2]]));
        }
        farthest = std::max(farthest, nearest);
    }
    return farthest;
}

std::size_t errors_but_open(const Diagnosis& d) {
    return static_cast<std::size_t>(std::count_if(d.defects.begin(), d.defects.end(), [](const Defect& x) {
        return x.severity == Severity::error && x.kind != DefectKind::open_edge && x.kind != DefectKind::no_cell;
    }));
}

TEST(RepairRandom, SoupsBecomeComplexes) {
    std::size_t resolved = 0, cut = 0;
    constexpr std::uint64_t kSoups = 60;
    for (std::uint64_t seed = 0; seed < kSoups; ++seed) {
        SCOPED_TRACE(seed);
        Plc plc = surface();
        const std::size_t n = 4 + mix64(seed, 1000000) % 24;
        const bool on_lattice = seed % 3 == 0;  // touching, coplanar and overlapping ones
        for (std::uint32_t t = 0; t < n; ++t) {
            for (std::uint64_t i = 0; i < 3; ++i) {
                Vec3 p{draw(seed, 9 * t + 3 * i), draw(seed, 9 * t + 3 * i + 1), draw(seed, 9 * t + 3 * i + 2)};
                if (on_lattice) p = {std::floor(4 * p.x), std::floor(4 * p.y), std::floor(4 * p.z)};
                plc.vertices.push_back(p);
            }
            PlcFacet f;
            f.polygons = {{3 * t, 3 * t + 1, 3 * t + 2}};
            plc.facets.push_back(f);
        }
        const RepairResult r = repair(plc);
        if (!r.resolved) {
            EXPECT_NE(r.summary.find("Given up"), std::string::npos);
            continue;
        }
        ++resolved;
        cut += r.actions.intersection_points > 0;
        EXPECT_EQ(errors_but_open(r.diagnosis), 0U) << listing(r.diagnosis);
        EXPECT_LE(r.max_displacement, 2 * r.tolerance);
        EXPECT_LE(one_sided_distance(r.plc, plc, seed), 2 * r.tolerance);
        if (on_lattice) continue;  // triangles without area and folds may have been left out
        EXPECT_LE(one_sided_distance(plc, r.plc, seed), 2 * r.tolerance);
    }
    EXPECT_EQ(resolved, kSoups);
    EXPECT_GT(cut, kSoups / 2);
}

/// Sums of directions in which facets pass each edge; none is left for a surface without border.
std::size_t unbalanced_edges(const Plc& plc) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> passed;
    for (const PlcFacet& f : plc.facets)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = f.polygons[0][i], b = f.polygons[0][(i + 1) % 3];
            passed[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    return static_cast<std::size_t>(std::count_if(passed.begin(), passed.end(), [](const auto& edge) { return edge.second != 0; }));
}

TEST(RepairRandom, ClosedStaysClosed) {
    // flat and needle-like tetrahedra that overlap; what is lower than the tolerance folds when it is joined
    std::size_t resolved = 0;
    constexpr std::uint64_t kClusters = 100;
    for (std::uint64_t seed = 0; seed < kClusters; ++seed) {
        SCOPED_TRACE(seed);
        Plc plc = surface();
        const std::uint32_t tets = 1 + static_cast<std::uint32_t>(seed % 4);
        for (std::uint32_t t = 0; t < tets; ++t) {
            for (std::uint64_t i = 0; i < 4; ++i) {
                const auto coordinate = [&](std::uint64_t k) {  // two of three on a coarse lattice, but for some tolerances
                    const double x = draw(seed, 12 * t + 3 * i + k), off = draw(seed, 1000 + 12 * t + 3 * i + k) - 0.5;
                    return (t + k) % 3 == 0 ? x : std::floor(4 * x) / 4 + 0.004 * off;
                };
                plc.vertices.push_back({coordinate(0), coordinate(1), coordinate(2)});
            }
            const std::uint32_t a = 4 * t, b = a + 1, c = a + 2, d = a + 3;
            for (const auto& f : {std::array{a, c, b}, std::array{a, b, d}, std::array{b, c, d}, std::array{c, a, d}})
                plc.facets.push_back({{{f[0], f[1], f[2]}}, {}, 0});
        }
        const RepairResult r = repair(plc, {.tolerance = 1e-3});
        if (!r.resolved) continue;
        ++resolved;
        EXPECT_EQ(unbalanced_edges(r.plc), 0U) << r.summary;
        EXPECT_EQ(count(r.diagnosis, DefectKind::open_edge), 0U);
    }
    EXPECT_GE(resolved, kClusters - 2);
}

TEST(RepairRandom, ResultsAreStable) {
    Plc plc = surface();
    for (std::uint64_t b = 0; b < 8; ++b) {
        const Vec3 low{draw(1, 6 * b), draw(1, 6 * b + 1), draw(1, 6 * b + 2)};
        add_box(plc, low, low + Vec3{0.3 + draw(1, 6 * b + 3), 0.3 + draw(1, 6 * b + 4), 0.3 + draw(1, 6 * b + 5)});
    }
    const RepairResult once = repair(plc), again = repair(plc), twice = repair(once.plc);
    ASSERT_TRUE(once.resolved);
    EXPECT_FALSE(once.diagnosis.has_errors()) << listing(once.diagnosis);
    EXPECT_EQ(once.plc.vertices, again.plc.vertices);
    EXPECT_EQ(twice.plc.vertices, once.plc.vertices);  // nothing to do
    EXPECT_EQ(twice.actions.intersection_points, 0U);
}

TEST(RepairRandom, NoisySphere) {
    // an octahedron split four times, on the sphere, each coordinate moved by up to a tenth of the radius: neighbours cut each other
    Plc plc = surface();
    plc.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    std::vector<std::array<std::uint32_t, 3>> faces{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < 4; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
        std::vector<std::array<std::uint32_t, 3>> finer;
        const auto between = [&](std::uint32_t a, std::uint32_t b) {
            const auto [it, fresh] = middle.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(plc.vertices.size()));
            if (fresh) {
                const Vec3 m = plc.vertices[a] + plc.vertices[b];
                plc.vertices.push_back((1 / norm(m)) * m);
            }
            return it->second;
        };
        for (const auto& [a, b, c] : faces) {
            const std::uint32_t ab = between(a, b), bc = between(b, c), ca = between(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        faces = finer;
    }
    for (std::size_t v = 0; v < plc.vertices.size(); ++v) {
        const Vec3 noise{draw(7, 3 * v) - 0.5, draw(7, 3 * v + 1) - 0.5, draw(7, 3 * v + 2) - 0.5};
        plc.vertices[v] = plc.vertices[v] + 0.2 * noise;
    }
    for (const auto& f : faces) plc.facets.push_back({{{f[0], f[1], f[2]}}, {}, 0});
    ASSERT_GT(count(diagnose(plc), DefectKind::self_intersection), 20U);
    const RepairResult r = repair(plc);
    EXPECT_TRUE(r.resolved) << r.summary;
    EXPECT_FALSE(r.diagnosis.has_errors()) << listing(r.diagnosis);
    EXPECT_LE(r.max_displacement, 2 * r.tolerance);
}

}  // namespace
}  // namespace wellmesh::testing
