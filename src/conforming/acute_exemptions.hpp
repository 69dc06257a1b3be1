// SPDX-License-Identifier: Apache-2.0
// Which bad tetrahedra the input's own acute angles force (docs/algorithm/acute.md).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "conforming/acute_geometry.hpp"
#include "conforming/conforming_mesh.hpp"

namespace wellmesh {

/// The acute feature that forces a tetrahedron.
struct ForcedBy {
    EntityKind kind = EntityKind::vertex;  ///< vertex or segment
    std::uint32_t id = 0;                  ///< VertexId or SegmentId value
    double angle_deg = 0;                  ///< the input's angle there
};

class AcuteExemptions {
public:
    AcuteExemptions(const ConformingMesh& mesh, AcuteGeometry& acute);

    /// Is the tetrahedron's shortest edge short because its ends lie on two cells of the input that meet at an acute angle?
    [[nodiscard]] bool forces_shortest_edge(TetId t) const;
    /// The acute feature that this tetrahedron touches: two of its vertices lie on different cells that meet there at an acute angle as seen from
    /// them, or one is on the sphere of a ball about it, or the ball holds the circumcentre, or the shortest edge ends in a copy about it; in that
    /// order, and of the first kind the sharpest. Empty if there is none.
    [[nodiscard]] std::optional<ForcedBy> feature_at(TetId t) const;
    /// The same of an acute input vertex.
    [[nodiscard]] std::optional<ForcedBy> feature_at(VertexId v) const;

private:
    struct Meeting {
        ForcedBy feature{};
        double seen_deg = 180;  ///< angle between the two points as seen from the feature
    };
    [[nodiscard]] std::optional<Meeting> meeting_of(VertexId p, VertexId q) const;
    [[nodiscard]] std::array<VertexId, 2> shortest_edge(TetId t) const;
    [[nodiscard]] std::optional<ForcedBy> origin_of_copy(TetId t) const;
    [[nodiscard]] bool holds_centre(TetId t, VertexId v) const;
    void meet_at_vertex(VertexId v, const Vec3& p, const Vec3& q, std::optional<Meeting>& best) const;
    void meet_at_segment(SegmentId s, const Vec3& p, const Vec3& q, std::optional<Meeting>& best) const;
    [[nodiscard]] bool on_boundary(VertexId v) const { return v != kInfiniteVertex && mesh_.info(v).carrier != CarrierKind::region; }

    const ConformingMesh& mesh_;
    AcuteGeometry& acute_;  // it finds radii when asked
    std::vector<double> vertex_deg_, segment_deg_;  // acute angle at each input vertex and segment; 180: none
};

}  // namespace wellmesh
