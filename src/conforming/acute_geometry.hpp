// SPDX-License-Identifier: Apache-2.0
// What meets what at an acute angle, and where splits go there so that they end (docs/algorithm/acute.md).
//
// Two segments or facets that meet at less than 90 degrees can encroach each other for ever when they are split at their midpoints and
// circumcentres. So they copy each other instead: what is encroached by a vertex of a feature that it meets is split at that vertex's copy,
// as far from the shared vertex, or as far along and from the shared segment. The copy lies inside the encroached sphere, and never
// encroaches where the original stands. A ball about each acute vertex is left empty: the features that leave it are cut on its sphere.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "conforming/conforming_mesh.hpp"
#include "core/checkpoint.hpp"
#include "core/compressed_rows.hpp"
#include "core/workers.hpp"
#include "validation/local_feature_size.hpp"

namespace wellmesh {

/// A point with the cells of the input that it lies on.
struct CarriedWitness {
    Vec3 point{};
    CarrierKind carrier = CarrierKind::region;
    std::uint32_t carrier_id = 0;
    std::uint8_t generation = 0;  ///< as in VertexInfo
};

/// Splits this near to the middle of a ball, in its radii, go to its sphere: the piece between would be short.
inline constexpr double kSphereReach = 1.3;

class AcuteGeometry {
public:
    /// @param has_narrow_gaps  features that do not meet have to copy each other, too
    /// @param checkpoint  called now and then on the caller's thread; may throw
    AcuteGeometry(const ValidPlc& plc, Workers& workers, bool has_narrow_gaps = false, const Checkpoint& checkpoint = {});

    /// Is there any acute angle at all? If not, nothing below is ever needed.
    [[nodiscard]] bool any() const { return any_; }
    /// Are there features that encroach each other wherever they are split, unless they copy each other?
    [[nodiscard]] bool copies() const { return copies_; }

    /// Radius of the ball about an input vertex that stays empty: a third of the local feature size if the vertex is acute or ends an acute
    /// segment, else 0.
    [[nodiscard]] double ball_radius(VertexId v) const { return v.index() < ball_.size() ? ball_[v.index()] : 0; }

    /// Boxes about all balls, empty ones left out.
    [[nodiscard]] std::vector<Box> boxes_of_balls() const;
    /// What the radii follow from, for whoever asks first. Some hundred bytes a facet. Null for input without acute angles.
    [[nodiscard]] std::unique_ptr<const LocalFeatureSize> take_feature_size() { return std::move(feature_size_); }

    /// Half of it, where a size is asked for that is finer than the ball.
    void halve_ball(VertexId v) { ball_[v.index()] /= 2; }
    /// All radii, for an undo.
    [[nodiscard]] const std::vector<double>& balls() const { return ball_; }
    void set_balls(const std::vector<double>& radii) { ball_ = radii; }

    /// Is a point of the segment in the ball of one of its ends?
    [[nodiscard]] bool in_ball_of_segment(SegmentId s, const Vec3& p) const;

    /// How far from the end `v` of segment s the witness's copy on it lies: as far as the witness itself, which must be on another segment at v,
    /// or on a facet at v that does not contain s. Empty if it has none.
    struct SegmentCopy {
        VertexId end{};
        double distance = 0;
    };
    [[nodiscard]] std::optional<SegmentCopy> copy_on_segment(SegmentId s, const CarriedWitness& q) const;

    /// The witness's copy on facet f inside the sphere of a subface: rotated about a shared segment, or else about a shared vertex.
    struct FacetCopy {
        Vec3 point{};
        std::uint8_t generation = 0;
        double lever = 0;  ///< distance of the centre from the segment that it was rotated about; infinite if swung about a vertex
    };
    [[nodiscard]] std::optional<FacetCopy> copy_on_facet(FacetId f, const CarriedWitness& q, const Vec3& centre, double radius) const;
    /// The direction, a unit vector of the facet's plane, in which the witness's copy lies as seen from v; for the arcs on the balls. The centre
    /// tells the sides of segments.
    [[nodiscard]] std::optional<Vec3> direction_on_facet(FacetId f, VertexId v, const CarriedWitness& q, const Vec3& centre) const;

    [[nodiscard]] std::span<const FacetId> facets_at(VertexId v) const { return facets_at_[v.index()]; }
    [[nodiscard]] std::span<const SegmentId> segments_at(VertexId v) const { return segments_at_[v.index()]; }
    /// Facets and segments whose closure contains a point of this carrier.
    [[nodiscard]] std::span<const FacetId> facets_of(CarrierKind carrier, std::uint32_t id) const;
    [[nodiscard]] std::span<const SegmentId> segments_of(CarrierKind carrier, std::uint32_t id) const;
    /// Segments in the closures of both facets.
    [[nodiscard]] std::span<const SegmentId> shared_segments(FacetId f, FacetId g) const;
    [[nodiscard]] bool is_on_facet(VertexId input_vertex, FacetId f) const;

private:
    struct FacetPair {
        std::uint32_t low = 0, high = 0;
        auto operator<=>(const FacetPair&) const = default;
    };
    void find_balls(Workers& workers, const Checkpoint& checkpoint);
    void list_incidences();
    void list_shared_segments();
    [[nodiscard]] std::optional<Vec3> rotated_about(SegmentId s, FacetId f, const Vec3& q, const Vec3& centre) const;
    [[nodiscard]] std::optional<Vec3> swung_about(VertexId v, FacetId f, const Vec3& q) const;
    [[nodiscard]] double stretch(VertexId v, SegmentId s) const;
    [[nodiscard]] const Vec3& point(VertexId v) const { return plc_->vertices[v.index()]; }

    const ValidPlc* plc_;
    bool any_ = false, copies_ = false;
    std::vector<double> acute_deg_;  // smallest acute angle at each input vertex; 180: none
    std::vector<double> ball_;       // radii; none: there are no acute angles
    std::unique_ptr<const LocalFeatureSize> feature_size_;
    CompressedRows<FacetId> facets_at_;  // each input vertex
    CompressedRows<SegmentId> segments_at_;
    std::vector<FacetId> ids_;  // ids_[i] = FacetId{i}: spans over single facets
    std::vector<SegmentId> segment_ids_;
    std::vector<FacetPair> pairs_;  // sorted, distinct
    CompressedRows<SegmentId> pair_segments_;
};

}  // namespace wellmesh
