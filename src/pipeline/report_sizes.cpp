// SPDX-License-Identifier: Apache-2.0
#include "pipeline/report_sizes.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "core/shared_array.hpp"
#include "core/vec3_math.hpp"
#include "quality/tet_shape.hpp"
#include "validation/local_feature_size.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kWorstInARegion = 8;
/// Splitting for size makes no edge below this part of the length asked for: (1 - delta) of the circumradius bound, half of that on what a centre encroaches
/// (as in Refiner::guard_edges).
constexpr double kShortestPerLength = (1 - kPracticalDelta) / 2 * kCircumradiusPerEdgeLength;

constexpr std::size_t kGrain = std::size_t{1} << 12;

/// Edges by their lower end, each as often as tetrahedra have it.
class EdgeLists {
public:
    struct Edge {
        std::uint32_t high = 0;
        std::int32_t region = 0;
        auto operator<=>(const Edge&) const = default;
    };

    EdgeLists(const TetMesh& mesh, Workers& workers) : first_(mesh.vertices.size() + 1, 0) {
        const bool alone = workers.threads() == 1;
        const auto for_edges = [&](auto&& use) {
            workers.for_ranges(mesh.tets.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
                for (std::size_t t = begin; t < end; ++t)
                    for (std::size_t i = 0; i < 4; ++i)
                        for (std::size_t j = i + 1; j < 4; ++j) use(std::min(mesh.tets[t][i], mesh.tets[t][j]), std::max(mesh.tets[t][i], mesh.tets[t][j]), mesh.tet_regions[t]);
            });
        };
        const auto add_one = [alone](std::size_t& counter) { return alone ? counter++ : std::atomic_ref(counter).fetch_add(1, std::memory_order_relaxed); };
        for_edges([&](std::uint32_t low, std::uint32_t, std::int32_t) { add_one(first_[low + 1]); });
        std::partial_sum(first_.begin(), first_.end(), first_.begin());
        edges_.resize_as_is(first_.back());
        std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
        for_edges([&](std::uint32_t low, std::uint32_t high, std::int32_t region) { edges_[add_one(next[low])] = {high, region}; });
    }

    /// Those of a vertex, each once for every region; sorts them. Not twice, nor for one vertex by several threads.
    [[nodiscard]] std::span<const Edge> take(std::size_t vertex) {
        const std::span<Edge> all(edges_.data() + first_[vertex], edges_.data() + first_[vertex + 1]);
        std::sort(all.begin(), all.end());
        return all.first(static_cast<std::size_t>(std::unique(all.begin(), all.end()) - all.begin()));
    }

private:
    std::vector<std::size_t> first_;  // edges of a vertex begin there and end where the next one's begin
    SharedArray<Edge> edges_;
};

class SizeReport {
public:
    SizeReport(MeshResult& result, const MeshOptions& options, const ValidPlc& plc, const SizeField& sizes, Workers& workers)
        : result_(result), mesh_(result.mesh), options_(options), plc_(plc), sizes_(sizes), workers_(workers) {
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

    using Regions = std::map<std::int32_t, Region>;

    /// Of a range of vertices: edges that begin there.
    struct Lengths {
        Regions regions;
        std::vector<double> ratios;  // to what is asked
    };
    void measure(EdgeLists& edges, std::size_t begin, std::size_t end, Lengths& out) const {
        for (std::size_t v = begin; v < end; ++v)
            for (const auto& [high, region] : edges.take(v)) {
                const Vec3 &p = mesh_.vertices[v], &q = mesh_.vertices[high];
                const double asked = sizes_.edge_length(0.5 * (p + q), cell_of_.at(region)), length = distance(p, q);
                if (!(asked < std::numeric_limits<double>::infinity())) continue;
                Region& r = out.regions[region];
                r.asked += asked;
                r.achieved += length;
                ++r.edges;
                out.ratios.push_back(length / asked);
            }
    }
    /// Of a range of tetrahedra: those that are too large.
    void list_missed(std::size_t begin, std::size_t end, Regions& out) const {
        for (std::size_t t = begin; t < end; ++t) {
            const auto& c = mesh_.tets[t];
            const Vec3 &p = mesh_.vertices[c[0]], &q = mesh_.vertices[c[1]], &r = mesh_.vertices[c[2]], &s = mesh_.vertices[c[3]];
            const std::int32_t region = mesh_.tet_regions[t];
            const double bound = kSizeTolerance * std::sqrt(sizes_.of(p, q, r, s, cell_of_.at(region)).max_squared_circumradius) * (1 + 1e-9);
            if (!(bound < std::numeric_limits<double>::infinity())) continue;
            if (const double by = circumradius(p, q, r, s) / bound; by > 1) out[region].missed.push_back({by, t});
        }
    }

    void report_lengths() {
        std::vector<Lengths> lengths((mesh_.vertices.size() + kGrain - 1) / kGrain);
        {
            EdgeLists edges(mesh_, workers_);
            workers_.for_ranges(mesh_.vertices.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) { measure(edges, begin, end, lengths[piece]); });
        }
        std::vector<Regions> missed((mesh_.tets.size() + kGrain - 1) / kGrain);
        workers_.for_ranges(mesh_.tets.size(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) { list_missed(begin, end, missed[piece]); });
        Regions regions;
        std::vector<double> ratios;
        std::size_t count = 0;
        for (const Lengths& l : lengths) count += l.ratios.size();
        ratios.reserve(count);
        for (Lengths& l : lengths) {
            ratios.insert(ratios.end(), l.ratios.begin(), l.ratios.end());
            std::vector<double>().swap(l.ratios);
            for (const auto& [region, here] : l.regions) {
                Region& r = regions[region];
                r.asked += here.asked;
                r.achieved += here.achieved;
                r.edges += here.edges;
            }
        }
        for (const Regions& piece : missed)
            for (const auto& [region, here] : piece) regions[region].missed.insert(regions[region].missed.end(), here.missed.begin(), here.missed.end());
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
    Workers& workers_;
    std::map<std::int32_t, CellId> cell_of_;
    std::vector<AskedAchieved> rows_;
};

}  // namespace

std::vector<AskedAchieved> report_sizes(MeshResult& result, const MeshOptions& options, const ValidPlc& plc, const SizeField& sizes, Workers& workers) {
    return SizeReport(result, options, plc, sizes, workers).rows();
}

}  // namespace wellmesh
