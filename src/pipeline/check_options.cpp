// SPDX-License-Identifier: Apache-2.0
// Ranges of the options. NaN fails every comparison below, as it should.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "pipeline/theory_run.hpp"
#include "wellmesh/options.hpp"

namespace wellmesh {

namespace {

// The regular tetrahedron is the extreme of both: R/L = sqrt(6)/4 and six equal dihedral angles of acos(1/3).
constexpr double kLeastRadiusEdgeRatio = 0.612372435695794;
/// Neighbours of a tetrahedron within bounds are hardly smaller than what is two edges from it: beyond, sources smaller than a tetrahedron would be missed.
constexpr double kLargestGradation = 1;
constexpr double kLargestMinDihedralDeg = 70.528779365509308;
constexpr std::uint64_t kLeastMemory = std::uint64_t{1} << 20;  // less than any process holds: it could only be a slip, bytes for MiB
constexpr double kLargest = std::numeric_limits<double>::max();  // excludes infinity

/// Combinations of strategy and mode that make no sense.
void check_strategy(const MeshOptions& options, std::vector<std::string>& problems) {
    const char* const name = to_string(options.slivers);
    if (options.mode == Mode::certified && options.slivers != SliverStrategy::best && options.slivers != SliverStrategy::refine) {
        problems.push_back(fmt::format("slivers must be best or refine in certified mode, whose own way with slivers is that of the paper, not {}", name));
        return;
    }
    const auto& boundary = options.quality.min_dihedral_boundary_deg;
    if (boundary && !(*boundary >= 0 && *boundary <= kLargestMinDihedralDeg))
        problems.push_back(fmt::format("min dihedral angle at the boundary must be between 0 and 70.52 degrees (the regular tetrahedron's), not {}", *boundary));
    if (boundary && (options.mode == Mode::certified || (options.slivers != SliverStrategy::refine && options.slivers != SliverStrategy::improve)))
        problems.push_back(fmt::format("min dihedral angle at the boundary is for the slivers refine and improve in practical mode; {} has one goal for all", name));
    if (options.slivers == SliverStrategy::chew && !options.size.edge_length)
        problems.push_back("slivers chew needs a size (edge length): its density is uniform, and the size is its unit");
}

void check_sizes(const SizeGoals& size, std::vector<std::string>& problems) {
    const auto positive = [&](double x, const std::string& field) {
        if (!(x > 0 && x <= kLargest)) problems.push_back(fmt::format("{} must be a finite number above 0, not {}", field, x));
    };
    if (size.per_local_feature_size) positive(*size.per_local_feature_size, "size over local feature size");
    if (size.min_edge_length) positive(*size.min_edge_length, "min size (edge length)");
    if (const auto n = size.elements_per_circle; n && !(*n >= 3 && *n <= kLargest))
        problems.push_back(fmt::format("elements a circle of curvature must be a finite number, at least 3, not {}", *n));
    if (!(size.gradation >= 0 && size.gradation <= kLargestGradation))
        problems.push_back(fmt::format("gradation must be between 0 (no limit) and {}, not {}", kLargestGradation, size.gradation));
    for (const EntitySize& e : size.entities) {
        positive(e.edge_length, fmt::format("size of {} {}", to_string(e.kind), e.id));
        if (e.kind != EntityKind::region && e.kind != EntityKind::facet && e.kind != EntityKind::segment && e.kind != EntityKind::vertex)
            problems.push_back(fmt::format("sizes are for regions, facets, segments and vertices, not for a {}", to_string(e.kind)));
        if (e.kind == EntityKind::vertex && size.gradation == 0) problems.push_back("the size of a vertex needs a gradation: without, nothing around it would follow");
    }
}

}  // namespace

std::vector<std::string> check(const MeshOptions& options) {
    std::vector<std::string> problems;
    const auto need = [&](bool good, const char* field, const char* range, double value) {
        if (!good) problems.push_back(fmt::format("{} must be {}, not {}", field, range, value));
    };
    const auto positive = [](double x) { return x > 0 && x <= kLargest; };

    const QualityGoals& quality = options.quality;
    need(quality.max_radius_edge_ratio >= kLeastRadiusEdgeRatio && quality.max_radius_edge_ratio <= kLargest, "max radius-edge ratio",
         "a finite number, at least 0.6124 (the regular tetrahedron's)", quality.max_radius_edge_ratio);
    need(quality.min_dihedral_angle_deg >= 0 && quality.min_dihedral_angle_deg <= kLargestMinDihedralDeg, "min dihedral angle",
         "between 0 and 70.52 degrees (the regular tetrahedron's)", quality.min_dihedral_angle_deg);

    if (const auto h = options.size.edge_length) need(positive(*h), "size (edge length)", "a finite number above 0", *h);
    if (const auto v = options.size.max_volume) need(positive(*v), "max volume", "a finite number above 0", *v);
    check_sizes(options.size, problems);
    if (const auto n = options.limits.max_vertices) need(*n >= 4, "max vertices", "at least 4", static_cast<double>(*n));
    if (const auto t = options.limits.time) need(t->count() > 0, "time limit", "above 0 milliseconds", static_cast<double>(t->count()));
    if (const auto m = options.limits.memory_bytes) need(*m >= kLeastMemory, "memory limit", "at least 2^20 bytes", static_cast<double>(*m));
    if (const auto d = options.coplanar_tolerance) need(*d >= 0 && *d <= kLargest, "coplanar tolerance", "a finite number, at least 0", *d);
    if (options.threads > kMostThreads) problems.push_back(fmt::format("threads must be at most {}, not {}", kMostThreads, options.threads));
    if (options.thin_features != ThinFeatures::join && options.thin_features != ThinFeatures::refuse)
        problems.push_back(fmt::format("thin features must be joined or refused, not {}", static_cast<int>(options.thin_features)));
    check_strategy(options, problems);
    const std::vector<std::string> constants = check_paper_constants(options);
    problems.insert(problems.end(), constants.begin(), constants.end());
    return problems;
}

}  // namespace wellmesh
