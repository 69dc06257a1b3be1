// SPDX-License-Identifier: Apache-2.0
// The account of a run's insertions and the claims of [LiTeng01] about them. Fed with events; knows no mesh, so that a test can feed it wrong ones.
// docs/theory.md states every claim, with what is corrected in it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "conforming/insertion_recorder.hpp"
#include "theory/constants.hpp"
#include "wellmesh/invariants.hpp"

namespace wellmesh {

/// The claims, in the order of the report.
enum class ClaimId : std::uint8_t {
    lemma_2_1, picking_region, empty_sphere, lemma_2_5, projection, order, parent, theorem_4_1, lemma_4_2, lemma_4_3, lemma_4_4, lemma_4_5,
    lemma_4_6_radius_edge, lemma_4_6_sliver, theorem_4_2, lemma_5_1_input, lemma_5_1_case_1, lemma_5_1_case_2, lemma_5_1_case_3, lemma_5_1_case_4,
    lemma_5_1_case_5, lemma_5_1_case_6, lemma_5_1_case_7, encroaching_vertex, lemma_5_2, theorem_5_1_segments, theorem_5_1_facets, theorem_5_1_inside,
    theorem_5_2, theorem_5_3, count
};

class InsertionLedger {
public:
    /// @param position_error  how far rounding may put a point from where it belongs, input units: bounds the rounding of every claim.
    InsertionLedger(const TheoryConstants& constants, double position_error);

    /// Input vertices first, in the order of their ids; `nearest` is the distance to the nearest other one.
    void add_input(const Vec3& point, double nearest);
    /// @return the event's number.
    std::uint32_t add(const PickEvent& event);
    /// What stands now is the paper's original mesh; its shortest edge is l_org. Only the first call counts.
    void set_original(double shortest_edge);
    [[nodiscard]] bool has_original() const { return original_vertices_ != kUnknown; }
    [[nodiscard]] std::size_t vertices() const { return vertex_record_.size(); }
    [[nodiscard]] const Vec3& point(std::size_t vertex) const { return records_[vertex_record_[vertex]].point; }

    /// Checks the claims about lfs, once all events are in.
    void check_density(const std::function<double(const Vec3&)>& local_feature_size);
    /// One more value for a claim, about `where`; for those that speak of the final mesh.
    void observe(ClaimId claim, double value, double slack, const Vec3& where, const std::string& witness);
    /// l_org, or a shorter edge that was made since by a split that is none of the paper's: for size, or because a mesh vertex encroaches.
    [[nodiscard]] double reference_edge() const { return reference_edge_; }

    [[nodiscard]] InvariantReport report() const;
    [[nodiscard]] const TheoryConstants& constants() const { return constants_; }
    [[nodiscard]] double position_error() const { return position_error_; }

private:
    static constexpr std::size_t kUnknown = static_cast<std::size_t>(-1);
    static constexpr std::uint32_t kNone = PickEvent::kNone;

    /// The bad tetrahedron that a chain of splits began with.
    enum class Root : std::uint8_t { none, size, radius_edge, sliver };

    struct Record {
        Vec3 point{};
        double nearest = 0;             // e_v
        double radius = 0;              // of the element
        double shortest = 0;            // edge of the element
        double slack = 0;               // relative rounding of what is compared
        double reference = 0;           // length that the Lemma 4.x of the root compares edges with
        std::uint32_t vertex = kNone;   // kNone: rejected
        std::uint32_t parent = kNone;   // record
        std::uint8_t element = 0;       // its number of corners
        std::uint8_t lemma_case = 0;    // 1 to 7, or 0
        InsertionReason reason = InsertionReason::input;
        Root root = Root::none;
        bool original_sliver = false;
        bool sliver_free = true;
        bool direct = true;             // linked to the root's tetrahedron by rejected points only
        bool after_original = false;
        bool by_vertex = false;         // split because a mesh vertex encroaches
        ClaimId edge_claim = ClaimId::count;
    };

    InvariantClaim& at(ClaimId id) { return claims_[static_cast<std::size_t>(id)]; }
    void check(ClaimId id, double value, const Record& record, double more_slack = 0);
    void check_ratio(const Record& record);
    void describe_element(Record& record, const PickEvent& event) const;
    void take_tetrahedron(Record& record, const PickEvent& event);
    void take_boundary(Record& record, const PickEvent& event);
    void check_parent_of_tetrahedron(const Record& record, const PickEvent& event);
    void find_edge_claim(Record& record);
    void check_edges(const Record& record);
    [[nodiscard]] std::string describe(const Record& record) const;
    [[nodiscard]] bool is_original(VertexId v) const { return has_original() && v.index() < original_vertices_; }

    TheoryConstants constants_;
    double position_error_;
    double original_edge_ = 0, reference_edge_ = 0;
    std::size_t original_vertices_ = kUnknown;
    std::vector<Record> records_;
    std::vector<std::uint32_t> vertex_record_;
    std::array<InvariantClaim, static_cast<std::size_t>(ClaimId::count)> claims_;
};

}  // namespace wellmesh
