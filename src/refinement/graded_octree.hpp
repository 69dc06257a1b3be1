// SPDX-License-Identifier: Apache-2.0
// A balanced octree whose leaves follow a size field, and the body-centred cubic lattice on it: corners and centres of its leaves.
//
// Where leaves are equal this is the bcc lattice, which covers space with the fewest circumspheres: all its Delaunay tetrahedra are alike,
// with dihedral angles of 60 and 90 degrees and circumradius sqrt(5)/4 of the lattice constant, and it is generic, so that small changes
// far away change nothing. Leaves that share a corner differ by at most one level [LabelleShewchuk07].
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/workers.hpp"
#include "wellmesh/vec3.hpp"

namespace wellmesh {

struct LatticePoint {
    Vec3 point{};
    double spacing = 0;  ///< lattice constant at this place: side of the (smallest) leaf that it belongs to
};

/// The used leaves and their place in the lattice: the centre of leaf i is its point i.
struct LatticeLeaves {
    static constexpr std::uint32_t kNone = 0xffffffffU;
    struct Leaf {
        std::array<std::array<std::uint32_t, 2>, 3> beyond{{{kNone, kNone}, {kNone, kNone}, {kNone, kNone}}};  ///< by axis: the leaf of the same size below, above
        std::uint32_t corner = kNone;                                                                          ///< its lowest one: a point of the lattice
    };
    std::vector<Leaf> leaves;
    std::vector<std::uint32_t> of_node;  ///< by node of the tree; kNone if it is no used leaf
};

class GradedOctree {
public:
    static constexpr unsigned kMaxDepth = 20;

    struct Box {
        Vec3 lo{};
        double side = 0;
    };

    /// @param lo, side  the root cube
    GradedOctree(const Vec3& lo, double side) : lo_(lo), side_(side) { nodes_.push_back({}); }

    [[nodiscard]] std::size_t size() const { return nodes_.size(); }
    [[nodiscard]] bool is_leaf(std::uint32_t node) const { return nodes_[node].first_child == 0; }
    [[nodiscard]] unsigned depth(std::uint32_t node) const { return nodes_[node].depth; }
    [[nodiscard]] Box box(std::uint32_t node) const;
    /// Splits a leaf. @return its first child; the other seven follow. @pre depth(leaf) < kMaxDepth
    std::uint32_t split(std::uint32_t leaf);
    /// Part of a tree that is grown on its own, for a leaf of another.
    struct Branch;
    [[nodiscard]] GradedOctree branch(std::uint32_t leaf) const;
    /// The tree with branches in place of these leaves, numbered as if each node's descendants had been split off one child after the other, depth first.
    /// @pre so are the nodes of this tree and of the branches  @param branches  ascending by leaf
    [[nodiscard]] GradedOctree with(std::span<const Branch> branches) const;
    /// Only used leaves have lattice points.
    void use(std::uint32_t leaf) { nodes_[leaf].used = true; }
    /// Splits leaves until those that share a corner with a used one differ from it by at most one level.
    void balance(Workers& workers);
    /// Corners and centres of the used leaves, each once, in an order that depends on the tree alone. @param leaves  gets these leaves
    [[nodiscard]] std::vector<LatticePoint> lattice(Workers& workers, LatticeLeaves& leaves) const;
    /// Calls visit(node) for each leaf that meets the closed box from lo to hi.
    template <class Visit>
    void visit_leaves(const Vec3& lo, const Vec3& hi, Visit&& visit) const {
        visit_leaves(0, lo_, side_, lo, hi, visit);
    }
    /// Of the smallest leaf.
    [[nodiscard]] double smallest_side() const;

private:
    template <class Visit>
    void visit_leaves(std::uint32_t node, const Vec3& at, double side, const Vec3& lo, const Vec3& hi, Visit& visit) const {
        const std::uint32_t first = nodes_[node].first_child;
        if (first == 0) return visit(node);
        const double half = side / 2;
        const Vec3 middle{at.x + half, at.y + half, at.z + half};
        for (std::uint32_t k = 0; k < 8; ++k) {
            const bool x = (k & 1U) != 0, y = (k & 2U) != 0, z = (k & 4U) != 0;
            if ((x ? hi.x < middle.x : lo.x > middle.x) || (y ? hi.y < middle.y : lo.y > middle.y) || (z ? hi.z < middle.z : lo.z > middle.z)) continue;
            visit_leaves(first + k, {x ? middle.x : at.x, y ? middle.y : at.y, z ? middle.z : at.z}, half, lo, hi, visit);
        }
    }
    struct Node {
        std::array<std::uint32_t, 3> at{};  // in units of the node's own side
        std::uint32_t first_child = 0;
        std::uint8_t depth = 0;
        bool used = false;
    };
    /// @pre it is not the root
    [[nodiscard]] std::uint32_t eldest_sibling(std::uint32_t node) const {
        const std::array<std::uint32_t, 3>& at = nodes_[node].at;
        return node - ((at[0] & 1U) + 2 * (at[1] & 1U) + 4 * (at[2] & 1U));
    }
    template <class Visit>
    void visit_coarsest_beside(std::uint32_t leaf, Visit&& visit) const;
    /// Takes over what is below a node of another tree, from `next` on of the branches there.
    void take_over(std::uint32_t leaf, const GradedOctree& from, std::uint32_t node, std::span<const Branch> branches, std::size_t& next);
    /// The leaf, or the node of that depth, that holds cell `at` of the grid of this depth.
    [[nodiscard]] std::uint32_t find(unsigned depth, const std::array<std::uint32_t, 3>& at) const;

    Vec3 lo_;
    double side_;
    std::vector<Node> nodes_;
};

struct GradedOctree::Branch {
    std::uint32_t leaf;
    GradedOctree tree;
};

}  // namespace wellmesh
