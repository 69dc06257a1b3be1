// SPDX-License-Identifier: Apache-2.0
// Lengths of the mesh's edges.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "certify/suspect_mesh.hpp"
#include "certify/tets_by_corner.hpp"
#include "certify/upper_edges.hpp"
#include "core/vec3_math.hpp"
#include "wellmesh/certificate.hpp"

namespace wellmesh::certifying {

class EdgeLengths {
public:
    void add(double length, bool interior, bool boundary) {
        all_.add(length);
        if (interior) interior_.add(length);
        if (boundary) boundary_.add(length);
    }
    /// Those from a vertex.
    void add(const SuspectMesh& mesh, std::uint32_t vertex, std::span<const UpperEdges::End> ends) {
        const Vec3& from = mesh.mesh().vertices[vertex];
        for (const UpperEdges::End& e : ends) add(distance(from, mesh.mesh().vertices[e.vertex]), e.interior, e.boundary);
    }
    void add(const EdgeLengths& later);
    /// Fills min_edge, mean_edge and max_edge.
    void store(ShapeStatistics& all, ShapeStatistics& interior, ShapeStatistics& boundary) const;

private:
    struct Lengths {
        double lowest = 0, highest = 0;
        long double sum = 0;
        std::uint64_t count = 0;

        void add(double length) {
            lowest = count == 0 ? length : std::min(lowest, length);
            highest = std::max(highest, length);
            sum += static_cast<long double>(length);
            ++count;
        }
        void add(const Lengths& o);
        void store(ShapeStatistics& s) const;
    };
    Lengths all_, interior_, boundary_;
};

/// As many as there are threads at work. Which one a piece of work gets makes no difference.
template <class Scratch>
class ScratchPool {
public:
    template <class Make>
    std::unique_ptr<Scratch> take(Make&& make) {
        {
            const std::lock_guard lock(mutex_);
            if (!idle_.empty()) {
                std::unique_ptr<Scratch> scratch = std::move(idle_.back());
                idle_.pop_back();
                return scratch;
            }
        }
        return make();
    }
    void give_back(std::unique_ptr<Scratch> scratch) {
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(scratch));
    }

private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<Scratch>> idle_;
};

/// Each edge counts once in all, and once in each of interior and boundary that has a tetrahedron at it. O(n) time on graded meshes.
/// @param classes  one entry a tetrahedron; the corners of those not left out are distinct.
[[nodiscard]] EdgeLengths measure_edges(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<TetClass>& classes);

}  // namespace wellmesh::certifying
