// SPDX-License-Identifier: Apache-2.0
#include "sizing/size_field.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/infinity.hpp"
#include "sizing/point_sizes.hpp"
#include "validation/box_tree.hpp"

namespace wellmesh {
namespace {

/// Samples between which a function grows faster than this part of the gradation are sources: neighbours in an octree lie along 26 directions
/// only, and along others what they allow of each other comes to up to 1.13 of it.
constexpr double kSteep = 0.88;
/// Refinement makes about so many vertices a cubed circumradius bound.
constexpr double kVerticesPerCubedRadius = 0.75;
/// A leaf of twice the length asks for about 17 vertices, so these are for 70 million; half a gigabyte.
constexpr std::size_t kMostLeaves = std::size_t{1} << 22U;
/// Where vertices are limited: so many leaves find what is small, and one a vertex is more than enough.
constexpr std::size_t kLeavesAnyway = 50'000;
constexpr unsigned kLeastDepth = 2;
/// A source that asks for hardly less than others do already is none.
constexpr double kWorthKeeping = 0.01;
constexpr std::size_t kFirstBatch = 64;

unsigned depth_of(double part_of_side) { return static_cast<unsigned>(std::ceil(-std::log2(part_of_side))); }

struct SampledDomain {
    Vec3 lo{};
    double side = 1;
    std::vector<Box> surface;
};

/// A cube about the domain, and the boxes of what bounds its cells.
SampledDomain domain_of(const ValidPlc& plc) {
    SampledDomain out;
    Box box;
    for (const Vec3& p : plc.vertices) box.add(p);
    out.side = std::max({box.high.x - box.low.x, box.high.y - box.low.y, box.high.z - box.low.z});
    out.lo = 0.5 * (box.low + box.high) - 0.5 * Vec3{out.side, out.side, out.side};
    for (const ValidFacet& f : plc.facets)
        for (const auto& t : f.triangles) {
            Box& b = out.surface.emplace_back();
            for (const VertexId v : t) b.add(plc.vertices[v.index()]);
        }
    return out;
}

/// Corners and probes of leaves from which f grows faster than the gradation allows.
class SteepPoints {
public:
    SteepPoints(const std::function<double(const Vec3&)>& f, const std::vector<Vec3>& probes, double gradation) : f_(f), probes_(probes), gradation_(gradation), slope_(kSteep * gradation) {}

    void look_at(const SizeOctree::Leaf& leaf) {
        if (!leaf.in_domain) return;
        std::array<Vec3, 8> corners;
        for (unsigned k = 0; k < 8; ++k)
            corners[k] = leaf.lo + leaf.side * Vec3{k & 1U ? 1.0 : 0.0, k & 2U ? 1.0 : 0.0, k & 4U ? 1.0 : 0.0};
        const auto is_steep = [&](const Vec3& p, double value) {
            for (unsigned k = 0; k < 8; ++k)
                if (leaf.at_corner[k] > value + slope_ * distance(p, corners[k])) return true;
            return false;
        };
        for (unsigned k = 0; k < 8; ++k)
            if (is_steep(corners[k], leaf.at_corner[k])) found_.push_back({{corners[k], {}, {}}, 1, leaf.at_corner[k]});
        for (const std::uint32_t i : leaf.probes)
            if (const double value = f_(probes_[i]); is_steep(probes_[i], value)) found_.push_back({{probes_[i], {}, {}}, 1, value});
    }
    /// Those that ask for less than the smaller ones among them and `others`, in an order that depends on the points alone.
    [[nodiscard]] std::vector<SizeSource> take(const std::vector<SizeSource>& others) {
        std::sort(found_.begin(), found_.end(), [](const SizeSource& a, const SizeSource& b) {
            return a.edge_length != b.edge_length ? a.edge_length < b.edge_length : lexicographically_less(a.corners[0], b.corners[0]);
        });
        // In batches, each as long as all before, so that few trees are built. Most points are beyond the reach of the smallest.
        const std::size_t given = others.size();
        std::vector<SizeSource> kept = others;
        for (std::size_t begin = 0; begin < found_.size();) {
            const std::size_t end = std::min(found_.size(), begin + std::max<std::size_t>(kFirstBatch, begin));
            const SourceTree tree(kept, gradation_);
            for (; begin < end; ++begin)
                if (const double asked = tree(found_[begin].corners[0]); found_[begin].edge_length < (1 - kWorthKeeping) * asked) kept.push_back(found_[begin]);
        }
        kept.erase(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(given));
        return kept;
    }

private:
    const std::function<double(const Vec3&)>& f_;
    const std::vector<Vec3>& probes_;
    double gradation_, slope_;
    std::vector<SizeSource> found_;
};

}  // namespace

double edge_length_of_volume(double max_volume) { return kCircumradiusPerRootOfVolume / kCircumradiusPerEdgeLength * std::cbrt(max_volume); }

double volume_of_edge_length(double edge_length) {
    const double root = kCircumradiusPerEdgeLength / kCircumradiusPerRootOfVolume * edge_length;
    return root * root * root;
}

TetSize SizeField::at(const Vec3& p, CellId c) const {
    const double radius = kCircumradiusPerEdgeLength * edge_length(p, c);
    return {radius * radius, cells_[c.index()].max_volume};
}

double SizeField::circumradius(const Vec3& p, CellId c) const {
    return std::min(kCircumradiusPerEdgeLength * edge_length(p, c), kCircumradiusPerRootOfVolume * std::cbrt(cells_[c.index()].max_volume));
}

void SizeField::add_volumes(const ValidPlc& plc, const SizeGoals& goals) {
    const double least = goals.min_edge_length ? volume_of_edge_length(*goals.min_edge_length) : 0;
    for (std::size_t i = 0; i < cells_.size(); ++i) {
        TetSize& cell = cells_[i];
        if (goals.max_volume) cell.max_volume = *goals.max_volume;
        if (plc.cells[i].max_volume > 0) cell.max_volume = std::min(cell.max_volume, plc.cells[i].max_volume);
        cell.max_volume = std::max(cell.max_volume, least);
        cell.max_squared_circumradius = kCircumradiusPerEdgeLength * kCircumradiusPerEdgeLength * lengths_[i] * lengths_[i];
        if (plc.cells[i].filled) smallest_ = std::min(smallest_, equivalent_length(i));
    }
}

std::vector<SizeSource> SizeField::sources_of(const ValidPlc& plc, const EntitySizes& sizes) const {
    std::vector<SizeSource> out;
    const auto at = [&](VertexId v) { return plc.vertices[v.index()]; };
    for (std::size_t v = 0; v < plc.vertices.size(); ++v)
        if (sizes.vertices[v] < kInfinity) out.push_back({{plc.vertices[v], {}, {}}, 1, sizes.vertices[v]});
    for (std::size_t s = 0; s < plc.segments.size(); ++s)
        if (sizes.segments[s] < kInfinity) out.push_back({{at(plc.segments[s].ends[0]), at(plc.segments[s].ends[1]), {}}, 2, sizes.segments[s]});
    for (std::size_t f = 0; f < plc.facets.size(); ++f) {
        double size = sizes.facets[f];
        const std::array<CellId, 2>& sides = plc.facets[f].cells;
        const bool parts = plc.cells[sides[0].index()].filled && plc.cells[sides[1].index()].filled;
        if (parts && equivalent_length(sides[0].index()) != equivalent_length(sides[1].index()))
            size = std::min({size, equivalent_length(sides[0].index()), equivalent_length(sides[1].index())});
        if (!(size < kInfinity)) continue;
        for (const auto& t : plc.facets[f].triangles) out.push_back({{at(t[0]), at(t[1]), at(t[2])}, 3, size});
    }
    return out;
}

void SizeField::count_constant(const ValidPlc& plc) {
    for (std::size_t c = 0; c < cells_.size(); ++c)
        if (plc.cells[c].filled) expected_vertices_ += plc.cells[c].volume * (0.75 / std::pow(cells_[c].max_squared_circumradius, 1.5) + 0.4 / cells_[c].max_volume);
}

SizeField::SizeField(const ValidPlc& plc, const SizeGoals& goals, const SizeFieldDomain& domain) : cells_(plc.cells.size()) {
    EntitySizes sizes = stated_sizes(plc, goals);
    if (goals.elements_per_circle) add_curvature_sizes(plc, *goals.elements_per_circle, sizes);
    const double least = goals.min_edge_length.value_or(0);
    for (std::vector<double>* of : {&sizes.vertices, &sizes.segments, &sizes.facets, &sizes.cells})
        for (double& h : *of) h = std::max(h, least);
    lengths_ = sizes.cells;
    add_volumes(plc, goals);
    count_constant(plc);

    const PointSizes point_sizes(plc, goals, sizes.vertices);
    std::vector<SizeSource> sources;
    if (goals.gradation > 0) {
        sources = sources_of(plc, sizes);
    } else {
        const auto any = [](const std::vector<double>& of) { return std::any_of(of.begin(), of.end(), [](double h) { return h < kInfinity; }); };
        if (any(sizes.facets)) bare_facets_ = sizes.facets;
        if (any(sizes.segments)) bare_segments_ = sizes.segments;
        for (const std::vector<double>* of : {&bare_facets_, &bare_segments_})
            for (const double h : *of) smallest_ = std::min(smallest_, h);
    }
    if (sources.empty() && !point_sizes.asks()) return;
    for (const SizeSource& s : sources) smallest_ = std::min(smallest_, s.edge_length);

    const std::function<double(const Vec3&)> f = [&](const Vec3& p) { return std::max(point_sizes(p), least); };
    const SampledDomain around = domain_of(plc);
    std::function<bool(const Vec3&)> inside;
    if (domain.cell_at) inside = [&](const Vec3& p) { return plc.cells[domain.cell_at(p).index()].filled; };
    const std::uint64_t most_leaves = std::min<std::uint64_t>(kMostLeaves, domain.max_vertices ? kLeavesAnyway + *domain.max_vertices : kMostLeaves);
    const auto may_go_on = [&](std::size_t leaves) {
        if (leaves >= kMostLeaves && !domain.max_vertices)
            throw MeshError(ErrorCode::mesh_too_large, Stage::refine,
                            fmt::format("the sizes ask for too many vertices: above {:.2g} on part of the domain; ask for coarser ones, or set a limit on vertices",
                                        17.0 * kMostLeaves));
        return leaves < most_leaves && (!domain.may_go_on || domain.may_go_on());
    };
    const unsigned depth = goals.at ? depth_of(kCallbackResolution) : kLeastDepth;
    if (point_sizes.asks() && goals.gradation > 0) {
        SteepPoints steep(f, point_sizes.probes(), goals.gradation);
        const SizeOctree scout({around.lo, around.side, f, point_sizes.probes(), around.surface, inside, depth, may_go_on},
                               [&](const SizeOctree::Leaf& leaf) { steep.look_at(leaf); });
        const std::vector<SizeSource> found = steep.take(sources);
        sources.insert(sources.end(), found.begin(), found.end());
    }
    const SourceTree tree(std::move(sources), goals.gradation);
    const std::function<double(const Vec3&)> graded = [&](const Vec3& p) { return tree(p, point_sizes.asks() ? f(p) : kInfinity); };
    double expected = 0;
    const auto count = [&](const SizeOctree::Leaf& leaf) {
        if (!leaf.in_domain) return;
        const Vec3 centre = leaf.lo + 0.5 * Vec3{leaf.side, leaf.side, leaf.side};
        const CellId cell = domain.cell_at ? domain.cell_at(centre) : CellId{0};
        const double shortest = *std::min_element(leaf.at_corner.begin(), leaf.at_corner.end());
        smallest_ = std::min(smallest_, shortest);
        if (domain.cell_at && !plc.cells[cell.index()].filled) return;
        double length = 0;
        for (const double h : leaf.at_corner) length += h / 8;
        length = std::min(length, equivalent_length(cell.index()));
        const double part = leaf.side / (kCircumradiusPerEdgeLength * length);
        shares_.push_back({length, kVerticesPerCubedRadius * part * part * part});
        expected += shares_.back().vertices;
    };
    octree_ = std::make_unique<const SizeOctree>(SizeSampling{around.lo, around.side, graded, point_sizes.probes(), around.surface, inside, depth, may_go_on}, count);
    expected_vertices_ = std::max(expected_vertices_, expected);
}

}  // namespace wellmesh
