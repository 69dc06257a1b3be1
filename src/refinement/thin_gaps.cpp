// SPDX-License-Identifier: Apache-2.0
#include "refinement/thin_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "conforming/edge_lookup.hpp"
#include "core/edge_key.hpp"
#include "core/vec3_math.hpp"
#include "quality/tet_shape.hpp"
#include "validation/gap_demand.hpp"

namespace wellmesh {
namespace {

/// The local feature size is that of another gap, across the boundary, unless the tetrahedron is as thin as this many of them.
constexpr double kSameGap = 4;

std::uint32_t feature_of(const ConformingMesh& mesh, VertexId v) {
    const VertexInfo& i = mesh.info(v);
    const ValidPlc& plc = mesh.plc();
    switch (i.carrier) {
        case CarrierKind::input_vertex: return i.carrier_id;
        case CarrierKind::segment: return static_cast<std::uint32_t>(plc.vertices.size()) + i.carrier_id;
        case CarrierKind::facet: return static_cast<std::uint32_t>(plc.vertices.size() + plc.segments.size()) + i.carrier_id;
        case CarrierKind::region: break;
    }
    return std::numeric_limits<std::uint32_t>::max();
}

double smallest_height(const ConformingMesh& mesh, TetId t) {
    const auto& k = mesh.tets().corners(t);
    double twice_area = 0;
    for (unsigned f = 0; f < 4; ++f) {
        const Vec3 &a = mesh.point(k[(f + 1) % 4]), &b = mesh.point(k[(f + 2) % 4]), &c = mesh.point(k[(f + 3) % 4]);
        twice_area = std::max(twice_area, norm(cross(b - a, c - a)));
    }
    return std::abs(six_volumes(mesh.point(k[0]), mesh.point(k[1]), mesh.point(k[2]), mesh.point(k[3]))) / twice_area;
}

}  // namespace

ThinGaps::ThinGaps(const ConformingMesh& mesh, double most_vertices, const std::function<bool(TetId)>& is_forced,
                   std::unique_ptr<const LocalFeatureSize> feature_size) {
    // What each piece of the boundary takes at most, from the tetrahedron beside it: mostly that settles it.
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < mesh.tets().slots(); ++i) {
        const TetId t{i};
        if (!mesh.tets().is_finite(t) || !mesh.in_domain(t) || !mesh.has_labels(t)) continue;
        list_faces(mesh, t, candidates);
        list_edges(mesh, t, candidates);
    }
    double rest = 0;
    for (const Candidate& c : candidates) rest += c.most;
    if (rest <= most_vertices) return;
    std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& x, const Candidate& y) { return x.most < y.most; });
    feature_size_ = feature_size ? std::move(feature_size) : std::make_unique<const LocalFeatureSize>(mesh.plc());
    std::size_t first = 0;  // those before it take next to nothing
    constexpr double kNextToNothing = 0.1;
    for (double sum = 0; first < candidates.size() && (sum += candidates[first].most) <= kNextToNothing * most_vertices;) ++first;
    std::unordered_set<std::uint64_t> sampled;  // edges are beside several tetrahedra; each is looked up, in no order
    for (std::size_t i = first; i < candidates.size(); ++i) {
        const Candidate& candidate = candidates[i];
        if (is_forced(candidate.tet)) continue;
        if (!candidate.far.valid()) {
            sample_face(mesh, candidate);
            continue;
        }
        const auto& corners = mesh.tets().corners(candidate.tet);
        const std::uint64_t key = edge_key(corners[kEdgeCorners[candidate.at][0]], corners[kEdgeCorners[candidate.at][1]]);
        if (!sampled.contains(key) && sample_edge(mesh, candidate)) sampled.insert(key);
    }
    choose(most_vertices);
    if (!any()) feature_size_.reset();
    samples_ = {};
}

/// On features without a common point?
bool ThinGaps::are_apart(const ConformingMesh& mesh, VertexId u, VertexId v) const {
    if (mesh.info(u).carrier == CarrierKind::region || mesh.info(v).carrier == CarrierKind::region) return false;
    return !feature_size_->incident(feature_of(mesh, u), feature_of(mesh, v));
}

/// Triangles of a facet whose tetrahedron ends on something else that is near.
void ThinGaps::list_faces(const ConformingMesh& mesh, TetId t, std::vector<Candidate>& out) const {
    const auto& c = mesh.tets().corners(t);
    for (unsigned f = 0; f < 4; ++f) {
        if (!mesh.labels(t).facets[f].valid() || mesh.info(c[f]).carrier == CarrierKind::region) continue;
        const auto fc = mesh.tets().face_corners(TetFace{t, f});
        const double twice_area = norm(cross(mesh.point(fc[1]) - mesh.point(fc[0]), mesh.point(fc[2]) - mesh.point(fc[0])));
        const double height = std::abs(six_volumes(mesh.point(fc[0]), mesh.point(fc[1]), mesh.point(fc[2]), mesh.point(c[f]))) / twice_area;
        if (twice_area > kSlender * kSlender * height * height) out.push_back({vertices_beside_facet(0.5 * twice_area, height / kSameGap), height, t, f, {}});
    }
}

/// Pieces of segments beside another segment, or beside a facet that they do not touch.
void ThinGaps::list_edges(const ConformingMesh& mesh, TetId t, std::vector<Candidate>& out) const {
    const auto& c = mesh.tets().corners(t);
    for (unsigned e = 0; e < 6; ++e) {
        if (!mesh.labels(t).segments[e].valid()) continue;
        const Vec3 &a = mesh.point(c[kEdgeCorners[e][0]]), &b = mesh.point(c[kEdgeCorners[e][1]]);
        const double length = distance(a, b);
        for (const unsigned k : {unsigned{kEdgeCorners[5 - e][0]}, unsigned{kEdgeCorners[5 - e][1]}}) {
            if (mesh.info(c[k]).carrier == CarrierKind::region) continue;
            const double off = norm(cross(mesh.point(c[k]) - a, b - a)) / length;
            if (length > kSlender * off) out.push_back({vertices_beside_segment(length, off / kSameGap), off, t, e, c[k]});
        }
    }
}

/// What a piece of a segment really takes. @return whether there is a gap at all
bool ThinGaps::sample_edge(const ConformingMesh& mesh, const Candidate& candidate) {
    const LocalFeatureSize& size = *feature_size_;
    const auto& c = mesh.tets().corners(candidate.tet);
    const VertexId a = c[kEdgeCorners[candidate.at][0]], b = c[kEdgeCorners[candidate.at][1]];
    if (!are_apart(mesh, a, candidate.far) && !are_apart(mesh, b, candidate.far)) return false;
    const std::size_t before = samples_.size();
    const std::array ends{mesh.point(a), mesh.point(b)};
    sample_gap(size, ends, {size(ends[0]), size(ends[1])}, [&](double length, double width) {
        if (candidate.height < kSameGap * width) samples_.push_back({width, vertices_beside_segment(length, width), a, candidate.far});
    });
    return samples_.size() > before;
}

/// The same of a facet.
void ThinGaps::sample_face(const ConformingMesh& mesh, const Candidate& candidate) {
    const LocalFeatureSize& size = *feature_size_;
    const VertexId far = mesh.tets().corners(candidate.tet)[candidate.at];
    const ValidPlc& plc = mesh.plc();
    const std::size_t facet = plc.vertices.size() + plc.segments.size() + mesh.labels(candidate.tet).facets[candidate.at].index();
    if (size.incident(static_cast<std::uint32_t>(facet), feature_of(mesh, far))) return;
    const auto fc = mesh.tets().face_corners(TetFace{candidate.tet, candidate.at});
    const auto near = std::find_if(fc.begin(), fc.end(), [&](VertexId v) { return are_apart(mesh, v, far); });
    if (near == fc.end()) return;
    const std::array<Vec3, 3> at{mesh.point(fc[0]), mesh.point(fc[1]), mesh.point(fc[2])};
    sample_gap(size, at, {size(at[0]), size(at[1]), size(at[2])}, [&](double area, double width) {
        if (candidate.height < kSameGap * width) samples_.push_back({width, vertices_beside_facet(area, width), *near, far});
    });
}

/// The narrowest gaps are left, as many as it takes.
void ThinGaps::choose(double most_vertices) {
    std::sort(samples_.begin(), samples_.end(), [](const Sample& x, const Sample& y) { return x.width > y.width; });
    std::size_t filled = 0;
    while (filled < samples_.size() && expected_vertices_ + samples_[filled].vertices <= most_vertices) expected_vertices_ += samples_[filled++].vertices;
    if (filled == samples_.size()) return;
    constexpr double kMargin = 1.01;  // the same gap, rounded
    left_ = LeftGaps{.narrowest = samples_.back().width, .filled_from = kMargin * samples_[filled].width};
    double most = 0;
    for (std::size_t i = filled; i < samples_.size(); ++i) {
        left_->vertices += samples_[i].vertices;
        if (samples_[i].vertices <= most) continue;
        most = samples_[i].vertices;
        left_->width = samples_[i].width;
        left_->sides = {samples_[i].near, samples_[i].far};
    }
}

bool ThinGaps::is_beside_left(const ConformingMesh& mesh, VertexId v) const {
    if (known_.size() <= v.index()) known_.resize(mesh.vertex_slots());
    Known& known = known_[v.index()];
    if (!known.asked || known.point != mesh.point(v)) known = {mesh.point(v), true, (*feature_size_)(mesh.point(v)) < left_->filled_from};
    return known.beside;
}

std::optional<std::array<VertexId, 2>> ThinGaps::sides_joined_by(const ConformingMesh& mesh, TetId t) const {
    if (!any() || !mesh.tets().is_finite(t) || smallest_height(mesh, t) > 2 * left_->filled_from) return std::nullopt;
    const auto& c = mesh.tets().corners(t);
    for (const auto& e : kEdgeCorners)
        if (are_apart(mesh, c[e[0]], c[e[1]]) && is_beside_left(mesh, c[e[0]]) && is_beside_left(mesh, c[e[1]])) return std::array{c[e[0]], c[e[1]]};
    return std::nullopt;
}

}  // namespace wellmesh
