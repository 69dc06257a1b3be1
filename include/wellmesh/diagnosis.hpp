// SPDX-License-Identifier: Apache-2.0
// What is wrong with an input, all of it at once.
#pragma once

#include <cstdint>
#include <optional>
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
    seed_conflict, outside_domain, acute_segment_angle, acute_dihedral_angle, empty_input, non_manifold_edge, near_miss
};
[[nodiscard]] const char* to_string(DefectKind kind) noexcept;

struct Defect {
    DefectKind kind{};
    Severity severity = Severity::error;
    std::vector<ElementRef> elements;  ///< source numbers and a point each
    std::string message;               ///< one sentence: what, where, what to do
    double value = 0;                  ///< angle [deg], distance or count, by kind
    /// Where it is, if the elements' own points do not say: one point, the ends of a segment (an intersection, a gap, an edge), or a triangle.
    std::vector<Vec3> points{};
};

struct CellSummary {
    std::int32_t region = 0;
    double volume = 0;
    Vec3 inside{};
    bool filled = false;
    std::string name{};  ///< of the region, if it has one
};

/// The least of something, and where: 0 points if there is none.
struct SmallestFeature {
    double value = 0;
    std::vector<Vec3> points{};
};

/// Lengths in input units, angles in degrees.
struct SmallestFeatures {
    SmallestFeature segment;  ///< shortest one: its ends
    SmallestFeature gap;      ///< smallest distance of two vertices, segments or facets that have no vertex in common: a point of each
    SmallestFeature angle;    ///< smallest angle between segments of a facet at a vertex, or between facets at a segment: the vertex, or the ends
};

struct Diagnosis {
    std::vector<Defect> defects;  ///< errors first, then by severity and kind, in a fixed order
    std::vector<CellSummary> cells;
    std::uint64_t vertices = 0, segments = 0, facets = 0;  ///< of the complex after merging
    double coplanar_tolerance = 0;                         ///< largest local tolerance used
    SmallestFeatures smallest{};                           ///< filled by examine() only
    [[nodiscard]] bool has_errors() const {
        for (const Defect& d : defects)
            if (d.severity == Severity::error) return true;
        return false;
    }
};

/// Lists every defect of `plc`. Never throws on bad geometry.
[[nodiscard]] Diagnosis diagnose(const Plc& plc, const MeshOptions& options = {});

struct ExamineOptions {
    /// Vertices, segments and facets without a common vertex that come closer than this are listed as near_miss. Input units; default: 1e-4 of the
    /// diagonal of the bounding box; 0: none.
    std::optional<double> near{};
    std::optional<double> coplanar_tolerance{};  ///< MeshOptions::coplanar_tolerance
};

/// Like diagnose(), and beyond what keeps an input from being meshed: near misses, non-manifold and inconsistently oriented edges of surface files,
/// dangling edges of other complexes, smallest features; acute angles and misplaced seeds also where the complex is not valid.
/// @throws MeshError{bad_options}  `near` is negative or not a number.
[[nodiscard]] Diagnosis examine(const Plc& plc, const ExamineOptions& options = {});

}  // namespace wellmesh
