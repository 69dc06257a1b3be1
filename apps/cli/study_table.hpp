// SPDX-License-Identifier: Apache-2.0
// The rows of a study, and the two files that show them: study.csv for programs, study.html for people.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wellmesh/options.hpp"
#include "wellmesh/result.hpp"

namespace wellmesh::cli {

inline constexpr std::array kStudyStages{Stage::validate, Stage::delaunay, Stage::conform, Stage::refine, Stage::shape, Stage::extract, Stage::certify};

/// One run. Names of columns and their meaning: docs/study.md.
struct StudyRow {
    std::string model, strategy;
    std::optional<double> theta{};  ///< degrees; empty for strategy none, which has no such goal
    std::optional<std::uint64_t> seed{};
    std::optional<double> size{};   ///< edge length that was asked for, input units
    std::string status;             ///< how the run ended, or the code of its error
    std::optional<std::uint64_t> almost_good_vertices{};
    std::uint64_t vertices = 0;     ///< 0: no mesh; the fields below mean nothing then
    ShapeStatistics all{}, interior{}, boundary{};
    std::array<double, kStudyStages.size()> stage_seconds{};  ///< in the order of kStudyStages
    double seconds = 0;
    bool proven = false;
    std::string error;              ///< what the error said, or which claim was refuted

    [[nodiscard]] bool has_mesh() const { return vertices > 0; }
    [[nodiscard]] std::uint64_t tets_below(unsigned degrees) const;  ///< a multiple of 5
};

/// Fills in what the result of a run says.
void take_result(StudyRow& row, const MeshResult& result);

/// RFC 4180, lines ended by LF, a header and one line a row; numbers as the shortest decimals that read back the same, empty where there is none.
[[nodiscard]] std::string render_csv(const std::vector<StudyRow>& rows);

/// One page that needs nothing else, no network either. @param description  one line: what was studied, with what.
[[nodiscard]] std::string render_page(const std::vector<StudyRow>& rows, const std::string& description);

/// For the terminal: medians over seeds.
[[nodiscard]] std::string render_summary(const std::vector<StudyRow>& rows);

}  // namespace wellmesh::cli
