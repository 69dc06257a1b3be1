// SPDX-License-Identifier: Apache-2.0
#include "sizing/entity_sizes.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/infinity.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kMostListed = 12;

/// Lowers `sizes` where `id_of(i)` is the wanted one.
template <class IdOf>
void apply(const EntitySize& wanted, std::vector<double>& sizes, const IdOf& id_of) {
    std::set<std::int32_t> known;
    bool found = false;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
        const std::optional<std::int32_t> id = id_of(i);
        if (!id) continue;
        known.insert(*id);
        if (*id != wanted.id) continue;
        found = true;
        sizes[i] = std::min(sizes[i], wanted.edge_length);
    }
    if (found) return;
    const bool region = wanted.kind == EntityKind::region;
    std::vector<std::int32_t> some(known.begin(), known.end());
    const bool more = some.size() > kMostListed;
    if (more) some.resize(kMostListed);
    throw MeshError(ErrorCode::bad_options, Stage::refine,
                    fmt::format("a size is asked for {} {}{}, but the input has {}{}{}", to_string(wanted.kind), region ? "" : "marker ", wanted.id,
                                some.empty() ? "none" : region ? "the regions " : "the markers ", fmt::join(some, ", "), more ? ", ..." : ""),
                    {{wanted.kind, static_cast<std::uint64_t>(wanted.id), {}}});
}

}  // namespace

std::vector<EntitySize> with_ids(const std::vector<EntitySize>& entities, const Names& names) {
    std::vector<EntitySize> out;
    for (const EntitySize& wanted : entities) {
        if (wanted.name.empty()) {
            out.push_back(wanted);
            continue;
        }
        const std::size_t dimension = wanted.kind == EntityKind::region ? 3 : wanted.kind == EntityKind::facet ? 2 : wanted.kind == EntityKind::segment ? 1 : 0;
        std::set<std::string> known;
        const std::size_t before = out.size();
        for (const auto& [marker, name] : names.of_dimension[dimension]) {
            known.insert(name);
            if (name == wanted.name) out.push_back({wanted.kind, marker, wanted.edge_length});
        }
        if (out.size() == before)
            throw MeshError(ErrorCode::bad_options, Stage::refine,
                            fmt::format("a size is asked for {} '{}', but the input has {}{}", to_string(wanted.kind), wanted.name,
                                        known.empty() ? "no names of that kind" : "the names ", fmt::join(known, ", ")));
    }
    return out;
}

EntitySizes stated_sizes(const ValidPlc& plc, const SizeGoals& goals) {
    EntitySizes out{std::vector<double>(plc.vertices.size(), kInfinity), std::vector<double>(plc.segments.size(), kInfinity),
                    std::vector<double>(plc.facets.size(), kInfinity), std::vector<double>(plc.cells.size(), goals.edge_length.value_or(kInfinity))};
    using Id = std::optional<std::int32_t>;
    for (const EntitySize& wanted : goals.entities) {
        switch (wanted.kind) {
            case EntityKind::region: apply(wanted, out.cells, [&](std::size_t c) { return plc.cells[c].filled ? Id(plc.cells[c].region) : Id(); }); break;
            case EntityKind::facet: apply(wanted, out.facets, [&](std::size_t f) { return Id(plc.facets[f].marker); }); break;
            case EntityKind::segment: apply(wanted, out.segments, [&](std::size_t s) { return Id(plc.segments[s].marker); }); break;
            default: apply(wanted, out.vertices, [&](std::size_t v) { return plc.vertex_markers.empty() ? Id() : Id(plc.vertex_markers[v]); }); break;
        }
    }
    if (goals.vertex_sizes)
        for (std::size_t v = 0; v < plc.vertex_sizes.size(); ++v)
            if (plc.vertex_sizes[v] > 0) out.vertices[v] = std::min(out.vertices[v], plc.vertex_sizes[v]);
    return out;
}

}  // namespace wellmesh
