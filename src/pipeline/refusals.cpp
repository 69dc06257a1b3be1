// SPDX-License-Identifier: Apache-2.0
#include "pipeline/refusals.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "validation/rounding.hpp"

namespace wellmesh {
namespace {

/// Of memory at the peak, which is in the certificate: 255 MB measured for 395 540 vertices of a cube.
constexpr double kBytesPerVertex = 650;

/// A promise that is not kept. Goals are none: they are asked for and reported.
bool is_broken(const Claim& claim) {
    const bool goal = claim.name == "radius_edge" || claim.name == "dihedral" || claim.name == "aspect_ratio" || claim.name == "sigma" || claim.name == "max_volume" ||
                      claim.name == "dihedral_boundary" || claim.name == "sigma_boundary";
    return !goal && claim.state == Claim::State::refuted;
}

}  // namespace

void require_valid_options(const MeshOptions& options, bool given) {
    std::vector<std::string> wrong = check(options);
    if (given) {
        if (options.mode == Mode::certified) wrong.emplace_back("the mode must be practical: the paper's claims are about meshes that are made from scratch");
        if (options.slivers != SliverStrategy::best) wrong.emplace_back("slivers must be best where a mesh is given");
        if (options.invariants) wrong.emplace_back("invariants are claims about insertions and can't be asked for where a mesh is given");
    }
    if (!wrong.empty()) throw MeshError(ErrorCode::bad_options, Stage::validate, fmt::format("{}", fmt::join(wrong, "; ")));
}

void check_vertex_sizes(const Plc& plc) {
    const std::vector<double>& sizes = plc.vertex_sizes;
    if (sizes.empty()) return;
    const auto fail = [](const std::string& what) { throw MeshError(ErrorCode::bad_input, Stage::validate, what); };
    if (sizes.size() != plc.vertices.size()) fail(fmt::format("there are {} sizes of vertices, but {} vertices", sizes.size(), plc.vertices.size()));
    for (std::size_t v = 0; v < sizes.size(); ++v)
        if (!(sizes[v] >= 0) || !std::isfinite(sizes[v]))
            fail(fmt::format("the size of vertex {} is {}; it must be a finite number above 0, or 0 for none", v + plc.first_number, sizes[v]));
}

bool may_unmerge(const MeshOptions& options, const Plc& plc) { return !options.coplanar_tolerance && plc.relative_rounding > 0; }

double rounding_of_doubles(const Plc& plc) {
    double largest = 0;
    for (const Vec3& p : plc.vertices) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return Rounding{.largest_coordinate = largest}.merging();
}

void require_room(const Limits& limits, std::size_t vertices, Stage stage) {
    const auto& most = limits.max_vertices;
    if (most && vertices > *most)
        throw MeshError(ErrorCode::budget_exhausted, stage,
                        fmt::format("at most {} vertices were allowed, and {} are there already in stage {}, before the mesh conformed to its input", *most, vertices, to_string(stage)));
}

void refuse_hopeless(const Limits& limits, double expected) {
    constexpr double kMostVertices = (1U << 30U) / 6.0;  // about six tetrahedra a vertex, 2^30 of them
    if (limits.max_vertices || limits.time) return;
    if (expected > kMostVertices)
        throw MeshError(ErrorCode::mesh_too_large, Stage::refine,
                        fmt::format("the size asks for about {:.2g} vertices; a mesh can have {:.2g}: ask for a coarser one, or set a limit", expected, kMostVertices));
    // What is beyond the limit by less is begun: the estimate is no better.
    constexpr double kSurelyTooMuch = 1.5;
    const auto& memory = limits.memory_bytes;
    if (memory && expected * kBytesPerVertex > kSurelyTooMuch * static_cast<double>(*memory))
        throw MeshError(ErrorCode::mesh_too_large, Stage::refine,
                        fmt::format("the size asks for about {:.2g} vertices, which take about {:.2g} GiB, and {:.2g} are allowed: ask for a coarser one, or set another limit",
                                    expected, expected * kBytesPerVertex / (1 << 30), static_cast<double>(*memory) / (1 << 30)));
}

double most_for_gaps(const Limits& limits, double vertices, double for_size) {
    constexpr double kAnyway = 1e5;
    return limits.max_vertices ? static_cast<double>(*limits.max_vertices) : kAnyway + 10 * std::max(vertices, for_size);
}

bool is_refuted(const Certificate& certificate) { return std::any_of(certificate.claims.begin(), certificate.claims.end(), is_broken); }

void fail_if_refuted(const Certificate& certificate) {
    for (const Claim& claim : certificate.claims) {
        if (!is_broken(claim)) continue;
        std::vector<ElementRef> offenders;
        if (claim.witness) offenders.push_back(*claim.witness);
        throw MeshError(ErrorCode::internal_invariant, Stage::certify,
                        fmt::format("the finished mesh fails its own certificate, claim {}: {} of {}: {}; please report this input", claim.name, claim.violations,
                                    claim.checked, claim.detail),
                        offenders);
    }
}

MeshError acute_failure(const ValidPlc& plc, const MeshError& cause, const RunGuard& guard) {
    const AcuteFeature& worst = plc.acute_features.front();
    const bool segment = worst.kind == EntityKind::segment;
    const Vec3 where = segment ? plc.vertices[plc.segments[worst.id].ends[0].index()] : plc.vertices[worst.id];
    return {guard.user_limit_spent() ? cause.code() : ErrorCode::unsupported_acute, cause.stage(),
            fmt::format("{}; the input has {} features at less than 90 degrees, the sharpest {:.4g} degrees at {} {} ({}, {}, {})", cause.what(),
                        plc.acute_features.size(), worst.angle_deg, to_string(worst.kind), segment ? worst.id + 1 : plc.source_vertex[worst.id] + 1, where.x,
                        where.y, where.z),
            {{worst.kind, segment ? worst.id + 1U : plc.source_vertex[worst.id] + 1U, where}}};
}

}  // namespace wellmesh
