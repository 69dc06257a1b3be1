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

using Square = std::array<int, 2>;
using Sheets = std::map<std::array<int, 3>, std::set<Square>>;

constexpr std::array<Square, 4> kSteps{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// Takes the connected squares around one of `squares` out of it.
std::set<Square> take_piece(std::set<Square>& squares) {
    std::set<Square> piece;
    std::vector<Square> stack{*squares.begin()};
    squares.erase(squares.begin());
    while (!stack.empty()) {
        const Square s = stack.back();
        stack.pop_back();
        piece.insert(s);
        for (const Square& d : kSteps)
            if (const Square n{s[0] + d[0], s[1] + d[1]}; squares.erase(n) != 0) stack.push_back(n);
    }
    return piece;
}

/// Outline of the piece as simple loops of lattice points; loops that touch in a point are told apart there.
std::vector<std::vector<Square>> loops_around(const std::set<Square>& piece) {
    std::map<Square, std::vector<Square>> next;  // directed unit edges, each with the piece on its left
    for (const Square& s : piece) {
        const int x = s[0], y = s[1];
        if (!piece.count({x, y - 1})) next[{x, y}].push_back({x + 1, y});
        if (!piece.count({x + 1, y})) next[{x + 1, y}].push_back({x + 1, y + 1});
        if (!piece.count({x, y + 1})) next[{x + 1, y + 1}].push_back({x, y + 1});
        if (!piece.count({x - 1, y})) next[{x, y + 1}].push_back({x, y});
    }
    std::vector<std::vector<Square>> loops;
    while (!next.empty()) {
        std::vector<Square> path{next.begin()->first};
        while (true) {
            const auto it = next.find(path.back());
            if (it == next.end()) break;
            const Square to = it->second.back();
            it->second.pop_back();
            if (it->second.empty()) next.erase(it);
            const auto seen = std::find(path.begin(), path.end(), to);
            if (seen == path.end()) {
                path.push_back(to);
                continue;
            }
            loops.emplace_back(seen, path.end());
            path.erase(seen + 1, path.end());
        }
    }
    return loops;
}

bool is_corner(const std::vector<Square>& loop, std::size_t i) {
    const Square &a = loop[(i + loop.size() - 1) % loop.size()], &b = loop[i], &c = loop[(i + 1) % loop.size()];
    return (b[0] - a[0]) * (c[1] - b[1]) != (b[1] - a[1]) * (c[0] - b[0]);
}

/// Middles of the squares that stand for the bounded components of the piece's complement.
std::vector<Square> holes_in(const std::set<Square>& piece) {
    Square lo = *piece.begin(), hi = lo;
    for (const Square& s : piece)
        for (std::size_t k = 0; k < 2; ++k) {
            lo[k] = std::min(lo[k], s[k] - 1);
            hi[k] = std::max(hi[k], s[k] + 1);
        }
    std::set<Square> empty;
    for (int x = lo[0]; x <= hi[0]; ++x)
        for (int y = lo[1]; y <= hi[1]; ++y)
            if (!piece.count({x, y})) empty.insert({x, y});
    take_piece(empty);  // the first square is a corner of the frame: the unbounded component
    std::vector<Square> holes;
    while (!empty.empty()) holes.push_back(*take_piece(empty).begin());
    return holes;
}

/// Boundary (and region interfaces) of a union of unit lattice cells; each facet is one maximal connected set of lattice squares in a plane
/// between the same two regions, given as polygons around its outline.
struct Polycube {
    std::map<Cell, int> region;  // 0 or absent: outside

    [[nodiscard]] int at(Cell c) const {
        auto it = region.find(c);
        return it == region.end() ? 0 : it->second;
    }

    [[nodiscard]] Plc plc(double side) const {
        std::vector<Piece> pieces;
        for (int axis = 0; axis < 3; ++axis) {
            Sheets sheets = sheets_across(axis);
            for (auto& [key, squares] : sheets)
                while (!squares.empty()) {
                    const std::set<Square> piece = take_piece(squares);
                    pieces.push_back({axis, key[0], loops_around(piece), holes_in(piece)});
                }
        }
        // A corner of one facet on a straight outline of another is a vertex of both.
        std::set<Cell> corners;
        for (const Piece& p : pieces)
            for (const auto& loop : p.loops)
                for (std::size_t i = 0; i < loop.size(); ++i)
                    if (is_corner(loop, i)) corners.insert(p.lattice_point(loop[i]));
        Plc plc;
        std::map<Cell, std::uint32_t> id;
        for (const Piece& p : pieces) {
            PlcFacet facet;
            for (const auto& loop : p.loops) {
                std::vector<std::uint32_t> polygon;
                for (const Square& s : loop) {
                    const Cell c = p.lattice_point(s);
                    if (!corners.count(c)) continue;
                    const auto [it, fresh] = id.try_emplace(c, static_cast<std::uint32_t>(plc.vertices.size()));
                    if (fresh) plc.vertices.push_back({side * c[0], side * c[1], side * c[2]});
                    polygon.push_back(it->second);
                }
                facet.polygons.push_back(std::move(polygon));
            }
            for (const Square& h : p.holes) facet.holes.push_back(p.middle(h, side));
            plc.facets.push_back(std::move(facet));
        }
        return plc;
    }

private:
    struct Piece {
        int axis, plane;
        std::vector<std::vector<Square>> loops;
        std::vector<Square> holes;

        [[nodiscard]] Cell lattice_point(const Square& s) const {
            Cell c{};
            c[static_cast<std::size_t>(axis)] = plane;
            c[static_cast<std::size_t>((axis + 1) % 3)] = s[0];
            c[static_cast<std::size_t>((axis + 2) % 3)] = s[1];
            return c;
        }
        [[nodiscard]] Vec3 middle(const Square& s, double side) const {
            const Cell c = lattice_point(s);
            return side * Vec3{c[0] + (axis == 0 ? 0 : 0.5), c[1] + (axis == 1 ? 0 : 0.5), c[2] + (axis == 2 ? 0 : 0.5)};
        }
    };

    /// Squares orthogonal to `axis` with different regions on both sides, by (plane, low region, high region).
    [[nodiscard]] Sheets sheets_across(int axis) const {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        Sheets sheets;
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
        return sheets;
    }
};

/// One cell of each connected component of equal label within the box [-1, n]^3.
std::vector<Cell> component_representatives(const Polycube& cells, int n) {
    std::set<Cell> seen;
    std::vector<Cell> out;
    for (int x = -1; x <= n; ++x)
        for (int y = -1; y <= n; ++y)
            for (int z = -1; z <= n; ++z) {
                if (!seen.insert({x, y, z}).second) continue;
                out.push_back({x, y, z});
                std::vector<Cell> stack{{x, y, z}};
                while (!stack.empty()) {
                    const Cell c = stack.back();
                    stack.pop_back();
                    for (std::size_t axis = 0; axis < 3; ++axis)
                        for (const int step : {-1, 1}) {
                            Cell d = c;
                            d[axis] += step;
                            if (d[axis] < -1 || d[axis] > n || cells.at(d) != cells.at(c) || !seen.insert(d).second) continue;
                            stack.push_back(d);
                        }
                }
            }
    return out;
}

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

RandomPolycube random_polycube(std::uint64_t seed) {
    constexpr int n = 4;
    Polycube cells;
    std::uint64_t draws = 0;
    const auto below = [&](std::uint64_t bound) { return static_cast<int>(mix64(seed, ++draws) % bound); };
    const int boxes = 1 + below(6), regions = 1 + below(3);
    for (int b = 0; b < boxes; ++b) {
        Cell lo{}, hi{};
        for (std::size_t k = 0; k < 3; ++k) {
            // The first box is large: there must be something to carve out of and to stand on.
            lo[k] = b == 0 ? below(2) : below(n);
            hi[k] = std::min(n, lo[k] + (b == 0 ? 2 : 1) + below(3));
        }
        const int label = b == 0 ? 1 : below(static_cast<std::uint64_t>(regions) + 1);
        for (int x = lo[0]; x < hi[0]; ++x)
            for (int y = lo[1]; y < hi[1]; ++y)
                for (int z = lo[2]; z < hi[2]; ++z) {
                    if (label != 0) cells.region[{x, y, z}] = label;
                    else cells.region.erase({x, y, z});
                }
    }
    if (cells.region.empty()) cells.region[{0, 0, 0}] = 1;
    RandomPolycube out{cells.plc(1), {}};
    for (const auto& [c, label] : cells.region) ++out.cells_of_region[label];
    for (const Cell& c : component_representatives(cells, n)) {
        const Vec3 middle{c[0] + 0.5, c[1] + 0.5, c[2] + 0.5};
        if (cells.at(c) != 0) out.plc.region_seeds.push_back({middle, cells.at(c), 0});
        else if (c != Cell{-1, -1, -1}) out.plc.hole_seeds.push_back(middle);
    }
    return out;
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
