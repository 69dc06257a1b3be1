// SPDX-License-Identifier: Apache-2.0
#include "shape/thin_out.hpp"

#include <algorithm>

namespace wellmesh {
namespace {

constexpr std::size_t kTrialsPerExcess = 12;  // of old vertices, for each vertex that is too many: on large meshes not all can be tried
constexpr std::size_t kFirstTrials = 600;       // that may fail before that proportion is asked of the vertices that went, too
constexpr double kNegligible = 0.005;  // part of the vertices that may be too many: each that goes takes as long as hundreds of tetrahedra took to make
constexpr std::size_t kStride = 16;  // from one vertex to the next one tried: the first ones tell how it would be everywhere
constexpr double kWorthGoingOn = 0.02;      // of the vertices must go in a sweep for another to be tried

std::size_t tolerated(std::size_t enough) { return enough + static_cast<std::size_t>(kNegligible * static_cast<double>(enough)); }

}  // namespace

RunGuard::Verdict Thinning::sweep(std::size_t first, std::size_t enough, std::size_t trials) {
    const std::size_t before = mesh_.vertex_count(), end = mesh_.vertex_slots();
    std::size_t tried = 0;
    for (std::size_t k = 0; k < kStride; ++k)
        for (std::size_t i = k; i < end - std::min(first, end); i += kStride) {
            const VertexId v{end - 1 - i};
            if (mesh_.vertex_count() <= enough || trials == 0) return RunGuard::Verdict::go_on;
            if (!mesh_.triangulation().is_inserted(v)) continue;
            const RunGuard::Verdict verdict = guard_.poll(mesh_.vertex_count(), mesh_.tets().live(), mesh_.vertex_count() - enough);
            if (verdict != RunGuard::Verdict::go_on) return verdict;
            chains_.dissolve(v);
            --trials;
            if (++tried > kFirstTrials + kTrialsPerExcess * (before - mesh_.vertex_count())) return RunGuard::Verdict::go_on;
        }
    return RunGuard::Verdict::go_on;
}

bool Thinning::is_pointless(std::size_t enough) const { return mesh_.vertex_count() <= tolerated(enough); }

RunGuard::Verdict Thinning::run(std::size_t first_new, std::size_t enough) {
    enough = tolerated(enough);
    RunGuard::Verdict verdict = RunGuard::Verdict::go_on;
    std::size_t before = 0;
    do {
        before = mesh_.vertex_count();
        verdict = sweep(first_new, 0, mesh_.vertex_slots());
        if (verdict == RunGuard::Verdict::go_on && mesh_.vertex_count() > enough)
            verdict = sweep(mesh_.plc().vertices.size(), enough, kTrialsPerExcess * (mesh_.vertex_count() - enough));
    } while (verdict == RunGuard::Verdict::go_on && mesh_.vertex_count() > enough &&
             static_cast<double>(before - mesh_.vertex_count()) > kWorthGoingOn * static_cast<double>(before));
    return verdict;
}

}  // namespace wellmesh
