// SPDX-License-Identifier: Apache-2.0
// Known tetrahedra take the place of what fills their region. Their rim must be there already: the triangulation of some of the points has every
// Delaunay tetrahedron of all of them that has no other corners, and nothing but these lies outside of the rim.
#include <algorithm>

#include "core/corner_table.hpp"
#include "delaunay/known_tets.hpp"
#include "delaunay/triangulation.hpp"

namespace wellmesh {
namespace {

/// The faces of the rim by their corners.
class Rim {
public:
    Rim(Workers& workers, const KnownTets& known)
        : role_(known.has_vertex().begin(), known.has_vertex().end()), table_(workers, known.has_vertex().size(), known.rim().size(), [&](std::size_t r) { return known.rim()[r].corners; }) {
        for (const KnownTets::RimFace& face : known.rim())
            for (const VertexId v : face.corners) role_[v.index()] = kOnRim;
    }
    static constexpr std::uint32_t kNone = CornerTable<3>::kNone;
    /// Of the vertices of known tetrahedra.
    [[nodiscard]] bool is_known(VertexId v) const { return role_[v.index()] != 0; }
    [[nodiscard]] std::uint32_t find(const std::array<VertexId, 3>& corners) const {
        return std::all_of(corners.begin(), corners.end(), [&](VertexId v) { return role_[v.index()] == kOnRim; }) ? table_.find(corners) : kNone;
    }

private:
    static constexpr char kOnRim = 2;
    std::vector<char> role_;  // by vertex
    CornerTable<3> table_;
};

bool same_side(const std::array<VertexId, 3>& a, const std::array<VertexId, 3>& b) {
    const auto first = static_cast<std::size_t>(std::find(b.begin(), b.end(), a[0]) - b.begin());
    return b[(first + 1) % 3] == a[1];
}

}  // namespace

bool Triangulation::find_region(Workers& workers, const KnownTets& known, KnownRegion& region, const std::function<bool()>& goes_on) {
    constexpr std::size_t kBetweenQuestions = 4096;
    const std::span<const KnownTets::RimFace> rim = known.rim();
    const Rim table(workers, known);
    region.tets.clear();
    region.group.clear();
    region.outside.assign(rim.size(), TetFace{});
    std::vector<char> is_within(tets_.slots(), 0);  // marks of searches won't do: find_face() leaves its own
    const auto enter = [&](TetId t, std::uint32_t group) {
        is_within[t.index()] = 1;
        region.tets.push_back(t);
        region.group.push_back(group);
        tets_.prefetch(t);  // it's looked at when those before it have been
    };
    for (std::size_t r = 0; r < rim.size(); ++r) {
        if (region.outside[r].valid()) continue;
        if (!goes_on()) return false;
        const auto& [a, b, c] = rim[r].corners;
        if (!is_inserted(a) || !is_inserted(b) || !is_inserted(c)) return false;
        TetFace start = find_face(a, b, c);
        if (!start.valid()) return false;
        if (!same_side(tets_.face_corners(start), rim[r].corners)) start = tets_.across(start);
        if (is_within[start.tet().index()] != 0) return false;  // it would have been met
        std::size_t next = region.tets.size();
        for (enter(start.tet(), rim[r].group); next < region.tets.size();) {
            const TetId t = region.tets[next++];
            if (tets_.is_ghost(t)) return false;
            for (const VertexId v : tets_.corners(t))
                if (!table.is_known(v)) return false;
            if (next % kBetweenQuestions == 0 && !goes_on()) return false;
            for (unsigned f = 0; f < 4; ++f) {
                const TetFace beyond = tets_.across(t, f);
                const std::array<VertexId, 3> corners = tets_.face_corners(TetFace{t, f});
                if (const std::uint32_t met = table.find(corners); met != Rim::kNone) {
                    if (!same_side(corners, rim[met].corners)) return false;
                    region.outside[met] = beyond;
                } else if (is_within[beyond.tet().index()] == 0) {
                    enter(beyond.tet(), rim[r].group);
                }
            }
        }
    }
    return true;
}

/// By marks, as they are part of a range that is not much larger.
void KnownRegion::sort(std::size_t slots) {
    std::vector<char> is_one(slots, 0);
    for (const TetId t : tets) is_one[t.index()] = 1;
    tets.clear();
    for (std::size_t i = 0; i < slots; ++i)
        if (is_one[i] != 0) tets.emplace_back(i);
}

void Triangulation::replace_region(Workers& workers, const KnownTets& known, KnownRegion& region) {
    const std::size_t count = known.count();
    while (region.tets.size() > count) {
        tets_.release(region.tets.back());
        region.tets.pop_back();
    }
    region.sort(tets_.slots());
    region.more = tets_.take_slots(count - region.tets.size());
    const auto face_of = [&](std::uint32_t packed) { return TetFace{region.tet(packed >> 2), packed & 3U}; };
    workers.for_each(known.pieces(), [&](std::size_t piece) {
        std::vector<KnownTets::Tet> tets;
        known.list(piece, tets);
        std::size_t n = known.first(piece);
        for (const KnownTets::Tet& tet : tets) {
            std::array<TetFace, 4> across;
            for (unsigned f = 0; f < 4; ++f)
                across[f] = (tet.across[f] & KnownTets::kRimBit) != 0 ? region.outside[tet.across[f] & ~KnownTets::kRimBit] : face_of(tet.across[f]);
            const TetId t = region.tet(n++);
            tets_.set(t, tet.corners, across);
            for (unsigned k = 0; k < 4; ++k)
                if ((tet.homes >> k & 1U) != 0) vertices_[tet.corners[k].index()].tet = t;
        }
    });
    for (std::size_t r = 0; r < region.outside.size(); ++r) {
        const KnownTets::RimFace& face = known.rim()[r];
        tets_.set_across(region.outside[r], face_of(face.owner));
        for (const VertexId v : face.corners) vertices_[v.index()].tet = region.outside[r].tet();
    }
    last_located_ = TetId{};
}

}  // namespace wellmesh
