// SPDX-License-Identifier: Apache-2.0
#include "certify/edge_lengths.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <utility>

#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

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
    void add(const EdgeLengths& o) {
        if (o.count == 0) return;
        lowest = count == 0 ? o.lowest : std::min(lowest, o.lowest);
        highest = std::max(highest, o.highest);
        sum += o.sum;
        count += o.count;
    }
    void store(ShapeStatistics& s) const {
        s.min_edge = lowest;
        s.max_edge = highest;
        s.mean_edge = count == 0 ? 0 : static_cast<double>(sum / static_cast<long double>(count));
    }
};

/// Of one range of vertices: the edges of which they are the lower ends.
struct Lengths {
    EdgeLengths all, interior, boundary;
};

/// The edges from one vertex to higher ones, each once.
class UpperEdges {
public:
    struct End {
        std::uint32_t vertex;
        bool interior, boundary;  ///< an end of an edge of such a tetrahedron
    };

    explicit UpperEdges(std::size_t vertices) : marks_(vertices, {kNone, 0}) {}

    [[nodiscard]] std::span<const End> of(const SuspectMesh& mesh, std::uint32_t vertex, std::span<const std::uint32_t> tets, const std::vector<TetClass>& classes) {
        ends_.resize(std::max(ends_.size(), 3 * tets.size() + 1));
        std::uint32_t n = 0;
        for (const std::uint32_t t : tets) {
            if (classes[t] == TetClass::left_out) continue;
            const bool interior = classes[t] == TetClass::interior;
            const auto visit = [&](std::uint32_t w) {  // whether an edge is new can't be predicted, so there is no branch
                Mark& mark = marks_[w];
                const bool is_new = mark.by != vertex;
                mark = {vertex, is_new ? n : mark.place};
                End& end = ends_[mark.place];
                end = {w, static_cast<bool>((end.interior & !is_new) | interior), static_cast<bool>((end.boundary & !is_new) | !interior)};
                n += is_new;
            };
            const auto v = AscendingTet(mesh.mesh().tets[t]).v;
            if (v[0] == vertex) visit(v[1]), visit(v[2]), visit(v[3]);
            else if (v[1] == vertex) visit(v[2]), visit(v[3]);
            else visit(v[3]);
        }
        return {ends_.data(), n};
    }

private:
    struct Mark {
        std::uint32_t by, place;  // the lower end that was last to find the vertex, and where in ends_
    };
    std::vector<End> ends_;  // in order of appearance
    std::vector<Mark> marks_;
};

/// As many as there are threads at work. Which one a piece of work gets makes no difference.
class UpperEdgesPool {
public:
    explicit UpperEdgesPool(std::size_t vertices) : vertices_(vertices) {}
    std::unique_ptr<UpperEdges> take() {
        {
            const std::lock_guard lock(mutex_);
            if (!idle_.empty()) {
                std::unique_ptr<UpperEdges> edges = std::move(idle_.back());
                idle_.pop_back();
                return edges;
            }
        }
        return std::make_unique<UpperEdges>(vertices_);
    }
    void give_back(std::unique_ptr<UpperEdges> edges) {
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(edges));
    }

private:
    std::size_t vertices_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<UpperEdges>> idle_;
};

}  // namespace

void measure_edges(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<TetClass>& classes, ShapeStatistics& all, ShapeStatistics& interior,
                   ShapeStatistics& boundary) {
    std::vector<Lengths> parts((mesh.vertex_count() + kVertexGrain - 1) / kVertexGrain);
    UpperEdgesPool pool(mesh.vertex_count());
    mesh.workers().for_ranges(mesh.vertex_count(), kVertexGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        std::unique_ptr<UpperEdges> edges = pool.take();
        Lengths lengths;
        for (std::size_t i = begin; i < end; ++i) {
            const auto v = static_cast<std::uint32_t>(i);
            for (const UpperEdges::End& e : edges->of(mesh, v, stars.of(v), classes)) {
                const double length = distance(mesh.mesh().vertices[v], mesh.mesh().vertices[e.vertex]);
                lengths.all.add(length);
                if (e.interior) lengths.interior.add(length);
                if (e.boundary) lengths.boundary.add(length);
            }
        }
        parts[piece] = lengths;
        pool.give_back(std::move(edges));
    });
    Lengths sum;
    for (const Lengths& part : parts) sum.all.add(part.all), sum.interior.add(part.interior), sum.boundary.add(part.boundary);
    sum.all.store(all);
    sum.interior.store(interior);
    sum.boundary.store(boundary);
}

}  // namespace wellmesh::certifying
