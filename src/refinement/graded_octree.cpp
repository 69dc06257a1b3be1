// SPDX-License-Identifier: Apache-2.0
#include "refinement/graded_octree.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "core/huge_pages.hpp"
#include "core/sorting.hpp"

namespace wellmesh {

GradedOctree::Box GradedOctree::box(std::uint32_t node) const {
    const Node& n = nodes_[node];
    const double side = std::ldexp(side_, -static_cast<int>(n.depth));
    return {{lo_.x + n.at[0] * side, lo_.y + n.at[1] * side, lo_.z + n.at[2] * side}, side};
}

std::uint32_t GradedOctree::split(std::uint32_t leaf) {
    const auto first = static_cast<std::uint32_t>(nodes_.size());
    for (std::uint32_t k = 0; k < 8; ++k) {
        const Node& parent = nodes_[leaf];
        Node child;
        child.at = {2 * parent.at[0] + (k & 1U), 2 * parent.at[1] + ((k >> 1) & 1U), 2 * parent.at[2] + (k >> 2)};
        child.depth = static_cast<std::uint8_t>(parent.depth + 1);
        child.used = parent.used;
        nodes_.push_back(child);
    }
    nodes_[leaf].first_child = first;
    return first;
}

GradedOctree GradedOctree::branch(std::uint32_t leaf) const {
    GradedOctree out(lo_, side_);
    out.nodes_[0] = nodes_[leaf];
    return out;
}

GradedOctree GradedOctree::with(std::span<const Branch> branches) const {
    GradedOctree out(lo_, side_);
    std::size_t size = nodes_.size(), next = 0;
    for (const Branch& b : branches) size += b.tree.size() - 1;
    out.nodes_.reserve(size);
    out.take_over(0, *this, 0, branches, next);
    return out;
}

void GradedOctree::take_over(std::uint32_t leaf, const GradedOctree& from, std::uint32_t node, std::span<const Branch> branches, std::size_t& next) {
    if (next < branches.size() && branches[next].leaf == node) {
        const std::vector<Node>& grown = branches[next++].tree.nodes_;
        const auto ahead = static_cast<std::uint32_t>(nodes_.size()) - 1;
        const auto moved = [&](Node n) {
            if (n.first_child != 0) n.first_child += ahead;
            return n;
        };
        nodes_[leaf] = moved(grown[0]);
        std::transform(grown.begin() + 1, grown.end(), std::back_inserter(nodes_), moved);
        return;
    }
    nodes_[leaf] = from.nodes_[node];
    if (from.is_leaf(node)) return;
    const std::uint32_t first = split(leaf);
    for (std::uint32_t k = 0; k < 8; ++k) take_over(first + k, from, from.nodes_[node].first_child + k, branches, next);
}

std::uint32_t GradedOctree::find(unsigned depth, const std::array<std::uint32_t, 3>& at) const {
    std::uint32_t node = 0;
    while (nodes_[node].first_child != 0 && nodes_[node].depth < depth) {
        const unsigned shift = depth - nodes_[node].depth - 1;
        node = nodes_[node].first_child + ((at[0] >> shift) & 1U) + 2 * ((at[1] >> shift) & 1U) + 4 * ((at[2] >> shift) & 1U);
    }
    return node;
}

/// Calls visit(depth, at) for the cells that must be split down to the size of the leaf's parent: those around it where they touch a used leaf of the eight siblings.
/// The first such one of them asks for all.
template <class Visit>
void GradedOctree::visit_coarsest_beside(std::uint32_t leaf, Visit&& visit) const {
    const Node node = nodes_[leaf];
    if (node.first_child != 0 || node.depth < 2) return;
    const std::uint32_t eldest = eldest_sibling(leaf);
    std::array<bool, 27> is_touched{};
    for (std::uint32_t s = 0; s < 8; ++s) {
        if (!nodes_[eldest + s].used || !is_leaf(eldest + s)) continue;
        if (eldest + s < leaf) return;
        const std::uint32_t x = s & 1U, y = (s >> 1) & 1U, z = s >> 2;
        for (std::uint32_t c = 0; c < 8; ++c) is_touched[x + (c & 1U) + 3 * (y + ((c >> 1) & 1U)) + 9 * (z + (c >> 2))] = true;
    }
    const unsigned depth = node.depth - 1U;
    const std::uint32_t cells = 1U << depth;
    for (std::uint32_t k = 0; k < 27; ++k) {
        if (!is_touched[k]) continue;
        // Unsigned wrap-around makes cells outside the root too large.
        const std::array<std::uint32_t, 3> at{node.at[0] / 2 + k % 3 - 1, node.at[1] / 2 + k / 3 % 3 - 1, node.at[2] / 2 + k / 9 - 1};
        if (at[0] < cells && at[1] < cells && at[2] < cells) visit(depth, at);
    }
}

void GradedOctree::balance(Workers& workers) {
    constexpr std::size_t kGrain = std::size_t{1} << 13;
    using At = std::array<std::uint32_t, 3>;
    // Most leaves have nothing coarser beside them, and never will.
    std::vector<std::vector<std::uint32_t>> asking((nodes_.size() + kGrain - 1) / kGrain);
    workers.for_ranges(nodes_.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
            if (!is_leaf(i) || !nodes_[i].used) continue;
            bool asks = false;
            visit_coarsest_beside(i, [&](unsigned depth, const At& at) { asks = asks || nodes_[find(depth, at)].depth < depth; });
            if (asks) asking[piece].push_back(i);
        }
    });
    std::vector<std::uint32_t> waiting;
    for (const std::vector<std::uint32_t>& piece : asking) waiting.insert(waiting.end(), piece.begin(), piece.end());
    while (!waiting.empty()) {
        const std::uint32_t leaf = waiting.back();
        waiting.pop_back();
        visit_coarsest_beside(leaf, [&](unsigned depth, const At& at) {
            for (std::uint32_t neighbour = find(depth, at); nodes_[neighbour].depth < depth; neighbour = find(depth, at)) {
                const std::uint32_t first = split(neighbour), eldest = eldest_sibling(neighbour);
                if (!nodes_[neighbour].used) continue;
                for (std::uint32_t c = 0; c < 8; ++c) {
                    waiting.push_back(first + c);
                    if (eldest + c != neighbour) waiting.push_back(eldest + c);  // it may have left it to this one to ask
                }
            }
        });
    }
}

double GradedOctree::smallest_side() const {
    unsigned deepest = 0;
    for (const Node& n : nodes_) deepest = std::max<unsigned>(deepest, n.depth);
    return std::ldexp(side_, -static_cast<int>(deepest));
}

std::vector<LatticePoint> GradedOctree::lattice(Workers& workers, LatticeLeaves& out) const {
    // Corners as cells of the grid of the greatest depth, so that those of different leaves are told to be the same exactly.
    constexpr unsigned kBits = kMaxDepth + 1;
    constexpr std::size_t kGrain = std::size_t{1} << 14;
    static_assert(3 * kBits <= 64);
    constexpr std::uint32_t kNone = LatticeLeaves::kNone;
    struct Corner {
        std::uint64_t at = 0;  // three coordinates, the first one in front
        std::uint32_t depth = 0;
        std::uint32_t lowest_of = kNone;  // leaf
    };
    struct Piece {
        std::vector<std::uint32_t> nodes;
        std::vector<Corner> corners;
        std::size_t first_leaf = 0, first_corner = 0;
    };
    std::vector<Piece> pieces((nodes_.size() + kGrain - 1) / kGrain);
    workers.for_ranges(nodes_.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t which) {
        for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i)
            if (is_leaf(i) && nodes_[i].used) pieces[which].nodes.push_back(i);
    });
    std::size_t count = 0, listed = 0;
    for (Piece& p : pieces) p.first_leaf = std::exchange(count, count + p.nodes.size());
    out.leaves.assign(count, {});
    out.of_node.assign(nodes_.size(), kNone);
    workers.for_each(pieces.size(), [&](std::size_t which) {
        for (std::size_t k = 0; k < pieces[which].nodes.size(); ++k) out.of_node[pieces[which].nodes[k]] = static_cast<std::uint32_t>(pieces[which].first_leaf + k);
    });
    workers.for_each(pieces.size(), [&](std::size_t which) {
        for (std::size_t k = 0; k < pieces[which].nodes.size(); ++k) {
            const std::uint32_t node = pieces[which].nodes[k];
            const Node& n = nodes_[node];
            for (unsigned axis = 0; axis < 3; ++axis) {
                std::array<std::uint32_t, 3> at = n.at;
                if (++at[axis] >= (1U << n.depth)) continue;
                const std::uint32_t above = (n.at[axis] & 1U) == 0 ? node + (1U << axis) : find(n.depth, at);  // a sibling, for one of two
                const std::uint32_t leaf = out.of_node[above];
                if (leaf == kNone || nodes_[above].depth != n.depth) continue;
                const auto here = static_cast<std::uint32_t>(pieces[which].first_leaf + k);
                out.leaves[here].beyond[axis][1] = leaf;
                out.leaves[leaf].beyond[axis][0] = here;
            }
        }
    });
    workers.for_each(pieces.size(), [&](std::size_t which) {
        Piece& piece = pieces[which];
        for (std::size_t i = 0; i < piece.nodes.size(); ++i) {
            const Node& n = nodes_[piece.nodes[i]];
            const unsigned shift = kMaxDepth - n.depth;
            for (std::uint32_t k = 0; k < 8; ++k) {
                // It is the lowest corner of the leaf beyond, if that is one of the same size: so most corners are listed once.
                auto leaf = static_cast<std::uint32_t>(piece.first_leaf + i);
                for (unsigned axis = 0; axis < 3 && leaf != kNone; ++axis)
                    if ((k >> axis & 1U) != 0) leaf = out.leaves[leaf].beyond[axis][1];
                if (k > 0 && leaf != kNone) continue;
                const std::array<std::uint64_t, 3> at{std::uint64_t{n.at[0] + (k & 1U)} << shift, std::uint64_t{n.at[1] + ((k >> 1) & 1U)} << shift,
                                                      std::uint64_t{n.at[2] + (k >> 2)} << shift};
                piece.corners.push_back({at[0] << (2 * kBits) | at[1] << kBits | at[2], n.depth, leaf});
            }
        }
    });
    for (Piece& p : pieces) p.first_corner = std::exchange(listed, listed + p.corners.size());
    std::vector<Corner> corners(listed);
    workers.for_each(pieces.size(), [&](std::size_t p) {
        std::copy(pieces[p].corners.begin(), pieces[p].corners.end(), corners.begin() + static_cast<std::ptrdiff_t>(pieces[p].first_corner));
    });
    sort_on(workers, std::span(corners), [](const Corner& a, const Corner& b) { return a.at != b.at ? a.at < b.at : a.depth > b.depth; });
    std::size_t kept = 0;
    for (const Corner& c : corners) {
        if (kept == 0 || corners[kept - 1].at != c.at) corners[kept++] = c;
        if (c.lowest_of != kNone) out.leaves[c.lowest_of].corner = static_cast<std::uint32_t>(count + kept - 1);
    }
    corners.resize(kept);
    auto points = make_on_huge_pages<LatticePoint>(count + kept, workers);
    workers.for_each(pieces.size(), [&](std::size_t p) {
        for (std::size_t k = 0; k < pieces[p].nodes.size(); ++k) {
            const Box b = box(pieces[p].nodes[k]);
            points[pieces[p].first_leaf + k] = {{b.lo.x + b.side / 2, b.lo.y + b.side / 2, b.lo.z + b.side / 2}, b.side};
        }
    });
    const double unit = std::ldexp(side_, -static_cast<int>(kMaxDepth));
    workers.for_ranges(kept, kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
        const auto along = [&](double lo, std::uint64_t cells) { return lo + static_cast<double>(cells & kMask) * unit; };
        for (std::size_t i = begin; i < end; ++i) {
            const std::uint64_t at = corners[i].at;
            points[count + i] = {{along(lo_.x, at >> (2 * kBits)), along(lo_.y, at >> kBits), along(lo_.z, at)},
                                  std::ldexp(side_, -static_cast<int>(corners[i].depth))};
        }
    });
    return points;
}

}  // namespace wellmesh
