// SPDX-License-Identifier: Apache-2.0
// The certificate, claim by claim. Shares core/, predicates/ and the shape measures with the generator, nothing else.
#include "wellmesh/certificate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "certify/hull_proof.hpp"
#include "certify/mesh_faces.hpp"
#include "certify/mesh_survey.hpp"
#include "certify/plc_claims.hpp"
#include "certify/shape_claims.hpp"
#include "certify/space_claims.hpp"
#include "certify/suspect_mesh.hpp"
#include "certify/tets_by_corner.hpp"
#include "certify/vertex_places.hpp"
#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"

namespace wellmesh {
namespace {

using namespace certifying;

Claim claim_finite(const TetMesh& mesh) {
    ClaimBuilder claim("finite_coordinates", fmt::format("Every coordinate{} is finite and within the range in which predicates are exact.",
                                                         mesh.weights.empty() ? "" : " and weight"));
    claim.checked(mesh.vertices.size());
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
        if (!in_exact_range(flush_to_exact_range(mesh.vertices[v])))
            claim.violated(EntityKind::vertex, v + 1, mesh.vertices[v],
                           [&] { return fmt::format("vertex {} is at {}", v + 1, text_of(mesh.vertices[v])); });
    for (std::size_t v = 0; v < std::min(mesh.weights.size(), mesh.vertices.size()); ++v)
        if (const double w = mesh.weights[v]; !weight_in_exact_range(std::fabs(w) < kMinWeight ? 0 : w))
            claim.violated(EntityKind::vertex, v + 1, mesh.vertices[v], [&] { return fmt::format("vertex {} has weight {}", v + 1, w); });
    return claim.decided();
}

/// Vertex numbers, and lengths of arrays that belong together.
Claim claim_numbers(const TetMesh& mesh) {
    ClaimBuilder claim("numbers_in_range", "Every tetrahedron, triangle and edge names existing vertices, and every array has the right length.");
    const auto look = [&](const auto& elements, EntityKind kind) {
        claim.checked(elements.size());
        for (std::size_t i = 0; i < elements.size(); ++i)
            if (*std::max_element(elements[i].begin(), elements[i].end()) >= mesh.vertices.size())
                claim.violated(kind, i + 1, Vec3{},
                               [&] { return fmt::format("{} {} names a vertex beyond the last, {}", to_string(kind), i + 1, mesh.vertices.size()); });
    };
    look(mesh.tets, EntityKind::tetrahedron);
    look(mesh.subfaces, EntityKind::triangle);
    look(mesh.subsegments, EntityKind::edge);
    const auto length = [&](std::size_t have, std::size_t want, const char* what) {
        if (have != 0 && have != want)
            claim.violated(EntityKind::file, 0, Vec3{}, [&] { return fmt::format("{} {} for {} elements", have, what, want); });
    };
    length(mesh.tet_regions.size(), mesh.tets.size(), "region references");
    length(mesh.weights.size(), mesh.vertices.size(), "weights");
    length(mesh.vertex_carriers.size(), mesh.vertices.size(), "vertex carriers");
    length(mesh.subface_facets.size(), mesh.subfaces.size(), "facet references");
    length(mesh.subface_markers.size(), mesh.subfaces.size(), "facet markers");
    length(mesh.subsegment_segments.size(), mesh.subsegments.size(), "segment references");
    Claim result = claim.decided();
    if (result.witness) result.witness->where.reset();
    return result;
}

Claim claim_positive(const SuspectMesh& mesh) {
    ClaimBuilder claim("positive_tets", "Every tetrahedron is positively oriented and has a volume.");
    claim.checked(mesh.tet_count());
    look_in_ranges(mesh.workers(), mesh.tet_count(), kGrain, claim, [&](std::size_t begin, std::size_t end, ClaimBuilder& part) {
        for (std::size_t t = begin; t < end; ++t) {
            if (mesh.positive(t)) continue;
            part.violated(EntityKind::tetrahedron, t + 1, mesh.tet_centroid(t), [&] {
                const auto& v = mesh.mesh().tets[t];
                const bool flat = orient3d(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])) == Sign::zero;
                return fmt::format("vertices {} {} {} {} make {} tetrahedron", v[0] + 1, v[1] + 1, v[2] + 1, v[3] + 1,
                                   flat ? "a flat" : "an inverted");
            });
        }
    });
    return claim.decided();
}

Claim claim_distinct_vertices(const SuspectMesh& mesh, const VertexPlaces& places) {
    ClaimBuilder claim("distinct_vertices", "No two vertices are at one place.");
    claim.checked(mesh.vertex_count());
    look_in_ranges(mesh.workers(), places.buckets(), kGrain, claim, [&](std::size_t begin, std::size_t end, ClaimBuilder& part) {
        places.for_repetitions(begin, end, [&](std::uint32_t v, std::uint32_t first) {
            part.violated(EntityKind::vertex, v + std::uint64_t{1}, mesh.points()[v],
                          [&] { return fmt::format("vertex {} is where vertex {} is", v + 1, first + 1); });
        });
    });
    return claim.decided();
}

Claim claim_used_vertices(const SuspectMesh& mesh) {
    ClaimBuilder claim("used_vertices", "Every vertex belongs to a tetrahedron.");
    claim.checked(mesh.vertex_count());
    std::vector<std::uint8_t> used(mesh.vertex_count(), 0);
    mesh.workers().for_ranges(mesh.tet_count(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        for (std::size_t t = begin; t < end; ++t)
            for (const std::uint32_t v : mesh.mesh().tets[t]) std::atomic_ref(used[v]).store(1, std::memory_order_relaxed);
    });
    for (std::size_t v = 0; v < used.size(); ++v)
        if (used[v] == 0)
            claim.violated(EntityKind::vertex, v + 1, mesh.points()[v], [&] { return fmt::format("vertex {} belongs to none", v + 1); });
    return claim.decided();
}

/// Every tetrahedron has four faces, every interior face two tetrahedra, every boundary face one.
Claim claim_conservation(const SuspectMesh& mesh, const FaceSurvey& faces) {
    ClaimBuilder claim("face_balance", "Twice the interior faces and the boundary faces are four times the tetrahedra.");
    claim.checked(faces.faces);
    const std::uint64_t left = 2 * faces.interior_faces + faces.boundary_faces, right = 4 * std::uint64_t{mesh.tet_count()};
    if (left != right) claim.violated(EntityKind::file, 0, Vec3{}, [] { return std::string("the balance is not even"); });
    claim.note(fmt::format("2 * {} + {} against 4 * {}", faces.interior_faces, faces.boundary_faces, mesh.tet_count()));
    Claim result = claim.decided();
    if (result.witness) result.witness->where.reset();
    return result;
}

bool broken(const Claim& claim) { return claim.state == Claim::State::refuted; }

/// Thrown between claims, caught in certify().
struct Stopped {};

void append_geometric_claims(const SuspectMesh& mesh, const CertifyOptions& options, const Plc* plc, Certificate& certificate) {
    auto& claims = certificate.claims;
    const auto poll = [&] {
        if (options.stop.stop_requested()) throw Stopped{};
    };
    poll();
    const VertexPlaces places(mesh.points(), mesh.workers());
    const Claim positive = claim_positive(mesh), distinct = claim_distinct_vertices(mesh, places), used = claim_used_vertices(mesh);
    const TetsByCorner stars(mesh);
    MeshSurvey survey = survey_mesh(mesh, stars, wanted_bounds(options), options.exempt);
    const FaceSurvey& faces = survey.faces;
    store_statistics(survey, certificate);
    poll();
    const bool faces_in_order = !broken(positive) && !broken(faces.face_sharing) && !broken(faces.opposite_sides);
    const HullProof proof(mesh, faces.constraints, faces_in_order);
    poll();
    VertexSearch search(mesh);
    const Claim disjoint = claim_disjoint(mesh, search, faces.constraints, proof, faces_in_order);
    claims.insert(claims.end(), {positive, faces.face_sharing, faces.opposite_sides, faces.distinct_tets, disjoint, claim_conservation(mesh, faces),
                                 distinct, used, faces.listed_subfaces_exist, claim_listed_subsegments_exist(mesh, stars)});
    poll();
    const bool locally_delaunay = faces_in_order && disjoint.state == Claim::State::proven && faces.locally_not_delaunay == 0 && !broken(used);
    const bool by_hull = locally_delaunay && proof.hull_is_clear();
    const GabrielFindings subfaces = claim_gabriel_subfaces(mesh, search, faces.constraints, by_hull && proof.interfaces_are_clear());
    poll();
    claims.push_back(claim_delaunay(mesh, search, by_hull || (locally_delaunay && subfaces.touched_hull_faces == 0)));
    claims.push_back(subfaces.claim);
    poll();
    const std::vector<ConstraintSegment> segments = find_constraint_segments(mesh, faces.constraints, options.flat_angle_rad);
    claims.push_back(claim_gabriel_subsegments(mesh, search, segments, by_hull && proof.segments_are_clear(stars, segments)));
    poll();
    certificate.regions = survey.shapes.regions;
    append_plc_claims({mesh, stars, places, faces.constraints}, options, plc, certificate);
    poll();
    const std::vector<Claim> about_shape = shape_claims(mesh, options, std::move(survey));
    claims.insert(claims.end(), about_shape.begin(), about_shape.end());
}

/// The other claims need coordinates to compute with and vertices to look up.
bool usable(const TetMesh& mesh, Certificate& certificate) {
    certificate.claims.push_back(claim_finite(mesh));
    certificate.claims.push_back(claim_numbers(mesh));
    if (mesh.tets.empty()) {
        Claim none = unchecked("has_tets", "The mesh has a tetrahedron.", "it has none");
        none.state = Claim::State::refuted;
        none.violations = 1;
        certificate.claims.push_back(std::move(none));
    }
    return certificate.proven();
}

}  // namespace

Certificate certify(const TetMesh& mesh, const CertifyOptions& options, const Plc* plc) {
    Certificate certificate;
    std::string reason = "the mesh has unusable numbers or coordinates, or no tetrahedron";
    if (usable(mesh, certificate)) {
        try {
            append_geometric_claims(SuspectMesh(mesh, options.threads), options, plc, certificate);
            return certificate;
        } catch (const Stopped&) {
            reason = "the check was stopped";
        }
    }
    // The names of all the others, from a mesh of one tetrahedron, so that readers of a report find every claim.
    TetMesh stand_in;
    stand_in.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    stand_in.tets = {{0, 1, 2, 3}};
    if (!mesh.weights.empty()) stand_in.weights.assign(4, 0);
    Certificate names;
    append_geometric_claims(SuspectMesh(stand_in), {}, nullptr, names);
    for (const Claim& c : names.claims)
        if (certificate.find(c.name) == nullptr) certificate.claims.push_back(unchecked(c.name, c.statement, reason));
    return certificate;
}

void measure_shape(const TetMesh& mesh, Certificate& certificate) {
    Certificate scratch;
    if (!usable(mesh, scratch)) return;
    const SuspectMesh suspect(mesh);
    const TetsByCorner stars(suspect);
    store_statistics(survey_mesh(suspect, stars, {}, {}), certificate);
}

}  // namespace wellmesh
