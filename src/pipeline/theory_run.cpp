// SPDX-License-Identifier: Apache-2.0
#include "pipeline/theory_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "strategies/sliver_strategies.hpp"

namespace wellmesh {
namespace {

/// Tries of a picking region in certified mode; facets get a half, segments a quarter. A last resort is no goal there, so many more than
/// the practical mode's: the first few succeed nearly always.
constexpr unsigned kCertifiedCandidates = 400;

bool has_size(const MeshOptions& options, const ValidPlc& plc) {
    const SizeGoals& size = options.size;
    return size.edge_length || size.max_volume || !size.entities.empty() || size.at || size.background || size.per_local_feature_size || size.elements_per_circle ||
           (size.vertex_sizes && !plc.vertex_sizes.empty()) ||
           std::any_of(plc.cells.begin(), plc.cells.end(), [](const ValidCell& c) { return c.filled && c.max_volume > 0; });
}

}  // namespace

TheoryConstants paper_constants(const MeshOptions& options) {
    const PaperConstants& paper = options.paper;
    const double rho0 = options.quality.max_radius_edge_ratio;
    if (options.mode == Mode::certified) return {paper.delta.value_or(kCertifiedDelta), paper.b.value_or(kCertifiedB), rho0, paper.sigma0.value_or(kCertifiedSigma)};
    const double delta = options.slivers == SliverStrategy::chew ? kChewDelta : paper.delta.value_or(kPracticalDelta);
    const double b = options.slivers == SliverStrategy::refine ? kPracticalB : std::numeric_limits<double>::infinity();
    return {delta, paper.b.value_or(b), rho0, paper.sigma0.value_or(0)};
}

namespace {

/// The constants of practical mode: who uses them, and their ranges.
void check_practical_constants(const MeshOptions& options, std::vector<std::string>& problems) {
    const PaperConstants& paper = options.paper;
    const std::string name = to_string(options.slivers);
    const bool papers_own = options.slivers == SliverStrategy::refine || options.slivers == SliverStrategy::improve;
    // No bound above on sigma0: the regular tetrahedron's 0.1179 is not the most, tetrahedra of the body-centred cubic lattice have 0.128.
    const auto constant = [&](const char* what, std::optional<double> value) {
        if (!value) return;
        if (!papers_own)
            problems.push_back(fmt::format("{} (here {}) belongs to certified mode and to the slivers refine and improve, not to {}", what, *value, name));
        else if (!(*value > 0 && *value <= std::numeric_limits<double>::max()))
            problems.push_back(fmt::format("{} must be a finite number above 0, not {}", what, *value));
    };
    constant("b", paper.b);
    constant("sigma0", paper.sigma0);
    constant("sigma0 at the boundary", paper.sigma0_boundary);
    if (paper.delta && options.slivers == SliverStrategy::chew)
        problems.push_back(fmt::format("delta (here {}) is not for the slivers chew: its points lie within half a unit", *paper.delta));
    if (paper.delta && (options.slivers == SliverStrategy::none || options.slivers == SliverStrategy::exude))
        problems.push_back(fmt::format("delta (here {}) is the radius of picking regions, from which the slivers {} pick nothing", *paper.delta, name));
    if (!papers_own) return;
    if (paper.sigma0_boundary && !paper.sigma0) problems.push_back("sigma0 at the boundary needs sigma0, by which slivers inside are judged then");
    if (paper.sigma0 && (options.quality.min_dihedral_angle_deg != 0 || options.quality.min_dihedral_boundary_deg))
        problems.push_back("min dihedral angle must be 0 where slivers are judged by sigma0");
}

}  // namespace

std::vector<std::string> check_paper_constants(const MeshOptions& options) {
    const TheoryConstants c = paper_constants(options);
    std::vector<std::string> problems;
    if (options.mode == Mode::certified) {
        for (const std::string& problem : check(c)) problems.push_back("certified mode: " + problem);
        if (options.quality.min_dihedral_angle_deg != 0)
            problems.push_back(fmt::format("min dihedral angle must be 0 in certified mode, which judges slivers by sigma0, not {}", options.quality.min_dihedral_angle_deg));
        if (options.paper.sigma0_boundary)
            problems.push_back("sigma0 at the boundary is for the slivers refine and improve of practical mode: in certified mode sigma0 holds everywhere");
        return problems;
    }
    if (!(c.delta > 0 && c.delta < 1)) problems.push_back(fmt::format("delta must be above 0 and below 1, not {}", c.delta));
    check_practical_constants(options, problems);
    return problems;
}

std::unique_ptr<RunRecorder> prepare_theory(const ConformingMesh& mesh, BoundaryRefiner& boundary, const MeshOptions& options) {
    const TheoryConstants c = paper_constants(options);
    const bool certified = options.mode == Mode::certified;
    boundary.rules.delta = c.delta;
    boundary.rules.jitter = certified ? 0 : std::min(boundary.rules.jitter, c.delta);
    boundary.rules.strict = certified;
    if (!certified && !options.invariants) return nullptr;
    auto recorder = std::make_unique<RunRecorder>(mesh, c, has_size(options, mesh.plc()));
    boundary.recorder = recorder.get();
    return recorder;
}

void set_sliver_rule(Refiner& refiner, const MeshOptions& options) {
    const TheoryConstants c = paper_constants(options);
    SliverRule rule;
    rule.inside = rule.at_boundary = c.sigma0;
    rule.b = c.b;
    rule.candidates = kCertifiedCandidates;
    refiner.set_sliver_rule(rule);
}

void finish_theory(RunRecorder* recorder, BoundaryRefiner& boundary, MeshResult& result) {
    if (!recorder) return;
    boundary.recorder = nullptr;
    result.invariants = recorder->finish();
}

void judge_invariants(MeshResult& result, const MeshOptions& options) {
    if (options.mode != Mode::certified || !result.invariants) return;
    std::string broken;  // witnesses say where: vertices that were inserted have no number in the input
    for (const InvariantClaim& claim : result.invariants->claims) {
        if (claim.violations == 0 || claim.name == "theorem_4_1") continue;
        broken += fmt::format("{}{} ({}): {} of {} events, bound {:.6g}, worst {:.6g}, first: {}", broken.empty() ? "" : "; ", claim.name, claim.statement, claim.violations,
                              claim.events, claim.bound, claim.worst, claim.witness);
    }
    if (!broken.empty())
        throw MeshError(ErrorCode::internal_invariant, Stage::refine, "the run violates what is proven of it; please report this input: " + broken);
    // Above the existence theorem's own sigma0, which no double holds, points without new small slivers need not exist.
    if (const InvariantClaim* existence = result.invariants->find("theorem_4_1"))
        result.goals.push_back({"picks that avoid new small slivers", 1, existence->violations == 0 ? 1.0 : 0.0, existence->violations == 0, existence->violations, {}});
}

}  // namespace wellmesh
