// SPDX-License-Identifier: Apache-2.0
#include "refinement/boundary_sample.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <span>
#include <tuple>
#include <utility>

#include "conforming/boundary_refiner.hpp"
#include "conforming/place_point.hpp"
#include "core/edge_key.hpp"
#include "core/infinity.hpp"
#include "core/rng.hpp"
#include "core/sorting.hpp"
#include "core/vec3_math.hpp"
#include "refinement/planar_refiner.hpp"

namespace wellmesh {
namespace {

constexpr std::size_t kTetsAPiece = std::size_t{1} << 14;
/// Over the greatest circumradius of tetrahedra: the length of a piece of a segment that has to be split, and about that of the pieces; with longer ones there is
/// more to mend along segments. A tetrahedron at a piece of 2 would have to have its centre on it.
constexpr double kWholeOverRadius = 1.8, kPieceOverRadius = 1.1;
/// Of a piece's length or a circumradius: takes exact symmetry away.
constexpr double kJitter = 0.05;
/// Of a subsegment: no piece is shorter.
constexpr double kLeastPart = 1e-6;
constexpr double kMostPieces = 1e6;
/// How often pieces of segments are split for the sake of facets. What is left then is for splitting in space.
constexpr unsigned kRounds = 4;
/// To find so many points anew takes less time than to split one piece in space.
constexpr std::size_t kWorth = 16;
/// Facets to a piece of work, where there are more than a few.
constexpr std::size_t kFacetsAPiece = 32, kFewFacets = 1024;
constexpr std::size_t kBetweenQuestions = 1024;  // subsegments

class BoundarySampler {
public:
    BoundarySampler(const ConformingMesh& mesh, const AcuteGeometry& acute, const std::function<double(const Vec3&, CellId)>& radius, bool varies, std::uint64_t seed,
                    Workers& workers, SharedGuard& guard)
        : mesh_(mesh), acute_(acute), radius_(radius), varies_(varies), seed_(seed), workers_(workers), guard_(guard) {}

    std::optional<BoundarySample> run() {
        list_boundary();
        if (!sample_segments()) return {};
        group_faces();
        for (unsigned round = 1; sample_facets(); ++round) {
            if (round < kRounds && split_encroached()) continue;
            collect();
            return std::move(out_);
        }
        return {};
    }

private:
    struct EdgePoint {
        double at = 0;             // from a, in lengths
        std::uint32_t number = 0;  // of the sample's points
    };
    struct Edge {
        std::uint64_t key = 0;
        Subsegment of{};  // a below b
        double radius = kInfinity;
        std::vector<EdgePoint> points{};  // from a to b
        bool changed = false;
    };
    /// Of one facet.
    struct Found {
        std::size_t begin = 0, end = 0;  // of faces_
        std::vector<Vec3> points;
        std::vector<std::array<VertexId, 3>> faces;  // points by kNew + their number here
        struct Piece {
            const Edge* of;
            std::size_t before;  // point k of it, or its end
            friend auto operator<=>(const Piece&, const Piece&) = default;
        };
        std::vector<Piece> encroached;
        bool waits = true;
    };
    static constexpr std::uint32_t kNew = 0x80000000U;

    void list_boundary();
    bool sample_segments();
    void sample(Edge& e);
    void halve(const Edge& e, const Vec3& a, const Vec3& b, double low, double high, std::vector<double>& at) const;
    void put(Edge& e, double at, VertexId ball = {});
    [[nodiscard]] double ball(const Edge& e, VertexId end) const;
    void group_faces();
    bool sample_facets();
    bool split_encroached();
    void split(Edge& e, std::size_t piece);
    bool sample(FacetId f, Found& found, PlanarRefiner& plane) const;
    void collect();
    [[nodiscard]] double radius_in(FacetId f, const Vec3& p) const;
    [[nodiscard]] const Edge* find(std::uint64_t key) const {
        const auto at = std::lower_bound(edges_.begin(), edges_.end(), key, [](const Edge& e, std::uint64_t k) { return e.key < k; });
        return at != edges_.end() && at->key == key ? &*at : nullptr;
    }

    const ConformingMesh& mesh_;
    const AcuteGeometry& acute_;
    const std::function<double(const Vec3&, CellId)>& radius_;
    bool varies_;
    std::uint64_t seed_;
    Workers& workers_;
    SharedGuard& guard_;
    BoundarySample out_;
    std::vector<Edge> edges_;     // by key
    std::vector<Subface> faces_;  // by facet
    std::vector<Found> found_;    // by facet that has faces
};

/// Subfaces, each once, and subsegments with the least radius beside them.
void BoundarySampler::list_boundary() {
    const TetStore& tets = mesh_.tets();
    struct Listed {
        std::vector<Edge> edges;
        std::vector<Subface> faces;
    };
    std::vector<Listed> listed((tets.slots() + kTetsAPiece - 1) / kTetsAPiece);
    workers_.for_ranges(tets.slots(), kTetsAPiece, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (std::size_t i = begin; i < end; ++i) {
            const TetId t{i};
            if (!tets.is_live(t) || !mesh_.has_labels(t)) continue;
            const TetLabels& l = mesh_.labels(t);
            for (unsigned f = 0; f < 4; ++f)
                if (l.facets[f].valid() && t < tets.across(t, f).tet()) listed[piece].faces.push_back({tets.face_corners(TetFace{t, f}), l.facets[f], t});
            if (tets.is_ghost(t)) continue;
            for (unsigned e = 0; e < 6; ++e) {
                if (!l.segments[e].valid()) continue;
                const VertexId a = tets.corner(t, kEdgeCorners[e][0]), b = tets.corner(t, kEdgeCorners[e][1]);
                const double radius = mesh_.in_domain(t) ? radius_(0.5 * (mesh_.point(a) + mesh_.point(b)), mesh_.cell(t)) : kInfinity;
                listed[piece].edges.push_back({.key = edge_key(a, b), .of = {std::min(a, b), std::max(a, b), l.segments[e]}, .radius = radius});
            }
        }
    });
    for (const Listed& l : listed) {
        edges_.insert(edges_.end(), l.edges.begin(), l.edges.end());
        faces_.insert(faces_.end(), l.faces.begin(), l.faces.end());
    }
    sort_on(workers_, std::span(edges_), [](const Edge& x, const Edge& y) { return std::tie(x.key, x.radius) < std::tie(y.key, y.radius); });
    edges_.erase(std::unique(edges_.begin(), edges_.end(), [](const Edge& x, const Edge& y) { return x.key == y.key; }), edges_.end());
    std::stable_sort(faces_.begin(), faces_.end(), [](const Subface& x, const Subface& y) { return x.facet < y.facet; });
}

bool BoundarySampler::sample_segments() {
    std::size_t k = 0;
    for (Edge& e : edges_) {
        if (++k % kBetweenQuestions == 0 && !guard_.may_go_on(0)) return false;
        sample(e);
    }
    return true;
}

void BoundarySampler::put(Edge& e, double at, VertexId ball) {
    const Vec3 &a = mesh_.point(e.of.a), &b = mesh_.point(e.of.b);
    const Vec3 p = at < 0.5 ? a + at * (b - a) : b - (1 - at) * (b - a);
    const EdgePoint point{at, static_cast<std::uint32_t>(out_.points.size())};
    e.points.insert(std::upper_bound(e.points.begin(), e.points.end(), at, [](double x, const EdgePoint& q) { return x < q.at; }), point);
    out_.points.push_back({{project_to_segment(mesh_.plc(), e.of.segment, p), CarrierKind::segment, e.of.segment.value()}, ball});
}

/// In lengths of the edge.
double BoundarySampler::ball(const Edge& e, VertexId end) const {
    if (mesh_.info(end).carrier != CarrierKind::input_vertex) return 0;
    const double radius = acute_.ball_radius(end);
    return radius > 0 ? radius / distance(mesh_.point(e.of.a), mesh_.point(e.of.b)) : 0;
}

void BoundarySampler::sample(Edge& e) {
    if (e.radius == kInfinity) return;
    const Vec3 a = mesh_.point(e.of.a), b = mesh_.point(e.of.b);
    const double length = distance(a, b);
    if (!varies_ && !(length > kWholeOverRadius * e.radius)) return;
    std::vector<double> at;  // from a, in lengths
    if (varies_) {
        halve(e, a, b, 0, 1, at);
    } else {
        const auto pieces = static_cast<std::uint32_t>(std::clamp(std::round(length / (kPieceOverRadius * e.radius)), 2.0, kMostPieces));
        const std::uint64_t key = mix64(seed_, e.key);
        for (std::uint32_t k = 1; k < pieces; ++k) at.push_back((k + kJitter * (unit_double(mix64(key, k)) - 0.5)) / pieces);
    }
    if (at.empty()) return;
    // What is in a ball stays; what leaves it near by is cut on its sphere.
    const double from = ball(e, e.of.a), to = ball(e, e.of.b);
    const bool cuts_low = from > 0 && at.front() < kSphereReach * from, cuts_high = to > 0 && 1 - at.back() < kSphereReach * to;
    if ((cuts_low || cuts_high) && !(from + to < 1 - kLeastPart)) return;
    if (cuts_low) put(e, from, e.of.a);
    for (const double x : at)
        if (!(cuts_low && x < kSphereReach * from) && !(cuts_high && 1 - x < kSphereReach * to)) put(e, x);
    if (cuts_high) put(e, 1 - to, e.of.b);
}

/// Piece k ends at point k.
void BoundarySampler::split(Edge& e, std::size_t piece) {
    const std::size_t count = e.points.size();
    const double low = piece == 0 ? 0 : e.points[piece - 1].at, high = piece == count ? 1 : e.points[piece].at;
    const double from = low == 0 ? ball(e, e.of.a) : 0, to = high == 1 ? ball(e, e.of.b) : 0;
    const double shake = kJitter * (unit_double(mix64(mix64(seed_, e.key), std::bit_cast<std::uint64_t>(low + high))) - 0.5);
    const double middle = low + (0.5 + shake) * (high - low);
    const bool cuts_low = from > 0 && middle < kSphereReach * from, cuts_high = to > 0 && 1 - middle < kSphereReach * to;
    const double at = cuts_low ? from : cuts_high ? 1 - to : middle;
    if (!(at > low + kLeastPart && at < high - kLeastPart)) return;
    put(e, at, cuts_low ? e.of.a : cuts_high ? e.of.b : VertexId{});
    e.changed = true;
}

/// Of pieces of segments that keep facets from being as fine as they are to be. @return whether any was split
bool BoundarySampler::split_encroached() {
    std::vector<Found::Piece> pieces;
    for (const Found& f : found_)
        if (f.encroached.size() * kWorth > f.points.size()) pieces.insert(pieces.end(), f.encroached.begin(), f.encroached.end());
    std::sort(pieces.begin(), pieces.end(), std::greater<>());  // from the far end, so that numbers stay
    pieces.erase(std::unique(pieces.begin(), pieces.end()), pieces.end());
    for (const Found::Piece& p : pieces) split(edges_[static_cast<std::size_t>(p.of - edges_.data())], p.before);
    bool any = false;
    for (Found& f : found_) {
        f.waits = false;
        for (std::size_t i = f.begin; i < f.end && !f.waits; ++i)
            for (unsigned k = 0; k < 3; ++k) {
                const Edge* const e = find(edge_key(faces_[i].corners[k], faces_[i].corners[(k + 1) % 3]));
                f.waits = f.waits || (e != nullptr && e->changed);
            }
        any = any || f.waits;
    }
    for (Edge& e : edges_) e.changed = false;
    return any;
}

/// Where the radius varies along the subsegment.
void BoundarySampler::halve(const Edge& e, const Vec3& a, const Vec3& b, double low, double high, std::vector<double>& at) const {
    const double middle = 0.5 * (low + high);
    const Vec3 p = a + middle * (b - a);
    double radius = e.radius;  // at the middle of the whole
    if (high - low < 1) {
        radius = kInfinity;
        for (const FacetId f : mesh_.plc().segments[e.of.segment.index()].facets) radius = std::min(radius, radius_in(f, p));
    }
    if (!((high - low) * distance(a, b) > kWholeOverRadius * radius) || high - low < kLeastPart) return;
    const double here = middle + kJitter * (unit_double(mix64(mix64(seed_, e.key), at.size())) - 0.5) * (high - low);
    halve(e, a, b, low, here, at);
    at.push_back(here);
    halve(e, a, b, here, high, at);
}

/// The least on both sides.
double BoundarySampler::radius_in(FacetId f, const Vec3& p) const {
    double least = kInfinity;
    for (const CellId c : mesh_.plc().facets[f.index()].cells)
        if (mesh_.is_filled(c)) least = std::min(least, radius_(p, c));
    return least;
}

void BoundarySampler::group_faces() {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
        if (i == 0 || faces_[i].facet != faces_[i - 1].facet) found_.emplace_back().begin = i;
        found_.back().end = i + 1;
    }
}

/// Those that wait. @return false if the guard said stop
bool BoundarySampler::sample_facets() {
    const std::size_t share = found_.size() < kFewFacets ? 1 : kFacetsAPiece;  // few of them may be large
    workers_.for_ranges(found_.size(), share, [&](std::size_t begin, std::size_t end, std::size_t) {
        PlanarRefiner plane;
        for (std::size_t f = begin; f < end; ++f)
            if (found_[f].waits && (!guard_.may_go_on(0) || !sample(faces_[found_[f].begin].facet, found_[f], plane))) return;
    });
    return guard_.may_go_on(0);
}

void BoundarySampler::collect() {
    const auto vertex = [&](std::uint32_t number) { return VertexId{mesh_.vertex_slots() + number}; };
    for (const Edge& e : edges_) {
        VertexId before = e.of.a;
        for (const EdgePoint& p : e.points) {
            out_.segments.push_back({before, vertex(p.number), e.of.segment});
            before = vertex(p.number);
        }
        out_.segments.push_back({before, e.of.b, e.of.segment});
    }
    for (const Found& found : found_) {
        const FacetId f = faces_[found.begin].facet;
        const auto first = static_cast<std::uint32_t>(out_.points.size());
        for (const Vec3& p : found.points) out_.points.push_back({{p, CarrierKind::facet, f.value()}, {}});
        for (std::array<VertexId, 3> corners : found.faces) {
            for (VertexId& v : corners)
                if ((v.value() & kNew) != 0) v = vertex(first + (v.value() & ~kNew));
            out_.faces.push_back({corners, f, {}});
        }
    }
}

/// @return false if the guard said stop
bool BoundarySampler::sample(FacetId f, Found& found, PlanarRefiner& plane) const {
    const ValidFacet& facet = mesh_.plc().facets[f.index()];
    const std::span<const Subface> faces(faces_.data() + found.begin, found.end - found.begin);
    found.points.clear();
    found.faces.clear();
    found.encroached.clear();
    const auto flat = [&](const Vec3& p) {
        const auto [u, v] = facet_coordinates(facet, p);
        return PlanarRefiner::Point{u, v};
    };
    const auto leave = [&] {  // as it is
        for (const Subface& s : faces) found.faces.push_back(s.corners);
    };
    std::vector<VertexId> vertices;  // by number in the plane
    for (const Subface& s : faces) vertices.insert(vertices.end(), s.corners.begin(), s.corners.end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    const auto number_of = [&](VertexId v) { return static_cast<std::uint32_t>(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin()); };
    std::vector<PlanarRefiner::Point> points;
    points.reserve(vertices.size());
    for (const VertexId v : vertices) points.push_back(flat(mesh_.point(v)));
    std::vector<PlanarRefiner::Corners> triangles;
    std::vector<std::uint8_t> fixed;
    std::vector<const Edge*> to_split;
    for (const Subface& s : faces) {
        PlanarRefiner::Corners c{number_of(s.corners[0]), number_of(s.corners[1]), number_of(s.corners[2])};
        const auto &p = points[c[0]], &q = points[c[1]], &r = points[c[2]];
        if ((q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x) < 0) std::swap(c[1], c[2]);
        std::uint8_t bits = 0;
        for (unsigned k = 0; k < 3; ++k) {
            const Edge* const e = find(edge_key(vertices[c[(k + 1) % 3]], vertices[c[(k + 2) % 3]]));
            if (e == nullptr) continue;
            bits |= static_cast<std::uint8_t>(1U << k);
            if (!e->points.empty()) to_split.push_back(e);
        }
        triangles.push_back(c);
        fixed.push_back(bits);
    }
    std::sort(to_split.begin(), to_split.end());
    to_split.erase(std::unique(to_split.begin(), to_split.end()), to_split.end());
    const auto most_at = [&](const Vec3& p) { return std::pow(radius_in(f, p), 2); };
    const double most = varies_ ? 0 : most_at({});
    if (!plane.begin(points, triangles, fixed)) {
        leave();
        return true;
    }
    const auto old_vertices = static_cast<std::uint32_t>(vertices.size());
    struct OnEdge {
        const Edge* of;
        std::size_t place;
    };
    std::vector<OnEdge> on_edge;  // vertices from old_vertices on
    for (const Edge* const e : to_split) {
        std::uint32_t before = number_of(e->of.a);
        const std::uint32_t end = number_of(e->of.b);
        for (std::size_t k = 0; k < e->points.size() && before != PlanarRefiner::kNone; ++k) {
            before = plane.split_edge(before, end, flat(out_.points[e->points[k].number].at.point));
            on_edge.push_back({e, k});
        }
        if (before != PlanarRefiner::kNone) continue;
        leave();  // the mesh will show what is wrong with that
        return true;
    }
    for (const OnEdge& p : on_edge) vertices.emplace_back(mesh_.vertex_slots() + p.of->points[p.place].number);
    const std::size_t old_ones = vertices.size();
    const auto in_space = [&](const PlanarRefiner::Point& p) { return facet.origin + (p.x * facet.axis_u + p.y * facet.axis_v); };
    Vec3 waiting{};
    const bool goes_on = plane.refine(
        [&](const PlanarRefiner::Point& p) { return varies_ ? most_at(in_space(p)) : most; },
        [&](const PlanarRefiner::Corners& c, double radius, PlanarRefiner::Point& p) {
            const std::uint64_t key = mix64(mix64(seed_, f.value()), mix64(c[0], mix64(c[1], c[2])));
            p.x += kJitter * radius * (2 * unit_double(mix64(key, 0)) - 1);
            p.y += kJitter * radius * (2 * unit_double(mix64(key, 1)) - 1);
            waiting = project_to_facet(facet, in_space(p));
            p = flat(waiting);
        },
        [&](std::uint32_t a, std::uint32_t b) {
            if (a > b) std::swap(a, b);
            if (b >= old_ones) return;
            if (b < old_vertices) {
                if (const Edge* const e = find(edge_key(vertices[a], vertices[b])); e != nullptr) found.encroached.push_back({e, 0});
                return;
            }
            // Between two points of one edge, the later one of which is b, or one and an end.
            const OnEdge& at = on_edge[b - old_vertices];
            const bool is_last = a < old_vertices && !(at.place == 0 && vertices[a] == at.of->of.a);
            found.encroached.push_back({at.of, is_last ? at.place + 1 : at.place});
        },
        [&](const PlanarRefiner::Point& p, std::uint32_t v) {
            if (v >= old_vertices || mesh_.info(vertices[v]).carrier != CarrierKind::input_vertex) return true;
            const double ball = acute_.ball_radius(vertices[v]);
            const PlanarRefiner::Point& at = plane.points()[v];
            return !((p.x - at.x) * (p.x - at.x) + (p.y - at.y) * (p.y - at.y) < ball * ball);
        },
        [&] { found.points.push_back(waiting); }, [&] { return guard_.may_go_on(0); });
    if (!goes_on) return false;
    const std::size_t first_new = found.points.size() - (plane.points().size() - old_ones);
    plane.for_each_triangle([&](const PlanarRefiner::Corners& c) {
        std::array<VertexId, 3>& corners = found.faces.emplace_back();
        for (unsigned k = 0; k < 3; ++k) corners[k] = c[k] < old_ones ? vertices[c[k]] : VertexId{kNew | (first_new + c[k] - old_ones)};
    });
    return true;
}

}  // namespace

std::optional<BoundarySample> sample_boundary(const ConformingMesh& mesh, const AcuteGeometry& acute, const std::function<double(const Vec3&, CellId)>& radius, bool varies,
                                              std::uint64_t seed, Workers& workers, SharedGuard& guard) {
    return BoundarySampler(mesh, acute, radius, varies, seed, workers, guard).run();
}

}  // namespace wellmesh
