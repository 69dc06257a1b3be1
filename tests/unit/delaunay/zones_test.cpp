// SPDX-License-Identifier: Apache-2.0
// Bulk insertion on several threads: the same tetrahedra, in the same canonical order, as on one.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "core/rng.hpp"
#include "delaunay/canonical_order.hpp"
#include "delaunay/check_delaunay.hpp"
#include "delaunay/spatial_order.hpp"
#include "delaunay/triangulation.hpp"
#include "support/any_threads.hpp"

namespace wellmesh {
namespace {

using testing::kSanitized;

/// Enough for several zones each with the numbers of threads below.
constexpr std::size_t kPoints = kSanitized ? 15'000 : 60'000;

double random_unit(std::uint64_t seed, std::uint64_t i) { return unit_double(mix64(seed, i)); }

std::vector<Vec3> uniform(std::size_t n) {
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < n; ++i) out.push_back({random_unit(1, 3 * i), random_unit(1, 3 * i + 1), random_unit(1, 3 * i + 2)});
    return out;
}

/// All cospherical eight by eight: every tie is broken symbolically.
std::vector<Vec3> grid(int n) {
    std::vector<Vec3> out;
    for (int x = 0; x < n; ++x)
        for (int y = 0; y < n; ++y)
            for (int z = 0; z < n; ++z) out.push_back({double(x), double(y), double(z)});
    return out;
}

/// Most of the points in a thousandth of the box.
std::vector<Vec3> clustered(std::size_t n) {
    std::vector<Vec3> out = uniform(n);
    for (std::size_t i = 0; i < n; i += 1 + i % 3) out[i] = {0.3 + 0.1 * out[i].x * out[i].x, 0.7 + 0.1 * out[i].y, 0.1 * out[i].z};
    return out;
}

/// On a sphere, whose triangulation has tetrahedra through all of its inside.
std::vector<Vec3> on_sphere(std::size_t n) {
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < n; ++i) {
        const double z = 2 * random_unit(5, 2 * i) - 1, angle = 6.283185307179586 * random_unit(5, 2 * i + 1), r = std::sqrt(1 - z * z);
        out.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
    return out;
}

/// Every third point is there two or three times.
std::vector<Vec3> with_duplicates(std::size_t n) {
    std::vector<Vec3> out = uniform(n);
    for (std::size_t i = 0; i < n; i += 3) out[i] = out[i / 2];
    return out;
}

struct Made {
    std::vector<TetStore::Corners> tets;
    std::size_t duplicates = 0;
    std::string flaws;
    friend bool operator==(const Made&, const Made&) = default;
};

Made make(const std::vector<Vec3>& points, unsigned threads) {
    Vec3 lo = points.at(0), hi = lo;
    for (const Vec3& p : points) {
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    Workers workers(threads);
    Triangulation mesh(lo, hi);
    EXPECT_TRUE(mesh.insert_all_in_order(points, biased_spatial_order(points, workers), workers));
    Made out;
    out.duplicates = mesh.duplicate_count();
    out.flaws = check_adjacency(mesh) + check_delaunay(mesh);
    visit_in_canonical_order<true>(
        mesh.tets(), mesh.vertex_count(), workers, [&](std::size_t n) { out.tets.resize(n); },
        [&](std::size_t place, TetId, const TetStore::Corners& c) { out.tets[place] = c; });
    return out;
}

class Zones : public ::testing::TestWithParam<int> {
protected:
    static std::vector<Vec3> points() {
        switch (GetParam()) {
            case 0: return uniform(kPoints);
            case 1: return grid(kSanitized ? 24 : 32);
            case 2: return clustered(kPoints);
            case 3: return on_sphere(13'000);
            default: return with_duplicates(kPoints);
        }
    }
};

TEST_P(Zones, TheSameForAnyNumberOfThreads) {
    const std::vector<Vec3> input = points();
    const Made made = testing::same_for_any_threads([&](unsigned threads) {
        Made one = make(input, threads);
        EXPECT_EQ(one.flaws, "") << threads << " threads";
        return one;
    });
    EXPECT_TRUE(std::is_sorted(made.tets.begin(), made.tets.end()));
}

INSTANTIATE_TEST_SUITE_P(Points, Zones, ::testing::Range(0, 5));

TEST(Renumber, TheSameMeshInCanonicalOrder) {
    const std::vector<Vec3> points = clustered(kSanitized ? kPoints : 20'000);
    for (const unsigned threads : kSanitized ? std::vector{3U} : std::vector{1U, 4U}) {
        Workers workers(threads);
        Triangulation mesh({0, 0, 0}, {1, 1, 1});
        ASSERT_TRUE(mesh.insert_all_in_order(points, biased_spatial_order(points), workers));
        const TetStore before = mesh.tets();
        const Triangulation::Renumbering renumbering = mesh.renumber(workers);
        const std::vector<TetId>& old_of = renumbering.old_of;
        EXPECT_EQ(mesh.tets().slots(), before.live());
        EXPECT_EQ(mesh.tets().live(), before.live());
        EXPECT_EQ(check_adjacency(mesh) + check_delaunay(mesh), "");
        TetStore::Corners last{};
        for (std::size_t i = 0; i < old_of.size(); ++i) {
            const TetStore::Corners c = mesh.tets().corners(TetId{i});
            EXPECT_EQ(c, canonical_corners(before.corners(old_of[i])));
            for (unsigned k = 0; k < 4; ++k) EXPECT_EQ(c[k], before.corner(old_of[i], renumbering.old_corner(TetId{i}, k)));
            EXPECT_TRUE(i == 0 || last < c);
            last = c;
        }
    }
}

/// Refuses what lies in a ball, and counts.
class Refuser : public BulkObserver {
public:
    explicit Refuser(const Triangulation& mesh) : mesh_(mesh) {}
    void make_room(std::size_t) override {}
    void split(std::size_t zones) override { split_ = split_ || zones > 1; }
    BulkObserver& for_zone(std::size_t) override { return *this; }
    void join() override {}
    bool welcomes(const Vec3& p, TetId) override { return p.x < 0.9; }
    Answer prepare(VertexId, const Cavity& cavity) override {
        const Vec3 &p = cavity.point;
        return (p.x - 0.5) * (p.x - 0.5) + (p.y - 0.5) * (p.y - 0.5) + (p.z - 0.5) * (p.z - 0.5) < 0.04 ? Answer::never : Answer::yes;
    }
    void made(VertexId v, const std::vector<TetId>& tets) override {
        made_ += 1;
        if (mesh_.tets().find_corner(tets.at(0), v) == 4) wrong_ += 1;
    }
    bool may_go_on() override { return !stop_ || made_ < 3000; }

    std::atomic<std::size_t> made_{0}, wrong_{0};
    bool split_ = false, stop_ = false;

private:
    const Triangulation& mesh_;
};

TEST(Zones, RefusedPointsAreLeftAndToldOf) {
    const std::vector<Vec3> points = uniform(kPoints);
    for (const unsigned threads : kSanitized ? std::vector{3U} : std::vector{1U, 2U, 4U}) {
        Workers workers(threads);
        Triangulation mesh({0, 0, 0}, {1, 1, 1});
        std::vector<std::uint32_t> order = biased_spatial_order(points);
        std::vector<Vec3> first;
        for (std::size_t k = 0; k < 10; ++k) first.push_back(points[order[k]]);
        ASSERT_TRUE(mesh.insert_all(first));
        std::vector<std::uint32_t> rest;
        for (std::size_t k = 10; k < order.size(); ++k) rest.push_back(mesh.add_point(points[order[k]]).value());
        Refuser observer(mesh);
        const std::vector<std::uint32_t> left = mesh.insert_on(workers, rest, &observer);
        EXPECT_EQ(observer.split_, threads > 1);
        EXPECT_EQ(observer.made_ + left.size(), rest.size());
        EXPECT_EQ(observer.wrong_, 0U);
        std::size_t expected = 0;
        for (const std::uint32_t i : rest) {
            const Vec3& p = mesh.point(VertexId{i});
            expected += p.x >= 0.9 || (p.x - 0.5) * (p.x - 0.5) + (p.y - 0.5) * (p.y - 0.5) + (p.z - 0.5) * (p.z - 0.5) < 0.04;
        }
        EXPECT_EQ(left.size(), expected);
        for (const std::uint32_t i : left) EXPECT_FALSE(mesh.is_inserted(VertexId{i}));
        EXPECT_EQ(check_adjacency(mesh) + check_delaunay(mesh), "");
    }
}

TEST(Zones, StopsWhenTheObserverSaysSo) {
    const std::vector<Vec3> points = uniform(60'000);
    for (const unsigned threads : {1U, 2U}) {
        Workers workers(threads);
        Triangulation mesh({0, 0, 0}, {1, 1, 1});
        ASSERT_TRUE(mesh.insert_all(std::vector<Vec3>(points.begin(), points.begin() + 10)));
        std::vector<std::uint32_t> rest;
        for (std::size_t k = 10; k < points.size(); ++k) rest.push_back(mesh.add_point(points[k]).value());
        Refuser observer(mesh);
        observer.stop_ = true;
        const std::vector<std::uint32_t> left = mesh.insert_on(workers, rest, &observer);
        EXPECT_LT(observer.made_, 8000U);
        EXPECT_EQ(observer.made_ + left.size(), rest.size());
        EXPECT_EQ(check_adjacency(mesh) + check_delaunay(mesh), "");
    }
}

TEST(SpatialOrder, TheSameForAnyNumberOfThreadsAndEachPointOnce) {
    const std::vector<Vec3> points = clustered(10'001);
    Workers alone(1), team(3);
    for (const bool biased : {false, true}) {
        const auto order = [&](Workers& w) { return biased ? biased_spatial_order(points, w) : spatial_order(points, w); };
        const std::vector<std::uint32_t> expected = order(alone);
        EXPECT_EQ(order(team), expected);
        EXPECT_EQ(std::set<std::uint32_t>(expected.begin(), expected.end()).size(), points.size());
    }
}

/// Along the curve through all cells of a grid each step goes to a neighbouring cell: that is what makes it Hilbert's.
TEST(SpatialOrder, StepsGoToNeighbours) {
    const std::vector<Vec3> points = grid(16);
    const std::vector<std::uint32_t> order = spatial_order(points);
    std::size_t far = 0;
    for (std::size_t i = 1; i < order.size(); ++i) {
        const Vec3 &p = points[order[i - 1]], &q = points[order[i]];
        far += std::abs(p.x - q.x) + std::abs(p.y - q.y) + std::abs(p.z - q.z) > 1;
    }
    EXPECT_EQ(far, 0U);
}

}  // namespace
}  // namespace wellmesh
