// SPDX-License-Identifier: Apache-2.0
#include "certify/suspect_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/infinity.hpp"
#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"

namespace wellmesh::certifying {

SuspectMesh::SuspectMesh(const TetMesh& mesh, unsigned threads) : mesh_(mesh), workers_(threads) {
    if (!std::all_of(mesh.vertices.begin(), mesh.vertices.end(), [](const Vec3& p) { return in_exact_range(p); })) {
        flushed_ = mesh.vertices;
        for (Vec3& p : flushed_) p = flush_to_exact_range(p);
    }
    weights_ = mesh.weights;
    for (double& w : weights_)
        if (std::fabs(w) < kMinWeight) w = 0;
    Vec3 low{kInfinity, kInfinity, kInfinity}, high{-kInfinity, -kInfinity, -kInfinity};
    places_.reserve(vertex_count());
    for (const Vec3& p : points()) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        largest_coordinate_ = std::max({largest_coordinate_, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        places_.push_back({{p, is_weighted() ? weights_[places_.size()] : 0}});
    }
    double weight_extent = 0;
    if (is_weighted()) weight_extent = *std::max_element(weights_.begin(), weights_.end()) - *std::min_element(weights_.begin(), weights_.end());
    if (!points().empty()) predicates_ = PredicateFilter(high - low, weight_extent);
    positive_.resize(mesh.tets.size());
    static_assert(kGrain % 1024 == 0, "ranges share no word of positive_");
    std::vector<std::size_t> counts((mesh.tets.size() + kGrain - 1) / kGrain, 0);
    workers_.for_ranges(mesh.tets.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        std::size_t count = 0;
        for (std::size_t t = begin; t < end; ++t) {
            const auto& v = mesh.tets[t];
            const bool positive = predicates_.orient3d(point(v[0]), point(v[1]), point(v[2]), point(v[3])) == Sign::positive;
            positive_[t] = positive;
            count += positive;
        }
        counts[piece] = count;
    });
    positive_count_ = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
}

Sign SuspectMesh::in_sphere(std::size_t tet, std::uint32_t vertex) const {
    const auto& v = mesh_.tets[tet];
    if (!is_weighted()) return predicates_.insphere(point(v[0]), point(v[1]), point(v[2]), point(v[3]), point(vertex));
    return predicates_.power_test(weighted(v[0]), weighted(v[1]), weighted(v[2]), weighted(v[3]), weighted(vertex));
}

Vec3 SuspectMesh::centroid(const std::uint32_t* v, std::size_t n) const {
    Vec3 offset{};
    for (std::size_t i = 1; i < n; ++i) offset = offset + (point(v[i]) - point(v[0]));
    return point(v[0]) + (1 / static_cast<double>(n)) * offset;
}

ClaimBuilder::ClaimBuilder(std::string name, std::string statement) {
    claim_.name = std::move(name);
    claim_.statement = std::move(statement);
}

void ClaimBuilder::absorb(ClaimBuilder&& later) {
    claim_.checked += later.claim_.checked;
    claim_.violations += later.claim_.violations;
    if (!later.claim_.witness || (claim_.witness && claim_.witness->number <= later.claim_.witness->number)) return;
    claim_.witness = std::move(later.claim_.witness);
    claim_.detail = std::move(later.claim_.detail);
}

void ClaimBuilder::note(const std::string& text) {
    if (!notes_.empty()) notes_ += "; ";
    notes_ += text;
}

Claim ClaimBuilder::decided() const {
    Claim claim = claim_;
    claim.state = claim.violations == 0 ? Claim::State::proven : Claim::State::refuted;
    if (!notes_.empty()) claim.detail += (claim.detail.empty() ? "" : "; ") + notes_;
    return claim;
}

Claim ClaimBuilder::undecided(const std::string& reason) const {
    Claim claim = decided();
    if (claim.violations == 0) claim.state = Claim::State::not_checked;
    claim.detail += (claim.detail.empty() ? "" : "; ") + reason;
    return claim;
}

Claim unchecked(std::string name, std::string statement, std::string reason) {
    Claim claim;
    claim.name = std::move(name);
    claim.statement = std::move(statement);
    claim.detail = std::move(reason);
    return claim;
}

std::string text_of(const Vec3& p) { return fmt::format("({}, {}, {})", p.x, p.y, p.z); }

}  // namespace wellmesh::certifying
