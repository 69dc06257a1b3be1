// SPDX-License-Identifier: Apache-2.0
// The faces and edges of which one vertex is the lowest corner, where all is sound around it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "certify/suspect_mesh.hpp"
#include "certify/tets_by_corner.hpp"
#include "certify/upper_edges.hpp"

namespace wellmesh::certifying {

/// Sound: all tetrahedra positive, no face of more than two, these on either side of it. One after the other; each vertex of a mesh at most once.
class SoundStar {
public:
    struct Face {
        std::uint32_t middle, highest;  ///< places in edges()
        std::array<std::uint32_t, 2> tets, apexes;  ///< the second kNone on the hull
        std::uint32_t listed;           ///< kNone, for others to fill in
        bool first_is_positive;         ///< the first tetrahedron is on the side that the face's normal points to, (lowest, middle, highest)
    };

    explicit SoundStar(const SuspectMesh& mesh) : mesh_(mesh), edges_(mesh.vertex_count()) {}

    /// @param classes  of all tetrahedra; left out are those that are not positive.
    /// @return whether the star is sound; if not, nothing else may be asked for.
    bool collect(std::uint32_t vertex, const TetsByCorner& stars, const std::vector<TetClass>& classes);

    [[nodiscard]] std::span<Face> faces() { return {faces_.data(), face_count_}; }
    [[nodiscard]] std::span<const Face> faces() const { return {faces_.data(), face_count_}; }
    [[nodiscard]] std::span<const UpperEdges::End> edges() const { return edges_.ends(); }
    [[nodiscard]] std::size_t pairs() const { return pairs_; }  ///< faces of two tetrahedra
    /// nullptr: no face. Ascending with the vertex.
    [[nodiscard]] Face* find(std::uint32_t middle, std::uint32_t highest);
    /// Interior faces with an apex strictly inside the sphere of the other side's tetrahedron (in conflict, with weights).
    [[nodiscard]] std::uint64_t count_not_delaunay() const;

private:
    /// A tetrahedron's upper corners by their places among the edges.
    struct Uppers {
        std::array<std::uint32_t, 3> at;
        std::uint32_t tet;
        bool odd;
    };
    static constexpr std::uint32_t kFewEnds = 64;  // pairs of them are looked up at once
    [[nodiscard]] std::uint32_t& slot(std::uint32_t middle, std::uint32_t highest);
    void clear_slots(std::size_t tets);
    void add(std::uint32_t middle, std::uint32_t highest, std::uint32_t top, std::uint32_t tet, bool positive);

    const SuspectMesh& mesh_;
    std::uint32_t vertex_ = 0;
    UpperEdges edges_;
    std::vector<Uppers> lowest_;  // of tetrahedra with the vertex as the lowest corner
    std::vector<Uppers> second_;  // as the second one; the first place is unused, and holds the lowest corner itself
    std::vector<Face> faces_;
    /// Numbers in faces_ by the places of middle and highest; kNone but for the faces of this star.
    std::vector<std::uint32_t> direct_ = std::vector<std::uint32_t>(std::size_t{kFewEnds} * kFewEnds, kNone);
    std::vector<std::uint32_t> table_;  // the same by open addressing
    std::size_t face_count_ = 0, pairs_ = 0;
    int shift_ = 0;
    bool few_ = true, sound_ = true;
};

}  // namespace wellmesh::certifying
