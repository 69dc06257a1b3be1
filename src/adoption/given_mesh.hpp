// SPDX-License-Identifier: Apache-2.0
// What a given mesh is, whoever made it: which vertices it uses, which of them are on its hull, how much it fills.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

struct GivenMesh {
    /// Per vertex: the first one at its place. Meshes that are put together from parts have several; of these only the first one counts below.
    std::vector<std::uint32_t> first_at_place;
    std::vector<char> used;                             ///< per vertex: is it a corner of a tetrahedron?
    std::vector<char> on_hull;                          ///< per vertex: of a face that has one tetrahedron only?
    std::vector<std::array<std::uint32_t, 3>> hull;     ///< those faces
    /// Per vertex: the reference of every listed triangle (edge) that has it, or 0 if there are none or several.
    std::vector<std::int32_t> facet_reference, segment_reference;
    /// Sums over the tetrahedra, cubed input units: of volumes, however they are oriented, and of signed ones. They differ if the orientation is
    /// mixed, as some tools write it, or if tetrahedra are inverted, and in both cases one of them is the domain's.
    double volume = 0, signed_volume = 0;
};

/// @throws MeshError  bad_input: no tetrahedra, corners that do not exist, coordinates that are not finite, arrays of unequal length;
///                    coordinate_range: coordinates outside the range in which the predicates are exact.
[[nodiscard]] GivenMesh inspect_given_mesh(const TetMesh& mesh);

}  // namespace wellmesh
