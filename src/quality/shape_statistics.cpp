// SPDX-License-Identifier: Apache-2.0
#include "quality/shape_statistics.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

namespace wellmesh {

void ShapeAccumulator::add(const TetShape& shape) {
    ShapeStatistics& s = extremes_;
    if (s.tets++ == 0) {
        s.min_sigma = shape.sigma;
        s.min_dihedral_angle_deg = shape.min_dihedral_deg;
        s.min_volume = s.max_volume = shape.volume;
    }
    s.max_radius_edge_ratio = std::max(s.max_radius_edge_ratio, shape.radius_edge);
    s.max_aspect_ratio = std::max(s.max_aspect_ratio, shape.aspect);
    s.min_sigma = std::min(s.min_sigma, shape.sigma);
    s.min_dihedral_angle_deg = std::min(s.min_dihedral_angle_deg, shape.min_dihedral_deg);
    s.max_dihedral_angle_deg = std::max(s.max_dihedral_angle_deg, shape.max_dihedral_deg);
    s.min_volume = std::min(s.min_volume, shape.volume);
    s.max_volume = std::max(s.max_volume, shape.volume);
    const double bin = shape.min_dihedral_deg / 5;  // the negated comparison keeps NaN in bin 0
    ++s.min_dihedral_histogram[!(bin >= 1) ? 0 : std::min<std::size_t>(s.min_dihedral_histogram.size() - 1, static_cast<std::size_t>(bin))];
}

ShapeStatistics ShapeAccumulator::result() const { return extremes_; }

namespace {

constexpr std::array<std::array<std::size_t, 2>, 6> kEdges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

/// For every vertex the higher-numbered ends of the edges of one class of tetrahedra, with repetitions.
struct EdgeBuckets {
    std::vector<std::size_t> first;
    std::vector<std::uint32_t> ends;

    EdgeBuckets(const TetMesh& mesh, const std::vector<TetClass>& classes, TetClass wanted) : first(mesh.vertices.size() + 2, 0) {
        const auto for_edges = [&](auto&& visit) {
            for (std::size_t t = 0; t < mesh.tets.size(); ++t)
                if (classes[t] == wanted)
                    for (const auto& e : kEdges) visit(std::minmax({mesh.tets[t][e[0]], mesh.tets[t][e[1]]}));
        };
        // Counted two places ahead so that, after filling, first[v] .. first[v + 1] is the bucket of v.
        for_edges([&](const auto& e) { ++first[std::size_t{e.first} + 2]; });
        for (std::size_t v = 2; v < first.size(); ++v) first[v] += first[v - 1];
        ends.resize(first.back());
        for_edges([&](const auto& e) { ends[first[std::size_t{e.first} + 1]++] = e.second; });
    }

    [[nodiscard]] std::pair<const std::uint32_t*, const std::uint32_t*> bucket(std::size_t v) const { return {ends.data() + first[v], ends.data() + first[v + 1]}; }
};

struct EdgeLengths {
    double lowest = 0, highest = 0;
    long double sum = 0;
    std::uint64_t count = 0;

    void add(double length) {
        lowest = count == 0 ? length : std::min(lowest, length);
        highest = std::max(highest, length);
        sum += static_cast<long double>(length);
        ++count;
    }
    void store(ShapeStatistics& s) const {
        s.min_edge = lowest;
        s.max_edge = highest;
        s.mean_edge = count == 0 ? 0 : static_cast<double>(sum / static_cast<long double>(count));
    }
};

}  // namespace

void measure_edges(const TetMesh& mesh, const std::vector<TetClass>& classes, ShapeStatistics& all, ShapeStatistics& interior, ShapeStatistics& boundary) {
    const EdgeBuckets inside(mesh, classes, TetClass::interior), outside(mesh, classes, TetClass::boundary);
    EdgeLengths of_all, of_inside, of_outside;
    // The lower end of the last edge found inside, and outside, whose higher end is this vertex: repetitions need no sorting.
    std::vector<std::uint32_t> last_inside(mesh.vertices.size(), kNoVertex), last_outside(mesh.vertices.size(), kNoVertex);
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        const auto v = static_cast<std::uint32_t>(i);
        const auto visit = [&](const EdgeBuckets& buckets, std::vector<std::uint32_t>& last, EdgeLengths& lengths, const std::vector<std::uint32_t>* counted) {
            const auto [begin, end] = buckets.bucket(v);
            for (const std::uint32_t* w = begin; w != end; ++w) {
                if (last[*w] == v) continue;
                last[*w] = v;
                const double length = distance(mesh.vertices[v], mesh.vertices[*w]);
                lengths.add(length);
                if (counted == nullptr || (*counted)[*w] != v) of_all.add(length);
            }
        };
        visit(inside, last_inside, of_inside, nullptr);
        visit(outside, last_outside, of_outside, &last_inside);
    }
    of_all.store(all);
    of_inside.store(interior);
    of_outside.store(boundary);
}

}  // namespace wellmesh
