// SPDX-License-Identifier: Apache-2.0
// Which cell of the input a point lies on, within a tolerance: the lowest-dimensional one, and of several the nearest.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "validation/box_tree.hpp"
#include "validation/valid_plc.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

struct Carrier {
    CarrierKind kind = CarrierKind::region;
    std::uint32_t id = 0;  ///< VertexId, SegmentId or FacetId value
    double distance = 0;   ///< of the point that was asked for, input units
    Vec3 point{};          ///< on the carrier, up to rounding
};

class CarrierFinder {
public:
    /// @param tolerance  input units; a facet's own tolerance is allowed on top. @param plc  must outlive the finder.
    CarrierFinder(const ValidPlc& plc, double tolerance);
    CarrierFinder(const CarrierFinder&) = delete;
    CarrierFinder& operator=(const CarrierFinder&) = delete;

    /// @param facet, segment  references (number from 1) that the mesh gives for the point, 0: none. They decide where several facets or
    ///                        segments are within the tolerance, and nothing else: other tools count differently.
    /// @return nothing if the point is farther than the tolerance from every vertex, segment and facet.
    [[nodiscard]] std::optional<Carrier> find(const Vec3& p, std::int32_t facet, std::int32_t segment) const;

    /// Distance from p to the nearest facet. O(facets): for messages.
    [[nodiscard]] double distance_to_facets(const Vec3& p) const;

private:
    struct Best {
        std::uint32_t id = 0;
        double distance = std::numeric_limits<double>::infinity();
        bool named = false;
        void offer(std::uint32_t candidate, double d, bool is_named) {
            if (is_named == named ? d < distance || (d == distance && candidate < id) : is_named) *this = {candidate, d, is_named};
        }
        [[nodiscard]] bool found() const { return distance < std::numeric_limits<double>::infinity(); }
    };
    [[nodiscard]] double distance_within(std::uint32_t triangle, const Vec3& p) const;

    const ValidPlc& plc_;
    double tolerance_, reach_;
    double kept_;                          // points this near to their carrier stay where they are
    std::vector<FacetId> triangle_facet_;  // of all facets' triangles,
    std::vector<std::uint32_t> triangle_;  // and which of its facet's each is
    std::vector<Box> boxes_;               // vertices, segments, triangles, in this order
    std::optional<BoxTree> tree_;
};

}  // namespace wellmesh
