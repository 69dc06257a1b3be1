// SPDX-License-Identifier: Apache-2.0
// Ties: the sign of the perturbed insphere, its algebra, and what it is for: one triangulation, whatever the numbering.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <vector>

#include "ladder_check.hpp"
#include "oracle/rational_predicates.hpp"

namespace wellmesh::test {
namespace {

bool all_distinct(const Quintuple& q) {
    for (std::size_t i = 0; i < 5; ++i)
        for (std::size_t j = i + 1; j < 5; ++j)
            if (q[i] == q[j]) return false;
    return true;
}

TEST(Perturbation, AgreesWithPerturbedNumbers) {
    const PredicateFilter no_filter;
    int ties = 0, flat = 0;
    std::uint64_t stream = 100;
    for (const auto generate : {small_integers, grid, scaled_to_range_ends, uniform}) {
        ++stream;
        for (std::uint64_t i = 0; i < 15'000; ++i) {
            Random random(stream, i);
            const Quintuple q = generate(random);
            if (!all_distinct(q)) continue;
            const Sign sign = insphere_perturbed(q[0], q[1], q[2], q[3], q[4]);
            ASSERT_EQ(sign, oracle::insphere_perturbed(q[0], q[1], q[2], q[3], q[4])) << describe(q, "perturbation", i);
            const Decision decision = decide_insphere_perturbed(no_filter, q[0], q[1], q[2], q[3], q[4]);
            ASSERT_EQ(decision.sign, sign);
            const Sign unperturbed = insphere(q[0], q[1], q[2], q[3], q[4]);
            ASSERT_EQ(decision.rung == Rung::perturbation, unperturbed == Sign::zero);
            if (orient3d(q[0], q[1], q[2], q[3]) == Sign::zero) {
                ++flat;
                continue;
            }
            ASSERT_NE(sign, Sign::zero) << describe(q, "perturbation", i);
            ties += unperturbed == Sign::zero;
        }
    }
    EXPECT_GT(ties, 2000);
    EXPECT_GT(flat, 2000);
}

/// As a determinant of five rows the predicate changes sign with every exchange of two of all five points.
/// For the exchange of d and e that is the symmetry of the local Delaunay test across face abc.
TEST(Perturbation, IsAlternatingInAllFivePoints) {
    int ties = 0;
    for (std::uint64_t i = 0; i < 1'500; ++i) {
        Random random(110, i);
        const Quintuple q = i % 2 == 0 ? small_integers(random) : grid(random);
        if (!all_distinct(q)) continue;
        const Sign sign = insphere_perturbed(q[0], q[1], q[2], q[3], q[4]);
        std::array<std::size_t, 5> order{0, 1, 2, 3, 4};
        do {
            int inversions = 0;
            for (std::size_t s = 0; s < 5; ++s)
                for (std::size_t t = s + 1; t < 5; ++t) inversions += order[s] > order[t];
            const Sign permuted = insphere_perturbed(q[order[0]], q[order[1]], q[order[2]], q[order[3]], q[order[4]]);
            ASSERT_EQ(permuted, inversions % 2 == 0 ? sign : -sign) << describe(q, "permuted", i);
        } while (std::next_permutation(order.begin(), order.end()));
        ties += sign != Sign::zero && insphere(q[0], q[1], q[2], q[3], q[4]) == Sign::zero;
    }
    EXPECT_GT(ties, 100);
}

TEST(Perturbation, LocalDelaunayTestIsSymmetric) {
    int ties = 0;
    for (std::uint64_t i = 0; i < 40'000; ++i) {
        Random random(120, i);
        const auto [a, b, c, d, e] = grid(random);
        if (orient3d(a, b, c, d) != Sign::positive || orient3d(a, c, b, e) != Sign::positive) continue;
        ASSERT_EQ(insphere_perturbed(a, b, c, d, e), insphere_perturbed(a, c, b, e, d));
        ties += insphere(a, b, c, d, e) == Sign::zero;
    }
    EXPECT_GT(ties, 300);
}

/// All tetrahedra of `points` whose perturbed circumsphere is empty, as sorted quadruples, and six times their volume.
struct BruteForceDelaunay {
    std::set<std::array<std::size_t, 4>> tets;
    double six_volumes = 0;
    int ties = 0;
};

BruteForceDelaunay brute_force_delaunay(const std::vector<Vec3>& points, const std::vector<std::size_t>& names) {
    BruteForceDelaunay result;
    const std::size_t n = points.size();
    const auto volume = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
        return PredicateFilter::orient3d_value(points[i], points[j], points[k], points[l]);  // exact for small integers
    };
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j)
            for (std::size_t k = j + 1; k < n; ++k)
                for (std::size_t l = k + 1; l < n; ++l) {
                    const Sign orientation = orient3d(points[i], points[j], points[k], points[l]);
                    if (orientation == Sign::zero) continue;
                    bool empty = true, tied = false;
                    for (std::size_t m = 0; m < n && empty; ++m) {
                        if (m == i || m == j || m == k || m == l) continue;
                        const Sign side = insphere_perturbed(points[i], points[j], points[k], points[l], points[m]);
                        empty = side != orientation;  // inside a negative tetrahedron is negative
                        tied = tied || insphere(points[i], points[j], points[k], points[l], points[m]) == Sign::zero;
                    }
                    if (!empty) continue;
                    std::array<std::size_t, 4> tet{names[i], names[j], names[k], names[l]};
                    std::sort(tet.begin(), tet.end());
                    result.tets.insert(tet);
                    result.six_volumes += std::fabs(volume(i, j, k, l));
                    result.ties += tied;
                }
    return result;
}

/// A 3 x 3 x 2 grid is nothing but ties. The empty tetrahedra must tile its hull exactly, and be the same under any numbering.
TEST(Perturbation, TriangulatesAGridUniquely) {
    std::vector<Vec3> points;
    for (int x = 0; x < 3; ++x)
        for (int y = 0; y < 3; ++y)
            for (int z = 0; z < 2; ++z) points.push_back({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
    std::vector<std::size_t> names(points.size());
    std::iota(names.begin(), names.end(), std::size_t{0});
    const BruteForceDelaunay reference = brute_force_delaunay(points, names);
    EXPECT_EQ(reference.six_volumes, 6 * 4.0);
    EXPECT_EQ(reference.ties, static_cast<int>(reference.tets.size()));
    for (std::uint64_t round = 0; round < 2; ++round) {
        Random random(130, round);
        std::vector<std::size_t> shuffled = names;
        for (std::size_t i = shuffled.size(); i > 1; --i) std::swap(shuffled[i - 1], shuffled[random.bits() % i]);
        std::vector<Vec3> moved;
        for (const std::size_t name : shuffled) moved.push_back(points[name]);
        EXPECT_EQ(brute_force_delaunay(moved, shuffled).tets, reference.tets);
    }
}

/// By hand, on the sphere |p| = 3: the lexicographically largest point is lifted most. Replacing it by e keeps the orientation,
/// so e is below the plane of the lifted corners: inside. Were e, the smallest, lifted most, it would be outside.
TEST(Perturbation, LargestPointIsLiftedMost) {
    const Vec3 a{2, 1, -2}, b{-2, 1, -2}, c{1, -2, -2}, largest{3, 0, 0}, smallest{-3, 0, 0};
    ASSERT_EQ(orient3d(a, b, c, largest), Sign::positive);
    ASSERT_EQ(orient3d(a, b, c, smallest), Sign::positive);
    ASSERT_EQ(insphere(a, b, c, largest, smallest), Sign::zero);
    EXPECT_EQ(insphere_perturbed(a, b, c, largest, smallest), Sign::positive);
    EXPECT_EQ(insphere_perturbed(a, b, c, smallest, largest), Sign::negative);
}

}  // namespace
}  // namespace wellmesh::test
