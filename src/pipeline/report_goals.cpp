// SPDX-License-Identifier: Apache-2.0
// Asked versus achieved.
#include "pipeline/report_goals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/vec3_math.hpp"
#include "pipeline/theory_run.hpp"
#include "quality/tet_shape.hpp"
#include "sizing/size_field.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kWorstListed = 8;

/// As the certificate divides them: the boundary's tetrahedra have a vertex on a segment, a facet or in the input.
enum class Part : std::uint8_t { all, interior, boundary };

/// A tetrahedron as the goals look at it: each measures what it needs.
struct Measured {
    const Vec3 &a, &b, &c, &d;
    std::int32_t region;
    [[nodiscard]] TetShape shape() const { return shape_of(a, b, c, d); }
    [[nodiscard]] double volume() const { return six_volumes(a, b, c, d) / 6; }
    /// As shape_of() has it.
    [[nodiscard]] double circumradius() const {
        const double size = std::abs(volume());
        constexpr double kOrdinary = 1e-90;  // of volumes: below, products of lengths may underflow
        return size > kOrdinary ? norm(scaled_circumcentre(b - a, c - a, d - a)) / (12 * size) : shape().circumradius;
    }
};

/// What shape is asked of exempt tetrahedra, too, is not counted.
/// Counts the tetrahedra for which `excess(measured)` is positive, asked from several threads, and keeps the worst few.
template <class F>
void count_misses(Workers& workers, const MeshResult& result, AskedAchieved& goal, F&& excess, bool of_shape, Part part = Part::all) {
    constexpr std::size_t kTetsAPiece = std::size_t{1} << 14;
    using Missed = std::vector<std::pair<double, std::size_t>>;
    const TetMesh& mesh = result.mesh;
    std::vector<Missed> found((mesh.tets.size() + kTetsAPiece - 1) / kTetsAPiece);
    workers.for_ranges(mesh.tets.size(), kTetsAPiece, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        auto exempt = std::lower_bound(result.exemptions.begin(), result.exemptions.end(), begin, [](const Exemption& e, std::size_t t) { return e.tet < t; });
        for (std::size_t t = begin; t < end; ++t) {
            while (exempt != result.exemptions.end() && exempt->tet < t) ++exempt;
            if (of_shape && exempt != result.exemptions.end() && exempt->tet == t) continue;
            const auto& c = mesh.tets[t];
            const auto touches = [&] { return std::any_of(c.begin(), c.end(), [&](std::uint32_t v) { return mesh.vertex_carriers[v].kind != CarrierKind::region; }); };
            if (part != Part::all && touches() != (part == Part::boundary)) continue;
            const double by = excess(Measured{mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]], mesh.vertices[c[3]], mesh.tet_regions[t]});
            if (by > 0) found[piece].push_back({by, t});
        }
    });
    Missed missed;
    for (const Missed& piece : found) missed.insert(missed.end(), piece.begin(), piece.end());
    goal.elements_missed = missed.size();
    goal.met = missed.empty();
    std::sort(missed.begin(), missed.end(), [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
    for (std::size_t i = 0; i < std::min(kWorstListed, missed.size()); ++i) {
        const auto& c = mesh.tets[missed[i].second];
        Vec3 centre;
        for (const std::uint32_t v : c) centre = centre + 0.25 * mesh.vertices[v];
        goal.worst.push_back({EntityKind::tetrahedron, missed[i].second + 1, centre});
    }
}

/// Least angle or sigma: one goal, or one for what lies inside and one for what touches the boundary.
void report_slivers(MeshResult& result, const MeshOptions& options, Workers& workers) {
    const auto report = [&](const char* name, double inside, std::optional<double> at_boundary, double ShapeStatistics::*achieved, double TetShape::*value) {
        const Certificate& c = result.certificate;
        const auto add = [&](const std::string& goal, double asked, const ShapeStatistics& of, Part part) {
            if (!(asked > 0)) return;
            AskedAchieved entry{goal, asked, of.*achieved, of.tets == 0 || of.*achieved >= asked, 0, {}};
            if (!entry.met) count_misses(workers, result, entry, [&](const Measured& m) { return asked - m.shape().*value; }, true, part);
            result.goals.push_back(entry);
        };
        if (!at_boundary) return add(name, inside, c.unexempt, Part::all);
        add(fmt::format("{} inside", name), inside, c.interior, Part::interior);
        add(fmt::format("{} at the boundary", name), *at_boundary, c.boundary, Part::boundary);
    };
    const QualityGoals& quality = options.quality;
    report("min dihedral angle [deg]", quality.min_dihedral_angle_deg, quality.min_dihedral_boundary_deg, &ShapeStatistics::min_dihedral_angle_deg, &TetShape::min_dihedral_deg);
    report("min sigma V/L^3", paper_constants(options).sigma0, options.paper.sigma0_boundary, &ShapeStatistics::min_sigma, &TetShape::sigma);
}

}  // namespace

void report_goals(MeshResult& result, const MeshOptions& options, const ValidPlc& plc, const std::vector<AskedAchieved>& sizes, Workers& workers) {
    const ShapeStatistics& all = result.certificate.all;
    for (const VertexCarrier& c : result.mesh.vertex_carriers) {
        switch (c.kind) {
            case CarrierKind::input_vertex: ++result.statistics.input_vertices; break;
            case CarrierKind::segment: ++result.statistics.segment_vertices; break;
            case CarrierKind::facet: ++result.statistics.facet_vertices; break;
            case CarrierKind::region: ++result.statistics.interior_vertices; break;
        }
    }
    const double rho = options.quality.max_radius_edge_ratio;
    const double largest = result.certificate.unexempt.max_radius_edge_ratio;
    AskedAchieved radius_edge{"max radius-edge ratio", rho, largest, largest <= rho, 0, {}};
    if (!radius_edge.met) count_misses(workers, result, radius_edge, [&](const Measured& m) { return m.shape().radius_edge - rho; }, true);
    result.goals.push_back(radius_edge);
    report_slivers(result, options, workers);
    if (options.size.edge_length) {
        const double h = std::max(*options.size.edge_length, options.size.min_edge_length.value_or(0));
        const double bound = kCircumradiusPerEdgeLength * h * (1 + 1e-9);
        AskedAchieved size{"edge length (mean)", h, all.mean_edge, true, 0, {}};
        count_misses(workers, result, size, [&](const Measured& m) { return m.circumradius() - bound * kSizeTolerance; }, false);
        result.goals.push_back(size);
    }
    const double least_volume = options.size.min_edge_length ? volume_of_edge_length(*options.size.min_edge_length) : 0;
    if (options.size.max_volume) {
        const double asked = std::max(*options.size.max_volume, least_volume), bound = asked * (1 + 1e-9);
        AskedAchieved volume{"max volume", asked, all.max_volume, true, 0, {}};
        count_misses(workers, result, volume, [&](const Measured& m) { return m.volume() - bound; }, false);
        result.goals.push_back(volume);
    }
    for (const ValidCell& c : plc.cells) {
        if (!c.filled || !(c.max_volume > 0)) continue;
        const double asked = std::max(c.max_volume, least_volume);
        AskedAchieved volume{fmt::format("max volume in region {}", c.region), asked, 0, true, 0, {}};
        count_misses(workers, result, volume, [&](const Measured& m) { return m.region == c.region ? m.volume() - asked * (1 + 1e-9) : 0; }, false);
        for (std::size_t t = 0; t < result.mesh.tets.size(); ++t) {
            if (result.mesh.tet_regions[t] != c.region) continue;
            const auto& k = result.mesh.tets[t];
            const std::vector<Vec3>& p = result.mesh.vertices;
            volume.achieved = std::max(volume.achieved, six_volumes(p[k[0]], p[k[1]], p[k[2]], p[k[3]]) / 6);
        }
        result.goals.push_back(volume);
    }
    if (const auto& gaps = result.statistics.gaps)
        result.goals.push_back({"narrowest gap filled", gaps->narrowest, gaps->filled_from, false, gaps->tets, {gaps->side, gaps->other_side}});
    result.goals.insert(result.goals.end(), sizes.begin(), sizes.end());
    if (result.termination == Termination::goals_met &&
        std::any_of(result.goals.begin(), result.goals.end(), [](const AskedAchieved& g) { return !g.met; }))
        result.termination = Termination::goals_unmet;
}

Termination termination(RunGuard::Verdict verdict) {
    switch (verdict) {
        case RunGuard::Verdict::cancelled: return Termination::cancelled;
        case RunGuard::Verdict::out_of_time: return Termination::time_budget_reached;
        case RunGuard::Verdict::out_of_vertices: return Termination::vertex_budget_reached;
        case RunGuard::Verdict::out_of_memory: return Termination::memory_budget_reached;
        case RunGuard::Verdict::go_on: break;
    }
    return Termination::goals_met;
}

}  // namespace wellmesh
