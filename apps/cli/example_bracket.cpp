// SPDX-License-Identifier: Apache-2.0
#include "example_bracket.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace wellmesh::cli {

namespace {

using Loop = std::vector<std::uint32_t>;

// Millimetres. The bracket is an L in the xz-plane, extruded along y.
constexpr double kLength = 80, kWidth = 40, kHeight = 50, kThickness = 10;
constexpr double kBushingTop = 14, kBushingRadius = 10, kBoreRadius = 6, kBoltRadius = 8;
constexpr double kBushingX = 32, kBoltX = 62, kAxisY = kWidth / 2;
constexpr int kSides = 12;  // corners of 150 degrees

constexpr std::int32_t kSteel = 1, kBronze = 2;

class BracketBuilder {
public:
    Plc build();

private:
    std::uint32_t vertex(double x, double y, double z) {
        plc_.vertices.push_back({x, y, z});
        return static_cast<std::uint32_t>(plc_.vertices.size() - 1);
    }
    void facet(std::vector<Loop> polygons, std::int32_t marker, std::vector<Vec3> holes = {}) {
        plc_.facets.push_back({.polygons = std::move(polygons), .holes = std::move(holes), .marker = marker});
    }
    /// Regular polygon about the vertical axis through (x, kAxisY).
    Loop circle(double x, double radius, double z) {
        Loop loop;
        for (int i = 0; i < kSides; ++i) {
            const double angle = 2 * std::numbers::pi * i / kSides;
            loop.push_back(vertex(x + radius * std::cos(angle), kAxisY + radius * std::sin(angle), z));
        }
        return loop;
    }
    /// One quadrilateral between each pair of corresponding sides of two polygons.
    void walls(const Loop& lower, const Loop& upper, std::int32_t marker) {
        for (std::size_t i = 0; i < lower.size(); ++i) {
            const std::size_t j = (i + 1) % lower.size();
            facet({{lower[i], lower[j], upper[j], upper[i]}}, marker);
        }
    }

    Plc plc_;
};

Plc BracketBuilder::build() {
    // The L, once at y = 0 and once at y = kWidth: corners 0 to 5 from the origin along the floor and around.
    const std::array<std::array<double, 2>, 6> profile = {
        {{0, 0}, {kLength, 0}, {kLength, kThickness}, {kThickness, kThickness}, {kThickness, kHeight}, {0, kHeight}}};
    Loop front, back;
    for (const auto& [x, z] : profile) front.push_back(vertex(x, 0, z));
    for (const auto& [x, z] : profile) back.push_back(vertex(x, kWidth, z));

    const Loop bushing_floor = circle(kBushingX, kBushingRadius, 0), bushing_collar = circle(kBushingX, kBushingRadius, kThickness),
               bushing_top = circle(kBushingX, kBushingRadius, kBushingTop);
    const Loop bore_floor = circle(kBushingX, kBoreRadius, 0), bore_top = circle(kBushingX, kBoreRadius, kBushingTop);
    const Loop bolt_floor = circle(kBoltX, kBoltRadius, 0), bolt_top = circle(kBoltX, kBoltRadius, kThickness);

    // Facet markers: 1 outside, 2 bolt hole, 3 bushing outside, 4 bore, 5 between the materials.
    facet({front}, 1);
    facet({back}, 1);
    for (std::size_t i = 0; i < profile.size(); ++i) {
        const std::size_t j = (i + 1) % profile.size();
        const Loop side = {front[i], front[j], back[j], back[i]};
        const double z = i == 0 ? 0 : kThickness;
        const std::vector<Vec3> holes = {{kBushingX, kAxisY, z}, {kBoltX, kAxisY, z}};
        if (i == 0) facet({side, bushing_floor, bolt_floor}, 1, holes);        // floor
        else if (i == 2) facet({side, bushing_collar, bolt_top}, 1, holes);    // top of the plate
        else facet({side}, 1);
    }
    walls(bolt_floor, bolt_top, 2);
    facet({bushing_floor, bore_floor}, 3, {{kBushingX, kAxisY, 0}});
    facet({bushing_top, bore_top}, 3, {{kBushingX, kAxisY, kBushingTop}});
    walls(bushing_collar, bushing_top, 3);
    walls(bore_floor, bore_top, 4);
    walls(bushing_floor, bushing_collar, 5);

    const double ring = kBushingX + (kBoreRadius + kBushingRadius) / 2;
    plc_.region_seeds = {{.point = {kThickness / 2, kAxisY, kThickness / 2}, .id = kSteel}, {.point = {ring, kAxisY, kThickness / 2}, .id = kBronze}};
    plc_.source_name = "example bracket";
    return std::move(plc_);
}

}  // namespace

Plc example_bracket() { return BracketBuilder().build(); }

}  // namespace wellmesh::cli
