// SPDX-License-Identifier: Apache-2.0
#include "exudation/star_growth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/infinity.hpp"
#include "predicates/exact_range.hpp"
#include "quality/tet_shape.hpp"

namespace wellmesh {
namespace {

/// In place of a cosine: worse than any angle, but a tetrahedron that may come and go while the star grows.
constexpr double kOutOfBounds = 1.5;
static_assert(1 < kOutOfBounds && kOutOfBounds < kNoAngleCosine);

/// Intervals shorter than this part of the weight's whole range are ties: what lies between is not looked at.
constexpr double kShortestInterval = 1e-6;

/// The weight in the middle of an interval, in as few bits as a quarter of its length allows: files are shorter and exact arithmetic is faster.
double middle_of(double low, double high) {
    const double middle = low + (high - low) / 2;
    const double unit = std::ldexp(1.0, std::ilogb((high - low) / 4));
    const double rounded = unit * std::round(middle / unit);
    return rounded > low && rounded < high ? rounded : middle;
}

}  // namespace

double StarGrowth::cosine(TetId t) const {
    const auto& c = mesh_.tets().corners(t);
    return max_cos_dihedral(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]));
}

// PowerFormula is affine in the weight of e, with six volumes as the slope; it is positive in conflict.
double StarGrowth::critical_weight(TetId t) const {
    const auto& c = mesh_.tets().corners(t);
    const WeightedPoint p{mesh_.point(p_), 0};
    const double at_zero = PredicateFilter::power_value(mesh_.weighted(c[0]), mesh_.weighted(c[1]), mesh_.weighted(c[2]), mesh_.weighted(c[3]), p);
    return -at_zero / six_volumes(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(c[3]));
}

bool StarGrowth::is_within_bounds(TetFace link_face) const {
    const auto c = mesh_.tets().face_corners(link_face);
    const Vec3 &a = mesh_.point(c[0]), &b = mesh_.point(c[1]), &d = mesh_.point(c[2]), &p = mesh_.point(p_);
    const double ratio_squared = radius_edge_squared(a, b, d, p);
    if (!(ratio_squared <= bounds_.max_radius_edge_ratio * bounds_.max_radius_edge_ratio)) return false;
    const double squared_radius = ratio_squared * shortest_edge_squared(a, b, d, p);
    if (bounds_.max_squared_circumradius_at && !(squared_radius <= bounds_.max_squared_circumradius_at(0.25 * ((a + b) + (d + p))))) return false;
    const auto size = bounds_.size_of_region.find(mesh_.region(link_face.tet()));
    if (size == bounds_.size_of_region.end()) return true;
    return squared_radius <= size->second.max_squared_circumradius && six_volumes(a, b, d, p) <= 6 * size->second.max_volume;
}

void StarGrowth::add_face(TetFace inside, bool original) {
    LinkFace f;
    f.original = original;
    f.face = {inside, mesh_.tets().across(inside)};
    f.critical = mesh_.is_constrained(inside) ? kInfinity : critical_weight(f.face.outside.tet());
    const auto c = mesh_.tets().face_corners(inside);
    f.cosine = max_cos_dihedral(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), mesh_.point(p_));
    if (!original && f.cosine < kNoAngleCosine && !is_within_bounds(inside)) f.cosine = kOutOfBounds;
    link_.push_back(f);
}

bool StarGrowth::start(VertexId p) {
    p_ = p;
    link_.clear();
    absorbed_.clear();
    destroyed_cosine_ = -1;
    if (!mesh_.find_star(p, star_)) return false;
    for (const TetId t : star_) add_face(TetFace{t, mesh_.tets().find_corner(t, p)}, true);
    return true;
}

std::uint32_t StarGrowth::next_face() const {
    std::size_t best = link_.size();
    double least = kInfinity;
    for (std::size_t i = 0; i < link_.size(); ++i)
        if (link_[i].alive && link_[i].critical < least) {
            least = link_[i].critical;
            best = i;
        }
    return static_cast<std::uint32_t>(best);
}

double StarGrowth::next_critical() const {
    const std::uint32_t i = next_face();
    return i < link_.size() ? link_[i].critical : kInfinity;
}

bool StarGrowth::link_has(VertexId a) const {
    return std::any_of(link_.begin(), link_.end(), [&](const LinkFace& f) {
        if (!f.alive) return false;
        const auto c = mesh_.tets().face_corners(f.face.inside);
        return c[0] == a || c[1] == a || c[2] == a;
    });
}

bool StarGrowth::link_has(VertexId a, VertexId b) const {
    return std::any_of(link_.begin(), link_.end(), [&](const LinkFace& f) {
        if (!f.alive) return false;
        const auto c = mesh_.tets().face_corners(f.face.inside);
        return (c[0] == a || c[1] == a || c[2] == a) && (c[0] == b || c[1] == b || c[2] == b);
    });
}

/// Through one face a new vertex comes to the link. Through two, the edge between them leaves it and the opposite one comes. Through three, the
/// vertex between them would be hidden: no weight may do that.
bool StarGrowth::may_absorb(TetId t, const std::vector<std::uint32_t>& faces) const {
    const TetStore& tets = mesh_.tets();
    if (faces.size() > 2) return false;
    for (const std::uint32_t i : faces)
        if (mesh_.is_constrained(link_[i].face.inside)) return false;
    const unsigned f = link_[faces[0]].face.outside.face();
    if (faces.size() == 1) return !link_has(tets.corner(t, f));
    const unsigned g = link_[faces[1]].face.outside.face();
    std::array<VertexId, 2> shared{};
    for (unsigned i = 0, n = 0; i < 4; ++i)
        if (i != f && i != g) shared[n++] = tets.corner(t, i);
    return !mesh_.is_subsegment(shared[0], shared[1]) && !link_has(tets.corner(t, f), tets.corner(t, g));
}

bool StarGrowth::absorb_next() {
    const TetId t = link_[next_face()].face.outside.tet();
    at_tet_.clear();
    for (std::uint32_t i = 0; i < link_.size(); ++i)
        if (link_[i].alive && link_[i].face.outside.valid() && link_[i].face.outside.tet() == t) at_tet_.push_back(i);
    if (!may_absorb(t, at_tet_)) return false;
    std::array<bool, 4> inner{};
    for (const std::uint32_t i : at_tet_) {
        inner[link_[i].face.outside.face()] = true;
        link_[i].alive = false;
        if (link_[i].original) destroyed_cosine_ = std::max(destroyed_cosine_, link_[i].cosine);
    }
    destroyed_cosine_ = std::max(destroyed_cosine_, cosine(t));
    absorbed_.push_back(t);
    for (unsigned f = 0; f < 4; ++f)
        if (!inner[f]) {
            add_face(TetFace{t, f}, false);
            if (link_.back().cosine >= kNoAngleCosine) return false;
        }
    return true;
}

WeightChoice StarGrowth::best_weight(VertexId p, TetId target, double target_cosine) {
    WeightChoice best;
    const double now = mesh_.weight(p), reach = reach_[p.index()];
    if (!(reach > now) || !start(p) || !(next_critical() < reach)) return best;
    const double limit = std::min(reach, boundary_.limit(p));
    if (!(limit > now)) return best;
    best.cosine = target_cosine;
    bool target_gone = false;
    while (true) {
        const double low = next_critical();
        if (!(low < limit) || !absorb_next()) break;
        // a link face of the target that is left keeps it
        target_gone = target_gone || absorbed_.back() == target;
        if (!target_gone)
            for (std::size_t i = 0; i < star_.size(); ++i) target_gone = target_gone || (star_[i] == target && !link_[i].alive);
        const double high = std::min(next_critical(), limit);
        if (!target_gone || !(std::max(low, now) + kShortestInterval * reach < high)) continue;
        double worst = -1;
        for (const LinkFace& f : link_)
            if (f.alive && !f.original) worst = std::max(worst, f.cosine);
        if (!(worst < best.cosine && worst < destroyed_cosine_)) continue;
        best = {p, middle_of(std::max(low, now), high), worst, absorbed_.size()};
    }
    return best;
}

bool StarGrowth::is_confirmed(double weight) const {
    if (!weight_in_exact_range(weight)) return false;
    const TetStore& tets = mesh_.tets();
    const WeightedPoint p{mesh_.point(p_), weight};
    const auto side = [&](TetId t) {
        const auto& c = tets.corners(t);
        return power_test(mesh_.weighted(c[0]), mesh_.weighted(c[1]), mesh_.weighted(c[2]), mesh_.weighted(c[3]), p);
    };
    for (const TetId t : absorbed_)
        if (side(t) != Sign::positive) return false;
    for (const LinkFace& f : link_) {
        if (!f.alive) continue;
        if (!mesh_.is_constrained(f.face.inside) && side(f.face.outside.tet()) != Sign::negative) return false;
        const auto c = tets.face_corners(f.face.inside);
        if (!f.original && orient3d(mesh_.point(c[0]), mesh_.point(c[1]), mesh_.point(c[2]), p.point) != Sign::positive) return false;
    }
    return boundary_.allows(p_, weight);
}

bool StarGrowth::apply(const WeightChoice& choice, std::vector<TetId>& created) {
    if (!start(choice.vertex)) return false;
    while (absorbed_.size() < choice.absorbed)
        if (!absorb_next()) return false;
    if (!is_confirmed(choice.weight)) return false;
    std::vector<TetId> deleted = star_;
    deleted.insert(deleted.end(), absorbed_.begin(), absorbed_.end());
    std::vector<BoundaryFace> link;
    for (const LinkFace& f : link_)
        if (f.alive) link.push_back(f.face);
    mesh_.replace_star(choice.vertex, choice.weight, deleted, link, created);
    return true;
}

}  // namespace wellmesh
