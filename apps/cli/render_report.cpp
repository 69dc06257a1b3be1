// SPDX-License-Identifier: Apache-2.0
#include "render_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "text_table.hpp"

namespace wellmesh::cli {

namespace {

using Align = TextTable::Align;

std::string number(double value) { return fmt::format("{:.6g}", value); }
std::string count(std::uint64_t value) { return fmt::format("{}", value); }
std::string point(const Vec3& p) { return fmt::format("({:.9g}, {:.9g}, {:.9g})", p.x, p.y, p.z); }

}  // namespace

std::string describe(const ElementRef& element) {
    const bool is_line = element.kind == EntityKind::file;  // counted from 1; 0 is the file as a whole
    const std::string name = !is_line              ? fmt::format("{} {}", to_string(element.kind), element.number)
                             : element.number == 0 ? std::string("file")
                                                   : fmt::format("line {}", element.number);
    return element.where ? fmt::format("{} at {}", name, point(*element.where)) : name;
}

std::string describe(const std::vector<ElementRef>& elements, std::size_t at_most) {
    std::string text;
    for (std::size_t i = 0; i < std::min(elements.size(), at_most); ++i) text += (i > 0 ? "; " : "") + describe(elements[i]);
    if (elements.size() > at_most) text += fmt::format("; and {} more", elements.size() - at_most);
    return text;
}

const char* to_string(Claim::State state) noexcept {
    switch (state) {
        case Claim::State::not_checked: return "not checked";
        case Claim::State::proven: return "proven";
        case Claim::State::refuted: return "REFUTED";
    }
    return "?";
}

const char* to_string(Severity severity) noexcept {
    switch (severity) {
        case Severity::note: return "note";
        case Severity::warning: return "warning";
        case Severity::error: return "error";
    }
    return "?";
}

std::string render_goals(const std::vector<AskedAchieved>& goals) {
    if (goals.empty()) return {};
    TextTable table({{"goal"}, {"asked", Align::right}, {"achieved", Align::right}, {"met"}, {"missed by", Align::right}, {"worst"}});
    for (const AskedAchieved& goal : goals)
        table.add({goal.goal, number(goal.asked), number(goal.achieved), goal.met ? "yes" : "NO",
                   goal.elements_missed > 0 ? count(goal.elements_missed) : "", describe(goal.worst, 1)});
    return "Asked and achieved\n" + table.str();
}

std::string render_claims(const Certificate& certificate) {
    if (certificate.claims.empty()) return {};
    TextTable table({{"claim"}, {"state"}, {"violations", Align::right}, {"checked", Align::right}, {"statement"}});
    std::string refutations;
    for (const Claim& claim : certificate.claims) {
        const bool checked = claim.state != Claim::State::not_checked;
        table.add({claim.name, to_string(claim.state), checked ? count(claim.violations) : "", checked ? count(claim.checked) : "", claim.statement});
        if (claim.state != Claim::State::refuted) continue;
        refutations += fmt::format("  {}: {}{}{}\n", claim.name, claim.witness ? describe(*claim.witness) : "",
                                   claim.witness && !claim.detail.empty() ? ": " : "", claim.detail);
    }
    std::string text = "Certificate\n" + table.str();
    if (!refutations.empty()) text += "First witnesses\n" + refutations;
    return text;
}

std::string render_shape(const Certificate& certificate) {
    TextTable table({{"shape"}, {"all", Align::right}, {"interior", Align::right}, {"boundary", Align::right}});
    const std::array<const ShapeStatistics*, 3> sets = {&certificate.all, &certificate.interior, &certificate.boundary};
    const auto row = [&](const char* title, auto&& value) {
        std::vector<std::string> cells = {title};
        for (const ShapeStatistics* set : sets) cells.push_back(set->tets > 0 ? value(*set) : "-");
        table.add(std::move(cells));
    };
    using S = ShapeStatistics;
    row("tetrahedra", [](const S& s) { return count(s.tets); });
    row("min dihedral angle [deg]", [](const S& s) { return number(s.min_dihedral_angle_deg); });
    row("max dihedral angle [deg]", [](const S& s) { return number(s.max_dihedral_angle_deg); });
    row("max radius-edge ratio R/L", [](const S& s) { return number(s.max_radius_edge_ratio); });
    row("max aspect ratio R/r", [](const S& s) { return number(s.max_aspect_ratio); });
    row("min sigma V/L^3", [](const S& s) { return number(s.min_sigma); });
    row("min edge", [](const S& s) { return number(s.min_edge); });
    row("mean edge", [](const S& s) { return number(s.mean_edge); });
    row("max edge", [](const S& s) { return number(s.max_edge); });
    row("min volume", [](const S& s) { return number(s.min_volume); });
    row("max volume", [](const S& s) { return number(s.max_volume); });
    return "Shape\n" + table.str();
}

std::string render_histogram(const ShapeStatistics& statistics) {
    const auto& bins = statistics.min_dihedral_histogram;
    const std::uint64_t largest = *std::max_element(bins.begin(), bins.end());
    if (largest == 0) return {};
    constexpr double kBarLength = 50;
    TextTable table({{"degrees", Align::right}, {"tetrahedra", Align::right}, {""}});
    std::size_t last = bins.size();
    while (last > 0 && bins[last - 1] == 0) --last;
    for (std::size_t i = 0; i < last; ++i) {
        // Rounded up: a bin that holds anything shows something.
        const auto length = static_cast<std::size_t>(std::ceil(kBarLength * static_cast<double>(bins[i]) / static_cast<double>(largest)));
        table.add({fmt::format("{}-{}", 5 * i, 5 * i + 5), count(bins[i]), std::string(length, '#')});
    }
    return "Smallest dihedral angle of each tetrahedron\n" + table.str();
}

std::string render_invariants(const InvariantReport& report) {
    TextTable table({{"claim"}, {"bound", Align::right}, {"worst", Align::right}, {"events", Align::right}, {"violations", Align::right}, {"statement"}});
    std::string witnesses;
    for (const InvariantClaim& claim : report.claims) {
        const bool bounded = std::isfinite(claim.bound);
        table.add({claim.name, bounded ? fmt::format("{} {}", claim.at_least ? ">=" : "<=", number(claim.bound)) : "none", claim.events > 0 ? number(claim.worst) : "-",
                   count(claim.events), count(claim.violations), claim.statement});
        if (claim.violations > 0) witnesses += fmt::format("  {}: {}\n", claim.name, claim.witness);
    }
    std::string text = fmt::format("The paper's claims on the refinement's insertions: delta {:g}, b {:g}, rho0 {:g}, sigma0 {:g}", report.delta, report.b, report.rho0, report.sigma0);
    if (std::isfinite(report.log10_existence_sigma0)) text += fmt::format(" (the existence theorem's own: 10^{:.0f})", report.log10_existence_sigma0);
    text += '\n' + table.str();
    if (!witnesses.empty()) text += "First violations\n" + witnesses;
    return text;
}

std::string render_exemptions(const MeshResult& result) {
    const ShapeStatistics& all = result.certificate.all;
    const auto angle = [](const Exemption& e) { return e.angle_deg > 0 ? e.angle_deg : 180; };  // gaps have none
    const Exemption& sharpest = *std::min_element(result.exemptions.begin(), result.exemptions.end(), [&](const Exemption& a, const Exemption& b) { return angle(a) < angle(b); });
    if (!(sharpest.angle_deg > 0))
        return fmt::format("note: {} tetrahedra lie in gaps that are left and are exempt: {:.4g} degrees and R/L {:.4g} with them; --exemptions FILE lists them\n",
                           result.exemptions.size(), all.min_dihedral_angle_deg, all.max_radius_edge_ratio);
    return fmt::format("note: {} tetrahedra miss a goal because acute angles of the input force them to{}, and are exempt: {:.4g} degrees and R/L {:.4g} with them; the sharpest angle is\n"
                       "      {:.4g} degrees at {}; --exemptions FILE lists them\n",
                       result.exemptions.size(), result.statistics.gaps ? " or because they lie in gaps that are left" : "", all.min_dihedral_angle_deg,
                       all.max_radius_edge_ratio, sharpest.angle_deg, describe(sharpest.feature));
}

std::string render_given(const GivenMeshStatistics& given) {
    std::string text = fmt::format("the given mesh: {} vertices; {} of its {} tetrahedra are Delaunay; smallest dihedral angle {:.4g} degrees\n", given.vertices,
                                   given.delaunay_tets, given.tets, given.min_dihedral_angle_deg);
    const auto line = [&](std::uint64_t count, const char* what) {
        if (count > 0) text += fmt::format("  {} {}\n", count, what);
    };
    if (given.moved_onto_input > 0)
        text += fmt::format("  {} vertices moved onto the input, by at most {:.4g}\n", given.moved_onto_input, given.farthest_vertex);
    line(given.dropped_vertices, "vertices dropped: of no tetrahedron, or two at one place");
    line(given.added_input_vertices, "vertices added that the input has and the mesh had not");
    line(given.added_for_conformity, "vertices added for conformity");
    line(given.added_for_refinement, "vertices added for radius-edge ratio and size");
    return text;
}

std::string render_regions(const Certificate& certificate) {
    if (certificate.regions.empty()) return {};
    TextTable table({{"region", Align::right}, {"tetrahedra", Align::right}, {"volume", Align::right}, {"input's volume", Align::right}, {"relative difference", Align::right}});
    for (const RegionVolume& region : certificate.regions) {
        std::vector<std::string> row = {fmt::format("{}", region.region), count(region.tets), fmt::format("{:.12g}", region.volume)};
        if (region.plc_volume) {
            row.push_back(fmt::format("{:.12g}", *region.plc_volume));
            row.push_back(fmt::format("{:.1e}", std::abs(region.volume - *region.plc_volume) / std::abs(*region.plc_volume)));
        }
        table.add(std::move(row));
    }
    return "Regions\n" + table.str();
}

std::string render_stages(const std::vector<StageTime>& stages) {
    TextTable table({{"stage"}, {"seconds", Align::right}, {"vertices after", Align::right}, {"tets after", Align::right}});
    double total = 0;
    for (const StageTime& stage : stages) {
        const bool counted = stage.vertices_after > 0;
        table.add({to_string(stage.stage), fmt::format("{:.3f}", stage.seconds), counted ? count(stage.vertices_after) : "",
                   counted ? count(stage.tets_after) : ""});
        total += stage.seconds;
    }
    table.add({"total", fmt::format("{:.3f}", total)});
    return "Time\n" + table.str();
}

namespace {

/// Kinds and how often they are, then the defects themselves, of each kind and severity the first ones.
std::string render_defects(const Diagnosis& diagnosis, std::size_t most_of_a_kind) {
    if (diagnosis.defects.empty()) return "Defects: none\n";
    TextTable counts({{"severity"}, {"defect"}, {"number", Align::right}});
    TextTable table({{"severity"}, {"defect"}, {"value", Align::right}, {"where"}, {"message"}});
    std::string left_out;
    const auto& all = diagnosis.defects;
    for (std::size_t first = 0; first < all.size();) {
        std::size_t last = first;
        while (last < all.size() && all[last].severity == all[first].severity && all[last].kind == all[first].kind) ++last;
        const std::size_t n = last - first;
        counts.add({to_string(all[first].severity), to_string(all[first].kind), count(n)});
        for (std::size_t d = first; d < std::min(last, first + most_of_a_kind); ++d)
            table.add({to_string(all[d].severity), to_string(all[d].kind), number(all[d].value), describe(all[d].elements, 4), all[d].message});
        if (n > most_of_a_kind)
            left_out += fmt::format("  and {} more: {}; --all or --json FILE lists them all\n", n - most_of_a_kind, to_string(all[first].kind));
        first = last;
    }
    return "Defects\n" + counts.str() + "Where\n" + table.str() + left_out;
}

std::string render_smallest(const SmallestFeatures& smallest) {
    TextTable table({{"smallest"}, {"value", Align::right}, {"from"}, {"to"}});
    const auto add = [&](const char* what, const SmallestFeature& feature) {
        if (!feature.points.empty()) table.add({what, fmt::format("{:.6g}", feature.value), point(feature.points.front()), feature.points.size() > 1 ? point(feature.points[1]) : ""});
    };
    add("segment", smallest.segment);
    add("gap", smallest.gap);
    add("angle [deg]", smallest.angle);
    return table.empty() ? std::string() : "Features\n" + table.str();
}

}  // namespace

std::string render_diagnosis(const Diagnosis& diagnosis, std::size_t most_of_a_kind) {
    std::string text = fmt::format("Complex: {} vertices, {} segments, {} facets, {} cells; planarity tolerance {:.3g}\n", diagnosis.vertices,
                                   diagnosis.segments, diagnosis.facets, diagnosis.cells.size(), diagnosis.coplanar_tolerance);
    text += render_defects(diagnosis, most_of_a_kind);
    text += render_smallest(diagnosis.smallest);
    return text + render_cells(diagnosis.cells);
}

std::string render_cells(const std::vector<CellSummary>& cells, std::size_t most) {
    if (cells.empty()) return {};
    TextTable table({{"region", Align::right}, {"name"}, {"meshed"}, {"volume", Align::right}, {"point inside"}});
    for (std::size_t c = 0; c < std::min(cells.size(), most); ++c) {
        const CellSummary& cell = cells[c];
        const bool bounded = std::isfinite(cell.volume);
        table.add({fmt::format("{}", cell.region), cell.name, cell.filled ? "yes" : "no", bounded ? fmt::format("{:.12g}", cell.volume) : "unbounded",
                   bounded ? point(cell.inside) : ""});
    }
    std::string text = "Cells\n" + table.str();
    if (cells.size() > most) text += fmt::format("  and {} more; --json FILE lists them all\n", cells.size() - most);
    return text;
}

}  // namespace wellmesh::cli
