// SPDX-License-Identifier: Apache-2.0
// Fills the inside of the domain with a body-centred cubic lattice before refinement: the lattice needs the fewest vertices for a bound on
// circumradii (0.349 volumes / R^3; refinement alone takes about twice as many), and its tetrahedra have dihedral angles of 60 degrees, so only
// the layer between lattice and boundary is left to refine. The theorems of refinement hold for any almost good mesh to start from.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "conforming/boundary_refiner.hpp"
#include "conforming/conforming_mesh.hpp"
#include "conforming/savepoint.hpp"
#include "core/run_guard.hpp"
#include "core/workers.hpp"
#include "refinement/boundary_sample.hpp"
#include "refinement/graded_octree.hpp"
#include "sizing/size_field.hpp"
#include "validation/box_tree.hpp"

namespace wellmesh {

class LatticeFilling;

/// Circumradius of the tetrahedra of the bcc lattice, over the lattice constant.
inline const double kLatticeCircumradius = std::sqrt(5.0) / 4;
/// The lattice's circumradii over the bound: at 1 the jitter makes every second one too large, and below 0.95 vertices are wasted (docs/decisions/0011).
inline constexpr double kLatticeScale = 0.95;

class LatticeSeeder {
public:
    /// @param sizes  must outlive this; where nothing is asked it stays empty, and so it does where a field varies and no lattice of the octree's would be
    ///               about as large as it may.
    LatticeSeeder(ConformingMesh& mesh, BoundaryRefiner& boundary, RunGuard& guard, const SizeField& sizes, Workers& workers);

    /// Splits subsegments and subfaces that no tetrahedron within its bound could have, then inserts the lattice's vertices, except those
    /// that lie close to the boundary or encroach upon it. The mesh conforms afterwards. @throws as BoundaryRefiner::conform does.
    /// Ends early, the mesh conforming, when the guard says so. The ids of tetrahedra are new afterwards. @return vertices inserted from the lattice
    std::uint64_t seed();
    /// Those of them that went in with tetrahedra that were known (lattice_filling.hpp).
    [[nodiscard]] std::uint64_t known() const { return known_; }
    /// Did boundary and lattice go in together, and not from coarse to fine? (docs/decisions/0035)
    [[nodiscard]] bool went_at_once() const { return went_at_once_; }

private:
    /// For a view of a zone: splits its boundary.
    LatticeSeeder(ConformingMesh& view, BoundaryRefiner& boundary, const LatticeSeeder& whole);

    /// A subface beside a cell that is to be seeded.
    struct Face {
        std::array<VertexId, 3> corners{};
        double spacing = 0;  ///< of that cell, at its middle
    };

    enum class Outcome : std::uint8_t { inserted, encroaches, refused };

    /// Down to `coarseness` times the bound. @return false if the guard said stop; with no more vertices than allowed, the mesh conforming.
    bool split_boundary(double coarseness);
    bool split_down_to(double coarseness);
    void keep_last();
    /// Most of the same, on all workers. @return false if the guard said stop.
    bool split_boundary_in_zones(double coarseness);
    void split_in_zone(double coarseness, std::vector<TetId> waiting, const std::function<bool(std::size_t)>& may_go_on);
    class Listening;
    void list_too_large(std::vector<TetId> of, double coarseness, std::vector<TetId>& which, std::vector<Subsegment>& segments, std::vector<Subface>& faces) const;
    void list_all_too_large(double coarseness, std::vector<TetId>& which, std::vector<Subsegment>& segments, std::vector<Subface>& faces) const;
    bool list_too_large(TetId t, double coarseness, std::vector<Subsegment>& segments, std::vector<Subface>& faces) const;
    [[nodiscard]] bool may_go_on(std::uint64_t waiting) { return guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), waiting) == RunGuard::Verdict::go_on; }
    /// Where its points would be, and those themselves.
    struct Lattice {
        std::optional<GradedOctree> tree;
        LatticeLeaves leaves;
        std::vector<LatticePoint> points;
    };
    [[nodiscard]] std::optional<Lattice> find_lattice(double base, std::vector<Face> faces);
    /// A point of the lattice that waits, moved by its jitter.
    struct Seed {
        Vec3 point{};
        VertexId vertex{};              ///< once it has been one, inserted or not
        std::uint32_t number : 31 = 0;  ///< of the lattice's points
        std::uint32_t waits : 1 = 1;
    };
    static_assert(sizeof(Seed) == 32);
    /// How a seed goes in: alone (0), in bulk (1), or in bulk unless its tetrahedra turn out to be known.
    static constexpr char kKnown = 2;
    using Welcomes = std::function<bool(const Vec3&, CellId)>;
    using GoesOn = std::function<bool()>;
    [[nodiscard]] std::vector<Seed> seeds_of(const std::vector<LatticePoint>& lattice);
    bool insert_seeds(std::span<Seed> seeds, Lattice* lattice);
    [[nodiscard]] bool may_seed_at_once() const;
    bool seed_at_once(double base);
    bool make_whole(std::size_t points);
    [[nodiscard]] double vertices_at_acute_segments() const;
    void shrink_balls();
    void number_points(BoundarySample& sample);
    void insert_at_once(const BoundarySample& sample, std::span<Seed> seeds, const std::vector<char>& which, std::span<const CellId> cells);
    /// What seeds keep away from.
    struct Boundary {
        struct Sphere {
            Vec3 centre{};
            double squared_radius = 0;
        };
        std::vector<Face> faces;
        std::span<const Subsegment> pieces;
        std::vector<Box> boxes;       ///< of the faces, then vertices, or pieces of segments
        std::vector<Sphere> spheres;  ///< what encroaches upon each is in it; none: that is found out later
        BoxTree tree;
        std::vector<Box> balls;  ///< about acute vertices
        double widest = 0;       ///< no seed keeps farther away; infinite where that is not known beforehand
    };
    [[nodiscard]] Boundary find_boundary(std::vector<Face> faces, std::span<const Subsegment> pieces = {});
    void find_filling(Lattice& lattice, const Boundary& boundary, std::span<const Seed> seeds, std::vector<char>& in_bulk, std::optional<LatticeFilling>& filling,
                      const BoundarySample* sample = nullptr);
    bool insert_left(std::span<Seed> seeds, const std::vector<char>& in_bulk);
    [[nodiscard]] std::vector<Face> faces_of(const BoundarySample& sample) const;
    [[nodiscard]] std::vector<Box> occupied(const Boundary& boundary, double least_spacing, const BoundarySample* sample) const;
    [[nodiscard]] Box space_of(VertexId a, VertexId b, VertexId c, double least_spacing) const;
    [[nodiscard]] std::vector<char> find_clear(const Boundary& boundary, std::span<Seed> seeds, std::vector<CellId>* cells = nullptr);
    void find_clear_of(const Boundary& boundary, std::span<Seed> block, std::span<CellId> cells, TetId& near, std::vector<std::uint32_t>& candidates) const;
    bool insert_in_bulk(std::span<Seed> seeds, const std::vector<char>& which);
    template <class InsertAll>
    bool insert_in_bulk(std::span<Seed> seeds, std::span<const std::uint32_t> numbers, InsertAll&& insert_all);
    bool fill(std::span<Seed> seeds, const std::vector<char>& in_bulk, LatticeFilling&& known);
    Outcome insert(const Vec3& p, TetId& near, VertexId& vertex);
    [[nodiscard]] double radius_at(const Vec3& p, CellId c) const;
    [[nodiscard]] double boundary_radius_at(const Vec3& p, CellId c) const;
    [[nodiscard]] double spacing_at(const Vec3& p, CellId c) const;
    [[nodiscard]] double radius_bound(TetId t, const Vec3& p) const;
    [[nodiscard]] double most_used_spacing() const;
    class OctreeBuilder;
    [[nodiscard]] std::vector<Face> list_faces() const;
    [[nodiscard]] std::vector<Box> boxes_of(const std::vector<Face>& faces) const;
    [[nodiscard]] bool is_clear(const Vec3& p, double distance) const;

    ConformingMesh& mesh_;
    BoundaryRefiner& boundary_;
    RunGuard& guard_;
    const SizeField& sizes_;
    Workers& workers_;
    std::uint64_t inserted_ = 0, known_ = 0;
    bool went_at_once_ = false;
    std::vector<double> radius_;   // by cell: circumradius bound that is the same all over it; infinite: none
    std::vector<double> spacing_;  // by cell: lattice constant of that
    std::vector<double> boundary_radius_;  // by cell: the same, also where there is no lattice
    std::vector<char> is_thin_;     // by cell: no lattice in it
    std::vector<char> is_sampled_;  // by cell: its boundary is to be as fine as its size wants it
    bool tets_are_numbered_ = false;  // by what does not depend on threads
    std::optional<Savepoint> last_;    // of splitting the boundary
    std::uint64_t left_at_last_ = 0;  // vertices
    Cavity cavity_;
    std::vector<Subsegment> encroached_segments_;
    std::vector<Subface> encroached_faces_;
};

}  // namespace wellmesh
