// SPDX-License-Identifier: Apache-2.0
// How the star of a vertex changes as its weight grows [Cheng00].
//
// The star of p with weight w is made of the tetrahedra of its present star and of all those in conflict with it: those whose
// orthogonal sphere p has a power of less than w to, the *critical weight* of the tetrahedron. So they are absorbed one at a time, in
// ascending order of critical weight, each through a face that it shares with what p has already; between two critical weights
// nothing changes, and the middle of such an interval is as far from any tie as a weight can be.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <vector>

#include "exudation/boundary_spheres.hpp"
#include "exudation/weighted_mesh.hpp"

namespace wellmesh {

/// Bounds that new tetrahedra keep, beside the angle.
struct ExudationBounds {
    double max_radius_edge_ratio = std::numeric_limits<double>::infinity();
    struct Size {
        double max_squared_circumradius = std::numeric_limits<double>::infinity();
        double max_volume = std::numeric_limits<double>::infinity();
    };
    std::map<std::int32_t, Size> size_of_region{};  ///< regions that are not there have none
    std::function<double(const Vec3&)> max_squared_circumradius_at{};  ///< for tetrahedra by their centroids, where that varies. Empty: none
};

/// A weight and what it does to the mesh. `cosine` values are those of smallest dihedral angles: larger is worse.
struct WeightChoice {
    VertexId vertex{};
    double weight = 0;
    double cosine = 0;       ///< worst of the tetrahedra that it makes
    std::size_t absorbed = 0;  ///< how many tetrahedra, in the order of growth
    [[nodiscard]] bool found() const { return vertex.valid(); }
};

class StarGrowth {
public:
    StarGrowth(WeightedMesh& mesh, const BoundarySpheres& boundary, const std::vector<double>& reach, const ExudationBounds& bounds)
        : mesh_(mesh), boundary_(boundary), reach_(reach), bounds_(bounds) {}

    /// The best weight of p that makes `target` disappear and everything it makes better than the worst that it destroys. Not found: none is.
    [[nodiscard]] WeightChoice best_weight(VertexId p, TetId target, double target_cosine);

    /// Gives the vertex its weight if exact arithmetic confirms what rounded arithmetic found. @param created  the new star.
    /// @return false, with nothing changed, if it does not.
    bool apply(const WeightChoice& choice, std::vector<TetId>& created);

    /// Cosine of the smallest dihedral angle.
    [[nodiscard]] double cosine(TetId t) const;

private:
    struct LinkFace {
        BoundaryFace face;
        double critical = 0;  // weight at which what is outside is absorbed; infinite at a constraint
        double cosine = 0;    // of the tetrahedron that p makes with the face
        bool original = false, alive = true;
    };

    bool start(VertexId p);
    /// Absorbs the tetrahedron outside the link face of the least critical weight. @return false if that would break the mesh.
    bool absorb_next();
    bool may_absorb(TetId t, const std::vector<std::uint32_t>& faces) const;
    void add_face(TetFace inside, bool original);
    [[nodiscard]] bool is_within_bounds(TetFace link_face) const;
    [[nodiscard]] double next_critical() const;
    [[nodiscard]] std::uint32_t next_face() const;
    [[nodiscard]] bool link_has(VertexId a, VertexId b) const;
    [[nodiscard]] bool link_has(VertexId a) const;
    [[nodiscard]] double critical_weight(TetId t) const;
    [[nodiscard]] bool is_confirmed(double weight) const;

    WeightedMesh& mesh_;
    const BoundarySpheres& boundary_;
    const std::vector<double>& reach_;
    const ExudationBounds& bounds_;

    VertexId p_{};
    std::vector<TetId> star_, absorbed_;
    std::vector<LinkFace> link_;
    double destroyed_cosine_ = 0;  // worst of what is gone
    mutable std::vector<std::uint32_t> at_tet_;
};

}  // namespace wellmesh
