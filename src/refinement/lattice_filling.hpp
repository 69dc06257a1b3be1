// SPDX-License-Identifier: Apache-2.0
// The lattice's own tetrahedra, where they are known without a search.
//
// The Delaunay triangulation of the bcc lattice is generic: all its tetrahedra are alike, and the next point is far outside of each circumsphere, in
// which jitter of a small part of the lattice constant changes nothing. So around a point of the lattice whose neighbourhood has all of the lattice and
// nothing else, the tetrahedra of the mesh are those of the lattice, two corners of a leaf's face and the centres on both sides of it. Points that have
// such stars need not be inserted: what the others make has all tetrahedra that have no such corner, and the rest is put in their place (KnownTets).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/workers.hpp"
#include "delaunay/known_tets.hpp"
#include "refinement/graded_octree.hpp"
#include "validation/box_tree.hpp"

namespace wellmesh {

class LatticeFilling : public KnownTets {
public:
    /// @param leaves    of the tree's lattice; must outlive this
    /// @param occupied  boxes around all else that there is: there are no known stars in leaves that meet one, nor all around these
    LatticeFilling(const GradedOctree& tree, const LatticeLeaves& leaves, std::span<const Box> occupied, Workers& workers);

    [[nodiscard]] bool is_regular(std::uint32_t leaf) const { return is_regular_[leaf] != 0; }
    /// By point of the lattice: may its star be known? If all of its neighbours are there.
    [[nodiscard]] std::vector<char> far_points(std::size_t points) const;
    /// Points of these for which a neighbour is not there. @param is_known, is_there  by point of the lattice
    [[nodiscard]] std::vector<std::uint32_t> short_of_neighbours(const std::vector<char>& is_known, const std::vector<char>& is_there) const;
    /// The stars of these points are the known tetrahedra from now on. @param vertex_of  by point of the lattice; must outlive this
    void know(const std::vector<char>& is_known, std::span<const VertexId> vertex_of, std::size_t vertices);

    [[nodiscard]] std::size_t count() const override { return first_.empty() ? 0 : first_.back(); }
    [[nodiscard]] std::size_t pieces() const override { return (leaves_.leaves.size() + kLeavesAPiece - 1) / kLeavesAPiece; }
    [[nodiscard]] std::size_t first(std::size_t piece) const override;
    void list(std::size_t piece, std::vector<Tet>& tets) const override;
    [[nodiscard]] std::span<const RimFace> rim() const override { return rim_; }
    [[nodiscard]] std::span<const char> has_vertex() const override { return has_vertex_; }

private:
    static constexpr std::uint32_t kNone = LatticeLeaves::kNone;
    static constexpr std::size_t kLeavesAPiece = 256;
    static constexpr unsigned kTets = 12;  ///< of a leaf: four on each face shared with a leaf above

    [[nodiscard]] std::uint32_t beyond(std::uint32_t leaf, unsigned axis, unsigned above) const {
        return leaf == kNone ? kNone : leaves_.leaves[leaf].beyond[axis][above];
    }
    /// The leaf whose lowest corner is corner q of the face between a leaf and the one above it.
    [[nodiscard]] std::uint32_t leaf_at_corner(std::uint32_t above, unsigned axis, unsigned q) const;
    [[nodiscard]] std::uint32_t point_at_corner(std::uint32_t above, unsigned axis, unsigned q) const {
        const std::uint32_t leaf = leaf_at_corner(above, axis, q);
        return leaf == kNone ? kNone : leaves_.leaves[leaf].corner;
    }
    template <class Visit>
    void visit_neighbours_of_centre(std::uint32_t leaf, Visit&& visit) const;
    template <class Visit>
    void visit_neighbours_of_corner(std::uint32_t leaf, Visit&& visit) const;
    [[nodiscard]] bool has_known_corner(std::uint32_t leaf) const;
    [[nodiscard]] std::uint16_t mask_of(std::uint32_t leaf, const std::vector<char>& is_known) const;
    class Around;
    [[nodiscard]] TetStore::Corners corners(std::uint32_t leaf, unsigned tet) const;
    void find_groups();
    void mark_vertices(std::uint32_t leaf, const std::vector<char>& is_known);

    const LatticeLeaves& leaves_;
    Workers& workers_;
    std::vector<char> is_regular_;          // by leaf: it and all leaves around it are of one size, and nothing else is in them
    std::vector<std::uint16_t> mask_;       // by leaf: which of its tetrahedra are known
    std::vector<std::uint32_t> first_;      // by leaf: number of its first one; and of all
    std::vector<std::uint32_t> first_rim_;  // by leaf: of its faces
    std::vector<std::uint32_t> group_;      // by leaf
    std::vector<RimFace> rim_;
    std::vector<char> has_vertex_;
    std::span<const VertexId> vertex_of_;
};

}  // namespace wellmesh
