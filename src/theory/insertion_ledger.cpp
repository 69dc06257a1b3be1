// SPDX-License-Identifier: Apache-2.0
#include "theory/insertion_ledger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/vec3_math.hpp"
#include "theory/claim_texts.hpp"

namespace wellmesh {
namespace {

/// Circumspheres of tetrahedra keep ten digits (refinement/circumsphere.hpp); ratios of two such have one less.
constexpr double kCircumsphereSlack = 1e-9;
constexpr double kEpsilon = 0x1p-53;

const char* name_of(InsertionReason reason) {
    switch (reason) {
        case InsertionReason::input: return "input";
        case InsertionReason::recovery: return "recovery";
        case InsertionReason::lattice: return "the lattice";
        case InsertionReason::encroachment: return "an encroaching vertex";
        case InsertionReason::size:
        case InsertionReason::boundary_by_size: return "size";
        case InsertionReason::radius_edge:
        case InsertionReason::boundary_by_radius_edge: return "radius-edge ratio";
        case InsertionReason::sliver:
        case InsertionReason::boundary_by_sliver: return "a sliver";
    }
    return "?";
}

}  // namespace

InsertionLedger::InsertionLedger(const TheoryConstants& constants, double position_error)
    : constants_(constants), position_error_(position_error), claims_(stated_claims(constants)) {}

void InsertionLedger::observe(ClaimId id, double value, double slack, const Vec3& where, const std::string& witness) {
    InvariantClaim& claim = at(id);
    ++claim.events;
    // Relative to the bound, if there is one: 0 bounds barycentric coordinates and counts.
    const double allowance = !std::isfinite(claim.bound) ? 0 : claim.bound == 0 ? slack : slack * std::abs(claim.bound);
    const bool good = claim.at_least ? value >= claim.bound - allowance : value <= claim.bound + allowance;
    const bool worse = !(claim.at_least ? value >= claim.worst : value <= claim.worst);  // true for the first
    if (worse) claim.worst = value;
    if (!good) ++claim.violations;
    if (good ? worse && claim.violations == 0 : claim.violations == 1) {
        claim.witness = witness;
        claim.where = where;
    }
}

void InsertionLedger::check(ClaimId id, double value, const Record& r, double more_slack) {
    const InvariantClaim& claim = at(id);
    const bool tells = !(claim.at_least ? value >= claim.worst : value <= claim.worst);  // only of those that may be told a sentence is made
    observe(id, value, r.slack + more_slack, r.point, tells ? describe(r) : std::string());
}

std::string InsertionLedger::describe(const Record& r) const {
    static constexpr std::array<const char*, 5> kElements = {"nothing", "?", "subsegment", "subface", "tetrahedron"};
    const std::string who = r.vertex == kNone ? std::string("rejected point") : fmt::format("vertex {}", r.vertex);
    std::string text = fmt::format("{} at ({}, {}, {}), of a {} of radius {:.6g}, for {}, case {}: e_v = {:.9g}", who, r.point.x, r.point.y, r.point.z, kElements[r.element],
                                   r.radius, name_of(r.reason), unsigned{r.lemma_case}, r.nearest);
    if (r.parent != kNone) {
        const Record& p = records_[r.parent];
        text += fmt::format("; parent {} at ({}, {}, {}): e_p = {:.9g}", p.vertex == kNone ? std::string("rejected") : fmt::format("vertex {}", p.vertex), p.point.x, p.point.y,
                            p.point.z, p.nearest);
    }
    return text;
}

void InsertionLedger::add_input(const Vec3& point, double nearest) {
    Record r;
    r.point = point;
    r.nearest = nearest;
    r.vertex = static_cast<std::uint32_t>(vertex_record_.size());
    r.slack = position_error_ / nearest;
    vertex_record_.push_back(static_cast<std::uint32_t>(records_.size()));
    records_.push_back(r);
}

void InsertionLedger::set_original(double shortest_edge) {
    if (has_original()) return;
    original_vertices_ = vertex_record_.size();
    original_edge_ = reference_edge_ = shortest_edge;
}

void InsertionLedger::describe_element(Record& r, const PickEvent& e) const {
    r.element = static_cast<std::uint8_t>(e.element.size);
    r.radius = e.element.radius;
    r.slack = position_error_ / (e.element.size == 0 ? e.nearest : e.element.radius);
    double shortest = std::numeric_limits<double>::infinity(), longest = 0;
    for (unsigned i = 0; i < e.element.size; ++i)
        for (unsigned j = 0; j < i; ++j) {
            const double d = squared_distance(point(e.element.corners[i].index()), point(e.element.corners[j].index()));
            shortest = std::min(shortest, d);
            longest = std::max(longest, d);
        }
    r.shortest = std::sqrt(shortest);
    if (e.element.size < 3) return;
    const auto corner = [&](std::size_t i) { return point(e.element.corners[i].index()); };
    const Vec3 u = corner(1) - corner(0), v = corner(2) - corner(0);
    if (e.element.size == 3) {
        r.slack += 64 * kEpsilon * longest * longest / squared_norm(cross(u, v));  // the circumcentre divides by the squared area
        return;
    }
    // Where the sigma criterion is in use circumspheres are computed with care, else in plain rounded arithmetic.
    r.slack += constants_.sigma0 > 0 ? kCircumsphereSlack : 64 * kEpsilon * longest * std::sqrt(longest) / std::abs(determinant(u, v, corner(3) - corner(0)));
}

std::uint32_t InsertionLedger::add(const PickEvent& e) {
    Record r;
    r.point = e.point;
    r.nearest = e.nearest;
    r.reason = e.reason;
    r.sliver_free = e.sliver_free;
    r.after_original = has_original();
    if (e.vertex.valid()) r.vertex = e.vertex.value();
    if (e.rejected != kNone) r.parent = e.rejected;
    else if (e.parent.valid()) r.parent = vertex_record_[e.parent.index()];
    describe_element(r, e);
    if (r.parent != kNone) {
        r.root = records_[r.parent].root;
        r.direct = records_[r.parent].direct;
    }
    if (e.reason == InsertionReason::recovery) r.by_vertex = true;
    const bool picked = e.element.size > 0 && !e.outside_rules;
    if (picked && r.vertex != kNone) check(ClaimId::picking_region, distance(e.point, e.element.centre) / r.radius, r);
    if (picked && e.element.size == 4) take_tetrahedron(r, e);
    else if (picked) take_boundary(r, e);
    if (r.after_original && r.vertex != kNone) check_edges(r);
    const auto number = static_cast<std::uint32_t>(records_.size());
    if (r.vertex != kNone) vertex_record_.push_back(number);
    records_.push_back(r);
    return number;
}

void InsertionLedger::take_tetrahedron(Record& r, const PickEvent& e) {
    check(ClaimId::order, static_cast<double>(e.more_urgent), r);
    check(ClaimId::empty_sphere, r.nearest / r.radius, r);
    r.direct = true;
    if (e.reason == InsertionReason::size) {
        r.root = Root::size;
        return;
    }
    const auto& corners = e.element.corners;
    const VertexId youngest = *std::max_element(corners.begin(), corners.end());
    r.root = e.reason == InsertionReason::sliver ? Root::sliver : Root::radius_edge;
    r.original_sliver = r.root == Root::sliver && is_original(youngest);
    const Record& made_by = records_[vertex_record_[youngest.index()]];
    if (r.root == Root::radius_edge) r.lemma_case = 1;
    else if (r.original_sliver) r.lemma_case = 2;
    else if (made_by.element == 4) r.lemma_case = made_by.root == Root::sliver ? 3 : 4;
    else r.lemma_case = made_by.root == Root::sliver ? 5 : 6;
    check_parent_of_tetrahedron(r, e);
    find_edge_claim(r);
    if (r.root == Root::sliver && r.vertex != kNone) check(ClaimId::theorem_4_1, e.sliver_free ? 1 : 0, r);
    // Cases 3 and 5 hold if the point that made the sliver avoided small ones, which theorem_4_1 counts.
    const bool hypothesis = (r.lemma_case != 3 && r.lemma_case != 5) || made_by.sliver_free;
    if (r.parent != kNone && hypothesis) check_ratio(r);
}

/// Lemma 5.1. @pre r has a case and a parent.
void InsertionLedger::check_ratio(const Record& r) {
    const Record& p = records_[r.parent];
    const auto id = static_cast<ClaimId>(static_cast<unsigned>(ClaimId::lemma_5_1_case_1) + r.lemma_case - 1U);
    check(id, r.nearest / p.nearest, r, p.slack + position_error_ / p.nearest);
}

void InsertionLedger::check_parent_of_tetrahedron(const Record& r, const PickEvent& e) {
    const auto& corners = e.element.corners;
    bool right = false;
    if (r.lemma_case > 2) {
        right = e.parent == *std::max_element(corners.begin(), corners.end());
    } else {
        // The younger end of the shortest edge, or of one equally short up to rounding.
        for (unsigned i = 0; i < 4; ++i)
            for (unsigned j = 0; j < i; ++j)
                right = right || (e.parent == std::max(corners[i], corners[j]) &&
                                  distance(point(corners[i].index()), point(corners[j].index())) <= r.shortest * (1 + 8 * kEpsilon));
    }
    check(ClaimId::parent, right && e.rejected == kNone ? 1 : 0, r);
}

/// Which lemma of section 4 speaks of the edges that the removal of this tetrahedron makes, and what length it compares them with.
void InsertionLedger::find_edge_claim(Record& r) {
    if (r.root == Root::radius_edge) {
        r.edge_claim = ClaimId::lemma_4_3;
        r.reference = r.shortest;
        return;
    }
    if (r.original_sliver) {
        r.edge_claim = ClaimId::lemma_4_2;
        r.reference = original_edge_;
        return;
    }
    if (r.parent == kNone) return;
    const Record& f = records_[r.parent];  // f(tau), or the element of a boundary split
    const bool by_sliver = f.root == Root::sliver;
    if (by_sliver && !f.sliver_free) return;
    r.reference = f.shortest;
    if (f.element == 4) {
        if (by_sliver) r.edge_claim = ClaimId::lemma_4_4;
        else if (f.root == Root::radius_edge) r.edge_claim = ClaimId::lemma_4_5;
        return;
    }
    if (by_sliver) {
        r.edge_claim = ClaimId::lemma_4_6_sliver;
        return;
    }
    if (f.root != Root::radius_edge || !f.direct) return;
    r.edge_claim = ClaimId::lemma_4_6_radius_edge;
    r.reference = f.reference;  // Lemma 4.3's: the shortest edge of the tetrahedron whose centre encroached
}

void InsertionLedger::take_boundary(Record& r, const PickEvent& e) {
    const bool by_vertex = e.reason == InsertionReason::encroachment || e.reason == InsertionReason::recovery;
    r.by_vertex = by_vertex;
    if (by_vertex) r.direct = false;
    if (r.parent == kNone) {
        // Lattice seeds split boundaries for size with nobody responsible.
        if (!by_vertex && e.reason != InsertionReason::boundary_by_size) check(ClaimId::parent, 0, r);
        return;
    }
    const Record& p = records_[r.parent];
    if (e.reason != InsertionReason::recovery) {
        // Whatever encroaches lies in the sphere; what is split for quality encroaches nothing but a rejected centre.
        const bool inside = distance(p.point, e.element.centre) <= r.radius * (1 + r.slack);
        check(ClaimId::parent, inside && (by_vertex || p.vertex == kNone) ? 1 : 0, r);
    }
    if (by_vertex) return;
    r.lemma_case = 7;
    r.edge_claim = p.edge_claim;
    r.reference = p.reference;
    check(ClaimId::empty_sphere, r.nearest / r.radius, r);
    check(ClaimId::lemma_2_5, r.radius / p.radius, r, p.slack);
    if (e.element.size == 3) check(ClaimId::projection, e.projection_depth, r);
    check_ratio(r);
    if (r.root == Root::sliver && r.vertex != kNone) check(ClaimId::theorem_4_1, e.sliver_free ? 1 : 0, r);
}

void InsertionLedger::check_edges(const Record& r) {
    // Vertices that encroach other parts of the boundary, and size, may make shorter edges: what follows is compared with those.
    if (r.by_vertex || r.root == Root::size || r.root == Root::none) {
        reference_edge_ = std::min(reference_edge_, r.nearest);
        return;
    }
    check(ClaimId::theorem_4_2, r.nearest / reference_edge_, r);
    if (r.edge_claim != ClaimId::count && r.direct) check(r.edge_claim, r.nearest / r.reference, r);
}

void InsertionLedger::check_density(const std::function<double(const Vec3&)>& local_feature_size) {
    std::vector<double> lfs(records_.size());
    for (std::size_t i = 0; i < records_.size(); ++i) lfs[i] = local_feature_size(records_[i].point);
    for (std::size_t i = 0; i < records_.size(); ++i) {
        const Record& r = records_[i];
        if (r.reason == InsertionReason::input) {
            if (std::isfinite(lfs[i])) check(ClaimId::lemma_5_1_input, r.nearest / lfs[i], r);
            continue;
        }
        const double density = lfs[i] / r.nearest;
        if (r.element == 4) check(ClaimId::theorem_5_1_inside, density, r);
        else if (r.element == 3) check(ClaimId::theorem_5_1_facets, density, r);
        else if (r.element == 2) check(ClaimId::theorem_5_1_segments, density, r);
        // A piece that is missing altogether was encroached, too, by whichever vertex.
        if (r.by_vertex && r.after_original && (r.parent == kNone || records_[r.parent].vertex != kNone)) check(ClaimId::encroaching_vertex, density, r);
        if (r.lemma_case != 0 && r.parent != kNone) check(ClaimId::lemma_5_2, density - lfs[r.parent] / r.nearest, r);
    }
}

InvariantReport InsertionLedger::report() const {
    InvariantReport out;
    out.delta = constants_.delta;
    out.b = constants_.b;
    out.rho0 = constants_.rho0;
    out.sigma0 = constants_.sigma0;
    const DensityBounds d = density_bounds(constants_);
    out.d1 = d.d1;
    out.d2 = d.d2;
    out.d3 = d.d3;
    out.log10_existence_sigma0 = std::isfinite(constants_.b) ? log10_existence_sigma(constants_) : -std::numeric_limits<double>::infinity();
    out.original_edge = original_edge_;
    out.original_vertices = has_original() ? original_vertices_ : 0;
    out.final_vertices = vertex_record_.size();
    out.claims.assign(claims_.begin(), claims_.end());
    return out;
}

}  // namespace wellmesh
