// SPDX-License-Identifier: Apache-2.0
// Reports for people: plain text tables.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "wellmesh/certificate.hpp"
#include "wellmesh/diagnosis.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh::cli {

[[nodiscard]] std::string describe(const ElementRef& element);                    ///< e.g. "facet 12 at (0, 1, 2)"
[[nodiscard]] std::string describe(const std::vector<ElementRef>& elements, std::size_t at_most);
[[nodiscard]] const char* to_string(Claim::State state) noexcept;
[[nodiscard]] const char* to_string(Severity severity) noexcept;

[[nodiscard]] std::string render_goals(const std::vector<AskedAchieved>& goals);
[[nodiscard]] std::string render_claims(const Certificate& certificate);
[[nodiscard]] std::string render_shape(const Certificate& certificate);           ///< all, interior, boundary side by side
[[nodiscard]] std::string render_histogram(const ShapeStatistics& statistics);
[[nodiscard]] std::string render_invariants(const InvariantReport& report);
/// How many tetrahedra acute angles force below the goals, and the sharpest of these angles. @pre there are any
[[nodiscard]] std::string render_exemptions(const MeshResult& result);
[[nodiscard]] std::string render_given(const GivenMeshStatistics& given);        ///< a few lines
[[nodiscard]] std::string render_regions(const Certificate& certificate);
[[nodiscard]] std::string render_stages(const std::vector<StageTime>& stages);
/// Of each kind of defect, at most so many.
[[nodiscard]] std::string render_diagnosis(const Diagnosis& diagnosis, std::size_t most_of_a_kind);
/// The first `most` cells of the input. Empty if there are none.
[[nodiscard]] std::string render_cells(const std::vector<CellSummary>& cells, std::size_t most = static_cast<std::size_t>(-1));

}  // namespace wellmesh::cli
