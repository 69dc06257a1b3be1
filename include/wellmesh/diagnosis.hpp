// SPDX-License-Identifier: Apache-2.0
// What is wrong with an input, all of it at once.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "wellmesh/error.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh {

enum class Severity { note, warning, error };

enum class DefectKind {
    non_finite_coordinate, coordinate_range, bad_index, degenerate_facet, duplicate_vertex, duplicate_facet, isolated_vertex,
    self_intersection, open_edge, inconsistent_orientation, non_planar_facet, feature_too_thin, no_cell, seed_outside, seed_on_facet,
    seed_conflict, outside_domain, acute_segment_angle, acute_dihedral_angle, empty_input
};
[[nodiscard]] const char* to_string(DefectKind kind) noexcept;

struct Defect {
    DefectKind kind{};
    Severity severity = Severity::error;
    std::vector<ElementRef> elements;  ///< source numbers and a point each
    std::string message;               ///< one sentence: what, where, what to do
    double value = 0;                  ///< angle [deg], distance or count, by kind
};

struct CellSummary {
    std::int32_t region = 0;
    double volume = 0;
    Vec3 inside{};
    bool filled = false;
    std::string name{};  ///< of the region, if it has one
};

struct Diagnosis {
    std::vector<Defect> defects;  ///< errors first, then by severity and kind, in a fixed order
    std::vector<CellSummary> cells;
    std::uint64_t vertices = 0, segments = 0, facets = 0;  ///< of the complex after merging
    double coplanar_tolerance = 0;                         ///< largest local tolerance used
    [[nodiscard]] bool has_errors() const {
        for (const Defect& d : defects)
            if (d.severity == Severity::error) return true;
        return false;
    }
};

/// Lists every defect of `plc`. Never throws on bad geometry.
[[nodiscard]] Diagnosis diagnose(const Plc& plc, const MeshOptions& options = {});

}  // namespace wellmesh
