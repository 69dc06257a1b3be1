// SPDX-License-Identifier: Apache-2.0
#include "validation/box_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/vec3_math.hpp"

namespace wellmesh {

SegmentClipper::SegmentClipper(const Vec3& p, const Vec3& q) : start_(p), along_(q - p) {
    double largest = 0;
    for (const Vec3& x : {p, q}) largest = std::max({largest, std::abs(x.x), std::abs(x.y), std::abs(x.z)});
    // a clipped place is off by a few ulp of the segment's length, a difference by an ulp of the coordinates
    pad_ = 1e-12 * norm(along_) + 16 * std::numeric_limits<double>::epsilon() * largest;
}

/// Halves boxes by their centres, along the longest side of the centres' own box, down to a few.
class BoxTree::Builder {
public:
    explicit Builder(BoxTree& tree) : tree_(tree), items_(tree.boxes_.size()) {
        for (std::uint32_t i = 0; i < items_.size(); ++i) items_[i] = {tree.boxes_[i].low + tree.boxes_[i].high, i};
        tree_.nodes_.resize(count_nodes(items_.size())[0]);
    }

    void run(Workers& workers) {
        // The first few halvings level by level, then what is below on its own.
        constexpr std::size_t kParts = 16, kWorthIt = 4096;
        std::vector<Part> upper, level{{0, 0, static_cast<std::uint32_t>(items_.size())}};
        while (workers.threads() > 1 && level.size() < kParts && items_.size() >= kWorthIt) {
            workers.for_each(level.size(), [&](std::size_t i) { halve(level[i]); });
            std::vector<Part> next;
            for (const Part& p : level) {
                const auto [left, right] = halves(p);
                next.insert(next.end(), {left, right});
            }
            upper.insert(upper.end(), level.begin(), level.end());
            level = std::move(next);
        }
        workers.for_each(level.size(), [&](std::size_t i) { build(level[i]); });
        for (std::size_t i = upper.size(); i-- > 0;) join_halves(upper[i]);
        tree_.order_.resize(items_.size());
        for (std::size_t i = 0; i < items_.size(); ++i) tree_.order_[i] = items_[i].box;
    }

private:
    static constexpr std::uint32_t kLeafSize = 4;
    struct Item {
        Vec3 centre{};  ///< twice
        std::uint32_t box = 0;
    };
    struct Part {
        std::uint32_t node, begin, end;
        [[nodiscard]] std::uint32_t middle() const { return begin + (end - begin) / 2; }
    };

    /// Of a tree of n boxes, and of one of n + 1.
    static std::array<std::uint32_t, 2> count_nodes(std::size_t n) {
        const auto inner = [](std::uint32_t left, std::uint32_t right) { return 1 + left + right; };
        if (n < kLeafSize) return {1, 1};
        const auto [less, more] = count_nodes(n / 2);
        const std::uint32_t uneven = inner(less, more);
        const std::uint32_t own = n == kLeafSize ? 1 : n % 2 == 0 ? inner(less, less) : uneven;
        return {own, n % 2 == 0 ? uneven : inner(more, more)};
    }
    static std::array<Part, 2> halves(const Part& p) {
        const Part left{p.node + 1, p.begin, p.middle()};
        return {left, Part{left.node + count_nodes(left.end - left.begin)[0], p.middle(), p.end}};
    }

    void halve(const Part& p) {
        Box centres;
        for (std::uint32_t i = p.begin; i < p.end; ++i) centres.add(items_[i].centre);
        const std::size_t axis = centres.longest_axis();
        std::nth_element(items_.begin() + p.begin, items_.begin() + p.middle(), items_.begin() + p.end, [axis](const Item& a, const Item& b) {
            const double ca = coordinate(a.centre, axis), cb = coordinate(b.centre, axis);
            return ca != cb ? ca < cb : a.box < b.box;
        });
    }
    void build(const Part& p) {
        if (p.end - p.begin <= kLeafSize) {
            Box box;
            for (std::uint32_t i = p.begin; i < p.end; ++i) box.add(tree_.boxes_[items_[i].box]);
            tree_.nodes_[p.node] = {box, p.begin, p.end, 0, 0};
            return;
        }
        halve(p);
        for (const Part& half : halves(p)) build(half);
        join_halves(p);
    }
    void join_halves(const Part& p) {
        const auto [left, right] = halves(p);
        Box box = tree_.nodes_[left.node].box;
        box.add(tree_.nodes_[right.node].box);
        tree_.nodes_[p.node] = {box, p.begin, p.end, left.node, right.node};
    }

    BoxTree& tree_;
    std::vector<Item> items_;
};

BoxTree::BoxTree(std::span<const Box> boxes, Workers& workers) : boxes_(boxes) {
    if (boxes.empty()) return;
    Builder(*this).run(workers);
    bounds_ = nodes_[0].box;
}

BoxTree::BoxTree(std::span<const Box> boxes) : boxes_(boxes) {
    Workers alone;
    *this = BoxTree(boxes, alone);
}

}  // namespace wellmesh
