// SPDX-License-Identifier: Apache-2.0
// What is true of a mesh, found afterwards by exact arithmetic that shares no code with the generator.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "wellmesh/error.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

/// One statement about a mesh. `violations` counts elements that break it; `witness` is the first one.
struct Claim {
    enum class State { not_checked, proven, refuted };
    std::string name;       ///< stable key, e.g. "delaunay"
    std::string statement;  ///< one sentence for people
    State state = State::not_checked;
    std::uint64_t checked = 0, violations = 0;
    std::optional<ElementRef> witness{};
    std::string detail;  ///< what is wrong with the witness, with numbers
};

/// Extremes and histogram of element shape over a set of tetrahedra. Angles in degrees.
struct ShapeStatistics {
    std::uint64_t tets = 0;
    double max_radius_edge_ratio = 0;  ///< R / L
    double max_aspect_ratio = 0;       ///< R / r, 3 for the regular tetrahedron
    double min_sigma = 0;              ///< V / L^3
    double min_dihedral_angle_deg = 0, max_dihedral_angle_deg = 0;
    std::array<std::uint64_t, 18> min_dihedral_histogram{};  ///< each tetrahedron's smallest dihedral angle, 5 degrees a bin
    double min_edge = 0, mean_edge = 0, max_edge = 0;        ///< over the edges of these tetrahedra, each edge once
    double min_volume = 0, max_volume = 0;
};

struct RegionVolume {
    std::int32_t region = 0;
    std::uint64_t tets = 0;
    double volume = 0;
    std::optional<double> plc_volume{};  ///< of the PLC's own cell(s), computed from its facets; empty without a PLC
};

struct Certificate {
    std::vector<Claim> claims;
    ShapeStatistics all, interior, boundary;  ///< boundary: at least one vertex on a constraint triangle
    ShapeStatistics unexempt;                 ///< all but the exempt ones: what the bounds are held against
    std::vector<RegionVolume> regions;
    [[nodiscard]] bool proven() const {  ///< no claim is refuted; some may be not checked
        for (const Claim& c : claims)
            if (c.state == Claim::State::refuted) return false;
        return true;
    }
    [[nodiscard]] const Claim* find(const std::string& name) const {
        for (const Claim& c : claims)
            if (c.name == name) return &c;
        return nullptr;
    }
};

/// Bounds and tolerances of a check. The defaults are the referee's.
struct CertifyOptions {
    std::optional<double> max_radius_edge_ratio{}, min_dihedral_angle_deg{}, max_aspect_ratio{}, min_sigma{}, max_volume{};
    /// Instead of the two without "boundary", for tetrahedra with a vertex on a constraint triangle. Empty: no other than elsewhere.
    std::optional<double> min_dihedral_boundary_deg{}, min_sigma_boundary{};
    double tolerance = 1e-9;        ///< how far a subface may leave the PLC, relative to the PLC's diagonal
    double flat_angle_rad = 1e-6;   ///< two constraint triangles that bend less than this make no segment
    /// Tetrahedra, numbers from 0, ascending, for which no bound on shape holds. Each must have two vertices on constraint triangles or listed subsegments.
    std::vector<std::uint64_t> exempt{};
    unsigned threads = 0;           ///< at work, the caller's among them; 0: as many as the machine has cores. Never changes the certificate
    std::stop_token stop{};         ///< polled between claims: the ones not reached stay `not_checked`
};

/// Proves or refutes P1-P4 for any tool's mesh. Never throws on a wrong mesh: that is a refuted claim. With weights (TetMesh::weights) the claims
/// `weighted_delaunay`, `weighted_gabriel_subfaces` and `weighted_gabriel_subsegments` stand in place of those without "weighted".
/// @param plc  the input that the mesh claims to fill; nullptr: claims about it stay `not_checked`.
[[nodiscard]] Certificate certify(const TetMesh& mesh, const CertifyOptions& options = {}, const Plc* plc = nullptr);

/// Shape statistics alone (all, interior, boundary); cheap.
void measure_shape(const TetMesh& mesh, Certificate& certificate);

}  // namespace wellmesh
