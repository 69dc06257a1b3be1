// SPDX-License-Identifier: Apache-2.0
// The points that segments and facets need to be as fine as the size asks, found on each segment and in each facet's plane by itself, before any of them is
// in the mesh: then they go in at once, with the lattice (lattice_seeding.hpp), which takes a fraction of the time of splitting the boundary in space.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "conforming/acute_geometry.hpp"
#include "conforming/conforming_mesh.hpp"
#include "core/shared_guard.hpp"
#include "core/workers.hpp"

namespace wellmesh {

/// What the boundary of a mesh will be once the points are in it, unless they are too near to something else. Vertices of the mesh go by their own numbers, point k
/// by that of the next vertex, and k more.
struct BoundarySample {
    struct Point {
        CarriedPoint at;
        VertexId ball{};  ///< as in VertexInfo
    };
    std::vector<Point> points;
    std::vector<VertexId> vertices;  ///< once they have numbers in the mesh, ascending
    std::vector<Subsegment> segments;
    std::vector<Subface> faces;
};

/// Splits subsegments into equal pieces, then refines the Delaunay triangulation of each facet (planar_refiner.hpp). Balls about acute vertices stay as they are.
/// What is not found here, or not right, is left as it was: splitting in space goes on from there.
/// @param mesh  conforms; where sizes vary segments without facets are left to splitting in space
/// @param radius  (point, cell) -> greatest circumradius of tetrahedra there; infinite: none asked for. From any thread
/// @param varies  whether that depends on the point  @return nothing if the guard said stop
[[nodiscard]] std::optional<BoundarySample> sample_boundary(const ConformingMesh& mesh, const AcuteGeometry& acute, const std::function<double(const Vec3&, CellId)>& radius,
                                                            bool varies, std::uint64_t seed, Workers& workers, SharedGuard& guard);

}  // namespace wellmesh
