// SPDX-License-Identifier: Apache-2.0
// What a run tells of every point that it picks, for whoever keeps account of the paper's claims (src/theory). Nobody listens unless asked.
#pragma once

#include <array>
#include <cstdint>

#include "conforming/conforming_mesh.hpp"

namespace wellmesh {

/// The tetrahedron, subface or subsegment whose picking region a point comes from.
struct PickedElement {
    unsigned size = 0;  ///< number of corners: 4, 3 or 2; 0: none (recovery of a missing piece)
    std::array<VertexId, 4> corners{};
    Vec3 centre{};      ///< of the smallest sphere through the corners
    double radius = 0;  ///< of that sphere, input units
};

/// A point that was inserted, or considered and rejected because it encroaches a subsegment or subface, which is split instead.
struct PickEvent {
    static constexpr std::uint32_t kNone = 0xffffffffU;

    InsertionReason reason = InsertionReason::input;
    PickedElement element{};
    Vec3 point{};
    VertexId vertex{};               ///< invalid: rejected
    VertexId parent{};               ///< the mesh vertex that is responsible; invalid when that is a rejected point, or nobody
    std::uint32_t rejected = kNone;  ///< number of the rejected point that is responsible
    double nearest = 0;              ///< e_v: distance to the nearest vertex at that moment [LiTeng01, section 5]
    bool sliver_free = true;         ///< false: no point without new small slivers was found, this is the centre
    double projection_depth = 0;     ///< subface: least barycentric coordinate of the projection of what encroaches it; below 0 it lies outside
    bool outside_rules = false;      ///< the practical mode's way with flat tetrahedra, which the paper does not know
    std::size_t more_urgent = 0;     ///< elements still waiting that should have come first [LiTeng01, 3.1]
};

class InsertionRecorder {
public:
    enum class Milestone : std::uint8_t { size_met, almost_good };

    InsertionRecorder() = default;
    InsertionRecorder(const InsertionRecorder&) = delete;
    InsertionRecorder& operator=(const InsertionRecorder&) = delete;
    virtual ~InsertionRecorder() = default;

    /// @return the event's number, by which a rejected point is named later.
    virtual std::uint32_t on_pick(const PickEvent& event) = 0;
    /// Told each time that nothing too large is left (size_met), nor anything with a large radius-edge ratio (almost_good).
    virtual void on_milestone(Milestone reached) = 0;
};

}  // namespace wellmesh
