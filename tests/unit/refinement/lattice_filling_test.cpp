// SPDX-License-Identifier: Apache-2.0
// Known tetrahedra of the lattice: the triangulation is the one that insertion makes.
#include "refinement/lattice_filling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <vector>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "delaunay/check_delaunay.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh::testing {
namespace {

/// Two balls of a lattice with constant 1 that don't touch, a few of whose points are missing, among other points.
struct Scene {
    GradedOctree tree{{0, 0, 0}, 16};
    LatticeLeaves leaves;
    std::vector<Vec3> points;          // the lattice's, then others
    std::vector<VertexId> vertex_of;   // by point of the lattice
    std::vector<Box> occupied;
    std::size_t lattice = 0;
    Workers workers;
    std::optional<LatticeFilling> filling;
    std::vector<char> is_known;

    explicit Scene(std::uint64_t seed, unsigned threads = 1) : workers(threads) {
        for (unsigned level = 0; level < 4; ++level)
            for (std::uint32_t i = 0, n = static_cast<std::uint32_t>(tree.size()); i < n; ++i)
                if (tree.is_leaf(i)) tree.split(i);
        for (std::uint32_t i = 0; i < tree.size(); ++i) {
            const GradedOctree::Box b = tree.box(i);
            const Vec3 c{b.lo.x + 0.5, b.lo.y + 0.5, b.lo.z + 0.5};
            if (tree.is_leaf(i) && (distance(c, {4, 4.2, 4.1}) < 4.2 || distance(c, {11.5, 11.2, 11.7}) < 4.6)) tree.use(i);
        }
        const auto random = [&](std::uint64_t k) { return unit_double(mix64(seed, k)); };
        std::uint64_t k = 0;
        for (const LatticePoint& p : tree.lattice(workers, leaves)) {
            vertex_of.push_back(random(k++) < 0.01 ? VertexId{} : VertexId{points.size()});
            const double x = random(k++), y = random(k++), z = random(k++);
            points.push_back(p.point + 1e-4 * Vec3{x - 0.5, y - 0.5, z - 0.5});
        }
        lattice = points.size();
        for (int i = 0; i < 8; ++i) add({i & 1 ? 20.0 : -4.0, i & 2 ? 20.0 : -4.0, i & 4 ? 20.0 : -4.0});
        for (int i = 0; i < 60; ++i) {
            const double x = random(k++), y = random(k++), z = random(k++);
            if (i % 20 == 0 || distance({16 * x, 16 * y, 16 * z}, {4, 4.2, 4.1}) > 3.5) add({16 * x, 16 * y, 16 * z});
        }
        filling.emplace(tree, leaves, occupied, workers);
        is_known = filling->far_points(lattice);
        std::vector<char> is_there(lattice);
        for (std::size_t p = 0; p < lattice; ++p) {
            is_there[p] = vertex_of[p].valid();
            is_known[p] = is_known[p] != 0 && is_there[p] != 0;
        }
        for (auto lack = filling->short_of_neighbours(is_known, is_there); !lack.empty(); lack = filling->short_of_neighbours(is_known, is_there))
            for (const std::uint32_t p : lack) is_known[p] = 0;
        filling->know(is_known, vertex_of, points.size());
    }
    void add(const Vec3& p) {
        points.push_back(p);
        occupied.push_back({p, p});
    }

    /// Of the vertices for which `wanted` holds; the box's corners among them.
    template <class Wanted>
    Triangulation triangulated(Wanted&& wanted) {
        Triangulation tri({-4, -4, -4}, {20, 20, 20});
        for (const Vec3& p : points) tri.add_point(p);
        const auto corner = [&](std::size_t i) { return VertexId{lattice + i}; };
        tri.start(corner(0), corner(1), corner(2), corner(4));
        std::vector<std::uint32_t> order;
        for (std::uint32_t v = 0; v < points.size(); ++v)
            if (v >= lattice || (vertex_of[v].valid() && wanted(v))) order.push_back(v);
        std::erase_if(order, [&](std::uint32_t v) { return tri.is_inserted(VertexId{v}); });
        EXPECT_TRUE(tri.insert_on(workers, order).empty());
        return tri;
    }
};

std::set<std::array<std::uint32_t, 4>> tets_of(const Triangulation& tri) {
    std::set<std::array<std::uint32_t, 4>> out;
    for (std::size_t i = 0; i < tri.tets().slots(); ++i) {
        if (!tri.tets().is_live(TetId{i})) continue;
        std::array<std::uint32_t, 4> c{};
        for (unsigned k = 0; k < 4; ++k) c[k] = tri.tets().corner(TetId{i}, k).value();
        std::sort(c.begin(), c.end());
        out.insert(c);
    }
    return out;
}

constexpr auto kGoesOn = [] { return true; };

TEST(LatticeFilling, MakesWhatInsertionMakes) {
    for (std::uint64_t seed = 0; seed < 6; ++seed)
        for (const unsigned threads : {1U, 3U}) {
            SCOPED_TRACE(seed);
            Scene scene(seed, threads);
            const Triangulation whole = scene.triangulated([](std::uint32_t) { return true; });
            // Some of the points whose stars are known are there all the same.
            Triangulation part = scene.triangulated([&](std::uint32_t v) { return scene.is_known[v] == 0 || mix64(seed, v) % 8 == 0; });
            EXPECT_GT(std::count(scene.is_known.begin(), scene.is_known.end(), 1), 100);
            EXPECT_GT(scene.filling->count(), 1500U);
            KnownRegion region;
            ASSERT_TRUE(part.find_region(scene.workers, *scene.filling, region, kGoesOn));
            EXPECT_GT(std::set<std::uint32_t>(region.group.begin(), region.group.end()).size(), 1U);
            part.replace_region(scene.workers, *scene.filling, region);
            EXPECT_EQ(check_adjacency(part), "");
            EXPECT_EQ(check_delaunay(part), "");
            EXPECT_TRUE(tets_of(part) == tets_of(whole));
            for (std::size_t v = 0; v < scene.points.size(); ++v) {
                ASSERT_EQ(part.is_inserted(VertexId{v}), whole.is_inserted(VertexId{v}));
                if (part.is_inserted(VertexId{v})) {
                    ASSERT_LT(part.tets().find_corner(part.tet_of(VertexId{v}), VertexId{v}), 4U);
                }
            }
        }
}

TEST(LatticeFilling, RefusesARegionWithAnotherVertexOrWithoutItsRim) {
    Scene scene(7);
    const auto is_shell = [&](std::uint32_t v) { return scene.is_known[v] == 0; };
    KnownRegion region;
    {
        Triangulation tri = scene.triangulated(is_shell);
        const auto known = static_cast<std::size_t>(std::find(scene.is_known.begin(), scene.is_known.end(), 1) - scene.is_known.begin());
        const VertexId stranger = tri.add_point(scene.points[known] + Vec3{0.1, 0.2, 0.05});
        Cavity cavity;
        ASSERT_TRUE(tri.find_conflict_cavity(tri.point(stranger), tri.tet_of(VertexId{scene.lattice}), cavity));
        tri.insert_vertex(stranger, cavity);
        scene.filling->know(scene.is_known, scene.vertex_of, scene.points.size() + 1);
        EXPECT_FALSE(tri.find_region(scene.workers, *scene.filling, region, kGoesOn));
        EXPECT_EQ(check_adjacency(tri), "");
    }
    scene.filling->know(scene.is_known, scene.vertex_of, scene.points.size());
    const VertexId on_rim = scene.filling->rim()[scene.filling->rim().size() / 2].corners[0];
    Triangulation tri = scene.triangulated([&](std::uint32_t v) { return is_shell(v) && v != on_rim.value(); });
    EXPECT_FALSE(tri.find_region(scene.workers, *scene.filling, region, kGoesOn));
    Triangulation complete = scene.triangulated(is_shell);
    const auto before = tets_of(complete);
    EXPECT_FALSE(complete.find_region(scene.workers, *scene.filling, region, [] { return false; }));
    EXPECT_TRUE(tets_of(complete) == before);
    EXPECT_TRUE(complete.find_region(scene.workers, *scene.filling, region, kGoesOn));
}

}  // namespace
}  // namespace wellmesh::testing
