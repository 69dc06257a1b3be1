// SPDX-License-Identifier: Apache-2.0
// The kernel against its own laws and a fresh triangulation: the triangulation is a function of the point set alone.
#include "delaunay/triangulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "delaunay/check_delaunay.hpp"
#include "delaunay/local_numbers.hpp"

namespace wellmesh {
namespace {

using Tets = std::set<std::array<std::array<double, 3>, 4>>;

/// The finite tetrahedra as sets of coordinates: comparable between triangulations with different numbering.
Tets tets_of(const Triangulation& mesh) {
    Tets out;
    for (std::size_t i = 0; i < mesh.tets().slots(); ++i) {
        const TetId t{i};
        if (!mesh.tets().is_finite(t)) continue;
        std::array<std::array<double, 3>, 4> corners;
        for (std::size_t k = 0; k < 4; ++k) {
            const Vec3& p = mesh.point(mesh.tets().corners(t)[k]);
            corners[k] = {p.x, p.y, p.z};
        }
        std::sort(corners.begin(), corners.end());
        out.insert(corners);
    }
    return out;
}

Triangulation triangulate(const std::vector<Vec3>& points) {
    Vec3 lo = points.at(0), hi = lo;
    for (const Vec3& p : points) {
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    Triangulation mesh(lo, hi);
    EXPECT_TRUE(mesh.insert_all(points));
    return mesh;
}

std::vector<Vec3> random_points(std::size_t n, std::uint64_t seed) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < n; ++i)
        points.push_back({unit_double(mix64(seed, 3 * i)), unit_double(mix64(seed, 3 * i + 1)), unit_double(mix64(seed, 3 * i + 2))});
    return points;
}

std::vector<Vec3> grid(int n) {
    std::vector<Vec3> points;
    for (int x = 0; x < n; ++x)
        for (int y = 0; y < n; ++y)
            for (int z = 0; z < n; ++z) points.push_back({double(x), double(y), double(z)});
    return points;
}

/// A rotated grid: nearly, but not exactly, cospherical and coplanar everywhere.
std::vector<Vec3> rotated_grid(int n) {
    const double c = std::cos(0.3), s = std::sin(0.3);
    std::vector<Vec3> points = grid(n);
    for (Vec3& p : points) {
        p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
        p = {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
    }
    return points;
}

/// Points on a sphere (a cube's surface points normalised) and on its coordinate planes: many cospherical, some exactly.
std::vector<Vec3> sphere_points(std::size_t n, std::uint64_t seed) {
    std::vector<Vec3> points;
    for (const Vec3& p : random_points(n, seed)) {
        const Vec3 q{std::round(8 * p.x - 4), std::round(8 * p.y - 4), std::round(8 * p.z - 4)};
        const Vec3 r = p - Vec3{0.5, 0.5, 0.5};
        points.push_back((1 / norm(r)) * r);
        points.push_back(q);
    }
    return points;
}

/// Random points on the faces and edges of two crossed bars: coplanar and collinear everywhere, not cospherical, the hull not the shape.
std::vector<Vec3> crossed_bars(std::size_t n, std::uint64_t seed) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < n; ++i) {
        const auto u = [&](std::uint64_t k) { return unit_double(mix64(seed, 8 * i + k)); };
        Vec3 p{35 * u(0) - 17.5, u(1) < 0.5 ? -0.35 : 0.35, u(2) < 0.5 ? -0.1 : 0.1};  // on an edge
        if (u(3) < 0.3) p.y = 0.7 * u(4) - 0.35;                                         // on a face
        if (u(5) < 0.5) std::swap(p.x, p.y);
        points.push_back(p);
    }
    return points;
}

std::vector<std::vector<Vec3>> all_clouds() {
    return {random_points(1500, 1), grid(9), rotated_grid(9), sphere_points(500, 7), crossed_bars(800, 3)};
}

void expect_valid(const Triangulation& mesh) {
    ASSERT_EQ(check_adjacency(mesh), "");
    ASSERT_EQ(check_delaunay(mesh), "");
}

TEST(Triangulation, IsDelaunayAndConvex) {
    for (const auto& cloud : all_clouds()) {
        const Triangulation mesh = triangulate(cloud);
        expect_valid(mesh);
        const std::set<std::array<double, 3>> distinct = [&] {
            std::set<std::array<double, 3>> s;
            for (const Vec3& p : cloud) s.insert({p.x + 0.0, p.y + 0.0, p.z + 0.0});
            return s;
        }();
        EXPECT_EQ(distinct.size() + mesh.duplicate_count(), cloud.size());
    }
}

TEST(Triangulation, VolumeOfGridIsExact) {
    const Triangulation mesh = triangulate(grid(6));
    double volume = 0;
    for (std::size_t i = 0; i < mesh.tets().slots(); ++i) {
        const TetId t{i};
        if (!mesh.tets().is_finite(t)) continue;
        const auto& c = mesh.tets().corners(t);
        volume += determinant(mesh.point(c[1]) - mesh.point(c[0]), mesh.point(c[2]) - mesh.point(c[0]), mesh.point(c[3]) - mesh.point(c[0])) / 6;
    }
    EXPECT_NEAR(volume, 125, 1e-9);
}

TEST(Triangulation, IgnoresNumbering) {
    for (const auto& cloud : all_clouds()) {
        std::vector<Vec3> shuffled = cloud;
        for (std::size_t i = shuffled.size(); i > 1; --i) std::swap(shuffled[i - 1], shuffled[mix64(99, i) % i]);
        EXPECT_EQ(tets_of(triangulate(cloud)), tets_of(triangulate(shuffled)));
    }
}

TEST(Triangulation, PowerOfTwoScalingKeepsCombinatorics) {
    for (const auto& cloud : all_clouds()) {
        std::vector<Vec3> scaled = cloud;
        for (Vec3& p : scaled) p = 1024.0 * p;
        const Triangulation a = triangulate(cloud), b = triangulate(scaled);
        EXPECT_EQ(a.tets().slots(), b.tets().slots());
        for (std::size_t i = 0; i < a.tets().slots(); ++i) ASSERT_EQ(a.tets().corners(TetId{i}), b.tets().corners(TetId{i}));
    }
}

TEST(Triangulation, RemovalEqualsFreshTriangulation) {
    for (const auto& cloud : all_clouds()) {
        Triangulation mesh = triangulate(cloud);
        std::vector<bool> kept(cloud.size(), true);
        std::size_t removed = 0;
        Hole hole;
        for (std::size_t i = 0; i < cloud.size(); ++i) {
            const VertexId v{i};
            if (!mesh.is_inserted(v)) kept[i] = false;
            if (!kept[i] || mix64(5, i) % 3 != 0) continue;
            ASSERT_TRUE(mesh.find_hole(v, hole)) << i;
            mesh.remove_vertex(hole);
            kept[i] = false;
            ++removed;
            if (removed % 64 == 1) expect_valid(mesh);
        }
        expect_valid(mesh);
        EXPECT_GT(removed, cloud.size() / 5);
        std::vector<Vec3> rest;
        for (std::size_t i = 0; i < cloud.size(); ++i)
            if (kept[i]) rest.push_back(cloud[i]);
        EXPECT_EQ(tets_of(mesh), tets_of(triangulate(rest)));
    }
}

TEST(Triangulation, RemovalThenInsertionRestores) {
    for (const auto& cloud : all_clouds()) {
        Triangulation mesh = triangulate(cloud);
        const Tets before = tets_of(mesh);
        Hole hole;
        Cavity cavity;
        for (std::size_t i = 0; i < cloud.size(); i += 5) {
            const VertexId v{i};
            if (!mesh.is_inserted(v)) continue;
            ASSERT_TRUE(mesh.find_hole(v, hole));
            mesh.remove_vertex(hole);
            ASSERT_TRUE(mesh.find_conflict_cavity(mesh.point(v), mesh.new_tets()[0], cavity));
            mesh.insert_vertex(v, cavity);
        }
        expect_valid(mesh);
        EXPECT_EQ(before, tets_of(mesh));
    }
}

std::vector<Vec3> points_of_sphere(std::size_t count, std::uint64_t seed) {
    std::vector<Vec3> points;
    for (std::uint64_t i = 0; points.size() < count; ++i) {
        const Vec3 p{2 * unit_double(mix64(seed, 3 * i)) - 1, 2 * unit_double(mix64(seed, 3 * i + 1)) - 1, 2 * unit_double(mix64(seed, 3 * i + 2)) - 1};
        if (squared_norm(p) > 0.1 && squared_norm(p) <= 1) points.push_back((1 / norm(p)) * p);
    }
    return points;
}

TEST(Triangulation, JoinsAVertexWithThousandsOfNeighbours) {
    // The centre of a sphere of points is a neighbour of them all: more than the table of edges has cells at its largest (128 x 128).
    std::vector<Vec3> points = points_of_sphere(20000, 9);
    Triangulation mesh = triangulate(points);
    const VertexId centre = mesh.add_point({1e-3, -2e-3, 1e-3});
    Cavity cavity;
    ASSERT_TRUE(mesh.find_conflict_cavity(mesh.point(centre), mesh.tet_of(VertexId{1}), cavity));
    mesh.insert_vertex(centre, cavity);
    EXPECT_GT(mesh.new_tets().size(), 2U * 128 * 128);
    points.push_back(mesh.point(centre));
    EXPECT_EQ(tets_of(mesh), tets_of(triangulate(points)));
    EXPECT_EQ(check_delaunay(mesh), "");
}

/// Around a centre: cavities on both sides of what each kind of numbers and table is for (local_numbers.hpp).
TEST(Triangulation, JoinsVerticesWithAnyNumberOfNeighbours) {
    for (const std::size_t around : {50U, 62U, 63U, 64U, 65U, 66U, 100U, 126U, 127U, 128U, 129U, 130U, 200U}) {
        std::vector<Vec3> points = points_of_sphere(around, around);
        Triangulation mesh = triangulate(points);
        const VertexId centre = mesh.add_point({1e-3, -2e-3, 1e-3});
        Cavity cavity;
        ASSERT_TRUE(mesh.find_conflict_cavity(mesh.point(centre), mesh.tet_of(VertexId{1}), cavity));
        mesh.insert_vertex(centre, cavity);
        EXPECT_EQ(mesh.new_tets().size(), 2 * around - 4);
        points.push_back(mesh.point(centre));
        EXPECT_EQ(tets_of(mesh), tets_of(triangulate(points)));
        EXPECT_EQ(check_adjacency(mesh) + check_delaunay(mesh), "");
    }
}

/// Whatever their words hold, vertices get 1, 2, 3, ... as they come.
template <class Numbers>
void expect_numbers_in_order(Numbers numbers, std::uint64_t seed) {
    std::vector<std::uint32_t> words(Numbers::kMost - 2);
    // Stamped numbers from before, and numbers that aren't stamped.
    for (std::size_t i = 0; i < words.size(); ++i) words[i] = static_cast<std::uint32_t>(mix64(seed, i) % (7 * StampedNumbers::kMost)) | (i % 3 == 0 ? kUnstamped : 0);
    std::map<std::size_t, std::uint32_t> expected;
    for (std::uint64_t k = 0; k < 6 * Numbers::kMost; ++k) {
        const std::size_t v = mix64(seed + 1, k) % words.size();
        const auto number = expected.try_emplace(v, static_cast<std::uint32_t>(expected.size()) + 1).first->second;
        ASSERT_EQ(numbers(VertexId{v}, words[v]), number);
    }
}

TEST(LocalNumbers, AreGivenInOrderOfFirstMention) {
    for (std::uint64_t seed = 0; seed < 200; seed += 2) {
        expect_numbers_in_order(StampedNumbers(7), seed);
        expect_numbers_in_order(StampedNumbers(StampedNumbers::kLastStamp), seed);
        expect_numbers_in_order(ListedNumbers<128>(), seed);
    }
}

TEST(Triangulation, FindsEdgesAndFaces) {
    Triangulation mesh = triangulate(random_points(300, 4));
    std::size_t faces = 0;
    for (std::size_t i = 0; i < mesh.tets().slots(); ++i) {
        const TetId t{i};
        if (!mesh.tets().is_finite(t)) continue;
        for (unsigned f = 0; f < 4; ++f) {
            const auto c = mesh.tets().face_corners(TetFace{t, f});
            const TetFace found = mesh.find_face(c[2], c[0], c[1]);
            ASSERT_TRUE(found.valid());
            EXPECT_TRUE(found == (TetFace{t, f}) || found == mesh.tets().across(t, f));
            ++faces;
        }
    }
    EXPECT_GT(faces, 4000U);
}

TEST(Triangulation, RefusesCoplanarPoints) {
    std::vector<Vec3> flat;
    for (int i = 0; i < 20; ++i) flat.push_back({double(i % 5), double(i / 5), 0});
    Triangulation mesh({0, 0, 0}, {5, 5, 0});
    EXPECT_FALSE(mesh.insert_all(flat));
}

TEST(Triangulation, CavityIsExactlyTheConflictSet) {
    const auto cloud = random_points(400, 11);
    Triangulation mesh = triangulate(cloud);
    Cavity cavity;
    for (const Vec3& p : random_points(50, 12)) {
        ASSERT_TRUE(mesh.find_conflict_cavity(p, TetId{}, cavity));
        std::set<std::uint32_t> found;
        for (const TetId t : cavity.tets) found.insert(t.value());
        for (std::size_t i = 0; i < mesh.tets().slots(); ++i)
            if (mesh.tets().is_live(TetId{i})) {
                EXPECT_EQ(mesh.in_conflict(TetId{i}, p), found.count(static_cast<std::uint32_t>(i)) == 1);
            }
    }
    ASSERT_FALSE(mesh.find_conflict_cavity(cloud[17], TetId{}, cavity));
    EXPECT_EQ(cavity.duplicate, VertexId{17});
}

}  // namespace
}  // namespace wellmesh
