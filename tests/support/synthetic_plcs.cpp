// SPDX-License-Identifier: Apache-2.0
#include "support/synthetic_plcs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh::testing {
namespace {

using Cell = std::array<int, 3>;

/// Boundary (and region interfaces) of a union of unit lattice cells; each facet is one maximal connected set of lattice squares in a plane
/// between the same two regions, given as polygons around its outline.
struct Polycube {
    std::map<Cell, int> region;  // 0 or absent: outside

    [[nodiscard]] int at(Cell c) const {
        auto it = region.find(c);
        return it == region.end() ? 0 : it->second;
    }

    [[nodiscard]] Plc plc(double side) const {
        Plc plc;
        std::map<Cell, std::uint32_t> id;
        auto vertex = [&](Cell c) {
            auto [it, fresh] = id.try_emplace(c, static_cast<std::uint32_t>(plc.vertices.size()));
            if (fresh) plc.vertices.push_back({side * c[0], side * c[1], side * c[2]});
            return it->second;
        };
        for (int axis = 0; axis < 3; ++axis) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            // squares orthogonal to `axis` with different regions on both sides, by (plane, low region, high region)
            std::map<std::array<int, 3>, std::set<std::array<int, 2>>> sheets;
            auto consider = [&](Cell low) {
                Cell high = low;
                ++high[static_cast<std::size_t>(axis)];
                const int a = at(low), b = at(high);
                if (a != b) sheets[{high[static_cast<std::size_t>(axis)], a, b}].insert({low[static_cast<std::size_t>(u)], low[static_cast<std::size_t>(v)]});
            };
            for (const auto& [c, r] : region) {
                consider(c);
                Cell below = c;
                --below[static_cast<std::size_t>(axis)];
                consider(below);
            }
            for (auto& [key, squares] : sheets) {
                while (!squares.empty()) {
                    std::set<std::array<int, 2>> piece;
                    std::vector<std::array<int, 2>> stack{*squares.begin()};
                    squares.erase(squares.begin());
                    while (!stack.empty()) {
                        const auto s = stack.back();
                        stack.pop_back();
                        piece.insert(s);
                        const std::array<std::array<int, 2>, 4> around{{{s[0] + 1, s[1]}, {s[0] - 1, s[1]}, {s[0], s[1] + 1}, {s[0], s[1] - 1}}};
                        for (const auto& n : around)
                            if (squares.erase(n) != 0) stack.push_back(n);
                    }
                    plc.facets.push_back(outline(piece, axis, key[0], vertex));
                }
            }
        }
        return plc;
    }

private:
    template <class V>
    static PlcFacet outline(const std::set<std::array<int, 2>>& piece, int axis, int plane, V&& vertex) {
        // directed unit edges around the piece, each with the piece on its left
        std::map<std::array<int, 2>, std::array<int, 2>> next;
        for (const auto& s : piece) {
            const int x = s[0], y = s[1];
            if (!piece.count({x, y - 1})) next[{x, y}] = {x + 1, y};
            if (!piece.count({x + 1, y})) next[{x + 1, y}] = {x + 1, y + 1};
            if (!piece.count({x, y + 1})) next[{x + 1, y + 1}] = {x, y + 1};
            if (!piece.count({x - 1, y})) next[{x, y + 1}] = {x, y};
        }
        PlcFacet facet;
        while (!next.empty()) {
            std::vector<std::array<int, 2>> loop;
            auto p = next.begin()->first;
            while (next.count(p)) {
                loop.push_back(p);
                const auto q = next[p];
                next.erase(p);
                p = q;
            }
            std::vector<std::uint32_t> polygon;
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const auto& a = loop[(i + loop.size() - 1) % loop.size()];
                const auto& b = loop[i];
                const auto& c = loop[(i + 1) % loop.size()];
                if ((b[0] - a[0]) * (c[1] - b[1]) == (b[1] - a[1]) * (c[0] - b[0])) continue;  // straight on
                Cell corner{};
                corner[static_cast<std::size_t>(axis)] = plane;
                corner[static_cast<std::size_t>((axis + 1) % 3)] = b[0];
                corner[static_cast<std::size_t>((axis + 2) % 3)] = b[1];
                polygon.push_back(vertex(corner));
            }
            facet.polygons.push_back(std::move(polygon));
        }
        return facet;
    }
};

Vec3 rotate(const std::array<double, 4>& q, const Vec3& p) {
    const Vec3 axis{q[1], q[2], q[3]};
    const Vec3 t = 2.0 * cross(axis, p);
    return p + q[0] * t + cross(axis, t);
}

}  // namespace

Plc cube(double side) { return Polycube{{{{0, 0, 0}, 1}}}.plc(side); }

Plc l_block(double side) { return Polycube{{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{0, 1, 0}, 1}}}.plc(side); }

Plc cube_with_cavity() {
    Polycube cells;
    for (int x = 0; x < 3; ++x)
        for (int y = 0; y < 3; ++y)
            for (int z = 0; z < 3; ++z)
                if (x != 1 || y != 1 || z != 1) cells.region[{x, y, z}] = 1;
    Plc plc = cells.plc(1);
    plc.hole_seeds.push_back({1.5, 1.5, 1.5});
    return plc;
}

Plc cube_with_internal_facet() {
    Plc plc = Polycube{{{{0, 0, 0}, 1}, {{1, 0, 0}, 2}}}.plc(1);
    plc.region_seeds.push_back({{0.5, 0.5, 0.5}, 1, 0});
    plc.region_seeds.push_back({{1.5, 0.5, 0.5}, 2, 0});
    return plc;
}

Plc stepped_shaft() {
    Plc plc;
    // octagons with vertices (+-a, +-b), (+-b, +-a): exactly planar sides, angles within rounding of 135 degrees
    auto ring = [&](double a, double z) {
        const double b = a * (std::sqrt(2.0) - 1);
        const std::array<std::array<double, 2>, 8> xy{{{a, b}, {b, a}, {-b, a}, {-a, b}, {-a, -b}, {-b, -a}, {b, -a}, {a, -b}}};
        std::vector<std::uint32_t> ids;
        for (const auto& p : xy) {
            ids.push_back(static_cast<std::uint32_t>(plc.vertices.size()));
            plc.vertices.push_back({p[0], p[1], z});
        }
        return ids;
    };
    const auto r0 = ring(1, 0), r1 = ring(1, 1.5), r2 = ring(0.5, 1.5), r3 = ring(0.5, 3);
    auto facet = [&](std::vector<std::vector<std::uint32_t>> polygons, std::vector<Vec3> holes = {}) {
        plc.facets.push_back({std::move(polygons), std::move(holes), 0});
    };
    auto sides = [&](const std::vector<std::uint32_t>& low, const std::vector<std::uint32_t>& high) {
        for (std::size_t i = 0; i < 8; ++i) facet({{low[i], low[(i + 1) % 8], high[(i + 1) % 8], high[i]}});
    };
    facet({r0});
    sides(r0, r1);
    facet({r1, r2}, {{0, 0, 1.5}});
    sides(r2, r3);
    facet({r3});
    return plc;
}

std::vector<NamedPlc> all_synthetic_plcs() {
    return {{"cube", cube()}, {"l_block", l_block()}, {"cavity", cube_with_cavity()}, {"two_regions", cube_with_internal_facet()}, {"shaft", stepped_shaft()}};
}

double diagonal(const Plc& plc) {
    Vec3 lo = plc.vertices.at(0), hi = lo;
    for (const Vec3& p : plc.vertices) {
        lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
        hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
    return distance(lo, hi);
}

Plc transformed(Plc plc, std::uint64_t rotation_seed, double shift_diagonals, double scale) {
    std::array<double, 4> q{1, 0, 0, 0};
    if (rotation_seed != 0) {
        double length = 0;
        for (std::size_t i = 0; i < 4; ++i) {
            q[i] = 2 * unit_double(mix64(rotation_seed, i)) - 1;
            length += q[i] * q[i];
        }
        for (double& x : q) x /= std::sqrt(length);
    }
    const double shift = shift_diagonals * scale * diagonal(plc);
    auto largest = [&] {
        double c = 0;
        for (const Vec3& p : plc.vertices) c = std::max({c, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        return c;
    };
    const double largest_before = largest();
    auto map = [&](Vec3& p) {
        if (rotation_seed != 0) p = rotate(q, p);
        p = scale * p + Vec3{shift, shift, shift};
    };
    for (Vec3& p : plc.vertices) map(p);
    for (PlcFacet& f : plc.facets)
        for (Vec3& p : f.holes) map(p);
    for (Vec3& p : plc.hole_seeds) map(p);
    for (RegionSeed& r : plc.region_seeds) {
        map(r.point);
        r.max_volume *= scale * scale * scale;
    }
    // the source's rounding moved the vertices by a length, which the shift leaves alone
    if (largest_before > 0) plc.relative_rounding *= scale * largest_before / largest();
    return plc;
}

}  // namespace wellmesh::testing
