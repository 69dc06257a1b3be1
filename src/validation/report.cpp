// SPDX-License-Identifier: Apache-2.0
#include "validation/report.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace wellmesh {
namespace {

constexpr std::size_t kShownPerKind = 3;      // enough to see a pattern; the full list is in the diagnosis
constexpr std::size_t kOffendersInError = 100000;  // an exception that weighs more than its input helps nobody

std::string with_line(const char* kind, std::uint64_t number, const std::vector<std::uint32_t>& lines, std::size_t index) {
    if (index < lines.size() && lines[index] != 0) return fmt::format("{} {} (line {})", kind, number, lines[index]);
    return fmt::format("{} {}", kind, number);
}

std::size_t of_source(const std::vector<std::uint32_t>* numbers, std::size_t i) { return numbers && i < numbers->size() ? (*numbers)[i] : i; }

}  // namespace

void Report::add(DefectKind kind, Severity severity, std::vector<ElementRef> elements, std::string message, double value,
                 std::vector<Vec3> points) {
    errors_ += severity == Severity::error;
    defects_.push_back({kind, severity, std::move(elements), std::move(message), value, std::move(points)});
}

ElementRef Report::vertex(std::size_t input_vertex) const {
    ElementRef ref{EntityKind::vertex, of_source(source_ ? &source_->vertex : nullptr, input_vertex) + plc_.first_number, std::nullopt};
    if (input_vertex < plc_.vertices.size()) ref.where = plc_.vertices[input_vertex];
    return ref;
}

ElementRef Report::facet(std::size_t input_facet, std::optional<Vec3> where) const {
    return {EntityKind::facet, of_source(source_ ? &source_->facet : nullptr, input_facet) + plc_.first_number, where};
}

std::string Report::name_vertex(std::size_t input_vertex) const {
    const std::size_t number = of_source(source_ ? &source_->vertex : nullptr, input_vertex);
    return with_line(number == input_vertex ? "vertex" : "a vertex made near vertex", number + plc_.first_number, plc_.vertex_lines, number);
}

std::string Report::name_facet(std::size_t input_facet) const {
    const std::size_t number = of_source(source_ ? &source_->facet : nullptr, input_facet);
    return with_line("facet", number + plc_.first_number, plc_.facet_lines, number);
}

std::size_t Report::count(DefectKind kind, Severity severity) const {
    return static_cast<std::size_t>(
        std::count_if(defects_.begin(), defects_.end(), [&](const Defect& d) { return d.kind == kind && d.severity == severity; }));
}

std::vector<Defect> Report::take() {
    std::stable_sort(defects_.begin(), defects_.end(), [](const Defect& a, const Defect& b) {
        if (a.severity != b.severity) return a.severity > b.severity;
        return a.kind < b.kind;
    });
    errors_ = 0;
    return std::move(defects_);
}

std::string format_point(const Vec3& p) { return fmt::format("({:.9g}, {:.9g}, {:.9g})", p.x, p.y, p.z); }

void throw_if_invalid(const Diagnosis& diagnosis, const std::string& source_name) {
    if (!diagnosis.has_errors()) return;
    std::string counts, details;
    std::vector<ElementRef> offenders;
    ErrorCode code = ErrorCode::coordinate_range;
    for (auto first = diagnosis.defects.begin(); first != diagnosis.defects.end() && first->severity == Severity::error;) {
        const auto last = std::find_if(first, diagnosis.defects.end(),
                                       [&](const Defect& d) { return d.severity != Severity::error || d.kind != first->kind; });
        const auto n = static_cast<std::size_t>(last - first);
        if (first->kind != DefectKind::coordinate_range) code = ErrorCode::bad_input;
        counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", n, to_string(first->kind));
        for (std::size_t i = 0; i < std::min(n, kShownPerKind); ++i)
            details += fmt::format("\n  {}: {}", to_string(first->kind), (first + static_cast<std::ptrdiff_t>(i))->message);
        if (n > kShownPerKind) details += fmt::format("\n  {}: and {} more", to_string(first->kind), n - kShownPerKind);
        for (; first != last; ++first)
            for (const ElementRef& e : first->elements)
                if (offenders.size() < kOffendersInError) offenders.push_back(e);
    }
    throw MeshError(code, Stage::validate,
                    fmt::format("{}the input is not a valid complex: {}{}", source_name.empty() ? "" : source_name + ": ", counts, details),
                    std::move(offenders));
}

}  // namespace wellmesh
