// SPDX-License-Identifier: Apache-2.0
// A mesh under test, after its numbers and coordinates were found usable: what all claims share.
//
// Nothing here comes from the generator: adjacency is found by sorting faces, orientation by exact predicates.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/workers.hpp"
#include "predicates/predicates.hpp"
#include "wellmesh/certificate.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh::certifying {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

using Triangle = std::array<std::uint32_t, 3>;  ///< vertex numbers
using Edge = std::array<std::uint32_t, 2>;      ///< vertex numbers
using Tet = std::array<std::uint32_t, 4>;       ///< vertex numbers

/// Corner of the tetrahedron that is not on the face; any corner if the tetrahedron repeats a vertex.
[[nodiscard]] constexpr std::uint32_t apex(const Tet& tet, const Triangle& face) {
    for (const std::uint32_t v : tet)
        if (v != face[0] && v != face[1] && v != face[2]) return v;
    return tet[3];
}

/// Face f of a tetrahedron is the triangle of these corners; corner f lies opposite. Seen from outside, they turn counter-clockwise.
inline constexpr std::array<std::array<std::size_t, 3>, 4> kFaceCorners{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// A triangle that the mesh must not cross: on its hull, between two regions, or listed.
struct ConstraintTriangle {
    Triangle v{};                                  ///< ascending
    std::array<std::uint32_t, 2> tets{kNone, kNone};  ///< on the side that (v1 - v0) x (v2 - v0) points to, and on the other
    std::uint32_t listed = kNone;                  ///< lowest number in TetMesh::subfaces
    bool is_face = false;                          ///< false: listed, but no face of the mesh
    bool on_hull = false;                          ///< face of exactly one tetrahedron
};

class SuspectMesh {
public:
    /// @pre every vertex number is in range, every coordinate and weight finite. Coordinates and weights too small for the predicates to be
    /// exact (predicates/exact_range.hpp) count as zero.
    /// @param threads  at work whenever something is done in ranges (workers()); 0: as many as the machine has cores.
    explicit SuspectMesh(const TetMesh& mesh, unsigned threads = 1);
    SuspectMesh(const SuspectMesh&) = delete;
    SuspectMesh& operator=(const SuspectMesh&) = delete;

    [[nodiscard]] const TetMesh& mesh() const { return mesh_; }
    [[nodiscard]] Workers& workers() const { return workers_; }
    [[nodiscard]] std::size_t vertex_count() const { return mesh_.vertices.size(); }
    [[nodiscard]] std::size_t tet_count() const { return mesh_.tets.size(); }
    [[nodiscard]] const Vec3& point(std::uint32_t v) const { return places_[v].point.point; }  ///< as insphere_lanes.hpp wants it
    [[nodiscard]] const std::vector<Vec3>& points() const { return flushed_.empty() ? mesh_.vertices : flushed_; }
    [[nodiscard]] bool is_weighted() const { return !weights_.empty(); }
    [[nodiscard]] const WeightedPoint& weighted(std::uint32_t v) const { return places_[v].point; }
    /// Of all vertices; empty: none.
    [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
    [[nodiscard]] const PredicateFilter& predicates() const { return predicates_; }
    [[nodiscard]] bool positive(std::size_t tet) const { return positive_[tet]; }
    [[nodiscard]] std::size_t positive_count() const { return positive_count_; }
    /// Positive: the vertex is strictly inside the circumsphere of the positive tetrahedron or, with weights, in conflict with its orthogonal sphere.
    [[nodiscard]] Sign in_sphere(std::size_t tet, std::uint32_t vertex) const;
    [[nodiscard]] std::int32_t region(std::size_t tet) const { return mesh_.tet_regions.empty() ? 0 : mesh_.tet_regions[tet]; }
    [[nodiscard]] Vec3 centroid(const std::uint32_t* v, std::size_t n) const;
    [[nodiscard]] Vec3 tet_centroid(std::size_t tet) const { return centroid(mesh_.tets[tet].data(), 4); }
    [[nodiscard]] double largest_coordinate() const { return largest_coordinate_; }

private:
    struct alignas(32) Place {
        WeightedPoint point;  // weight 0 without weights
    };
    const TetMesh& mesh_;
    mutable Workers workers_;
    std::vector<Place> places_;
    std::vector<Vec3> flushed_;  // empty unless some coordinate had to be
    std::vector<double> weights_;
    PredicateFilter predicates_;
    std::vector<bool> positive_;
    std::size_t positive_count_ = 0;
    double largest_coordinate_ = 0;
};

// ---- words for claims

/// Counts violations and keeps the first witness, i.e. the one with the lowest number.
class ClaimBuilder {
public:
    ClaimBuilder() = default;  ///< nameless, to be absorbed by one that has a name
    ClaimBuilder(std::string name, std::string statement);
    /// Adds what was found in later elements.
    void absorb(ClaimBuilder&& later);
    /// One more violation by the element of this number (from 1; 0: it has none in the file). `detail` is called when it becomes the witness.
    template <class Detail>
    void violated(EntityKind kind, std::uint64_t number, const Vec3& where, Detail&& detail) {
        ++claim_.violations;
        if (claim_.witness && !(number < claim_.witness->number)) return;
        claim_.witness = ElementRef{kind, number, where};
        claim_.detail = detail();
    }
    void checked(std::uint64_t n) { claim_.checked += n; }
    /// Appended to the detail, whatever the outcome.
    void note(const std::string& text);
    /// Proven or refuted by the count of violations.
    [[nodiscard]] Claim decided() const;
    /// Refuted if there are violations, else not checked, for the reason given.
    [[nodiscard]] Claim undecided(const std::string& reason) const;
    [[nodiscard]] std::uint64_t violations() const { return claim_.violations; }

private:
    Claim claim_;
    std::string notes_;
};

/// Calls look(begin, end, part) for ranges of [0, n) whose limits don't depend on the number of threads, then joins the parts in order.
template <class Look>
void look_in_ranges(Workers& workers, std::size_t n, std::size_t grain, ClaimBuilder& claim, Look&& look) {
    std::vector<ClaimBuilder> parts((n + grain - 1) / grain);
    workers.for_ranges(n, grain, [&](std::size_t begin, std::size_t end, std::size_t piece) { look(begin, end, parts[piece]); });
    for (ClaimBuilder& part : parts) claim.absorb(std::move(part));
}

/// Of elements that cost some ten nanoseconds each, and of those that cost a hundred times that.
inline constexpr std::size_t kGrain = std::size_t{1} << 14, kSmallGrain = std::size_t{1} << 8;

/// A claim that could not be looked at.
[[nodiscard]] Claim unchecked(std::string name, std::string statement, std::string reason);

/// "(0.25, 1, -3)" with as many digits as tell doubles apart.
[[nodiscard]] std::string text_of(const Vec3& p);

}  // namespace wellmesh::certifying
