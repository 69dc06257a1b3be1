// SPDX-License-Identifier: Apache-2.0
#include "refinement/lattice_filling.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

namespace wellmesh {
namespace {

constexpr std::size_t kLeafGrain = std::size_t{1} << 12;
/// Corners of a face, along the two axes after its own in cyclic order.
constexpr std::array<std::array<unsigned, 2>, 4> kAround{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

using Offset = std::array<int, 3>;

/// Corner q of the face above a leaf, from the leaf's lowest corner, in lattice constants.
constexpr Offset corner_offset(unsigned axis, unsigned q) {
    Offset out{};
    out[axis] = 1;
    out[(axis + 1) % 3] = static_cast<int>(kAround[q % 4][0]);
    out[(axis + 2) % 3] = static_cast<int>(kAround[q % 4][1]);
    return out;
}

/// Tetrahedron 4 * axis + q of a leaf has for corners the centres of the leaf and of the one above it, and corners q and q + 1 of the face between.
/// Across a face that has only one of these centres lies a tetrahedron of another face of that centre's leaf, the one that has the same edge.
struct Beyond {
    unsigned axis = 0;      // of that face
    bool is_below = false;  // the leaf's centre
    unsigned q = 0;
};
constexpr Beyond find_beyond(unsigned axis, unsigned q, bool of_upper) {
    Beyond out{(axis + (q % 2 == 0 ? 2 : 1)) % 3, q == 0 || q == 3, 4};
    // From the lowest corner of the leaf whose centre it is.
    const auto edge = [](unsigned along, unsigned k, int down) {
        std::array<Offset, 2> ends{corner_offset(along, k), corner_offset(along, k + 1)};
        for (Offset& o : ends) o[along] -= down;
        return ends;
    };
    const auto mine = edge(axis, q, of_upper ? 1 : 0);
    for (unsigned k = 0; k < 4; ++k) {
        const auto its = edge(out.axis, k, out.is_below ? 1 : 0);
        if ((its[0] == mine[0] && its[1] == mine[1]) || (its[0] == mine[1] && its[1] == mine[0])) out.q = k;
    }
    return out;
}
/// By tetrahedron, and whether it is the upper centre's leaf.
constexpr std::array<std::array<Beyond, 2>, 12> kBeyond = [] {
    std::array<std::array<Beyond, 2>, 12> out{};
    for (unsigned t = 0; t < 12; ++t) out[t] = {find_beyond(t / 4, t % 4, false), find_beyond(t / 4, t % 4, true)};
    return out;
}();
static_assert(std::all_of(kBeyond.begin(), kBeyond.end(), [](const auto& both) { return both[0].q < 4 && both[1].q < 4; }));

}  // namespace

LatticeFilling::LatticeFilling(const GradedOctree& tree, const LatticeLeaves& leaves, std::span<const Box> occupied, Workers& workers)
    : leaves_(leaves), workers_(workers) {
    const std::size_t count = leaves.leaves.size();
    std::vector<char> here(count, 0), wider(count, 0);
    workers.for_ranges(occupied.size(), kLeafGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t i = begin; i < end; ++i)
            tree.visit_leaves(occupied[i].low, occupied[i].high, [&](std::uint32_t node) {
                if (const std::uint32_t leaf = leaves.of_node[node]; leaf != kNone) std::atomic_ref(here[leaf]).store(1, std::memory_order_relaxed);
            });
    });
    for (unsigned axis = 0; axis < 3; ++axis) {
        workers.for_ranges(count, kLeafGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i) {
                const auto& [below, above] = leaves.leaves[i].beyond[axis];
                wider[i] = here[i] != 0 || below == kNone || above == kNone || here[below] != 0 || here[above] != 0;
            }
        });
        here.swap(wider);
    }
    is_regular_ = std::move(here);
    for (char& c : is_regular_) c = c == 0;
}

std::uint32_t LatticeFilling::leaf_at_corner(std::uint32_t above, unsigned axis, unsigned q) const {
    std::uint32_t leaf = above;
    for (unsigned k = 0; k < 2; ++k)
        if (kAround[q % 4][k] != 0) leaf = beyond(leaf, (axis + 1 + k) % 3, 1);
    return leaf;
}

/// Is everything regular around the lowest corner of this leaf?
bool LatticeFilling::has_known_corner(std::uint32_t leaf) const {
    for (unsigned k = 0; k < 8; ++k) {
        std::uint32_t at = leaf;
        for (unsigned axis = 0; axis < 3; ++axis)
            if ((k >> axis & 1U) != 0) at = beyond(at, axis, 0);
        if (at == kNone || !is_regular(at)) return false;
    }
    return true;
}

std::vector<char> LatticeFilling::far_points(std::size_t points) const {
    std::vector<char> out(points, 0);
    workers_.for_ranges(leaves_.leaves.size(), kLeafGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
            if (!is_regular(i)) continue;
            out[i] = 1;
            if (has_known_corner(i)) out[leaves_.leaves[i].corner] = 1;
        }
    });
    return out;
}

/// @pre is_regular(leaf)
template <class Visit>
void LatticeFilling::visit_neighbours_of_centre(std::uint32_t leaf, Visit&& visit) const {
    for (unsigned axis = 0; axis < 3; ++axis)
        for (const std::uint32_t other : leaves_.leaves[leaf].beyond[axis]) visit(other);
    for (unsigned k = 0; k < 8; ++k) {
        std::uint32_t at = leaf;
        for (unsigned axis = 0; axis < 3; ++axis)
            if ((k >> axis & 1U) != 0) at = beyond(at, axis, 1);
        visit(leaves_.leaves[at].corner);
    }
}

/// @pre has_known_corner(leaf)
template <class Visit>
void LatticeFilling::visit_neighbours_of_corner(std::uint32_t leaf, Visit&& visit) const {
    for (unsigned axis = 0; axis < 3; ++axis)
        for (const std::uint32_t other : leaves_.leaves[leaf].beyond[axis]) visit(leaves_.leaves[other].corner);
    for (unsigned k = 0; k < 8; ++k) {
        std::uint32_t at = leaf;
        for (unsigned axis = 0; axis < 3; ++axis)
            if ((k >> axis & 1U) != 0) at = beyond(at, axis, 0);
        visit(at);
    }
}

std::vector<std::uint32_t> LatticeFilling::short_of_neighbours(const std::vector<char>& is_known, const std::vector<char>& is_there) const {
    const std::size_t count = leaves_.leaves.size();
    std::vector<std::vector<std::uint32_t>> found((count + kLeafGrain - 1) / kLeafGrain);
    workers_.for_ranges(count, kLeafGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
            const std::uint32_t corner = leaves_.leaves[i].corner;
            bool complete = true;
            const auto look_at = [&](std::uint32_t point) { complete = complete && is_there[point] != 0; };
            if (is_known[i] != 0) visit_neighbours_of_centre(i, look_at);
            if (!std::exchange(complete, true)) found[piece].push_back(i);
            if (is_known[corner] != 0) visit_neighbours_of_corner(i, look_at);
            if (!complete) found[piece].push_back(corner);
        }
    });
    std::vector<std::uint32_t> out;
    for (const auto& piece : found) out.insert(out.end(), piece.begin(), piece.end());
    return out;
}

std::uint16_t LatticeFilling::mask_of(std::uint32_t leaf, const std::vector<char>& is_known) const {
    unsigned mask = 0;
    for (unsigned axis = 0; axis < 3; ++axis) {
        const std::uint32_t above = beyond(leaf, axis, 1);
        if (above == kNone || !(is_regular(leaf) || is_regular(above))) continue;
        if (is_known[leaf] != 0 || is_known[above] != 0) {
            mask |= 15U << (4 * axis);
            continue;
        }
        for (unsigned q = 0; q < 4; ++q)  // of tetrahedra q and q - 1
            if (is_known[point_at_corner(above, axis, q)] != 0) mask |= (1U << q | 1U << (q + 3) % 4) << (4 * axis);
    }
    return static_cast<std::uint16_t>(mask);
}

/// Of the leaves that tetrahedra around a leaf belong to: numbers of their first ones, and which ones are known.
class LatticeFilling::Around {
public:
    Around(const LatticeFilling& filling, std::uint32_t leaf) {
        at_[0][3] = read(filling, leaf);
        for (unsigned d = 0; d < 3; ++d) at_[0][d] = read(filling, filling.beyond(leaf, d, 0));
        for (unsigned axis = 0; axis < 3; ++axis) {
            const std::uint32_t above = filling.beyond(leaf, axis, 1);
            at_[axis + 1][3] = read(filling, above);
            for (unsigned d = 0; d < 3; ++d)
                if (d != axis) at_[axis + 1][d] = read(filling, filling.beyond(above, d, 0));
        }
    }
    /// Across face f of a known tetrahedron: 4 * number + face, or kNone.
    [[nodiscard]] std::uint32_t across(unsigned tet, unsigned face) const {
        if (face >= 2)  // about the line through both centres
            return number(at_[0][3], (tet & ~3U) | ((tet + (face == 2 ? 1 : 3)) & 3U), 5 - face);
        const Beyond& b = kBeyond[tet][1 - face];
        return number(at_[face == 0 ? tet / 4 + 1 : 0][b.is_below ? b.axis : 3], 4 * b.axis + b.q, b.is_below ? 0 : 1);
    }

private:
    struct Known {
        std::uint32_t first = 0, mask = 0;
    };
    static Known read(const LatticeFilling& filling, std::uint32_t leaf) {
        return leaf == kNone ? Known{} : Known{filling.first_[leaf], filling.mask_[leaf]};
    }
    static std::uint32_t number(const Known& of, unsigned tet, unsigned face) {
        if ((of.mask >> tet & 1U) == 0) return kNone;
        return 4 * (of.first + static_cast<std::uint32_t>(std::popcount(of.mask & ((1U << tet) - 1U)))) + face;
    }
    std::array<std::array<Known, 4>, 4> at_{};  // the leaf and those above it by axis; each with those below it by axis, then itself
};

TetStore::Corners LatticeFilling::corners(std::uint32_t leaf, unsigned tet) const {
    const unsigned axis = tet / 4;
    const std::uint32_t above = beyond(leaf, axis, 1);
    return {vertex_of_[leaf], vertex_of_[above], vertex_of_[point_at_corner(above, axis, tet)], vertex_of_[point_at_corner(above, axis, tet + 1)]};
}

/// Leaves that have known tetrahedra, on whichever side, and are neighbours.
void LatticeFilling::find_groups() {
    const std::size_t count = leaves_.leaves.size();
    constexpr std::uint32_t kWaits = kNone - 1;
    group_.assign(count, kNone);
    for (std::uint32_t i = 0; i < count; ++i)
        for (unsigned axis = 0; axis < 3; ++axis)
            if ((mask_[i] >> (4 * axis) & 15U) != 0) group_[i] = group_[beyond(i, axis, 1)] = kWaits;
    std::uint32_t groups = 0;
    std::vector<std::uint32_t> stack;
    for (std::uint32_t i = 0; i < count; ++i) {
        if (group_[i] != kWaits) continue;
        const std::uint32_t group = groups++;
        group_[i] = group;
        for (stack.push_back(i); !stack.empty();) {
            const std::uint32_t at = stack.back();
            stack.pop_back();
            for (unsigned k = 0; k < 6; ++k)
                if (const std::uint32_t next = beyond(at, k / 2, k % 2); next != kNone && group_[next] == kWaits) {
                    group_[next] = group;
                    stack.push_back(next);
                }
        }
    }
}

void LatticeFilling::know(const std::vector<char>& is_known, std::span<const VertexId> vertex_of, std::size_t vertices) {
    const std::size_t count = leaves_.leaves.size();
    vertex_of_ = vertex_of;
    mask_.resize(count);
    workers_.for_ranges(count, kLeafGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) mask_[i] = mask_of(i, is_known);
    });
    first_.resize(count + 1);
    first_[0] = 0;
    for (std::size_t i = 0; i < count; ++i) first_[i + 1] = first_[i] + static_cast<std::uint32_t>(std::popcount(mask_[i]));
    find_groups();
    has_vertex_.assign(vertices, 0);
    first_rim_.assign(count + 1, 0);
    std::vector<std::vector<RimFace>> found(pieces());
    workers_.for_ranges(count, kLeavesAPiece, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
            mark_vertices(i, is_known);
            // Stars about the lower and the upper centre have all that is across.
            const auto star_is_known = [&](std::uint32_t leaf) { return leaf != kNone && is_known[leaf] != 0; };
            if (mask_[i] == 0) continue;
            if (star_is_known(i) && star_is_known(beyond(i, 0, 1)) && star_is_known(beyond(i, 1, 1)) && star_is_known(beyond(i, 2, 1))) continue;
            std::uint32_t number = first_[i];
            const Around around(*this, i);
            for (unsigned t = 0; t < kTets; ++t) {
                if ((mask_[i] >> t & 1U) == 0) continue;
                const TetStore::Corners c = corners(i, t);
                for (unsigned f = 0; f < 4; ++f) {
                    if (around.across(t, f) != kNone) continue;
                    const auto& k = kFaceCorners[f];
                    found[piece].push_back({{c[k[0]], c[k[1]], c[k[2]]}, 4 * number + f, group_[i]});
                    ++first_rim_[i + 1];
                }
                ++number;
            }
        }
    });
    for (std::size_t i = 0; i < count; ++i) first_rim_[i + 1] += first_rim_[i];
    rim_.clear();
    for (const auto& piece : found) rim_.insert(rim_.end(), piece.begin(), piece.end());
}

/// Of a leaf's centre and lowest corner: whatever has a known star, and its neighbours.
void LatticeFilling::mark_vertices(std::uint32_t leaf, const std::vector<char>& is_known) {
    const std::uint32_t corner = leaves_.leaves[leaf].corner;
    // Neighbours of each other.
    bool has_centre = is_known[leaf] != 0 || is_known[corner] != 0, has_corner = has_centre;
    const auto look_at = [&](std::uint32_t point, bool& has) { has = has || (point != kNone && is_known[point] != 0); };
    if (!has_centre) {
        const auto corner_of = [&](std::uint32_t at) { return at == kNone ? kNone : leaves_.leaves[at].corner; };
        for (unsigned axis = 0; axis < 3; ++axis)
            for (unsigned above = 0; above < 2; ++above) {
                look_at(beyond(leaf, axis, above), has_centre);
                look_at(corner_of(beyond(leaf, axis, above)), has_corner);
            }
        for (unsigned k = 1; k < 8; ++k) {
            std::uint32_t up = leaf, down = leaf;
            for (unsigned axis = 0; axis < 3; ++axis)
                if ((k >> axis & 1U) != 0) {
                    up = beyond(up, axis, 1);
                    down = beyond(down, axis, 0);
                }
            look_at(corner_of(up), has_centre);
            look_at(down, has_corner);
        }
    }
    if (has_centre) has_vertex_[vertex_of_[leaf].index()] = 1;
    if (has_corner) has_vertex_[vertex_of_[corner].index()] = 1;
}

std::size_t LatticeFilling::first(std::size_t piece) const { return first_[std::min(piece * kLeavesAPiece, leaves_.leaves.size())]; }

void LatticeFilling::list(std::size_t piece, std::vector<Tet>& tets) const {
    tets.clear();
    tets.reserve(first(piece + 1) - first(piece));
    for (auto i = static_cast<std::uint32_t>(piece * kLeavesAPiece); i < std::min((piece + 1) * kLeavesAPiece, leaves_.leaves.size()); ++i) {
        if (mask_[i] == 0) continue;
        std::uint32_t rim = first_rim_[i];
        const Around around(*this, i);
        for (unsigned t = 0; t < kTets; ++t) {
            if ((mask_[i] >> t & 1U) == 0) continue;
            Tet& tet = tets.emplace_back();
            tet.corners = corners(i, t);
            tet.group = group_[i];
            // The first one of a leaf is home to its centre, and to the lowest corner of the leaf above.
            if (t == 0) tet.homes = 1U << 0 | 1U << 2;
            for (unsigned f = 0; f < 4; ++f) {
                const std::uint32_t other = around.across(t, f);
                tet.across[f] = other != kNone ? other : kRimBit | rim++;
            }
        }
    }
}

}  // namespace wellmesh
