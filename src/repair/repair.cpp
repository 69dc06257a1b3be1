// SPDX-License-Identifier: Apache-2.0
#include "wellmesh/repair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"
#include "repair/assemble.hpp"
#include "repair/resolve.hpp"
#include "validation/box_tree.hpp"
#include "validation/report.hpp"
#include "validation/rounding.hpp"

namespace wellmesh {
namespace {

double largest_coordinate(const Plc& plc) {
    double largest = 0;
    for (const Vec3& p : plc.vertices)
        if (in_exact_range(p)) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return largest;
}

double diagonal(const Plc& plc) {
    Box box;
    for (const Vec3& p : plc.vertices)
        if (in_exact_range(p)) box.add(p);
    return box.empty() ? 0 : distance(box.low, box.high);
}

double checked_tolerance(const Plc& plc, const RepairOptions& options) {
    if (!options.tolerance) return default_repair_tolerance(plc);
    const double least = least_repair_tolerance(plc), most = 0.1 * diagonal(plc), asked = *options.tolerance;
    if (!(asked >= least && asked <= most))
        throw MeshError(ErrorCode::bad_options, Stage::validate,
                        fmt::format("the tolerance of a repair must be between {:.3g} (rounding at these coordinates) and {:.3g} (a tenth of the diagonal), not {:.3g}", least,
                                    most, asked));
    return asked;
}

std::string summarise(const RepairResult& r) {
    std::string text;
    const auto tell = [&](std::uint64_t n, const char* what) {
        if (n != 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, what);
    };
    const RepairActions& a = r.actions;
    tell(a.unusable_dropped, "unusable facets or segments dropped");
    tell(a.vertices_merged, "vertices merged");
    tell(a.unused_vertices_dropped, "unused vertices dropped");
    tell(a.degenerate_dropped, "triangles without area dropped");
    tell(a.duplicates_dropped, "repeated triangles dropped");
    tell(a.folds_dropped, "folded triangles dropped");
    tell(a.inner_dropped, "inner triangles dropped");
    tell(a.facets_turned, "facets turned");
    tell(a.vertices_joined_to_edges, "times an edge led through a vertex nearby");
    tell(a.vertices_joined_to_facets, "times a facet led through a vertex nearby");
    tell(a.intersection_points, "vertices made where facets meet");
    tell(a.facets_cut, "facets cut");
    if (text.empty()) text = "nothing to do";
    text += fmt::format(". Nothing moved by more than {:.3g}{}.", r.max_displacement, r.max_displacement > 0 ? ", near " + format_point(r.displaced_most) : std::string());
    if (!r.resolved)
        text += fmt::format(" Given up: after {} rounds there were still intersections to cut, and the more, the more was cut: many facets are almost coplanar or lie in each "
                            "other. The input is left as it is; a tolerance above the distance of these facets may help.",
                            r.rounds);
    if (r.max_displacement > 2 * r.tolerance)
        text += fmt::format(" That is more than twice the tolerance of {:.3g}: the result is refused; features as small as the tolerance are too close to each other.", r.tolerance);
    return text;
}

}  // namespace

double least_repair_tolerance(const Plc& plc) { return 64 * std::numeric_limits<double>::epsilon() * largest_coordinate(plc); }

double default_repair_tolerance(const Plc& plc) {
    constexpr double kRelative = 1e-8;  // far below any feature that is meant, far above the rounding of doubles
    Rounding rounding;
    rounding.largest_coordinate = largest_coordinate(plc);
    rounding.relative = std::max(0.0, plc.relative_rounding);
    // two vertices that were one are up to twice the source's rounding apart
    return std::max({kRelative * diagonal(plc), 2 * rounding.source(), least_repair_tolerance(plc)});
}

RepairResult repair(const Plc& plc, const RepairOptions& options, const std::stop_token& stop) {
    RepairResult result;
    if (!(largest_coordinate(plc) > 0)) throw MeshError(ErrorCode::bad_input, Stage::validate, "nothing to repair: no vertex has usable coordinates");
    if (options.drop_inner_facets && plc.fill != FillRule::nonzero_winding)
        throw MeshError(ErrorCode::bad_options, Stage::validate, "inner facets can be dropped from surface files only: here, they separate regions");
    result.tolerance = checked_tolerance(plc, options);
    StatedPieces stated = make_pieces(plc, result.tolerance);
    if (stated.pieces.triangles.empty() && stated.pieces.wires.empty())
        throw MeshError(ErrorCode::bad_input, Stage::validate, "nothing to repair: no facet and no segment is usable");
    if (plc.fill == FillRule::nonzero_winding) orient_consistently(stated);
    const Resolution resolution = resolve(stated, least_repair_tolerance(plc) / 8, stop);
    result.resolved = resolution.complete;
    result.rounds = resolution.rounds;
    if (!result.resolved) {  // half cut, it would be worse than before
        result.plc = plc;
        result.actions = stated.pieces.actions;
        result.diagnosis = diagnose(plc);
        result.summary = summarise(result);
        return result;
    }
    if (plc.fill == FillRule::nonzero_winding) drop_idle_pieces(stated.pieces, options.drop_inner_facets);
    const Displacement displacement = displacement_of(plc, stated);
    result.max_displacement = displacement.distance;
    result.displaced_most = displacement.where;
    result.plc = assemble(plc, stated);
    result.actions = stated.pieces.actions;
    MeshOptions meshing;
    meshing.coplanar_tolerance = options.coplanar_tolerance;
    result.diagnosis = diagnose(result.plc, meshing);
    result.summary = summarise(result);
    return result;
}

}  // namespace wellmesh
