// SPDX-License-Identifier: Apache-2.0
#include "support/acute_plcs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180, kTurn = 2 * std::numbers::pi;

/// Collects vertices, polygons and segments.
struct Builder {
    Plc plc;

    std::uint32_t vertex(double x, double y, double z) {
        plc.vertices.push_back({x, y, z});
        return static_cast<std::uint32_t>(plc.vertices.size() - 1);
    }
    void facet(std::vector<std::uint32_t> polygon) { plc.facets.push_back({{std::move(polygon)}, {}, 0}); }
    void segment(std::uint32_t a, std::uint32_t b) { plc.segments.push_back({{a, b}, 0}); }
    void box(const Vec3& low, const Vec3& high) {
        std::array<std::uint32_t, 8> v{};
        for (unsigned i = 0; i < 8; ++i) v[i] = vertex(i & 1U ? high.x : low.x, i & 2U ? high.y : low.y, i & 4U ? high.z : low.z);
        for (const auto& f : {std::array{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}) {
            std::vector<std::uint32_t> polygon;
            for (const int i : f) polygon.push_back(v[static_cast<std::size_t>(i)]);
            facet(polygon);
        }
    }
    Plc take() {
        plc.fill = FillRule::bounded_cells;
        plc.merge_coplanar = MergeRule::none;
        return std::move(plc);
    }
};

Builder in_unit_cube() {
    Builder b;
    b.box({0, 0, 0}, {1, 1, 1});
    return b;
}

double draw(std::uint64_t seed, std::uint64_t& n) { return unit_double(mix64(seed, ++n)); }

/// Rectangles around one upright segment in the unit cube, at these azimuths.
Plc blades(const std::vector<double>& azimuths) {
    Builder b = in_unit_cube();
    const std::uint32_t low = b.vertex(0.5, 0.5, 0.2), high = b.vertex(0.5, 0.5, 0.8);
    for (const double t : azimuths) {
        const double x = 0.5 + 0.3 * std::cos(t), y = 0.5 + 0.3 * std::sin(t);
        const std::uint32_t bottom = b.vertex(x, y, 0.2), top = b.vertex(x, y, 0.8);
        b.facet({low, high, top, bottom});
    }
    return b.take();
}

}  // namespace

Plc wedge(double angle_deg) {
    Builder b;
    const double c = std::cos(angle_deg * kDegree), s = std::sin(angle_deg * kDegree);
    std::array<std::array<std::uint32_t, 3>, 2> ends{};
    for (std::size_t e = 0; e < 2; ++e) {
        const auto z = static_cast<double>(e);
        ends[e] = {b.vertex(0, 0, z), b.vertex(1, 0, z), b.vertex(c, s, z)};
        b.facet({ends[e].begin(), ends[e].end()});
    }
    for (std::size_t i = 0; i < 3; ++i) b.facet({ends[0][i], ends[0][(i + 1) % 3], ends[1][(i + 1) % 3], ends[1][i]});
    return b.take();
}

Plc spike(double angle_deg, int sides) {
    Builder b;
    const double radius = std::tan(angle_deg * kDegree / 2);
    const std::uint32_t tip = b.vertex(0, 0, 1);
    std::vector<std::uint32_t> base;
    for (int i = 0; i < sides; ++i) base.push_back(b.vertex(radius * std::cos(kTurn * i / sides), radius * std::sin(kTurn * i / sides), 0));
    b.facet(base);
    for (std::size_t i = 0; i < base.size(); ++i) b.facet({base[i], base[(i + 1) % base.size()], tip});
    return b.take();
}

Plc bumpy_ball(int rings) {
    Builder b;
    const int sides = 2 * rings;
    const auto vertex = [&](int ring, int side) {
        const double polar = kTurn / 2 * ring / rings, azimuth = kTurn * side / sides, r = 1 + 0.2 * std::sin(4 * polar) * std::cos(5 * azimuth);
        return b.vertex(r * std::sin(polar) * std::cos(azimuth), r * std::sin(polar) * std::sin(azimuth), r * std::cos(polar));
    };
    const std::uint32_t top = b.vertex(0, 0, 1), bottom = b.vertex(0, 0, -1);
    std::vector<std::vector<std::uint32_t>> at(static_cast<std::size_t>(rings) - 1);
    for (int ring = 1; ring < rings; ++ring)
        for (int side = 0; side < sides; ++side) at[static_cast<std::size_t>(ring) - 1].push_back(vertex(ring, side));
    for (std::size_t i = 0, n = at[0].size(); i < n; ++i) {
        const std::size_t next = (i + 1) % n;
        b.facet({top, at.front()[i], at.front()[next]});
        b.facet({bottom, at.back()[next], at.back()[i]});
        for (std::size_t ring = 0; ring + 1 < at.size(); ++ring) {
            b.facet({at[ring][i], at[ring + 1][i], at[ring + 1][next]});
            b.facet({at[ring][i], at[ring + 1][next], at[ring][next]});
        }
    }
    return b.take();
}

Plc fan(int count) {
    std::vector<double> azimuths;
    for (int i = 0; i < count; ++i) azimuths.push_back(10 * kDegree + kTurn * i / count);
    return blades(azimuths);
}

Plc two_blades(double angle_deg) { return blades({20 * kDegree, (20 + angle_deg) * kDegree}); }

Plc tip_to_tip(double gap_deg, int sides, double twist) {
    Builder b = in_unit_cube();
    const std::uint32_t tip = b.vertex(0.5, 0.5, 0.5);
    const double slope = gap_deg * kDegree / 2, radius = 0.4 * std::cos(slope);
    for (const int sign : {-1, 1}) {
        std::vector<std::uint32_t> rim;
        for (int i = 0; i < sides; ++i) {
            const double t = kTurn * (i + 0.1 + (sign > 0 ? twist : 0)) / sides;
            rim.push_back(b.vertex(0.5 + radius * std::cos(t), 0.5 + radius * std::sin(t), 0.5 + sign * 0.4 * std::sin(slope)));
        }
        for (std::size_t i = 0; i < rim.size(); ++i) b.facet({tip, rim[i], rim[(i + 1) % rim.size()]});
    }
    return b.take();
}

Plc touching_triangles(double angle_deg) {
    Builder b = in_unit_cube();
    std::vector<std::uint32_t> rectangle;
    for (const double x : {0.2, 0.4, 0.6, 0.8}) rectangle.push_back(b.vertex(x, 0.5, 0.5));
    rectangle.push_back(b.vertex(0.8, 0.85, 0.5));
    rectangle.push_back(b.vertex(0.2, 0.85, 0.5));
    b.facet(rectangle);
    const std::uint32_t p = b.vertex(0.35, 0.3, 0.7), q = b.vertex(0.5, 0.3, 0.75);
    b.facet({rectangle[1], p, q});
    const double y = 0.5 + 0.25 * std::cos(angle_deg * kDegree), z = 0.5 + 0.25 * std::sin(angle_deg * kDegree);
    const std::uint32_t r = b.vertex(0.55, y, z), s = b.vertex(0.7, y, z);
    b.facet({rectangle[2], r, s});
    return b.take();
}

Plc segments_on_a_facet(double angle_deg) {
    Builder b = in_unit_cube();
    const double rise = 0.3 * std::sin(angle_deg * kDegree), run = 0.3 * std::cos(angle_deg * kDegree);
    std::vector<std::uint32_t> square;
    for (const auto& [x, y] : {std::array{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.5}, {0.8, 0.8}, {0.2, 0.8}}) square.push_back(b.vertex(x, y, 0.5));
    b.facet(square);
    const std::uint32_t inside = b.vertex(0.4, 0.45, 0.5);
    b.plc.facets.back().polygons.push_back({inside});
    b.segment(inside, b.vertex(0.4 + run, 0.45, 0.5 + rise));
    b.segment(square[0], b.vertex(0.2 + 0.6 * run, 0.2 + 0.8 * run, 0.5 - rise));
    b.segment(square[2], b.vertex(0.8 - run, 0.5, 0.5 - rise));
    return b.take();
}

Plc bundle(std::uint64_t seed, int triangles) {
    Builder b = in_unit_cube();
    std::uint64_t n = 0;
    const std::uint32_t low = b.vertex(0.5, 0.5, 0.25), high = b.vertex(0.52, 0.55, 0.8);
    for (int i = 0; i < triangles; ++i) {
        const double t = kTurn * draw(seed, n), r = 0.05 + 0.3 * draw(seed, n), z = 0.15 + 0.7 * draw(seed, n);
        b.facet({low, high, b.vertex(0.5 + r * std::cos(t), 0.5 + r * std::sin(t), z)});
    }
    return b.take();
}

Plc random_complex(std::uint64_t seed) {
    std::uint64_t n = 0;
    const std::array<Vec3, 3> shapes{Vec3{1, 1, 1}, {1, 1, 0.05}, {1, 0.05, 0.05}};
    const Vec3 shape = shapes[seed % 3];
    const auto count = static_cast<std::size_t>(8 + 32 * draw(seed, n));
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
        const double x = draw(seed, n), y = draw(seed, n), z = draw(seed, n);
        points.push_back({x * shape.x, y * shape.y, z * shape.z});
    }
    Triangulation delaunay({0, 0, 0}, shape);
    delaunay.insert_all(points);
    std::set<std::array<std::uint32_t, 3>> faces;
    std::set<std::array<std::uint32_t, 2>> edges;
    for (std::size_t slot = 0; slot < delaunay.tets().slots(); ++slot) {
        if (!delaunay.tets().is_finite(TetId{slot})) continue;
        std::array<std::uint32_t, 4> t{};
        for (unsigned i = 0; i < 4; ++i) t[i] = delaunay.tets().corner(TetId{slot}, i).value();
        std::sort(t.begin(), t.end());
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j) {
                edges.insert({t[i], t[j]});
                for (std::size_t k = j + 1; k < 4; ++k) faces.insert({t[i], t[j], t[k]});
            }
    }
    Builder b;
    b.box({-0.25, -0.25, -0.25}, shape + Vec3{0.25, 0.25, 0.25});
    std::map<std::uint32_t, std::uint32_t> kept;
    const auto keep = [&](std::uint32_t v) {
        const auto [at, fresh] = kept.try_emplace(v, 0);
        if (fresh) at->second = b.vertex(points[v].x, points[v].y, points[v].z);
        return at->second;
    };
    for (const auto& f : faces) {
        if (draw(seed, n) >= 0.35) continue;
        b.facet({keep(f[0]), keep(f[1]), keep(f[2])});
        for (std::size_t i = 0; i < 3; ++i) edges.erase({std::min(f[i], f[(i + 1) % 3]), std::max(f[i], f[(i + 1) % 3])});
    }
    for (const auto& e : edges)
        if (draw(seed, n) < 0.1) b.segment(keep(e[0]), keep(e[1]));
    return b.take();
}

NamedPlc random_acute(std::uint64_t seed) {
    std::uint64_t n = 1000;  // apart from what the makers draw
    const double angle = std::pow(10.0, -2 + 3.75 * draw(seed, n));  // 0.01 to 56 degrees
    const int count = 3 + static_cast<int>(14 * draw(seed, n));
    NamedPlc named;
    switch (seed % 10) {
        case 0: named = {"wedge", wedge(angle)}; break;
        case 1: named = {"spike", spike(angle, count)}; break;
        case 2: named = {"fan", fan(count)}; break;
        case 3: named = {"tip_to_tip", tip_to_tip(angle, count, draw(seed, n))}; break;
        case 4: named = {"touching", touching_triangles(angle)}; break;
        case 5: named = {"segments_on_a_facet", segments_on_a_facet(angle)}; break;
        case 6: named = {"bundle", bundle(seed, count)}; break;
        default: named = {"complex", random_complex(seed / 10 * 3 + seed % 10 - 7)}; break;
    }
    const bool rotated = draw(seed, n) < 0.7;
    const double scale = draw(seed, n) < 0.6 ? 1 : std::pow(10.0, 12 * draw(seed, n) - 6);
    named.name = fmt::format("{} of seed {}: {:.3g} degrees, {}, {}, scale {:.3g}", named.name, seed, angle, count, rotated ? "rotated" : "as it is", scale);
    named.plc = transformed(std::move(named.plc), rotated ? mix64(seed) : 0, 0, scale);
    return named;
}

}  // namespace wellmesh::testing
