// SPDX-License-Identifier: Apache-2.0
// Predicates as the library's own loops call them: with a static filter for one bounding box, and with ties broken.
// Exact for coordinates within exact_range.hpp. Stateless, thread-safe, independent of the order of earlier calls.
//
// Symbolic perturbation [Devillers03]. Point p_i is lifted to (p_i, |p_i|^2 + eps_i), eps_i > 0, where the
// lexicographically larger of two points has the infinitely larger eps. A triangulation that is Delaunay in this sense is
// the lower hull of the lifted points, which is unique: it depends on the set of points only, not on their numbers, and all
// its tetrahedra are decided without ties. The signs are derived beside break_tie in insphere.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "predicates/apex_search.hpp"
#include "predicates/four_inspheres.hpp"
#include "predicates/fp_environment.hpp"
#include "predicates/insphere_lanes.hpp"
#include "wellmesh/predicates.hpp"

namespace wellmesh {

/// insphere with ties broken. Like insphere it changes sign under odd permutations of a, b, c, d and is unchanged under even ones.
/// Never zero when the five points are distinct (0.0 and -0.0 do not differ) and a, b, c, d are not coplanar.
[[nodiscard]] Sign insphere_perturbed(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e);

/// How often this thread has gone as far as expansion arithmetic so far. Take differences: nothing ever resets it.
[[nodiscard]] std::uint64_t exact_predicate_calls() noexcept;

/// Static filter: error bounds for all points of one bounding box. Decides most calls by one comparison. Insphere tests that it leaves open are mostly decided by the
/// bound for the points' own box; the others go down the ladder, so that every answer is the exact one.
class PredicateFilter {
public:
    PredicateFilter() = default;  ///< bounds that never decide
    /// @param box_extent  upper minus lower corner, computed as such (rounding is monotonous, so no rounded difference of
    ///                    coordinates exceeds it), of a box that holds all points that will ever be passed.
    /// @param weight_extent  largest minus smallest weight that will ever be passed, computed as such.
    explicit PredicateFilter(const Vec3& box_extent, double weight_extent = 0);

    [[nodiscard]] Sign orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) const {
        const double value = orient3d_value(a, b, c, d);
        if (value > orient3d_bound_) [[likely]]
            return Sign::positive;
        if (value < -orient3d_bound_) return Sign::negative;
        return orient3d_beyond_filter(a, b, c, d);
    }
    [[nodiscard]] Sign insphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) const {
        const double value = insphere_value(a, b, c, d, e);
        if (value > insphere_bound_) return Sign::positive;
        if (value < -insphere_bound_) [[likely]]
            return Sign::negative;
        return insphere_beyond_filter(a, b, c, d, e);
    }
    [[nodiscard]] Sign insphere_perturbed(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) const {
        const double value = insphere_value(a, b, c, d, e);
        if (value > insphere_bound_) return Sign::positive;
        if (value < -insphere_bound_) [[likely]]
            return Sign::negative;
        return insphere_perturbed_beyond_filter(a, b, c, d, e);
    }
    /// The same for points that are stored as insphere_lanes.hpp wants them; faster.
    [[nodiscard]] Sign insphere_perturbed_padded(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e) const {
        const double value = has_lanes_ ? insphere_value_in_lanes(a, b, c, d, e) : insphere_value(a, b, c, d, e);
        return insphere_perturbed_of_value(value, {&a, &b, &c, &d}, e);
    }
    /// Rounded determinants of several spheres, stored likewise, at one point e; faster than one by one.
    void insphere_values_padded(std::span<const SphereCorners> spheres, const Vec3& e, double* values) const {
        if (has_lanes_) [[likely]]
            return insphere_values_in_lanes(spheres, e, values);
        for (std::size_t i = 0; i < spheres.size(); ++i) values[i] = insphere_value(*spheres[i][0], *spheres[i][1], *spheres[i][2], *spheres[i][3], e);
    }
    /// The same for corners by number; there is room for three values more.
    void insphere_values_of(PointRecords points, std::span<const RecordNumbers> tets, const Vec3& e, double* values) const {
        if (has_lanes_) [[likely]]
            return insphere_values_of_records(points, tets, e, values);
        for (std::size_t i = 0; i < tets.size(); ++i) values[i] = insphere_value(points[tets[i][0]], points[tets[i][1]], points[tets[i][2]], points[tets[i][3]], e);
    }
    /// The sign that insphere_perturbed has, given the rounded determinant.
    [[nodiscard]] Sign insphere_perturbed_of_value(double value, const SphereCorners& s, const Vec3& e) const {
        if (value > insphere_bound_) return Sign::positive;
        if (value < -insphere_bound_) return Sign::negative;
        return insphere_perturbed_beyond_filter(*s[0], *s[1], *s[2], *s[3], e);
    }
    /// insphere(points[i]..., e) for i = 0 .. 3; points as insphere_lanes.hpp wants them.
    void insphere_of_four_padded(const std::array<std::array<const Vec3*, 4>, 4>& points, const Vec3& e, std::array<Sign, 4>& signs) const {
        std::array<double, 4> values{};
        if (has_lanes_) {
            values = four_insphere_values(points, e);
        } else {
            for (std::size_t i = 0; i < 4; ++i) values[i] = insphere_value(*points[i][0], *points[i][1], *points[i][2], *points[i][3], e);
        }
        for (std::size_t i = 0; i < 4; ++i)
            signs[i] = values[i] > insphere_bound_    ? Sign::positive
                       : values[i] < -insphere_bound_ ? Sign::negative
                                                      : insphere_beyond_filter(*points[i][0], *points[i][1], *points[i][2], *points[i][3], e);
    }
    /// The point in front of the face whose sphere with it is empty of the others is the nominee or one of the rivals (ApexSearch): exact
    /// tests decide among these.
    [[nodiscard]] std::uint32_t nominate_apex(const PointColumns& points, const std::array<std::uint32_t, 3>& face,
                                              std::vector<std::uint32_t>& rivals) const {
        const ApexSearch search{points, face, orient3d_bound_, insphere_bound_};
        return has_lanes_ ? search.nominate_in_lanes(rivals) : search.nominate(rivals);
    }
    [[nodiscard]] Sign power_test(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
                                  const WeightedPoint& e) const {
        const double value = power_value(a, b, c, d, e);
        if (value > power_bound_) return Sign::positive;
        if (value < -power_bound_) [[likely]]
            return Sign::negative;
        return power_test_beyond_filter(a, b, c, d, e);
    }
    [[nodiscard]] Sign side_of_diametral_sphere(const Vec3& a, const Vec3& b, const Vec3& p) const {
        return wellmesh::side_of_diametral_sphere(a, b, p);
    }
    [[nodiscard]] Sign side_of_equatorial_sphere(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) const {
        return wellmesh::side_of_equatorial_sphere(a, b, c, p);
    }

    /// What the bound for a box about these points only tells, which in a fine mesh is far smaller than that for all: zero if nothing.
    [[nodiscard]] static Sign insphere_within_own_box(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e);

    [[nodiscard]] double orient3d_bound() const { return orient3d_bound_; }  ///< for tests
    [[nodiscard]] double insphere_bound() const { return insphere_bound_; }  ///< for tests
    [[nodiscard]] double power_bound() const { return power_bound_; }        ///< for tests

    /// The rounded determinants that the bounds are for.
    [[nodiscard]] static double orient3d_value(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
    [[nodiscard]] static double insphere_value(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e);
    [[nodiscard]] static double power_value(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
                                            const WeightedPoint& e);

private:
    static Sign orient3d_beyond_filter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
    static Sign insphere_beyond_filter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e);
    static Sign insphere_perturbed_beyond_filter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Vec3& e);

    static Sign power_test_beyond_filter(const WeightedPoint& a, const WeightedPoint& b, const WeightedPoint& c, const WeightedPoint& d,
                                         const WeightedPoint& e);

    double orient3d_bound_ = std::numeric_limits<double>::infinity();
    double insphere_bound_ = std::numeric_limits<double>::infinity();
    double power_bound_ = std::numeric_limits<double>::infinity();
    bool has_lanes_ = has_insphere_lanes();
};

}  // namespace wellmesh

#include "predicates/predicate_filter_inline.hpp"
