// SPDX-License-Identifier: Apache-2.0
#include "pipeline/report_sizes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "quality/tet_shape.hpp"
#include "validation/local_feature_size.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kWorstInARegion = 8;
/// Splitting for size makes no edge below this part of the length asked for: (1 - delta) of the circumradius bound, half of that on what a centre encroaches
/// (as in Refiner::guard_edges).
constexpr double kShortestPerLength = (1 - kPracticalDelta) / 2 * kCircumradiusPerEdgeLength;

struct RegionEdge {
    std::int32_t region = 0;
    std::uint32_t a = 0, b = 0;
    auto operator<=>(const RegionEdge&) const = default;
};

/// Every edge of every region, once for each.
std::vector<RegionEdge> edges_by_region(const TetMesh& mesh) {
    std::vector<RegionEdge> edges;
    edges.reserve(6 * mesh.tets.size());
    for (std::size_t t = 0; t < mesh.tets.size(); ++t)
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j) edges.push_back({mesh.tet_regions[t], std::min(mesh.tets[t][i], mesh.tets[t][j]), std::max(mesh.tets[t][i], mesh.tets[t][j])});
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
}

class SizeReport {
public:
    SizeReport(MeshResult& result, const MeshOptions& options, const ValidPlc& plc, const SizeField& sizes)
        : result_(result), mesh_(result.mesh), options_(options), plc_(plc), sizes_(sizes) {
        for (std::size_t c = plc.cells.size(); c-- > 0;)
            if (plc.cells[c].filled) cell_of_[plc.cells[c].region] = CellId{c};
    }

    std::vector<AskedAchieved> rows() {
        const bool by_region = std::any_of(options_.size.entities.begin(), options_.size.entities.end(), [](const EntitySize& e) { return e.kind == EntityKind::region; });
        if (sizes_.varies() || by_region) report_lengths();
        if (options_.size.min_edge_length) report_shortest(*options_.size.min_edge_length);
        return std::move(rows_);
    }

private:
    struct Region {
        double asked = 0, achieved = 0;
        std::size_t edges = 0;
        std::vector<std::pair<double, std::size_t>> missed;  // by how much, tetrahedron
    };

    void report_lengths() {
        std::map<std::int32_t, Region> regions;
        std::vector<double> ratios;
        for (const auto& [region, a, b] : edges_by_region(mesh_)) {
            const Vec3 &p = mesh_.vertices[a], &q = mesh_.vertices[b];
            const double asked = sizes_.edge_length(0.5 * (p + q), cell_of_[region]), length = distance(p, q);
            if (!(asked < std::numeric_limits<double>::infinity())) continue;
            Region& r = regions[region];
            r.asked += asked;
            r.achieved += length;
            ++r.edges;
            ratios.push_back(length / asked);
        }
        for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
            const auto& c = mesh_.tets[t];
            const Vec3 &p = mesh_.vertices[c[0]], &q = mesh_.vertices[c[1]], &r = mesh_.vertices[c[2]], &s = mesh_.vertices[c[3]];
            const std::int32_t region = mesh_.tet_regions[t];
            const double bound = kSizeTolerance * std::sqrt(sizes_.of(p, q, r, s, cell_of_[region]).max_squared_circumradius) * (1 + 1e-9);
            if (!(bound < std::numeric_limits<double>::infinity())) continue;
            if (const double by = shape_of(p, q, r, s).circumradius / bound; by > 1) regions[region].missed.push_back({by, t});
        }
        for (auto& [region, r] : regions) {
            if (r.edges == 0) continue;
            const auto n = static_cast<double>(r.edges);
            AskedAchieved row{fmt::format("edge length (mean) in region {}", region), r.asked / n, r.achieved / n, r.missed.empty(), r.missed.size(), {}};
            list_worst(r.missed, row);
            rows_.push_back(std::move(row));
        }
        if (ratios.empty()) return;
        const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
        std::nth_element(ratios.begin(), middle, ratios.end());
        rows_.push_back({"edge length / size (median)", 1, *middle, true, 0, {}});
    }

    /// Edges much shorter than `least`, which no size goal asks for: where the input's features are closer than that they must be.
    void report_shortest(double least) {
        const LocalFeatureSize lfs(plc_);
        double shortest = std::numeric_limits<double>::infinity(), closest = shortest;
        Vec3 where{};
        std::size_t forced = 0;
        std::vector<std::pair<double, std::size_t>> unforced;
        for (std::size_t t = 0; t < mesh_.tets.size(); ++t) {
            double length = std::numeric_limits<double>::infinity();
            Vec3 middle{};
            for (std::size_t i = 0; i < 4; ++i)
                for (std::size_t j = i + 1; j < 4; ++j) {
                    const Vec3 &p = mesh_.vertices[mesh_.tets[t][i]], &q = mesh_.vertices[mesh_.tets[t][j]];
                    if (distance(p, q) >= length) continue;
                    length = distance(p, q);
                    middle = 0.5 * (p + q);
                }
            shortest = std::min(shortest, length);
            if (length >= kShortestPerLength * least) continue;
            const double features = lfs(middle);
            if (features >= least) {
                unforced.push_back({least / length, t});
                continue;
            }
            ++forced;
            if (features < closest) {
                closest = features;
                where = middle;
            }
        }
        AskedAchieved row{"edge length (smallest)", least, shortest, unforced.empty(), unforced.size(), {}};
        list_worst(unforced, row);
        rows_.push_back(std::move(row));
        if (forced > 0)
            result_.statistics.notes.push_back(
                fmt::format("{} tetrahedra are much smaller than the smallest size {:.4g}, where features of the input are closer; the closest at ({:.6g}, {:.6g}, {:.6g}), {:.4g} apart",
                            forced, least, where.x, where.y, where.z, 2 * closest));
    }

    void list_worst(std::vector<std::pair<double, std::size_t>>& missed, AskedAchieved& row) const {
        std::sort(missed.begin(), missed.end(), [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
        for (std::size_t i = 0; i < std::min(kWorstInARegion, missed.size()); ++i) {
            Vec3 centre;
            for (const std::uint32_t v : mesh_.tets[missed[i].second]) centre = centre + 0.25 * mesh_.vertices[v];
            row.worst.push_back({EntityKind::tetrahedron, missed[i].second + 1, centre});
        }
    }

    MeshResult& result_;
    const TetMesh& mesh_;
    const MeshOptions& options_;
    const ValidPlc& plc_;
    const SizeField& sizes_;
    std::map<std::int32_t, CellId> cell_of_;
    std::vector<AskedAchieved> rows_;
};

}  // namespace

std::vector<AskedAchieved> report_sizes(MeshResult& result, const MeshOptions& options, const ValidPlc& plc, const SizeField& sizes) {
    return SizeReport(result, options, plc, sizes).rows();
}

}  // namespace wellmesh
