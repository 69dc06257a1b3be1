// SPDX-License-Identifier: Apache-2.0
// What a caller may ask for. Every default is written here and nowhere else.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace wellmesh {

struct QualityGoals {
    /// Bound on circumradius / shortest edge of every tetrahedron. Below 2 there is no proof of termination.
    double max_radius_edge_ratio = 2.0;
    /// Every dihedral angle at least this many degrees; 0 ignores slivers.
    double min_dihedral_angle_deg = 20.0;
};

struct SizeGoals {
    /// Target edge length h in input units: the mean edge length of a uniform mesh of a cube is within 10 % of h.
    /// Realised as the circumradius bound R <= kCircumradiusPerEdgeLength * h (src/refinement/sizing.hpp). Empty: none.
    std::optional<double> edge_length{};
    /// Bound on the volume of every tetrahedron, in cubed input units. Empty: none.
    std::optional<double> max_volume{};
};

struct Limits {
    std::optional<std::uint64_t> max_vertices{};  ///< of the whole mesh, input vertices included
    std::optional<std::chrono::milliseconds> time{};
};

/// Vertices from a body-centred cubic lattice inside, where a size is asked for: about a third fewer for the same size.
enum class Seeding : std::uint8_t { automatic, off };

struct MeshOptions {
    QualityGoals quality{};
    SizeGoals size{};
    Limits limits{};
    Seeding seeding = Seeding::automatic;
    /// Overrides the local planarity tolerance by which facets are merged and accepted, in input units.
    std::optional<double> coplanar_tolerance{};
    /// Input, options and seed fix the output bytes (time limits and cancellation apart).
    std::uint64_t seed = 0;
};

/// All that is wrong with `options`, one sentence a field with its valid range; empty when nothing is.
[[nodiscard]] std::vector<std::string> check(const MeshOptions& options);

}  // namespace wellmesh
