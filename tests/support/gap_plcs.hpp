// SPDX-License-Identifier: Apache-2.0
// Domains with gaps between features that have no point in common. What filling them takes is known: a piece of area A at width w half of A / w^2 vertices on each
// side, a piece of length L of a segment 3 L / w.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "wellmesh/plc.hpp"

namespace wellmesh::testing {

inline void add_facet(Plc& plc, std::vector<std::uint32_t> polygon) {
    PlcFacet facet;
    facet.polygons.push_back(std::move(polygon));
    plc.facets.push_back(std::move(facet));
}

/// Boxes on unit squares, each on the one below; their heights from the lowest to the highest.
inline void add_stack(Plc& plc, double x, const std::vector<double>& heights) {
    const auto layer = [&](double z) {
        const auto first = static_cast<std::uint32_t>(plc.vertices.size());
        for (const auto& [u, v] : {std::array{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}) plc.vertices.push_back({x + u, v, z});
        add_facet(plc, {first, first + 1, first + 2, first + 3});
        return first;
    };
    double z = 0;
    std::uint32_t low = layer(z);
    for (const double height : heights) {
        const std::uint32_t high = layer(z += height);
        for (std::uint32_t k = 0; k < 4; ++k) add_facet(plc, {low + k, low + (k + 1) % 4, high + (k + 1) % 4, high + k});
        low = high;
    }
}

inline Plc stack(const std::vector<double>& heights) {
    Plc plc;
    add_stack(plc, 0, heights);
    return plc;
}

/// Unit squares of these widths, side by side and far from each other.
inline Plc slabs(const std::vector<double>& widths) {
    Plc plc;
    for (std::size_t i = 0; i < widths.size(); ++i) add_stack(plc, 3 * static_cast<double>(i), {widths[i]});
    return plc;
}

/// The unit cube with a square plate in it, whose height above the floor goes from one width to another.
inline Plc plate_above_floor(double side, double width, double other_width) {
    Plc plc = stack({1});
    const double low = 0.5 - side / 2, high = 0.5 + side / 2;
    plc.vertices.insert(plc.vertices.end(), {{low, low, width}, {high, low, other_width}, {high, high, other_width}, {low, high, width}});
    add_facet(plc, {8, 9, 10, 11});
    return plc;
}

/// The unit cube with an upright square in it, whose lower edge is that far above the floor, on no line that halves it.
inline Plc blade_above_floor(double length, double width) {
    Plc plc = stack({1});
    const double low = 0.5 - length / 2, high = 0.5 + length / 2;
    plc.vertices.insert(plc.vertices.end(), {{low, 0.47, width}, {high, 0.47, width}, {high, 0.47, width + length}, {low, 0.47, width + length}});
    add_facet(plc, {8, 9, 10, 11});
    return plc;
}

/// The unit cube with two parallel wires in it, the second one shifted by a quarter of its length.
inline Plc two_wires(double length, double width) {
    Plc plc = stack({1});
    const double low = 0.5 - length / 2, high = 0.5 + length / 2;
    plc.vertices.insert(plc.vertices.end(), {{low, 0.47, 0.5}, {high, 0.47, 0.5}, {low + length / 4, 0.47 + width, 0.5}, {high + length / 4, 0.47 + width, 0.5}});
    plc.segments = {{{8, 9}}, {{10, 11}}};
    return plc;
}

/// The unit cube with wires in it that cross others at right angles, that far from them: near to each other at no end.
inline Plc crossed_wires(std::uint32_t count, double width) {
    Plc plc = stack({1});
    for (std::uint32_t i = 0; i < count; ++i) {
        const double at = 0.1 + 0.8 * (i + 0.5) / count;
        const auto first = static_cast<std::uint32_t>(plc.vertices.size());
        plc.vertices.insert(plc.vertices.end(), {{0.06, at, 0.5}, {0.94, at, 0.5}, {at, 0.06, 0.5 + width}, {at, 0.94, 0.5 + width}});
        plc.segments.push_back({{first, first + 1}});
        plc.segments.push_back({{first + 2, first + 3}});
    }
    return plc;
}

}  // namespace wellmesh::testing
