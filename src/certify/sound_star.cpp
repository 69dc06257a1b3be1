// SPDX-License-Identifier: Apache-2.0
#include "certify/sound_star.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

namespace wellmesh::certifying {

inline std::uint32_t& SoundStar::slot(std::uint32_t middle, std::uint32_t highest) {
    if (few_) [[likely]]
        return direct_[middle * kFewEnds + highest];
    const auto hashed = static_cast<std::size_t>(((std::uint64_t{middle} << 32 | highest) * 0x9E3779B97F4A7C15U) >> shift_);
    for (std::size_t i = hashed;; i = (i + 1) & (table_.size() - 1)) {
        std::uint32_t& found = table_[i];
        if (found == kNone || (faces_[found].middle == middle && faces_[found].highest == highest)) return found;
    }
}

inline void SoundStar::add(std::uint32_t middle, std::uint32_t highest, std::uint32_t top, std::uint32_t tet, bool positive) {
    std::uint32_t& number = slot(middle, highest);
    const bool is_new = number == kNone;  // as often as not: no branch
    number = is_new ? static_cast<std::uint32_t>(face_count_) : number;
    Face& face = faces_[number];
    sound_ &= is_new | ((face.tets[1] == kNone) & (face.first_is_positive != positive));
    face.tets = {is_new ? tet : face.tets[0], is_new ? kNone : tet};
    face.apexes = {is_new ? top : face.apexes[0], is_new ? kNone : top};
    face.middle = middle;
    face.highest = highest;
    face.listed = kNone;
    face.first_is_positive = is_new ? positive : face.first_is_positive;
    face_count_ += is_new;
    pairs_ += !is_new;
}

bool SoundStar::collect(std::uint32_t vertex, const TetsByCorner& stars, const std::vector<TetClass>& classes) {
    constexpr std::size_t kAhead = 24;  // tetrahedra, of later vertices, too: they are all over the place
    const std::span<const std::uint32_t> tets = stars.of(vertex), all = stars.of_all();
    const std::array<std::uint32_t, 4>* const corners = mesh_.mesh().tets.data();
    // What came before may be asked for until now.
    if (few_)
        for (const Face& f : faces()) direct_[f.middle * kFewEnds + f.highest] = kNone;
    vertex_ = vertex;
    face_count_ = pairs_ = 0;
    edges_.start(vertex, tets.size());
    lowest_.clear();
    second_.clear();
    bool positive = true;
    for (const std::uint32_t& entry : tets) {
        const std::uint32_t t = entry;
        const auto left = static_cast<std::size_t>(all.data() + all.size() - &entry);
        if (left > kAhead) __builtin_prefetch(corners + (&entry)[kAhead]);
        positive = positive && classes[t] != TetClass::left_out;
        const bool interior = classes[t] == TetClass::interior;
        const AscendingTet tet(corners[t]);
        const auto& v = tet.v;
        if (v[0] == vertex) {
            const std::uint32_t b = edges_.visit(v[1], interior), c = edges_.visit(v[2], interior), d = edges_.visit(v[3], interior);
            lowest_.push_back({{b, c, d}, t, tet.odd});
        } else if (v[1] == vertex) {
            const std::uint32_t c = edges_.visit(v[2], interior), d = edges_.visit(v[3], interior);
            second_.push_back({{v[0], c, d}, t, tet.odd});
        } else {
            edges_.visit(v[3], interior);
        }
    }
    if (!positive) return false;
    few_ = edges().size() <= kFewEnds;
    if (!few_) clear_slots(tets.size());
    faces_.resize(std::max(faces_.size(), 4 * tets.size() + 1));
    sound_ = true;
    // Of a positive tetrahedron the side of a face on which its apex lies follows from the order of its corners: the apex at place i takes 3 - i
    // transpositions to the end.
    for (const auto& [at, t, odd] : lowest_) {
        add(at[0], at[1], edges()[at[2]].vertex, t, !odd);
        add(at[0], at[2], edges()[at[1]].vertex, t, odd);
        add(at[1], at[2], edges()[at[0]].vertex, t, !odd);
    }
    for (const auto& [at, t, odd] : second_) add(at[1], at[2], at[0], t, odd);
    return sound_;
}

void SoundStar::clear_slots(std::size_t tets) {
    const std::size_t slots = std::bit_ceil(std::max<std::size_t>(16, 4 * tets));
    table_.assign(slots, kNone);
    shift_ = 64 - std::countr_zero(slots);
}

SoundStar::Face* SoundStar::find(std::uint32_t middle, std::uint32_t highest) {
    const std::uint32_t m = edges_.place_of(middle), h = edges_.place_of(highest);
    if (m == kNone || h == kNone) return nullptr;
    const std::uint32_t found = slot(m, h);
    return found == kNone ? nullptr : &faces_[found];
}

std::uint64_t SoundStar::count_not_delaunay() const {
    std::uint64_t count = 0;
    if (mesh_.is_weighted()) {
        for (const Face& f : faces())
            if (f.tets[1] != kNone) count += mesh_.in_sphere(f.tets[0], f.apexes[1]) == Sign::positive;
        return count;
    }
    // The first tetrahedron's corners and the other's apex, the common vertex last: an even permutation if it is (vertex, middle, highest, apex).
    const Vec3& origin = mesh_.point(vertex_);
    std::array<std::array<const Vec3*, 4>, 4> rows{};
    std::array<Sign, 4> inside{}, signs{};
    std::size_t n = 0;
    const auto evaluate = [&] {
        for (std::size_t i = n; i < 4; ++i) rows[i] = rows[0];
        mesh_.predicates().insphere_of_four_padded(rows, origin, signs);
        for (std::size_t i = 0; i < n; ++i) count += signs[i] == inside[i];
        n = 0;
    };
    for (const Face& f : faces()) {
        if (f.tets[1] == kNone) continue;
        const std::uint32_t middle = edges()[f.middle].vertex, highest = edges()[f.highest].vertex;
        rows[n] = {&mesh_.point(middle), &mesh_.point(highest), &mesh_.point(f.apexes[0]), &mesh_.point(f.apexes[1])};
        inside[n++] = f.first_is_positive ? Sign::positive : Sign::negative;
        if (n == 4) evaluate();
    }
    if (n > 0) evaluate();
    return count;
}

}  // namespace wellmesh::certifying
