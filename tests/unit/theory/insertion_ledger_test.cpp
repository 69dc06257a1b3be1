// SPDX-License-Identifier: Apache-2.0
// Each rule of the paper broken on purpose, by events that no run would send, and its claim refuted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/vec3_math.hpp"
#include "refinement/circumsphere.hpp"
#include "theory/insertion_ledger.hpp"

namespace wellmesh::testing {
namespace {

const TheoryConstants kConstants{0.05, 4.5, 20, 0.01};

/// A regular tetrahedron of edge 1 as the original mesh, and short ways to say what happens to it.
class History {
public:
    History() {
        const double s = 1 / std::sqrt(8.0);
        for (const Vec3& p : {Vec3{s, s, s}, Vec3{s, -s, -s}, Vec3{-s, s, -s}, Vec3{-s, -s, s}}) ledger.add_input(p, 1);
        ledger.set_original(1);
    }

    PickEvent tetrahedron(InsertionReason reason, std::array<unsigned, 4> corners) const {
        PickEvent e;
        e.reason = reason;
        e.element.size = 4;
        for (std::size_t i = 0; i < 4; ++i) e.element.corners[i] = VertexId{corners[i]};
        const Circumsphere s = exact_circumsphere(at(corners[0]), at(corners[1]), at(corners[2]), at(corners[3]));
        e.element.centre = e.point = s.centre;
        e.element.radius = e.nearest = s.radius;
        e.parent = *std::max_element(e.element.corners.begin(), e.element.corners.end());
        return e;
    }
    /// A rejected centre of the original tetrahedron; returns its number.
    std::uint32_t reject(InsertionReason reason) { return ledger.add(tetrahedron(reason, {0, 1, 2, 3})); }
    /// A split of subface 0 1 2, or subsegment 0 1, because of a rejected centre.
    PickEvent boundary(InsertionReason reason, unsigned size, std::uint32_t rejected) const {
        PickEvent e;
        e.reason = reason;
        e.element.size = size;
        for (unsigned i = 0; i < size; ++i) e.element.corners[i] = VertexId{i};
        e.element.centre = e.point = size == 2 ? 0.5 * (at(0) + at(1)) : (1.0 / 3) * (at(0) + at(1) + at(2));
        e.element.radius = e.nearest = size == 2 ? 0.5 : 1 / std::sqrt(3.0);
        e.rejected = rejected;
        e.projection_depth = 1.0 / 3;
        return e;
    }
    std::uint32_t insert(PickEvent e) {
        e.vertex = VertexId{ledger.vertices()};
        return ledger.add(e);
    }
    [[nodiscard]] Vec3 at(unsigned v) const { return ledger.point(v); }
    [[nodiscard]] InvariantClaim claim(const std::string& name) const {
        const InvariantReport report = ledger.report();
        const InvariantClaim* found = report.find(name);
        EXPECT_NE(found, nullptr) << name;
        return found ? *found : InvariantClaim{};
    }
    [[nodiscard]] std::vector<std::string> violated() const {
        std::vector<std::string> names;
        for (const InvariantClaim& c : ledger.report().claims)
            if (c.violations > 0) names.push_back(c.name);
        return names;
    }

    InsertionLedger ledger{kConstants, 1e-15};
};

using Names = std::vector<std::string>;

TEST(InsertionLedger, ARightPickViolatesNothing) {
    History h;
    h.insert(h.tetrahedron(InsertionReason::sliver, {0, 1, 2, 3}));
    EXPECT_EQ(h.violated(), Names{});
    EXPECT_EQ(h.claim("lemma_5_1_case_2").events, 1U);
    EXPECT_EQ(h.claim("lemma_4_2").events, 1U);
    EXPECT_EQ(h.claim("theorem_4_2").events, 1U);
}

TEST(InsertionLedger, APickOutsideItsRegion) {
    History h;
    PickEvent e = h.tetrahedron(InsertionReason::sliver, {0, 1, 2, 3});
    e.point = e.point + Vec3{0.0501 * e.element.radius, 0, 0};
    h.insert(e);
    EXPECT_EQ(h.violated(), Names{"picking_region"});
    EXPECT_NE(h.claim("picking_region").witness.find("vertex 4"), std::string::npos);
    EXPECT_DOUBLE_EQ(h.claim("picking_region").where.x, e.point.x);
    e.point = e.element.centre + Vec3{0.0499 * e.element.radius, 0, 0};
    History good;
    good.insert(e);
    EXPECT_EQ(good.violated(), Names{});
    // A subsegment's region is delta R, not delta times its length.
    History segment;
    PickEvent s = segment.boundary(InsertionReason::boundary_by_sliver, 2, segment.reject(InsertionReason::sliver));
    s.point = s.element.centre + 0.04 * (segment.at(1) - segment.at(0));
    segment.insert(s);
    EXPECT_EQ(segment.violated(), Names{"picking_region"});
}

TEST(InsertionLedger, AWrongParent) {
    History h;
    PickEvent e = h.tetrahedron(InsertionReason::sliver, {0, 1, 2, 3});
    e.parent = VertexId{0};  // never the younger end of an edge
    h.insert(e);
    EXPECT_EQ(h.violated(), Names{"parent"});
    // Of a created sliver it is the youngest vertex, also if the shortest edge is elsewhere.
    History created;
    created.insert(created.tetrahedron(InsertionReason::radius_edge, {0, 1, 2, 3}));
    PickEvent child = created.tetrahedron(InsertionReason::sliver, {0, 1, 2, 4});
    child.parent = VertexId{2};
    created.insert(child);
    EXPECT_EQ(created.claim("parent").violations, 1U);
    EXPECT_EQ(created.claim("parent").events, 2U);
    // What encroaches lies in the sphere.
    History boundary;
    PickEvent split = boundary.boundary(InsertionReason::encroachment, 2, PickEvent::kNone);
    split.parent = VertexId{2};
    boundary.insert(split);
    EXPECT_EQ(boundary.violated(), Names{"parent"});
    // A split for quality has a rejected centre behind it.
    History none;
    none.insert(none.boundary(InsertionReason::boundary_by_sliver, 2, PickEvent::kNone));
    EXPECT_EQ(none.violated(), Names{"parent"});
}

TEST(InsertionLedger, AWrongOrder) {
    History h;
    PickEvent e = h.tetrahedron(InsertionReason::sliver, {0, 1, 2, 3});
    e.more_urgent = 1;
    h.insert(e);
    EXPECT_EQ(h.violated(), Names{"order"});
}

TEST(InsertionLedger, AnEdgeTooShort) {
    History h;
    PickEvent e = h.tetrahedron(InsertionReason::sliver, {0, 1, 2, 3});
    e.nearest = 0.237;  // (1 - delta) / 4 = 0.2375
    h.insert(e);
    EXPECT_EQ(h.violated(), (Names{"empty_sphere", "lemma_4_2", "theorem_4_2", "lemma_5_1_case_2"}));
}

TEST(InsertionLedger, ASplitOfTheWrongElement) {
    History h;
    PickEvent e = h.boundary(InsertionReason::boundary_by_sliver, 3, h.reject(InsertionReason::sliver));
    e.projection_depth = -0.01;
    h.insert(e);
    EXPECT_EQ(h.violated(), Names{"projection"});
    // Lemma 2.5: an element this small can't be encroached by that centre.
    History small;
    PickEvent s = small.boundary(InsertionReason::boundary_by_sliver, 3, small.reject(InsertionReason::sliver));
    s.element.radius = 0.43;  // 0.612 / sqrt(2) = 0.433
    s.nearest = 0.5;
    s.point = s.element.centre;
    small.insert(s);
    EXPECT_EQ(small.violated(), Names{"lemma_2_5"});
}

/// The event whose e_v / e_p Lemma 5.1 bounds, after what makes it that case, and with `factor` times what the bound asks.
void make_case(History& h, unsigned number, double factor) {
    PickEvent e;
    const bool boundary = number == 5 || number == 6;
    const InsertionReason first = number == 3 || number == 5 ? InsertionReason::sliver : InsertionReason::radius_edge;
    double parent = 1;
    if (number == 3 || number == 4) {
        const PickEvent maker = h.tetrahedron(first, {0, 1, 2, 3});
        h.insert(maker);
        parent = maker.nearest;
    }
    if (boundary) {
        const InsertionReason why = number == 5 ? InsertionReason::boundary_by_sliver : InsertionReason::boundary_by_radius_edge;
        const PickEvent maker = h.boundary(why, 2, h.reject(first));
        h.insert(maker);
        parent = maker.nearest;
    }
    if (number == 7) {
        const std::uint32_t rejected = h.reject(InsertionReason::sliver);
        e = h.boundary(InsertionReason::boundary_by_sliver, 3, rejected);
        parent = h.tetrahedron(InsertionReason::sliver, {0, 1, 2, 3}).nearest;
    } else if (number < 3) {
        e = h.tetrahedron(number == 1 ? InsertionReason::radius_edge : InsertionReason::sliver, {0, 1, 2, 3});
    } else {
        e = h.tetrahedron(InsertionReason::sliver, {0, 2, 3, 4});
    }
    e.nearest = factor * insertion_factor(number, kConstants) * parent;
    h.insert(e);
}

TEST(InsertionLedger, EachCaseOfLemma51OnBothSidesOfItsBound) {
    for (unsigned number = 1; number <= 7; ++number) {
        const std::string name = "lemma_5_1_case_" + std::to_string(number);
        History good, bad;
        make_case(good, number, 1.0001);
        make_case(bad, number, 0.9999);
        EXPECT_EQ(good.claim(name).violations, 0U) << number;
        EXPECT_GE(good.claim(name).events, 1U) << number;
        EXPECT_EQ(bad.claim(name).violations, 1U) << number;
        EXPECT_NE(bad.claim(name).witness.find("case " + std::to_string(number)), std::string::npos) << bad.claim(name).witness;
    }
}

TEST(InsertionLedger, EachLemmaOfSection4OnBothSidesOfItsBound) {
    const std::vector<std::pair<unsigned, std::string>> lemmas = {{1, "lemma_4_3"}, {2, "lemma_4_2"}, {3, "lemma_4_4"}, {4, "lemma_4_5"}, {5, "lemma_4_6_sliver"}, {6, "lemma_4_6_radius_edge"}};
    for (const auto& [number, name] : lemmas)
        for (const double factor : {1.0001, 0.9999}) {
            // What the lemma compares with has length 1 everywhere: the original tetrahedron's edges, and the subsegment's.
            History h;
            make_case(h, number, 1);  // leaves an event of this claim; now one with the length that is asked
            History probe;
            const double bound = probe.claim(name).bound;
            const double parent = number == 3 || number == 4 ? std::sqrt(0.375) : number >= 5 ? 0.5 : 1.0;
            make_case(probe, number, factor * bound / (insertion_factor(number, kConstants) * parent));
            const InvariantClaim claim = probe.claim(name);
            EXPECT_EQ(claim.violations, factor < 1 ? 1U : 0U) << name << ": " << claim.worst << " against " << claim.bound;
            EXPECT_GE(claim.events, 1U);
        }
}

TEST(InsertionLedger, PicksThatCouldNotAvoidSliversAreCountedAndAskNothingOfTheirSlivers) {
    History h;
    PickEvent e = h.tetrahedron(InsertionReason::sliver, {0, 1, 2, 3});
    e.sliver_free = false;
    h.insert(e);
    PickEvent child = h.tetrahedron(InsertionReason::sliver, {0, 1, 2, 4});
    h.insert(child);
    EXPECT_EQ(h.claim("theorem_4_1").violations, 1U);
    EXPECT_EQ(h.claim("lemma_5_1_case_3").events, 0U);
    EXPECT_EQ(h.claim("lemma_4_4").events, 0U);
}

TEST(InsertionLedger, SplitsForEncroachingVerticesLowerTheReference) {
    History h;
    PickEvent e = h.boundary(InsertionReason::encroachment, 2, PickEvent::kNone);
    e.parent = VertexId{0};
    e.nearest = 0.01;
    h.insert(e);
    EXPECT_EQ(h.violated(), Names{});
    EXPECT_DOUBLE_EQ(h.ledger.reference_edge(), 0.01);
    h.ledger.check_density([](const Vec3&) { return 0.0100; });
    EXPECT_EQ(h.claim("encroaching_vertex").violations, 0U);
    History bad;
    bad.insert(e);
    bad.ledger.check_density([](const Vec3&) { return 0.0111; });  // alpha = 1.105
    EXPECT_EQ(bad.claim("encroaching_vertex").violations, 1U);
}

TEST(InsertionLedger, DensityAgainstEachOfTheThreeBounds) {
    const DensityBounds d = density_bounds(kConstants);
    const std::vector<std::tuple<unsigned, std::string, double>> kinds = {{2, "theorem_5_1_segments", d.d1}, {3, "theorem_5_1_facets", d.d2}, {4, "theorem_5_1_inside", d.d3}};
    for (const auto& [size, name, bound] : kinds)
        for (const double factor : {0.9999, 1.0001}) {
            History h;
            double nearest = 0;
            if (size == 4) {
                const PickEvent e = h.tetrahedron(InsertionReason::sliver, {0, 1, 2, 3});
                nearest = e.nearest;
                h.insert(e);
            } else {
                const PickEvent e = h.boundary(InsertionReason::boundary_by_sliver, size, h.reject(InsertionReason::sliver));
                nearest = e.nearest;
                h.insert(e);
            }
            const Vec3 last = h.at(4);
            h.ledger.check_density([&](const Vec3& x) { return x == last ? factor * bound * nearest : 0.1; });
            EXPECT_EQ(h.claim(name).violations, factor > 1 ? 1U : 0U) << name;
            EXPECT_EQ(h.claim("lemma_5_2").violations, 1U);  // the parent's density doesn't explain it
        }
    History input;
    input.ledger.check_density([](const Vec3&) { return 1.01; });
    EXPECT_EQ(input.claim("lemma_5_1_input").violations, 4U);
}

TEST(InsertionLedger, TheFirstWitnessStays) {
    History h;
    for (const double offset : {0.06, 0.5}) {
        PickEvent e = h.tetrahedron(InsertionReason::sliver, {0, 1, 2, 3});
        e.point = e.point + Vec3{offset * e.element.radius, 0, 0};
        h.insert(e);
    }
    const InvariantClaim claim = h.claim("picking_region");
    EXPECT_EQ(claim.violations, 2U);
    EXPECT_NEAR(claim.worst, 0.5, 1e-12);
    EXPECT_NE(claim.witness.find("vertex 4"), std::string::npos);
    EXPECT_EQ(h.ledger.report().violations(), 2U);
}

}  // namespace
}  // namespace wellmesh::testing
