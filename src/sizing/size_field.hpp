// SPDX-License-Identifier: Apache-2.0
// What size tetrahedra may have: the smallest of all that is asked for at a place, growing with the distance from it by at most the gradation.
//
//   F(p) = max(smallest allowed, min(f(p), min over sources s of (h_s + g |p - s|)))
//
// Sources are vertices, segments, facets and the boundaries of regions with sizes of their own; f is what is known point by point: a callback, a
// background mesh, the local feature size. Where samples of f grow faster than g they are sources, too. F is sampled in an octree once, as finely as its own
// values are short, and looked up from there; where all that is asked for is the same all over each cell there is no octree, and a bound costs one look
// into a table.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/ids.hpp"
#include "core/vec3_math.hpp"
#include "sizing/entity_sizes.hpp"
#include "sizing/size_octree.hpp"
#include "sizing/source_tree.hpp"
#include "validation/valid_plc.hpp"
#include "wellmesh/options.hpp"

namespace wellmesh {

/// Circumradius bound for a target edge length h: with R <= this * h everywhere the mean edge length of a cube, seeded or not, is h within
/// 10 % (measured from 1k to 200k tetrahedra; tests/unit/refinement/sizing_test.cpp).
inline constexpr double kCircumradiusPerEdgeLength = 0.70;

/// Moving vertices may let circumradii exceed the bound by this factor (docs/decisions/0010).
inline constexpr double kSizeTolerance = 1.2;

/// Refinement that meets a bound v on volumes leaves circumradii of about this times the cube root of v: those of the regular tetrahedron of v are
/// (27 / (8 sqrt(3)))^(1/3) = 1.25 of it.
inline constexpr double kCircumradiusPerRootOfVolume = 1.25;

/// Bounds of one tetrahedron; infinite where nothing is asked.
struct TetSize {
    double max_squared_circumradius = std::numeric_limits<double>::infinity();
    double max_volume = std::numeric_limits<double>::infinity();
};

/// Target edge length that has the same circumradii as a bound on volumes, and the other way about.
[[nodiscard]] double edge_length_of_volume(double max_volume);
[[nodiscard]] double volume_of_edge_length(double edge_length);

/// What the field needs to know of the mesh that it is for.
struct SizeFieldDomain {
    /// Cell that holds a point; cell 0, or one that isn't filled: outside. Empty: every point is inside, in no cell with a size of its own.
    std::function<CellId(const Vec3&)> cell_at{};
    /// Asked now and then; false: the field may stay coarse. Empty: true.
    std::function<bool()> may_go_on{};
    /// The mesh will be given up at so many, so the field may stay coarse beyond what they need.
    std::optional<std::uint64_t> max_vertices{};
};

class SizeField {
public:
    /// @throws MeshError{bad_options}: an id that the input lacks, a background mesh that isn't one, a callback's answer that is no length;
    ///         MeshError{mesh_too_large}: far more vertices than a mesh can have; whatever the callback throws. Deterministic if the callback is.
    SizeField(const ValidPlc& plc, const SizeGoals& goals, const SizeFieldDomain& domain = {});

    /// Is it anything but constant in every cell?
    [[nodiscard]] bool varies() const { return octree_ != nullptr; }
    /// Is any size asked for?
    [[nodiscard]] bool asks() const { return varies() || smallest_ < std::numeric_limits<double>::infinity(); }
    /// What is asked of whole cells: all there is, unless the field varies.
    [[nodiscard]] const TetSize& of_cell(CellId c) const { return cells_[c.index()]; }

    /// Target edge length at a point of a cell; infinite where only volumes or nothing is asked.
    [[nodiscard]] double edge_length(const Vec3& p, CellId c) const { return varies() ? std::min(lengths_[c.index()], (*octree_)(p)) : lengths_[c.index()]; }
    [[nodiscard]] TetSize at(const Vec3& p, CellId c) const;
    /// Bounds of tetrahedron pqrs of this cell: those at its centroid.
    [[nodiscard]] TetSize of(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, CellId c) const {
        return varies() ? at(0.25 * ((p + q) + (r + s)), c) : cells_[c.index()];
    }
    /// Circumradius that tetrahedra around p are to have at most: the bound, or that of the volume.
    [[nodiscard]] double circumradius(const Vec3& p, CellId c) const;

    /// What is asked of a facet's or a segment's pieces themselves, where without gradation nothing around them is.
    [[nodiscard]] bool has_bare_entities() const { return !bare_facets_.empty() || !bare_segments_.empty(); }
    [[nodiscard]] double of_facet(FacetId f) const { return bare_facets_.empty() ? std::numeric_limits<double>::infinity() : bare_facets_[f.index()]; }
    [[nodiscard]] double of_segment(SegmentId s) const { return bare_segments_.empty() ? std::numeric_limits<double>::infinity() : bare_segments_[s.index()]; }

    /// The shortest edge length that is asked for anywhere in filled cells, volumes included; infinite if none is.
    [[nodiscard]] double smallest() const { return smallest_; }
    /// Vertices that refinement will make of the whole domain for its size alone.
    [[nodiscard]] double expected_vertices() const { return expected_vertices_; }
    /// Places of the domain by size: edge length and the part of the vertices that will be there. Empty unless the field varies.
    struct Share {
        double edge_length = 0, vertices = 0;
    };
    [[nodiscard]] const std::vector<Share>& shares() const { return shares_; }

private:
    void add_volumes(const ValidPlc& plc, const SizeGoals& goals);
    [[nodiscard]] double equivalent_length(std::size_t cell) const { return std::min(lengths_[cell], edge_length_of_volume(cells_[cell].max_volume)); }
    [[nodiscard]] std::vector<SizeSource> sources_of(const ValidPlc& plc, const EntitySizes& sizes) const;
    void count_constant(const ValidPlc& plc);

    std::vector<TetSize> cells_;
    std::vector<double> lengths_;  // of cells
    std::unique_ptr<const SizeOctree> octree_;
    std::vector<double> bare_facets_, bare_segments_;
    double smallest_ = std::numeric_limits<double>::infinity(), expected_vertices_ = 0;
    std::vector<Share> shares_;
};

}  // namespace wellmesh
