// SPDX-License-Identifier: Apache-2.0
#include "validation/fill_cells.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "validation/box_tree.hpp"
#include "validation/local_feature_size.hpp"

namespace wellmesh {
namespace {

class CellFiller {
public:
    CellFiller(const CleanInput& input, const Soup& soup, const CellMap& map, const LineQuery& lines, const Rounding& rounding, Report& report)
        : input_(input), soup_(soup), map_(map), lines_(lines), rounding_(rounding), report_(report), plc_(report.plc()), cells_(map.size()), is_hole_(map.size(), 0), has_seed_(map.size(), 0) {}

    std::vector<ValidCell> run() {
        for (std::size_t c = 0; c < map_.size(); ++c) cells_[c].volume = map_.volume[c];
        for (std::size_t h = 0; h < plc_.hole_seeds.size(); ++h) place_hole(h);
        apply_fill_rule();
        place_regions();
        number_rest();
        for (std::uint32_t c = 1; c < cells_.size(); ++c)
            if (cells_[c].filled) cells_[c].inside = point_inside(c);
        return std::move(cells_);
    }

private:
    [[nodiscard]] std::optional<std::uint32_t> touched_triangle(const Vec3& p, double reach) const;
    [[nodiscard]] std::optional<std::uint32_t> cell_at(const Vec3& p, std::size_t number, const std::string& what);
    void place_hole(std::size_t h);
    void apply_fill_rule();
    void place_regions();
    void number_rest();
    [[nodiscard]] Vec3 point_inside(std::uint32_t cell) const;

    const CleanInput& input_;
    const Soup& soup_;
    const CellMap& map_;
    const LineQuery& lines_;
    const Rounding& rounding_;
    Report& report_;
    const Plc& plc_;
    std::vector<ValidCell> cells_;
    std::vector<char> is_hole_, has_seed_;
};

/// The first triangle within `reach` of p.
std::optional<std::uint32_t> CellFiller::touched_triangle(const Vec3& p, double reach) const {
    for (std::uint32_t t = 0; t < soup_.triangles.size(); ++t) {
        const auto corner = [&](std::size_t i) -> const Vec3& { return input_.points[soup_.triangles[t].v[i].index()]; };
        Box box;
        for (std::size_t i = 0; i < 3; ++i) box.add(corner(i));
        const bool near = p.x >= box.low.x - reach && p.x <= box.high.x + reach && p.y >= box.low.y - reach && p.y <= box.high.y + reach &&
                          p.z >= box.low.z - reach && p.z <= box.high.z + reach;
        if (near && distance_to_triangle(p, corner(0), corner(1), corner(2)) <= reach) return t;
    }
    return std::nullopt;
}

/// The cell of a seed; nothing (reported) if the seed is unusable.
std::optional<std::uint32_t> CellFiller::cell_at(const Vec3& p, std::size_t number, const std::string& what) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
        report_.add(DefectKind::non_finite_coordinate, Severity::error, {{EntityKind::region, number, p}}, fmt::format("{} has a coordinate that is not finite", what));
        return std::nullopt;
    }
    const auto place = lines_.locate(p);
    const auto facet_of = [&](std::uint32_t triangle) { return input_.facets[soup_.triangles[triangle].facet].source; };
    if (const auto on = place.on ? place.on : touched_triangle(p, rounding_.ulps(Rounding::kUlps))) {
        const std::uint32_t facet = facet_of(*on);
        report_.add(DefectKind::seed_on_facet, Severity::error, {{EntityKind::region, number, p}, report_.facet(facet, p)},
                    fmt::format("{} at {} lies {} {}: move it into a cell", what, format_point(p), place.on ? "exactly on" : "within rounding on", report_.name_facet(facet)));
        return std::nullopt;
    }
    if (const auto near = touched_triangle(p, rounding_.on_edge())) {
        const std::uint32_t facet = facet_of(*near);
        report_.add(DefectKind::seed_on_facet, Severity::warning, {{EntityKind::region, number, p}, report_.facet(facet, p)},
                    fmt::format("{} at {} is as near {} as the digits of the file may be off: it is taken as it is", what, format_point(p), report_.name_facet(facet)));
    }
    return place.sees ? map_.cell_of_side[*place.sees] : 0;
}

void CellFiller::place_hole(std::size_t h) {
    const Vec3& p = plc_.hole_seeds[h];
    const std::string what = fmt::format("hole seed {}", h + 1);
    const auto cell = cell_at(p, h + 1, what);
    if (!cell) return;
    if (*cell == 0)
        report_.add(DefectKind::seed_outside, Severity::warning, {{EntityKind::region, h + 1, p}},
                    fmt::format("{} at {} lies outside of all bounded cells and has no effect", what, format_point(p)));
    is_hole_[*cell] = 1;
}

void CellFiller::apply_fill_rule() {
    std::optional<std::vector<int>> winding;
    if (plc_.fill == FillRule::nonzero_winding) {
        std::vector<int> weights;
        for (const SoupTriangle& t : soup_.triangles) weights.push_back(input_.facets[t.facet].winding);
        winding = winding_numbers(map_, weights);
        if (!winding)
            report_.add(DefectKind::inconsistent_orientation, Severity::note, {},
                        "the facets are not consistently oriented: every bounded cell is filled");
    }
    std::size_t filled = 0, bounded = cells_.size() - 1;
    for (std::size_t c = 1; c < cells_.size(); ++c) {
        cells_[c].filled = !is_hole_[c] && (!winding || (*winding)[c] != 0);
        filled += cells_[c].filled;
    }
    if (filled == 0)
        report_.add(DefectKind::no_cell, Severity::error, {},
                    bounded == 0 ? std::string("the facets enclose no volume: nothing to mesh (is the surface open?)")
                                 : fmt::format("none of the {} bounded cells is filled: {}", bounded,
                                               winding ? "their winding numbers are zero or they have hole seeds" : "each has a hole seed"));
}

void CellFiller::place_regions() {
    std::vector<std::optional<std::size_t>> seed_of(cells_.size());
    for (std::size_t r = 0; r < plc_.region_seeds.size(); ++r) {
        const RegionSeed& seed = plc_.region_seeds[r];
        const std::string what = fmt::format("region seed {}", r + 1);
        const auto cell = cell_at(seed.point, r + 1, what);
        if (!cell) continue;
        ValidCell& c = cells_[*cell];
        const ElementRef ref{EntityKind::region, r + 1, seed.point};
        if (*cell == 0 || is_hole_[*cell]) {
            report_.add(DefectKind::seed_outside, Severity::error, {ref},
                        fmt::format("{} (id {}) at {} lies {}", what, seed.id, format_point(seed.point), *cell == 0 ? "outside of all bounded cells" : "in a hole"));
            continue;
        }
        c.filled = true;  // a seed asks for its cell, whatever its winding number
        if (const auto first = seed_of[*cell]) {
            if (plc_.region_seeds[*first].id != seed.id)
                report_.add(DefectKind::seed_conflict, Severity::error, {{EntityKind::region, *first + 1, plc_.region_seeds[*first].point}, ref},
                            fmt::format("region seeds {} (id {}) and {} (id {}) at {} and {} lie in one cell", *first + 1, plc_.region_seeds[*first].id, r + 1,
                                        seed.id, format_point(plc_.region_seeds[*first].point), format_point(seed.point)));
            else if (seed.max_volume > 0)
                c.max_volume = c.max_volume > 0 ? std::min(c.max_volume, seed.max_volume) : seed.max_volume;
            continue;
        }
        seed_of[*cell] = r;
        has_seed_[*cell] = 1;
        c.region = seed.id;
        c.max_volume = seed.max_volume;
    }
}

void CellFiller::number_rest() {
    std::set<std::int32_t> taken;
    for (const RegionSeed& s : plc_.region_seeds) taken.insert(s.id);
    std::int32_t next = 1;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        if (!cells_[c].filled || has_seed_[c]) continue;
        while (taken.contains(next)) ++next;
        cells_[c].region = next++;
    }
}

/// The middle of the widest gap that lines through the cell's largest triangles find, checked by lines in other directions.
Vec3 CellFiller::point_inside(std::uint32_t cell) const {
    constexpr std::size_t kTriangles = 6;
    constexpr std::uint64_t kLines = 4;
    const auto vertex = [&](SideId s, std::size_t i) -> const Vec3& { return input_.points[soup_.triangles[s / 2].v[i].index()]; };
    std::vector<std::pair<double, SideId>> by_area;
    for (const SideId s : map_.sides[cell]) by_area.emplace_back(-squared_norm(cross(vertex(s, 1) - vertex(s, 0), vertex(s, 2) - vertex(s, 0))), s);
    std::sort(by_area.begin(), by_area.end());
    std::optional<Vec3> best;
    double widest = 0;
    for (std::size_t i = 0; i < by_area.size() && (i < kTriangles || !best); ++i) {
        const SideId side = by_area[i].second;
        const Vec3 centre = vertex(side, 0) + (1.0 / 3) * ((vertex(side, 1) - vertex(side, 0)) + (vertex(side, 2) - vertex(side, 0)));
        for (std::uint64_t k = 0; k < kLines; ++k) {
            const Vec3 p = lines_.far_point(centre, 1000 + k), q = lines_.far_point(centre, 1000 + k, -1);
            const auto hits = lines_.pierce(p, q);
            for (std::size_t h = 0; hits && h + 1 < hits->size(); ++h) {
                const Hit &from = (*hits)[h], &to = (*hits)[h + 1];
                const double gap = (to.t - from.t) * distance(p, q);
                if (map_.cell_of_side[from.side_towards_end()] != cell || gap <= widest) continue;
                const Vec3 middle = p + (0.5 * (from.t + to.t)) * (q - p);
                const auto place = lines_.locate(middle);
                if (!place.sees || map_.cell_of_side[*place.sees] != cell) continue;
                widest = gap;
                best = middle;
            }
        }
    }
    // a cell so thin that no double lies inside of it: its smallest triangle's corner stands for it
    return best.value_or(input_.points[soup_.triangles[map_.sides[cell].front() / 2].v[0].index()]);
}

}  // namespace

std::vector<ValidCell> fill_cells(const CleanInput& input, const Soup& soup, const CellMap& map, const LineQuery& lines, const Rounding& rounding, Report& report) {
    return CellFiller(input, soup, map, lines, rounding, report).run();
}

}  // namespace wellmesh
