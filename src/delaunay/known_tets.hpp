// SPDX-License-Identifier: Apache-2.0
// Tetrahedra that need not be found by inserting points, since somebody knows them: those of a lattice, say.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "delaunay/tet_store.hpp"

namespace wellmesh {

/// Delaunay tetrahedra of a set of points that fill regions of space, each bounded by a closed surface, the rim. They are numbered from 0, without gaps, and
/// listed in pieces, from several threads at once.
class KnownTets {
public:
    static constexpr std::uint32_t kRimBit = 0x80000000U;
    static constexpr std::size_t kMost = kRimBit / 4;  ///< so many numbers leave that bit free
    struct Tet {
        TetStore::Corners corners{};            ///< positive
        std::array<std::uint32_t, 4> across{};  ///< the neighbour's number times 4, plus its face; or with kRimBit the number of a rim face
        std::uint32_t group = 0;                ///< of tetrahedra that are connected
        std::uint8_t homes = 0;                 ///< bit k: corner k is to be entered from here. Of a vertex whose star is all known one tetrahedron says so.
    };
    struct RimFace {
        std::array<VertexId, 3> corners{};  ///< as TetStore::face_corners() of the known tetrahedron
        std::uint32_t owner = 0;            ///< its number times 4, plus its face
        std::uint32_t group = 0;
    };

    virtual ~KnownTets() = default;
    [[nodiscard]] virtual std::size_t count() const = 0;
    [[nodiscard]] virtual std::size_t pieces() const = 0;
    /// Number of the first tetrahedron of a piece; of the piece after the last: count().
    [[nodiscard]] virtual std::size_t first(std::size_t piece) const = 0;
    virtual void list(std::size_t piece, std::vector<Tet>& tets) const = 0;
    [[nodiscard]] virtual std::span<const RimFace> rim() const = 0;
    /// By vertex: is it a corner of one of them?
    [[nodiscard]] virtual std::span<const char> has_vertex() const = 0;
};

/// What is where known tetrahedra are to be.
struct KnownRegion {
    std::vector<TetId> tets;
    std::vector<std::uint32_t> group;  ///< of each of them: one that its known ones have
    std::vector<TetFace> outside;      ///< behind each rim face

    // --- once it is replaced
    TetStore::Slots more{};  ///< where there are more known ones than there were others
    void sort(std::size_t slots);
    /// Where known tetrahedron n is.
    [[nodiscard]] TetId tet(std::size_t n) const {
        if (n < tets.size()) return tets[n];
        n -= tets.size();
        return n < more.count ? TetId{more.first + n} : more.recycled[more.recycled.size() - 1 - (n - more.count)];
    }
};

}  // namespace wellmesh
