// SPDX-License-Identifier: Apache-2.0
#include "study_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tuple>

#include "study_page_template.hpp"
#include "text_table.hpp"
#include "wellmesh/version.hpp"

namespace wellmesh::cli {

namespace {

constexpr unsigned kDegreesABin = 5;  // of ShapeStatistics::min_dihedral_histogram
constexpr std::array kBelow{5U, 10U, 15U, 20U};

using Cell = std::pair<std::string, std::string>;  // column, value

std::string in_cell(double value) { return std::isfinite(value) ? fmt::format("{}", value) : std::string(); }
template <class T>
std::string in_cell(const std::optional<T>& value) {
    return value ? fmt::format("{}", *value) : std::string();
}

/// Every column of the table, in order.
std::vector<Cell> cells(const StudyRow& row) {
    std::vector<Cell> out{{"model", row.model}, {"strategy", row.strategy}, {"theta_deg", in_cell(row.theta)}, {"seed", in_cell(row.seed)}, {"size", in_cell(row.size)},
                          {"status", row.status}};
    const auto add = [&](std::string column, const std::string& value) { out.emplace_back(std::move(column), row.has_mesh() ? value : std::string()); };
    add("vertices", fmt::format("{}", row.vertices));
    out.emplace_back("almost_good_vertices", in_cell(row.almost_good_vertices));
    add("vertices_over_almost_good", row.almost_good_vertices ? in_cell(static_cast<double>(row.vertices) / static_cast<double>(*row.almost_good_vertices)) : std::string());
    add("tets", fmt::format("{}", row.all.tets));
    // Without a tetrahedron inside (or at the boundary) there is no extreme there.
    const auto extreme = [](const ShapeStatistics& s, double value) { return s.tets > 0 ? in_cell(value) : std::string(); };
    add("min_dihedral_interior_deg", extreme(row.interior, row.interior.min_dihedral_angle_deg));
    add("min_dihedral_boundary_deg", extreme(row.boundary, row.boundary.min_dihedral_angle_deg));
    add("max_dihedral_interior_deg", extreme(row.interior, row.interior.max_dihedral_angle_deg));
    add("max_dihedral_boundary_deg", extreme(row.boundary, row.boundary.max_dihedral_angle_deg));
    add("max_radius_edge", in_cell(row.all.max_radius_edge_ratio));
    add("max_aspect_ratio", in_cell(row.all.max_aspect_ratio));
    add("min_sigma", in_cell(row.all.min_sigma));
    for (const unsigned degrees : kBelow) add(fmt::format("tets_below_{}_deg", degrees), fmt::format("{}", row.tets_below(degrees)));
    for (std::size_t i = 0; i < kStudyStages.size(); ++i) add(fmt::format("seconds_{}", to_string(kStudyStages[i])), fmt::format("{:.4f}", row.stage_seconds[i]));
    out.emplace_back("seconds", fmt::format("{:.4f}", row.seconds));
    add("certificate", row.proven ? "proven" : "refuted");
    out.emplace_back("error", row.error);
    return out;
}

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted(1, '"');
    for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
    quoted += '"';
    return quoted;
}

std::string csv_line(const std::vector<Cell>& line, std::string Cell::*part) {
    std::string text;
    for (const Cell& cell : line) {
        if (&cell != &line.front()) text += ',';
        text += csv_field(cell.*part);
    }
    text += '\n';
    return text;
}

std::string html_text(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&': out += "&amp;"; break;
            case '<': out += "&lt;"; break;
            case '>': out += "&gt;"; break;
            case '"': out += "&quot;"; break;
            default: out += c;
        }
    }
    return out;
}

/// What the page's script draws from. A '<' in a name must not end the element that holds it.
std::string page_data(const std::vector<StudyRow>& rows) {
    nlohmann::ordered_json data = nlohmann::ordered_json::array();
    for (const StudyRow& row : rows) {
        nlohmann::ordered_json json;
        for (const auto& [column, value] : cells(row)) json[column] = value;
        if (row.has_mesh()) json["histogram"] = row.all.min_dihedral_histogram;
        data.push_back(std::move(json));
    }
    std::string text = data.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace);
    for (std::size_t at = 0; (at = text.find('<', at)) != std::string::npos;) text.replace(at, 1, "\\u003c");
    return text;
}

/// For eyes; the page's data have all digits.
std::string shortened(const std::string& value) {
    constexpr std::size_t kLong = 8;
    double x = 0;
    const char* const end = value.data() + value.size();
    if (value.size() <= kLong || std::from_chars(value.data(), end, x).ptr != end) return value;
    return fmt::format("{:.5g}", x);
}

std::string page_table(const std::vector<StudyRow>& rows) {
    std::string text = "<thead><tr>";
    for (const Cell& cell : cells(StudyRow{})) text += fmt::format("<th>{}</th>", html_text(cell.first));
    text += "</tr></thead>\n<tbody>\n";
    for (const StudyRow& row : rows) {
        text += "<tr>";
        for (const Cell& cell : cells(row)) text += fmt::format("<td>{}</td>", html_text(shortened(cell.second)));
        text += "</tr>\n";
    }
    return text + "</tbody>";
}

double median(std::vector<double> values) {
    if (values.empty()) return std::nan("");
    std::sort(values.begin(), values.end());
    return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

}  // namespace

std::uint64_t StudyRow::tets_below(unsigned degrees) const {
    std::uint64_t n = 0;
    for (std::size_t bin = 0; bin < degrees / kDegreesABin; ++bin) n += all.min_dihedral_histogram[bin];
    return n;
}

void take_result(StudyRow& row, const MeshResult& result) {
    row.status = to_string(result.termination);
    row.vertices = result.mesh.vertices.size();
    row.all = result.certificate.all;
    row.interior = result.certificate.interior;
    row.boundary = result.certificate.boundary;
    row.proven = result.certificate.proven();
    for (const StageTime& time : result.statistics.stages) {
        row.seconds += time.seconds;
        for (std::size_t i = 0; i < kStudyStages.size(); ++i)
            if (kStudyStages[i] == time.stage) row.stage_seconds[i] += time.seconds;
    }
    for (const Claim& claim : result.certificate.claims)
        if (claim.state == Claim::State::refuted) row.error += fmt::format("{}{}: {} of {}", row.error.empty() ? "" : "; ", claim.name, claim.violations, claim.checked);
}

std::string render_csv(const std::vector<StudyRow>& rows) {
    std::string text = csv_line(cells(StudyRow{}), &Cell::first);
    for (const StudyRow& row : rows) text += csv_line(cells(row), &Cell::second);
    return text;
}

std::string render_page(const std::vector<StudyRow>& rows, const std::string& description) {
    std::string page = kStudyPageTemplate;
    const auto fill = [&page](std::string_view place, const std::string& text) {
        if (const std::size_t at = page.find(place); at != std::string::npos) page.replace(at, place.size(), text);
    };
    // In this order: what is filled in is not searched for places.
    fill("{{data}}", page_data(rows));
    fill("{{table}}", page_table(rows));
    fill("{{version}}", "wellmesh " WELLMESH_VERSION);
    fill("{{description}}", html_text(description));
    return page;
}

std::string render_summary(const std::vector<StudyRow>& rows) {
    using Align = TextTable::Align;
    TextTable table({{"model"}, {"strategy"}, {"theta", Align::right}, {"runs", Align::right}, {"reached", Align::right}, {"least angle", Align::right},
                     {"inside", Align::right}, {"at boundary", Align::right}, {"vertices / almost good", Align::right}, {"R/r", Align::right}, {"seconds", Align::right}});
    using Key = std::tuple<std::string, double, std::string, double>;  // model, size, strategy, theta
    std::vector<Key> order;
    std::map<Key, std::vector<const StudyRow*>> groups;
    for (const StudyRow& row : rows) {
        const Key key{row.model, row.size.value_or(0), row.strategy, row.theta.value_or(-1)};
        auto& group = groups[key];
        if (group.empty()) order.push_back(key);
        group.push_back(&row);
    }
    for (const Key& key : order) {
        std::vector<double> inside, boundary, ratio, aspect, seconds;
        std::size_t reached = 0;
        double least = 180;
        const auto& group = groups[key];
        for (const StudyRow* row : group) {
            if (!row->has_mesh()) continue;
            reached += row->status == to_string(Termination::goals_met);
            least = std::min(least, row->all.min_dihedral_angle_deg);
            if (row->interior.tets > 0) inside.push_back(row->interior.min_dihedral_angle_deg);
            if (row->boundary.tets > 0) boundary.push_back(row->boundary.min_dihedral_angle_deg);
            if (row->almost_good_vertices) ratio.push_back(static_cast<double>(row->vertices) / static_cast<double>(*row->almost_good_vertices));
            aspect.push_back(row->all.max_aspect_ratio);
            seconds.push_back(row->seconds);
        }
        const auto shown = [](const std::vector<double>& values, const char* format) { return values.empty() ? std::string("-") : fmt::format(fmt::runtime(format), median(values)); };
        const StudyRow& first = *group.front();
        const std::string name = first.size ? fmt::format("{} size {:.4g}", first.model, *first.size) : first.model;
        table.add({name, first.strategy, first.theta ? fmt::format("{}", *first.theta) : "-", fmt::format("{}", group.size()), fmt::format("{}", reached),
                   aspect.empty() ? "-" : fmt::format("{:.2f}", least), shown(inside, "{:.2f}"), shown(boundary, "{:.2f}"), shown(ratio, "{:.3f}"), shown(aspect, "{:.2f}"),
                   shown(seconds, "{:.2f}")});
    }
    return "Medians over seeds (least angle: the worst)\n" + table.str();
}

}  // namespace wellmesh::cli
