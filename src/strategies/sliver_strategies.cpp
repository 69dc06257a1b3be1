// SPDX-License-Identifier: Apache-2.0
#include "strategies/sliver_strategies.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "shape/improve.hpp"
#include "strategies/local_improver.hpp"

namespace wellmesh {
namespace {

/// `best`: refinement looks for points without slivers up to this angle, among so many: more cost more than the moves that they save. For
/// larger angles most stars would have to be moved anyway, and picks only add vertices (docs/decisions/0010).
constexpr double kPickingAngleDeg = 20;
constexpr unsigned kPickingCandidates = 12;
/// Tries of a picking region after the fact, where a failure may start a chain of slivers; they end with the first that is good.
constexpr unsigned kTries = 100;

double cosine_of_degrees(double degrees) { return std::cos(degrees * (std::numbers::pi / 180)); }

/// The options' slivers. @return false if there are none to remove.
bool sliver_rule(const MeshOptions& options, SliverRule& rule) {
    rule.candidates = kTries;
    if (const auto sigma0 = options.paper.sigma0) {
        rule.measure = SliverMeasure::sigma;
        rule.inside = *sigma0;
        rule.at_boundary = options.paper.sigma0_boundary.value_or(*sigma0);
        return true;
    }
    const double inside = options.quality.min_dihedral_angle_deg, at_boundary = options.quality.min_dihedral_boundary_deg.value_or(inside);
    rule.measure = SliverMeasure::dihedral;
    rule.inside = cosine_of_degrees(inside);
    rule.at_boundary = cosine_of_degrees(at_boundary);
    return inside > 0 || at_boundary > 0;
}

std::uint64_t growth_budget(const ConformingMesh& mesh) {
    return static_cast<std::uint64_t>(kGrowthLimit * static_cast<double>(mesh.vertex_count())) + kGrowthAllowance;
}

std::string growth_note(const MeshOptions& options, std::uint64_t almost_good, const ConformingMesh& mesh) {
    return fmt::format("{} stopped at {} vertices, its bound of {} times the {} of the almost-good mesh and {} more: slivers are left", to_string(options.slivers),
                       mesh.vertex_count(), kGrowthLimit, almost_good, kGrowthAllowance);
}

SliverOutcome refine_slivers(ConformingMesh& mesh, const BoundaryRefiner& boundary, Refiner& refiner, RunGuard& guard, const MeshOptions& options) {
    SliverOutcome outcome;
    SliverRule rule;
    if (!sliver_rule(options, rule)) return outcome;
    rule.b = options.paper.b.value_or(kPracticalB);
    const std::uint64_t almost_good = mesh.vertex_count();
    refiner.set_sliver_rule(rule);
    refiner.set_sliver_budget(growth_budget(mesh));
    // The paper assumes that no input angle is acute. Where one is, the cascade that splits slivers is rarely endless, but it can be: a fan of ten blades
    // at 0.4 degrees is such an input, of 40 models of CAD and geology none. Refiner::refine() would end it with a mesh, too, but half-way, full of vertices
    // that helped nothing; so what there was before is handed out. The exception comes only where there was no memory for Refiner's own copy.
    std::optional<ConformingMesh> before;
    if (!mesh.plc().acute_features.empty() && !boundary.recorder && guard.can_double()) {
        before = mesh;
        guard.set_ceiling(2 * growth_budget(mesh));
    }
    bool endless = false;
    try {
        outcome.verdict = refiner.refine();
        endless = outcome.verdict == RunGuard::Verdict::out_of_vertices;
    } catch (const MeshError& e) {
        if (!before || e.code() != ErrorCode::budget_exhausted || guard.user_limit_spent()) throw;
        endless = true;
    }
    if (before && endless && !guard.user_limit_spent()) {
        mesh = std::move(*before);
        outcome.verdict = RunGuard::Verdict::go_on;
        outcome.note = "refine gave up on slivers, as splits about an acute angle of the input would not end: the almost-good mesh is left";
        return outcome;
    }
    if (refiner.sliver_budget_spent()) outcome.note = growth_note(options, almost_good, mesh);
    return outcome;
}

SliverOutcome improve_locally(ConformingMesh& mesh, BoundaryRefiner& boundary, const Refiner& refiner, RunGuard& guard, const MeshOptions& options) {
    SliverOutcome outcome;
    SliverRule rule;
    if (!sliver_rule(options, rule)) return outcome;
    rule.b = options.paper.b.value_or(std::numeric_limits<double>::infinity());
    const std::uint64_t almost_good = mesh.vertex_count();
    LocalImprover improver(mesh, boundary, guard, refiner.sizes(), refiner.max_radius_edge(), rule);
    outcome.verdict = improver.improve(growth_budget(mesh));
    if (improver.budget_spent()) outcome.note = growth_note(options, almost_good, mesh);
    return outcome;
}

}  // namespace

bool asks_for_shape(const MeshOptions& options) {
    SliverRule rule;
    return options.slivers != SliverStrategy::none && options.slivers != SliverStrategy::chew && sliver_rule(options, rule);
}

bool only_refines(SliverStrategy strategy) {
    return strategy == SliverStrategy::none || strategy == SliverStrategy::refine || strategy == SliverStrategy::chew;
}

void prepare_refinement(Refiner& refiner, BoundaryRefiner& boundary, const MeshOptions& options) {
    const double theta = options.quality.min_dihedral_angle_deg;
    if (options.slivers == SliverStrategy::best && theta > 0 && theta <= kPickingAngleDeg)
        refiner.set_sliver_cosine(cosine_of_degrees(theta), kPickingCandidates);
    if (options.slivers != SliverStrategy::chew) return;
    SliverRule rule;
    if (!sliver_rule(options, rule)) return;
    rule.unit = kCircumradiusPerEdgeLength * options.size.edge_length.value();
    rule.centre_first = rule.splits = false;
    boundary.rules.delta = kChewDelta;  // of boundary elements, and of what is split for its radius-edge ratio, which may be smaller than the unit
    boundary.rules.reach = kChewDelta * rule.unit;
    refiner.set_sliver_rule(rule);
}

SliverOutcome remove_slivers(ConformingMesh& mesh, BoundaryRefiner& boundary, Refiner& refiner, RunGuard& guard, Workers& workers, const MeshOptions& options) {
    SliverOutcome outcome;
    const double theta = options.quality.min_dihedral_angle_deg;
    switch (options.slivers) {
        case SliverStrategy::none:
        case SliverStrategy::chew:   // refinement has made none where it could
        case SliverStrategy::exude: break;  // the finished mesh gets weights (exudation/)
        case SliverStrategy::refine: return refine_slivers(mesh, boundary, refiner, guard, options);
        case SliverStrategy::improve: return improve_locally(mesh, boundary, refiner, guard, options);
        case SliverStrategy::perturb:
        case SliverStrategy::best: {
            if (!(theta > 0)) break;
            ShapeImprover improver(mesh, boundary, refiner, guard, workers, options.seed);
            outcome.verdict = options.slivers == SliverStrategy::best ? improver.improve(theta) : improver.perturb(theta);
            outcome.moved_vertices = improver.statistics().moves;
            break;
        }
    }
    return outcome;
}

}  // namespace wellmesh
