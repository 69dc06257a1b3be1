// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "conforming/conforming_mesh.hpp"
#include "core/workers.hpp"
#include "refinement/refine.hpp"
#include "wellmesh/exemption.hpp"
#include "wellmesh/options.hpp"
#include "wellmesh/result.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh {

/// The tetrahedra, in the order of the output, that miss a quality goal and touch an acute feature of the input, or lie in a gap that was left. Others
/// that miss one are not excused.
/// @param first_number  of vertices in the source's own counting.
[[nodiscard]] std::vector<Exemption> list_exemptions(const ConformingMesh& mesh, std::span<const TetId> order, Refiner& refiner, const MeshOptions& options,
                                                     std::uint32_t first_number, Workers& workers);

/// Of the gaps that were left, and how many of the exemptions lie in them; nothing if none does.
[[nodiscard]] std::optional<GapStatistics> gaps_left(const std::vector<Exemption>& exemptions, const ConformingMesh& mesh, const Refiner& refiner, std::uint32_t first_number);

/// The exemptions of a mesh whose tetrahedra are about to change. Those that come out of it as they were stay exempt, under their new number; new ones
/// never are.
class ExemptionKeeper {
public:
    ExemptionKeeper(const TetMesh& mesh, std::vector<Exemption> exemptions);
    [[nodiscard]] std::vector<Exemption> of(const TetMesh& mesh) const;

private:
    std::map<std::array<std::uint32_t, 4>, Exemption> by_corners_;  // ascending
};

}  // namespace wellmesh
