// SPDX-License-Identifier: Apache-2.0
#include "validation/find_cells.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "core/check.hpp"
#include "core/vec3_math.hpp"
#include "validation/plane.hpp"

namespace wellmesh {
namespace {

/// Glues sides of triangles into cells.
class CellFinder {
public:
    CellFinder(std::span<const Vec3> points, std::span<const SoupTriangle> triangles, const EdgeTable& edges, const LineQuery& lines)
        : points_(points), triangles_(triangles), edges_(edges), lines_(lines), sides_(2 * triangles.size() + 1), pieces_(triangles.size()) {}

    CellMap run() {
        glue_at_edges();
        glue_pieces();
        return number_cells();
    }

private:
    [[nodiscard]] SideId outer() const { return static_cast<SideId>(2 * triangles_.size()); }
    [[nodiscard]] const Vec3& corner(std::uint32_t t, std::size_t i) const { return points_[triangles_[t].v[i].index()]; }
    void glue_at_edges();
    void glue_pieces();
    bool glue_along_line(std::uint32_t through, std::vector<char>& placed);
    CellMap number_cells();

    std::span<const Vec3> points_;
    std::span<const SoupTriangle> triangles_;
    const EdgeTable& edges_;
    const LineQuery& lines_;
    DisjointSets sides_;
    DisjointSets pieces_;  // triangles that hang together through edges
};

void CellFinder::glue_at_edges() {
    for (std::size_t e = 0; e < edges_.keys.size(); ++e) {
        const auto order = radial_order(points_, triangles_, edges_, e);
        for (std::size_t i = 0; i < order.size(); ++i) {
            const std::uint32_t here = order[i], there = order[(i + 1) % order.size()];
            sides_.unite(facing_sides(triangles_, edges_, here).next, facing_sides(triangles_, edges_, there).previous);
            pieces_.unite(here / 3, there / 3);
        }
    }
}

/// Consecutive triangles on a line that runs from outside to outside face the same cell. One line through each piece glues it to
/// whatever surrounds it.
bool CellFinder::glue_along_line(std::uint32_t through, std::vector<char>& placed) {
    constexpr std::uint64_t kAttempts = 64;
    const Vec3 &a = corner(through, 0), &b = corner(through, 1), &c = corner(through, 2);
    const Vec3 centre = a + (1.0 / 3) * ((b - a) + (c - a));
    for (std::uint64_t attempt = 0; attempt < kAttempts; ++attempt) {
        const auto hits = lines_.pierce(lines_.far_point(centre, attempt), lines_.far_point(centre, attempt, -1));
        if (!hits || std::none_of(hits->begin(), hits->end(), [&](const Hit& h) { return pieces_.find(h.triangle) == pieces_.find(through); })) continue;
        SideId behind = outer();
        for (const Hit& h : *hits) {
            sides_.unite(behind, h.side_towards_start());
            behind = h.side_towards_end();
            placed[pieces_.find(h.triangle)] = 1;
        }
        sides_.unite(behind, outer());
        return true;
    }
    return false;
}

void CellFinder::glue_pieces() {
    std::vector<char> placed(triangles_.size(), 0);
    std::vector<std::pair<double, std::uint32_t>> by_area;  // large triangles are easy to hit
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
        by_area.emplace_back(-squared_norm(cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0))), t);
    std::sort(by_area.begin(), by_area.end());
    for (const auto& [area, t] : by_area)
        if (!placed[pieces_.find(t)]) glue_along_line(t, placed);
    for (const auto& [area, t] : by_area) WELLMESH_CHECK(Stage::validate, placed[pieces_.find(t)]);
}

CellMap CellFinder::number_cells() {
    const std::size_t n = triangles_.size();
    constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> order(n);  // triangles by their smallest corner
    std::vector<Vec3> smallest(n);
    for (std::uint32_t t = 0; t < n; ++t) {
        smallest[t] = corner(t, 0);
        for (std::size_t i = 1; i < 3; ++i)
            if (lexicographically_less(corner(t, i), smallest[t])) smallest[t] = corner(t, i);
    }
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return smallest[a] == smallest[b] ? a < b : lexicographically_less(smallest[a], smallest[b]); });

    CellMap map;
    map.cell_of_side.assign(2 * n, kNone);
    std::vector<std::uint32_t> number(2 * n + 1, kNone);
    number[sides_.find(outer())] = 0;
    std::uint32_t cells = 1;
    for (const std::uint32_t t : order)
        for (const SideId s : {2 * t, 2 * t + 1}) {
            std::uint32_t& c = number[sides_.find(s)];
            if (c == kNone) c = cells++;
            map.cell_of_side[s] = c;
        }
    map.volume.assign(cells, 0);
    map.sides.resize(cells);
    Box box;
    for (std::uint32_t t = 0; t < n; ++t)
        for (std::size_t i = 0; i < 3; ++i) box.add(corner(t, i));
    const Vec3 origin = 0.5 * box.low + 0.5 * box.high;  // local: far from the origin nothing is lost
    for (std::uint32_t t = 0; t < n; ++t) {
        const double v = determinant(corner(t, 0) - origin, corner(t, 1) - origin, corner(t, 2) - origin) / 6;
        map.volume[map.cell_of_side[2 * t]] -= v;  // the front looks into this cell: the normal points inwards
        map.volume[map.cell_of_side[2 * t + 1]] += v;
        map.sides[map.cell_of_side[2 * t]].push_back(2 * t);
        map.sides[map.cell_of_side[2 * t + 1]].push_back(2 * t + 1);
    }
    map.volume[0] = std::numeric_limits<double>::infinity();
    return map;
}

}  // namespace

std::optional<std::vector<int>> winding_numbers(const CellMap& map, std::span<const int> weights) {
    std::vector<int> number(map.size(), 0);
    std::vector<char> known(map.size(), 0);
    std::vector<std::uint32_t> queue{0};
    known[0] = 1;
    for (std::size_t i = 0; i < queue.size(); ++i) {
        const std::uint32_t c = queue[i];
        for (const SideId s : map.sides[c]) {
            const int weight = weights[s / 2];
            const std::uint32_t beyond = map.cell_of_side[s ^ 1U];
            const int value = number[c] + (s % 2 == 0 ? weight : -weight);  // entering through the front goes in once more
            if (!known[beyond]) {
                known[beyond] = 1;
                number[beyond] = value;
                queue.push_back(beyond);
            } else if (number[beyond] != value) {
                return std::nullopt;
            }
        }
    }
    return number;
}

std::vector<std::uint32_t> radial_order(std::span<const Vec3> points, std::span<const SoupTriangle> triangles, const EdgeTable& edges, std::size_t edge) {
    const auto around = edges.around(edge);
    std::vector<std::uint32_t> order(around.begin(), around.end());
    if (order.size() < 3) return order;  // one cyclic order only
    const auto ends = edge_ends(edges.keys[edge]);
    const Vec3 &a = points[ends[0].index()], &b = points[ends[1].index()];
    const auto apex = [&](std::uint32_t corner) -> const Vec3& { return points[triangles[corner / 3].v[(corner % 3 + 2) % 3].index()]; };
    const Vec3 reference = apex(order[0]);
    // sectors counter-clockwise from the first triangle: its own half plane 0, less than a half turn 1, the opposite half plane 2, more 3
    const auto sector = [&](std::uint32_t corner) {
        if (corner == order[0]) return 0;
        const Sign side = orient3d(a, b, reference, apex(corner));
        if (side != Sign::zero) return side == Sign::positive ? 1 : 3;
        const PlaneProjection p(cross(b - a, reference - a));
        return orient2d(p(a), p(b), p(reference)) == orient2d(p(a), p(b), p(apex(corner))) ? 0 : 2;
    };
    std::vector<std::pair<int, std::uint32_t>> keyed;
    for (const std::uint32_t c : order) keyed.emplace_back(sector(c), c);
    std::sort(keyed.begin() + 1, keyed.end(), [&](const auto& x, const auto& y) {
        if (x.first != y.first) return x.first < y.first;
        if (x.first % 2 == 0) return x.second < y.second;
        const Sign side = orient3d(a, b, apex(x.second), apex(y.second));
        return side != Sign::zero ? side == Sign::positive : x.second < y.second;
    });
    for (std::size_t i = 0; i < keyed.size(); ++i) order[i] = keyed[i].second;
    return order;
}

FacingSides facing_sides(std::span<const SoupTriangle> triangles, const EdgeTable& edges, std::uint32_t corner) {
    const std::uint32_t t = corner / 3;
    const bool along = triangles[t].v[corner % 3] == edge_ends(edges.keys[edges.edge_of[corner]])[0];
    // (a, b, c): its normal is (b - a) x (c - a), where turning counter-clockwise about b - a leads from c
    return along ? FacingSides{2 * t, 2 * t + 1} : FacingSides{2 * t + 1, 2 * t};
}

CellMap find_cells(std::span<const Vec3> points, std::span<const SoupTriangle> triangles, const EdgeTable& edges, const LineQuery& lines) {
    return CellFinder(points, triangles, edges, lines).run();
}

}  // namespace wellmesh
