// SPDX-License-Identifier: Apache-2.0
// Keeps the account of a run: takes its events, and looks at the mesh where the paper speaks of a mesh.
#pragma once

#include <optional>

#include "conforming/conforming_mesh.hpp"
#include "theory/insertion_ledger.hpp"
#include "validation/local_feature_size.hpp"

namespace wellmesh {

class RunRecorder final : public InsertionRecorder {
public:
    /// @param mesh   triangulates the input's vertices and nothing else yet.
    /// @param sized  the run has size goals: the mesh that meets them is the paper's original mesh, and its spacing bounds lfs, too.
    RunRecorder(const ConformingMesh& mesh, const TheoryConstants& constants, bool sized);

    std::uint32_t on_pick(const PickEvent& event) override;
    void on_milestone(Milestone reached) override;

    /// Checks what is left, on the mesh as it is, and reports. To be called once.
    [[nodiscard]] InvariantReport finish();

private:
    void enter_unpicked(std::size_t vertices);
    [[nodiscard]] double local_feature_size(const Vec3& x) const;
    [[nodiscard]] std::vector<double> nearest_neighbours() const;
    double check_final_tetrahedra();  ///< @return the shortest edge
    void check_final_vertices();

    const ConformingMesh& mesh_;
    InsertionLedger ledger_;
    LocalFeatureSize complex_lfs_;
    bool sized_;
    std::optional<SpacingOfPoints> original_spacing_;
    std::uint64_t almost_good_vertices_ = 0;
};

}  // namespace wellmesh
