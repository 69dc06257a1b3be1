// SPDX-License-Identifier: Apache-2.0
// What it takes to fill a gap between two features of the input that have no point in common with tetrahedra of bounded radius-edge ratio: about as
// many vertices as there are squares of the gap's width on its sides.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vec3_math.hpp"
#include "core/workers.hpp"
#include "validation/local_feature_size.hpp"
#include "validation/valid_plc.hpp"

namespace wellmesh {

/// Of the size of a piece of the boundary and of the gap's width there: smaller pieces are no more than ordinary meshes need.
inline constexpr double kSlender = 8;

/// Vertices that fill a gap beside a piece of a facet, which has another one across it; and along a piece of a segment. Within a quarter of what
/// squares and ribbons take that are 0.01 to 0.001 of their size from a wall.
inline double vertices_beside_facet(double area, double width) { return 0.5 * area / (width * width); }
inline double vertices_beside_segment(double length, double width) { return 3 * length / width; }

/// From the corners of an equilateral triangle to its centre, over its side, and a little more: no point of any triangle is so many longest sides from all corners.
inline constexpr double kFarthestOverSide = 0.5774;

/// How often a triangle is halved: at least, unless the gap is wider than the piece, and at most.
struct Halvings {
    unsigned least = 0, most = 6;
};

/// The width with the same mean of 1 / width^2 as a triangle over which the width goes linearly from corner to corner: the mean of f'' is twice the divided
/// difference of f [Hermite-Genocchi], here of -log. One small width, at the end of a gap, counts for little.
inline double width_of_like_triangle(std::array<double, 3> widths) {
    std::sort(widths.begin(), widths.end());
    const auto& [a, b, c] = widths;
    constexpr double kAlike = 1.01;  // differences of logarithms tell nothing
    if (!(c > kAlike * a)) return (a + b + c) / 3;
    const auto slope = [](double from, double to) { return to > from ? -std::log1p((to - from) / from) / (to - from) : -1 / from; };
    return 1 / std::sqrt(2 * (slope(b, c) - slope(a, b)) / (c - a));
}

/// Halves a triangle's longest side until the gap is about as wide everywhere, or wider than the piece.
/// @param widths  local feature sizes at its corners
/// @param slender  of pieces no larger than the square of so many widths nothing is said, and none are looked for where there can be no others
/// @param emit  (area, width) of a piece
template <class Emit>
void sample_gap(const LocalFeatureSize& size, const std::array<Vec3, 3>& corners, const std::array<double, 3>& widths, Emit&& emit, Halvings halvings = {},
                double slender = 0) {
    const auto [least, most] = std::minmax_element(widths.begin(), widths.end());
    const double area = 0.5 * norm(cross(corners[1] - corners[0], corners[2] - corners[0]));
    std::array<double, 3> squares{};  // of the sides opposite each corner
    for (std::size_t i = 0; i < 3; ++i) squares[i] = squared_distance(corners[(i + 1) % 3], corners[(i + 2) % 3]);
    const auto k = static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) - squares.begin());
    // All of a triangle is within that of some corner, and within its longest side of each; local feature size falls no faster than distance grows.
    const double longest = std::sqrt(squares[k]), narrowest = std::max(*least - kFarthestOverSide * longest, *most - longest);
    if (slender > 0 && narrowest > 0 && !(area > slender * slender * narrowest * narrowest)) return;
    if (halvings.most == 0 || !(*most > 2 * *least || halvings.least > 0) || !(squares[k] > *least * *least)) {
        const double width = width_of_like_triangle(widths);
        if (!(slender > 0) || area > slender * slender * width * width) emit(area, width);
        return;
    }
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const Vec3 middle = 0.5 * (corners[i] + corners[j]);
    const double width = size(middle);
    const Halvings fewer{halvings.least > 0 ? halvings.least - 1 : 0, halvings.most - 1};
    sample_gap(size, {corners[k], corners[i], middle}, {widths[k], widths[i], width}, emit, fewer, slender);
    sample_gap(size, {corners[k], middle, corners[j]}, {widths[k], width, widths[j]}, emit, fewer, slender);
}

/// The same for a segment. @param widths  at its ends  @param emit  (length, width) of a piece
template <class Emit>
void sample_gap(const LocalFeatureSize& size, const std::array<Vec3, 2>& ends, const std::array<double, 2>& widths, Emit&& emit, Halvings halvings = {2, 12}) {
    const Vec3 middle = 0.5 * (ends[0] + ends[1]);
    const double width = size(middle), length = distance(ends[0], ends[1]), least = std::min({width, widths[0], widths[1]});
    const bool varies = std::max({width, widths[0], widths[1]}) > 2 * least;
    if (halvings.most == 0 || !(varies || halvings.least > 0) || !(length > least)) {
        emit(length, width);
        return;
    }
    const Halvings fewer{halvings.least > 0 ? halvings.least - 1 : 0, halvings.most - 1};
    sample_gap(size, std::array{ends[0], middle}, std::array{widths[0], width}, emit, fewer);
    sample_gap(size, std::array{middle, ends[1]}, std::array{width, widths[1]}, emit, fewer);
}

/// Vertices that filling all narrow gaps of a complex takes, gaps outside the domain included; or any number above `enough` that they take at least.
[[nodiscard]] double vertices_for_gaps(const ValidPlc& plc, double enough, Workers& workers);

/// Whether it takes more vertices than that. Most complexes have no gap that could, which is found in a fraction of the time.
[[nodiscard]] bool gaps_take_more_than(double enough, const ValidPlc& plc, Workers& workers);

}  // namespace wellmesh
