// SPDX-License-Identifier: Apache-2.0
// Words for the public enumerations.
#include "wellmesh/diagnosis.hpp"
#include "wellmesh/error.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh {

const char* to_string(Stage stage) noexcept {
    switch (stage) {
        case Stage::read: return "read";
        case Stage::validate: return "validate";
        case Stage::delaunay: return "delaunay";
        case Stage::conform: return "conform";
        case Stage::refine: return "refine";
        case Stage::shape: return "shape";
        case Stage::extract: return "extract";
        case Stage::certify: return "certify";
        case Stage::write: return "write";
    }
    return "?";
}

const char* to_string(ErrorCode code) noexcept {
    switch (code) {
        case ErrorCode::bad_input: return "bad_input";
        case ErrorCode::coordinate_range: return "coordinate_range";
        case ErrorCode::bad_options: return "bad_options";
        case ErrorCode::budget_exhausted: return "budget_exhausted";
        case ErrorCode::unsupported_acute: return "unsupported_acute";
        case ErrorCode::cancelled: return "cancelled";
        case ErrorCode::cannot_read: return "cannot_read";
        case ErrorCode::cannot_write: return "cannot_write";
        case ErrorCode::mesh_too_large: return "mesh_too_large";
        case ErrorCode::internal_invariant: return "internal_invariant";
    }
    return "?";
}

const char* to_string(EntityKind kind) noexcept {
    switch (kind) {
        case EntityKind::vertex: return "vertex";
        case EntityKind::segment: return "segment";
        case EntityKind::facet: return "facet";
        case EntityKind::region: return "region";
        case EntityKind::tetrahedron: return "tetrahedron";
        case EntityKind::triangle: return "triangle";
        case EntityKind::edge: return "edge";
        case EntityKind::file: return "file";
    }
    return "?";
}

const char* to_string(Termination termination) noexcept {
    switch (termination) {
        case Termination::goals_met: return "goals_met";
        case Termination::goals_unmet: return "goals_unmet";
        case Termination::vertex_budget_reached: return "vertex_budget_reached";
        case Termination::time_budget_reached: return "time_budget_reached";
        case Termination::memory_budget_reached: return "memory_budget_reached";
        case Termination::cancelled: return "cancelled";
    }
    return "?";
}

const char* to_string(SliverStrategy strategy) noexcept {
    switch (strategy) {
        case SliverStrategy::none: return "none";
        case SliverStrategy::refine: return "refine";
        case SliverStrategy::improve: return "improve";
        case SliverStrategy::chew: return "chew";
        case SliverStrategy::exude: return "exude";
        case SliverStrategy::perturb: return "perturb";
        case SliverStrategy::best: return "best";
    }
    return "?";
}

std::optional<SliverStrategy> parse_sliver_strategy(std::string_view name) noexcept {
    for (const SliverStrategy strategy : kSliverStrategies)
        if (name == to_string(strategy)) return strategy;
    return std::nullopt;
}

const char* to_string(DefectKind kind) noexcept {
    switch (kind) {
        case DefectKind::non_finite_coordinate: return "non_finite_coordinate";
        case DefectKind::coordinate_range: return "coordinate_range";
        case DefectKind::bad_index: return "bad_index";
        case DefectKind::degenerate_facet: return "degenerate_facet";
        case DefectKind::duplicate_vertex: return "duplicate_vertex";
        case DefectKind::duplicate_facet: return "duplicate_facet";
        case DefectKind::isolated_vertex: return "isolated_vertex";
        case DefectKind::outside_domain: return "outside_domain";
        case DefectKind::self_intersection: return "self_intersection";
        case DefectKind::open_edge: return "open_edge";
        case DefectKind::inconsistent_orientation: return "inconsistent_orientation";
        case DefectKind::non_planar_facet: return "non_planar_facet";
        case DefectKind::feature_too_thin: return "feature_too_thin";
        case DefectKind::no_cell: return "no_cell";
        case DefectKind::seed_outside: return "seed_outside";
        case DefectKind::seed_on_facet: return "seed_on_facet";
        case DefectKind::seed_conflict: return "seed_conflict";
        case DefectKind::acute_segment_angle: return "acute_segment_angle";
        case DefectKind::acute_dihedral_angle: return "acute_dihedral_angle";
        case DefectKind::empty_input: return "empty_input";
        case DefectKind::non_manifold_edge: return "non_manifold_edge";
        case DefectKind::near_miss: return "near_miss";
    }
    return "?";
}

}  // namespace wellmesh
