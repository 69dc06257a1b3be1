// SPDX-License-Identifier: Apache-2.0
// Collects what is wrong with an input, in the words and numbers of its source.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "wellmesh/diagnosis.hpp"
#include "wellmesh/plc.hpp"

namespace wellmesh {

/// Which entities of the source those of a complex that was derived from it stand for.
struct SourceNumbers {
    std::vector<std::uint32_t> vertex;  ///< for each vertex; those after the source's own stand near the one given
    std::vector<std::uint32_t> facet;   ///< for each facet
};

class Report {
public:
    explicit Report(const Plc& plc, const SourceNumbers* source = nullptr) : plc_(plc), source_(source) {}

    void add(DefectKind kind, Severity severity, std::vector<ElementRef> elements, std::string message, double value = 0,
             std::vector<Vec3> points = {});

    /// References to entities of the input; `input_*` count from 0, the results as the source counts.
    [[nodiscard]] ElementRef vertex(std::size_t input_vertex) const;
    [[nodiscard]] ElementRef facet(std::size_t input_facet, std::optional<Vec3> where = std::nullopt) const;

    /// "vertex 12 (line 40)", "facet 3 (line 71)".
    [[nodiscard]] std::string name_vertex(std::size_t input_vertex) const;
    [[nodiscard]] std::string name_facet(std::size_t input_facet) const;

    [[nodiscard]] bool has_errors() const { return errors_ != 0; }
    [[nodiscard]] std::size_t count(DefectKind kind, Severity severity) const;
    [[nodiscard]] const Plc& plc() const { return plc_; }

    /// All defects: errors first, then by severity and kind, otherwise in the order found.
    [[nodiscard]] std::vector<Defect> take();

private:
    const Plc& plc_;
    const SourceNumbers* source_;
    std::vector<Defect> defects_;
    std::size_t errors_ = 0;
};

/// "(x, y, z)" with as many digits as tell doubles apart at the scale of a message (9).
[[nodiscard]] std::string format_point(const Vec3& p);

/// Throws bad_input, or coordinate_range when only that is wrong, if `diagnosis` has errors: counts by kind, the first few of each,
/// and all offenders.
void throw_if_invalid(const Diagnosis& diagnosis, const std::string& source_name);

}  // namespace wellmesh
