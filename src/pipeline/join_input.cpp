// SPDX-License-Identifier: Apache-2.0
#include "pipeline/join_input.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "validation/report.hpp"
#include "validation/rounding.hpp"

namespace wellmesh {
namespace {

constexpr unsigned kMostRounds = 8;      // what was joined may make others too thin
constexpr std::size_t kMostListed = 20;  // of the text; the statistics have all

}  // namespace

std::optional<JoinedPlc> join_input(const Plc& plc, const MeshOptions& options, bool assumed_single_precision) {
    Diagnosis found = diagnose(plc, options);
    const auto joinable = [](const Defect& d) { return d.severity != Severity::error || d.kind == DefectKind::feature_too_thin; };
    if (!std::all_of(found.defects.begin(), found.defects.end(), joinable)) return std::nullopt;
    Rounding rounding{.relative = std::max(0.0, plc.relative_rounding), .override_with = options.coplanar_tolerance};
    for (const Vec3& p : plc.vertices) rounding.largest_coordinate = std::max({rounding.largest_coordinate, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    JoinedPlc joined = nothing_joined(plc, rounding.closing());
    joined.plc.relative_rounding = 0;
    joined.statistics.assumed_single_precision = assumed_single_precision;
    MeshOptions exact = options;
    exact.coplanar_tolerance.reset();
    for (unsigned round = 0; round < kMostRounds; ++round) {
        if (!join_thin(joined, found)) return std::nullopt;
        found = diagnose(joined.plc, exact);
        if (!found.has_errors()) return joined;
    }
    return std::nullopt;
}

Plc as_if_single_precision(const Plc& plc) {
    Plc coarse = plc;
    coarse.relative_rounding = 0x1p-24;
    return coarse;
}

std::string describe(const JoinStatistics& joined, const Plc& plc) {
    const Report names(plc);
    const auto name = [&](const ElementRef& e) {
        const std::size_t i = e.number - plc.first_number;
        return e.kind == EntityKind::vertex ? names.name_vertex(i) : names.name_facet(i);
    };
    std::string list;
    for (std::size_t i = 0; i < std::min(kMostListed, joined.joined.size()); ++i) {
        const JoinedFeature& j = joined.joined[i];
        list += fmt::format("{}{} at {} with {}, {:.3g} apart", i == 0 ? "" : "; ", name(j.vertex), format_point(j.vertex.where.value_or(Vec3{})), name(j.with), j.distance);
    }
    if (joined.joined.size() > kMostListed) list += fmt::format("; and {} more", joined.joined.size() - kMostListed);
    const bool assumed = joined.assumed_single_precision;
    return fmt::format("{}{} features of the input that are closer than {} ({:.3g}) were joined: {}. No vertex moved, and no facet by more than {:.3g}",
                       assumed ? "as no mesh could be made of it as it is, " : "", joined.joined.size(), assumed ? "what single precision explains" : "the rounding of its coordinates",
                       joined.tolerance, list, joined.largest_move);
}

void name_facets(ValidPlc& valid, const JoinedPlc& joined) {
    for (ValidFacet& f : valid.facets) f.source_facet = joined.source.facet[f.source_facet];
}

void name_vertices(MeshResult& result, const JoinedPlc& joined, const Plc& plc) {
    TetMesh& mesh = result.mesh;
    const std::size_t stated = plc.vertices.size();
    const auto made = [&](std::uint32_t v) {
        const VertexCarrier& carrier = mesh.vertex_carriers[v];
        return carrier.kind == CarrierKind::input_vertex && carrier.id >= stated;
    };
    for (std::size_t s = 0; s < mesh.subsegments.size(); ++s)
        for (const std::uint32_t v : mesh.subsegments[s])
            if (made(v)) mesh.vertex_carriers[v] = {CarrierKind::segment, static_cast<std::uint32_t>(mesh.subsegment_segments[s] - 1)};
    for (std::size_t f = 0; f < mesh.subfaces.size(); ++f)
        for (const std::uint32_t v : mesh.subfaces[f])
            if (made(v)) mesh.vertex_carriers[v] = {CarrierKind::facet, static_cast<std::uint32_t>(mesh.subface_facets[f] - 1)};
    for (Exemption& e : result.exemptions)
        if (const std::uint64_t v = e.feature.number - plc.first_number; e.feature.kind == EntityKind::vertex && v >= stated)
            e.feature.number = std::uint64_t{joined.source.vertex[v]} + plc.first_number;
}

}  // namespace wellmesh
