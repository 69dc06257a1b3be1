// SPDX-License-Identifier: Apache-2.0
#include "sizing/size_octree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/rng.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

/// Lengths beyond so many sides of the root ask for nothing: no tetrahedron inside has such a circumradius and a bounded radius-edge ratio.
constexpr double kCeiling = 1e6;

double trilinear(const std::array<double, 8>& v, double x, double y, double z) {
    const double v00 = v[0] + x * (v[1] - v[0]), v10 = v[2] + x * (v[3] - v[2]), v01 = v[4] + x * (v[5] - v[4]), v11 = v[6] + x * (v[7] - v[6]);
    const double v0 = v00 + y * (v10 - v00), v1 = v01 + y * (v11 - v01);
    return v0 + z * (v1 - v0);
}

}  // namespace

/// What was sampled last, by place: neighbours in a tree that is built depth first ask for the same samples, and a small table stays in the processor's cache.
class SizeOctree::RecentSamples {
public:
    RecentSamples() : keys_(kSlots, kNone), values_(kSlots, 0) {}
    /// @param sample  called if there is none for this key
    template <class Sample>
    double find(std::uint64_t key, Sample&& sample) {
        std::size_t slot = mix64(key) % kSlots;
        while (keys_[slot] != kNone && keys_[slot] != key) slot = (slot + 1) % kSlots;
        if (keys_[slot] == key) return values_[slot];
        const double value = sample();
        if (++used_ > kSlots / 2) {
            std::fill(keys_.begin(), keys_.end(), kNone);
            used_ = 1;
            slot = mix64(key) % kSlots;
        }
        keys_[slot] = key;
        values_[slot] = value;
        return value;
    }

private:
    static constexpr std::size_t kSlots = std::size_t{1} << 15;
    static constexpr std::uint64_t kNone = ~std::uint64_t{0};
    std::vector<std::uint64_t> keys_;
    std::vector<double> values_;
    std::size_t used_ = 0;
};

struct SizeOctree::Builder {
    SizeOctree& tree;
    const SizeSampling& sampling;
    const std::function<void(const Leaf&)>& on_leaf;
    RecentSamples recent{};

    [[nodiscard]] Vec3 point(const At& at) const {
        const double unit = std::ldexp(tree.side_, -static_cast<int>(kMaxDepth));
        return {tree.lo_.x + at[0] * unit, tree.lo_.y + at[1] * unit, tree.lo_.z + at[2] * unit};
    }
    double sample(const At& at) {
        const std::uint64_t key = (std::uint64_t{at[0]} << 42U) | (std::uint64_t{at[1]} << 21U) | at[2];
        return recent.find(key, [&] { return std::min(sampling.edge_length(point(at)), tree.ceiling_); });
    }
    std::array<double, 8> sample_corners(const At& at, std::uint32_t width) {
        std::array<double, 8> values{};
        for (std::uint32_t k = 0; k < 8; ++k) values[k] = sample({at[0] + (k & 1U) * width, at[1] + ((k >> 1U) & 1U) * width, at[2] + (k >> 2U) * width});
        return values;
    }

    /// Is the function as fine as the leaf, or as the interpolation in it?
    bool must_split(const At& at, std::uint32_t width, double side, const std::array<double, 8>& corners, const std::vector<std::uint32_t>& probes) {
        const std::uint32_t half = width / 2;
        const At centre{at[0] + half, at[1] + half, at[2] + half};
        std::array<double, 7> seen{};
        std::array<double, 7> guess{};
        for (std::size_t k = 0; k < 7; ++k) {
            At where = centre;
            std::array<double, 3> place{0.5, 0.5, 0.5};
            if (k > 0) {
                const std::size_t axis = (k - 1) / 2;
                where[axis] = at[axis] + (k % 2 == 1 ? 0 : width);
                place[axis] = k % 2 == 1 ? 0 : 1;
            }
            seen[k] = sample(where);
            guess[k] = trilinear(corners, place[0], place[1], place[2]);
        }
        double least = std::min(*std::min_element(corners.begin(), corners.end()), *std::min_element(seen.begin(), seen.end()));
        double error = 0;
        for (std::size_t k = 0; k < 7; ++k) error = std::max(error, std::abs(seen[k] - guess[k]));
        const Vec3 lo = point(at);
        for (const std::uint32_t i : probes) {
            const Vec3 p = sampling.probes[i];
            const double value = std::min(sampling.edge_length(p), tree.ceiling_);
            least = std::min(least, value);
            error = std::max(error, std::abs(value - trilinear(corners, (p.x - lo.x) / side, (p.y - lo.y) / side, (p.z - lo.z) / side)));
        }
        if (side <= kFinestLeafPerLength * least) return false;
        return side > kLeafPerLength * least || error > kInterpolationError * least;
    }

    void build(std::uint32_t node, unsigned depth, const At& at, const std::vector<std::uint32_t>& surface, const std::vector<std::uint32_t>& probes) {
        const std::uint32_t width = 1U << (kMaxDepth - depth);
        const double side = std::ldexp(tree.side_, -static_cast<int>(depth));
        const Vec3 lo = point(at), hi = lo + Vec3{side, side, side};
        const Box box{lo, hi};
        std::vector<std::uint32_t> surface_here, probes_here;
        for (const std::uint32_t i : surface)
            if (sampling.surface[i].meets(box)) surface_here.push_back(i);
        for (const std::uint32_t i : probes) {
            const Vec3& p = sampling.probes[i];
            if (p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y && p.z >= lo.z && p.z <= hi.z) probes_here.push_back(i);
        }
        const bool in_domain = !surface_here.empty() || !sampling.inside || sampling.inside(0.5 * (lo + hi));
        const std::array<double, 8> corners = sample_corners(at, width);
        // The finest cells have no centre on the grid of samples.
        const bool may_split = in_domain && depth + 1 < kMaxDepth && (!sampling.may_go_on || sampling.may_go_on(tree.values_.size()));
        if (!may_split || (depth >= sampling.least_depth && !must_split(at, width, side, corners, probes_here))) {
            tree.nodes_[node].values = static_cast<std::uint32_t>(tree.values_.size());
            tree.values_.push_back(corners);
            if (on_leaf) on_leaf({lo, side, corners, in_domain, !surface_here.empty(), probes_here});
            return;
        }
        const auto first = static_cast<std::uint32_t>(tree.nodes_.size());
        tree.nodes_.resize(tree.nodes_.size() + 8);
        tree.nodes_[node].first_child = first;
        for (std::uint32_t k = 0; k < 8; ++k)
            build(first + k, depth + 1, {at[0] + (k & 1U) * (width / 2), at[1] + ((k >> 1U) & 1U) * (width / 2), at[2] + (k >> 2U) * (width / 2)}, surface_here, probes_here);
    }
};

SizeOctree::SizeOctree(const SizeSampling& sampling, const std::function<void(const Leaf&)>& on_leaf)
    : lo_(sampling.lo), side_(sampling.side), ceiling_(kCeiling * sampling.side), nodes_(1) {
    std::vector<std::uint32_t> surface(sampling.surface.size()), probes(sampling.probes.size());
    std::iota(surface.begin(), surface.end(), 0U);
    std::iota(probes.begin(), probes.end(), 0U);
    Builder{*this, sampling, on_leaf}.build(0, 0, {0, 0, 0}, surface, probes);
}

double SizeOctree::operator()(const Vec3& p) const {
    constexpr double kCells = 1U << kMaxDepth;
    const double x = std::clamp((p.x - lo_.x) / side_, 0.0, 1.0), y = std::clamp((p.y - lo_.y) / side_, 0.0, 1.0), z = std::clamp((p.z - lo_.z) / side_, 0.0, 1.0);
    const auto cell = [](double u) { return std::min(static_cast<std::uint32_t>(u * kCells), (1U << kMaxDepth) - 1); };
    const std::uint32_t i = cell(x), j = cell(y), k = cell(z);
    std::uint32_t node = 0;
    unsigned depth = 0;
    for (; nodes_[node].first_child != 0; ++depth) {
        const unsigned shift = kMaxDepth - depth - 1;
        node = nodes_[node].first_child + ((i >> shift) & 1U) + 2 * ((j >> shift) & 1U) + 4 * ((k >> shift) & 1U);
    }
    const double cells = std::ldexp(1.0, static_cast<int>(depth));
    const unsigned shift = kMaxDepth - depth;
    const double value = trilinear(values_[nodes_[node].values], x * cells - (i >> shift), y * cells - (j >> shift), z * cells - (k >> shift));
    return value < 0.5 * ceiling_ ? value : std::numeric_limits<double>::infinity();
}

}  // namespace wellmesh
