// SPDX-License-Identifier: Apache-2.0
#include "certify/space_claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "certify/box_cover.hpp"
#include "certify/delaunay_cells.hpp"
#include "certify/triangle_tree.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

bool has(const Tet& tet, std::uint32_t v) { return v == tet[0] || v == tet[1] || v == tet[2] || v == tet[3]; }

/// Is `other` on or beyond the outer side of a face of the positive tetrahedron `tet`?
bool beyond_a_face(const SuspectMesh& mesh, const Tet& tet, const Tet& other) {
    for (const auto& f : kFaceCorners) {
        const Triangle face{tet[f[0]], tet[f[1]], tet[f[2]]};
        if (std::all_of(other.begin(), other.end(), [&](std::uint32_t v) {
                if (v == face[0] || v == face[1] || v == face[2]) return true;
                // The face turns counter-clockwise seen from outside: outer is positive.
                return mesh.predicates().orient3d(mesh.point(face[0]), mesh.point(face[1]), mesh.point(face[2]), mesh.point(v)) != Sign::negative;
            }))
            return true;
    }
    return false;
}

std::uint64_t number(std::size_t index) { return std::uint64_t{index} + 1; }

Box3 box_of(const SuspectMesh& mesh, const Tet& tet) {
    const std::array<Vec3, 4> p{mesh.point(tet[0]), mesh.point(tet[1]), mesh.point(tet[2]), mesh.point(tet[3])};
    return Box3::of(p.data(), 4);
}

std::uint32_t tet_of_hull_face(const ConstraintTriangle& t) { return t.tets[t.tets[0] == kNone ? 1 : 0]; }

/// A hull face and its plane.
struct HullFace {
    Box3 box;
    Vec3 corner, normal;  ///< rounded once a difference, a product and a sum, as orient3d's minors are
    std::uint32_t triangle = 0;
    std::uint32_t plane = 0;  ///< the same only for faces that lie in one plane exactly, with the mesh on the same side

    HullFace(const SuspectMesh& mesh, const ConstraintTriangle& t, std::uint32_t number) : corner(mesh.point(t.v[0])), triangle(number) {
        const Corners corners{mesh.point(t.v[0]), mesh.point(t.v[1]), mesh.point(t.v[2])};
        box = Box3::of(corners.data(), 3);
        normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    }
};

/// Does the positive tetrahedron meet the plane of the hull face in more than a point or an edge, with points on its inner side?
bool spans_plane_inside(const SuspectMesh& mesh, const HullFace& plane, const ConstraintTriangle& face, const Tet& tet) {
    const Sign inner_sign = face.tets[0] == kNone ? Sign::negative : Sign::positive;
    const double bound = mesh.predicates().orient3d_bound();
    // orient3d's determinants, expanded by their last rows: with as many roundings, so that the same bound holds.
    std::array<double, 4> values{};
    for (std::size_t i = 0; i < 4; ++i) values[i] = dot(plane.normal, mesh.point(tet[i]) - plane.corner);
    int inner = 0, outer = 0;
    for (double& inwards : values) {
        if (inner_sign != Sign::positive) inwards = -inwards;
        inner += inwards > bound;
        outer += inwards < -bound;
    }
    for (std::size_t i = 0; inner + outer < 4 && i < 4; ++i) {
        if (std::abs(values[i]) > bound) continue;
        const std::uint32_t v = tet[i];
        if (v == face.v[0] || v == face.v[1] || v == face.v[2]) continue;
        const Sign s = mesh.predicates().orient3d(mesh.point(face.v[0]), mesh.point(face.v[1]), mesh.point(face.v[2]), mesh.point(v));
        if (s != Sign::zero) ++(s == inner_sign ? inner : outer);
    }
    return inner > 0 && (outer > 0 || inner == 1);
}

bool in_one_plane(const SuspectMesh& mesh, const ConstraintTriangle& a, const ConstraintTriangle& b) {
    const auto side = [&](std::uint32_t v) { return mesh.predicates().orient3d(mesh.point(a.v[0]), mesh.point(a.v[1]), mesh.point(a.v[2]), mesh.point(v)); };
    if (std::any_of(b.v.begin(), b.v.end(), [&](std::uint32_t v) { return std::find(a.v.begin(), a.v.end(), v) == a.v.end() && side(v) != Sign::zero; })) return false;
    // A positive tetrahedron is on the inner side.
    const Tet& inside = mesh.mesh().tets[tet_of_hull_face(b)];
    const auto apex = std::find_if(inside.begin(), inside.end(), [&](std::uint32_t v) { return std::find(b.v.begin(), b.v.end(), v) == b.v.end(); });
    return apex != inside.end() && side(*apex) == (a.tets[0] == kNone ? Sign::negative : Sign::positive);
}

/// Pairs of a tetrahedron and a hull face whose box it meets, per element, that are looked at before it is worth trying another way: each costs a few
/// signs, and these together about as much as the other way.
constexpr std::size_t kPairsPerElement = 100;

enum class InsideHull : std::uint8_t { clear, not_clear, too_many };

/// Hull faces near a few tetrahedra that are listed one after the other: mostly they are neighbours, and one search serves them all.
class NearFaces {
public:
    static constexpr std::size_t kTets = 32;  ///< listed together
    static constexpr std::size_t kFew = 4;    ///< of these, and looked at together

    NearFaces(const BoxTree& tree, const std::vector<HullFace>& faces) : tree_(tree), faces_(faces) {}

    void move_to(const Box3& around) {
        found_.clear();
        // Where they are no neighbours, each is searched for by itself.
        few_ = !tree_.any_meeting(around, [&](std::uint32_t i) {
            if (found_.empty()) box_ = faces_[i].box;
            box_.grow(faces_[i].box);
            found_.push_back(faces_[i]);
            return found_.size() > kMost;
        });
    }
    /// @pre `around` is inside the one that was moved to.
    void narrow_to(const Box3& around) {
        if (!few_) return;
        nearest_.resize(kMost + 1);  // to be written to without a branch
        std::size_t n = 0;
        if (!found_.empty() && box_.meets(around))
            for (std::size_t i = 0; i < found_.size(); ++i) {
                nearest_[n] = static_cast<std::uint16_t>(i);
                n += meet(found_[i].box, around);
            }
        nearest_.resize(n);
    }
    /// Calls visit(face) for those whose box meets `box`, but those that `skip` says yes to, until it returns true. @return whether it did.
    /// @pre `box` is inside the one that was narrowed to.
    template <class Skip, class Visit>
    bool any_meeting(const Box3& box, Skip&& skip, Visit&& visit) const {
        if (!few_) return tree_.any_meeting(box, [&](std::uint32_t i) { return !skip(faces_[i]) && visit(faces_[i]); });
        return std::any_of(nearest_.begin(), nearest_.end(), [&](std::uint16_t i) { return !skip(found_[i]) && meet(found_[i].box, box) && visit(found_[i]); });
    }

private:
    static bool meet(const Box3& a, const Box3& b) {  // no branches: whether they do can't be foreseen
        return (a.low.x <= b.high.x) & (b.low.x <= a.high.x) & (a.low.y <= b.high.y) & (b.low.y <= a.high.y) & (a.low.z <= b.high.z) & (b.low.z <= a.high.z);
    }
    static constexpr std::size_t kMost = 256;
    const BoxTree& tree_;
    const std::vector<HullFace>& faces_;
    std::vector<HullFace> found_;
    std::vector<std::uint16_t> nearest_;  // of those
    Box3 box_{};
    bool few_ = true;
};

/// Clear: no tetrahedron overlaps the one at a hull face next to that face, which proves `disjoint_tets` if the premises of (1) hold.
/// @param faces  numbers of the hull faces to look at.
InsideHull look_inside_hull(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, const std::vector<std::uint32_t>& faces) {
    std::vector<HullFace> hull;
    std::vector<Box3> boxes;
    for (const std::uint32_t i : faces) {
        hull.emplace_back(mesh, triangles[i], i);
        // Neighbours in the list are neighbours in space.
        const std::size_t n = hull.size();
        hull.back().plane = n > 1 && in_one_plane(mesh, triangles[hull[n - 2].triangle], triangles[i]) ? hull[n - 2].plane : static_cast<std::uint32_t>(n - 1);
        boxes.push_back(hull.back().box);
    }
    const std::size_t most_pairs = kPairsPerElement * (mesh.tet_count() + hull.size());
    const BoxCover cover(boxes);
    const BoxTree tree(boxes);
    // Either ends the search; then the claim is decided in another way, so that it doesn't matter which was first.
    std::atomic<std::size_t> pairs = 0;
    std::atomic<bool> overlapping = false;
    mesh.workers().for_ranges(mesh.tet_count(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
        NearFaces near(tree, hull);
        std::array<Box3, NearFaces::kTets> box{};
        for (std::size_t first = begin; first < end && !overlapping && pairs <= most_pairs; first += NearFaces::kTets) {
            const std::size_t n = std::min(NearFaces::kTets, end - first);
            for (std::size_t i = 0; i < n; ++i) box[i] = box_of(mesh, mesh.mesh().tets[first + i]);
            Box3 around = box[0];
            for (std::size_t i = 1; i < n; ++i) around.grow(box[i]);
            if (!cover.may_meet(around)) continue;
            near.move_to(around);
            std::size_t met = 0;
            for (std::size_t i = 0; i < n; ++i) {
                if (i % NearFaces::kFew == 0) {
                    Box3 few = box[i];
                    for (std::size_t k = i + 1; k < std::min(n, i + NearFaces::kFew); ++k) few.grow(box[k]);
                    near.narrow_to(few);
                }
                const std::size_t t = first + i;
                const Tet& tet = mesh.mesh().tets[t];
                std::uint32_t plane = kNone;  // that was looked at last
                bool spans = false;
                const bool found = near.any_meeting(
                    box[i], [&](const HullFace& f) { return f.plane == plane && !spans; },
                    [&](const HullFace& f) {
                        if (++met > most_pairs) return true;
                        const ConstraintTriangle& face = triangles[f.triangle];
                        const std::uint32_t owner = tet_of_hull_face(face);
                        if (owner == t) return false;
                        if (f.plane != plane) spans = spans_plane_inside(mesh, f, face, tet);
                        plane = f.plane;
                        return spans && overlap(mesh, t, owner);
                    });
                if (found && met <= most_pairs) overlapping = true;
            }
            if (met > 0) pairs += met;
        }
    });
    return overlapping ? InsideHull::not_clear : pairs > most_pairs ? InsideHull::too_many : InsideHull::clear;
}

}  // namespace

// Convex bodies have disjoint interiors iff a plane separates them weakly. The planes that do so for two polytopes form a cone; where
// together they span space, the cone is pointed, and its extreme rays are planes through three of the corners. So it is enough to try
// those.
bool overlap(const SuspectMesh& mesh, std::size_t tet, std::size_t other) {
    const Tet &a = mesh.mesh().tets[tet], &b = mesh.mesh().tets[other];
    if (mesh.positive(tet) && beyond_a_face(mesh, a, b)) return false;
    if (mesh.positive(other) && beyond_a_face(mesh, b, a)) return false;
    std::array<std::uint32_t, 8> corners{};
    const auto middle = std::copy(a.begin(), a.end(), corners.begin());
    const auto end = std::copy_if(b.begin(), b.end(), middle, [&](std::uint32_t v) { return !has(a, v); });
    for (auto i = corners.begin(); i != end; ++i)
        for (auto j = i + 1; j != end; ++j)
            for (auto k = j + 1; k != end; ++k) {
                // bits: some corner of a (1, 2) or b (4, 8) is on the negative (1, 4) or positive (2, 8) side
                int seen = 0;
                const auto look = [&](const Tet& corners_of, int negative, int positive) {
                    for (const std::uint32_t v : corners_of) {
                        if (v == *i || v == *j || v == *k) continue;
                        const Sign s = mesh.predicates().orient3d(mesh.point(*i), mesh.point(*j), mesh.point(*k), mesh.point(v));
                        seen |= s == Sign::negative ? negative : s == Sign::positive ? positive : 0;
                    }
                };
                look(a, 1, 2);
                if (seen == 3 || seen == 0) continue;  // 0: the three are collinear, as a is not flat
                look(b, 4, 8);
                if (seen == (1 | 8) || seen == (2 | 4)) return false;
            }
    return true;
}

Claim claim_disjoint(const SuspectMesh& mesh, VertexSearch& search, const std::vector<ConstraintTriangle>& triangles, const HullProof& proof,
                     bool faces_in_order) {
    ClaimBuilder claim("disjoint_tets", "No two tetrahedra overlap.");
    claim.checked(mesh.tet_count());
    if (faces_in_order) {
        const std::vector<std::uint32_t>& components = proof.components();
        if (proof.embedded() && (components.size() == 1 || look_inside_hull(mesh, triangles, components) == InsideHull::clear))
            return claim.decided();
        std::vector<std::uint32_t> hull;
        for (std::uint32_t i = 0; i < triangles.size(); ++i)
            if (triangles[i].on_hull) hull.push_back(i);
        const InsideHull inside = look_inside_hull(mesh, triangles, hull);
        if (inside == InsideHull::clear || (inside == InsideHull::too_many && disjoint_as_delaunay(mesh, search.get()))) return claim.decided();
    }
    std::vector<std::uint32_t> at_hull;
    for (const ConstraintTriangle& t : triangles)
        if (t.on_hull) at_hull.push_back(tet_of_hull_face(t));
    std::sort(at_hull.begin(), at_hull.end());
    at_hull.erase(std::unique(at_hull.begin(), at_hull.end()), at_hull.end());
    const auto flat = [&](std::size_t t) {
        const Tet& v = mesh.mesh().tets[t];
        return !mesh.positive(t) && mesh.predicates().orient3d(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(v[3])) == Sign::zero;
    };
    std::erase_if(at_hull, flat);
    std::vector<Box3> boxes;
    boxes.reserve(at_hull.size());
    for (const std::uint32_t t : at_hull) boxes.push_back(box_of(mesh, mesh.mesh().tets[t]));
    const BoxTree tree(boxes);
    look_in_ranges(mesh.workers(), mesh.tet_count(), kGrain, claim, [&](std::size_t begin, std::size_t end, ClaimBuilder& part) {
        for (std::size_t t = begin; t < end; ++t) {
            std::uint32_t partner = kNone;
            // Each pair of two tetrahedra at the hull is met from both sides: both overlap.
            const bool found = tree.any_meeting(box_of(mesh, mesh.mesh().tets[t]), [&](std::uint32_t i) {
                if (at_hull[i] == t) return false;
                partner = at_hull[i];
                return !flat(t) && overlap(mesh, t, partner);
            });
            if (found) part.violated(EntityKind::tetrahedron, number(t), mesh.tet_centroid(t), [&] { return fmt::format("overlaps tetrahedron {}", partner + 1); });
        }
    });
    if (claim.violations() > 0) claim.note("only overlaps with tetrahedra at the hull are counted");
    return faces_in_order ? claim.decided() : claim.undecided("without sound faces only overlaps at the hull can be found");
}

Claim claim_delaunay(const SuspectMesh& mesh, VertexSearch& vertices, bool proven_by_faces) {
    const bool weighted = mesh.is_weighted();
    ClaimBuilder claim = weighted ? ClaimBuilder("weighted_delaunay", "No vertex is in conflict with the sphere orthogonal to a tetrahedron.")
                                  : ClaimBuilder("delaunay", "No vertex lies strictly inside the circumsphere of a tetrahedron.");
    const std::uint64_t positive = mesh.positive_count();
    claim.checked(positive);
    if (positive < mesh.tet_count()) claim.note(fmt::format("{} inverted or flat tetrahedra have no circumsphere to look at", mesh.tet_count() - positive));
    if (proven_by_faces) return claim.decided();
    const BallSearch& search = vertices.get();
    look_in_ranges(mesh.workers(), mesh.tet_count(), kSmallGrain, claim, [&](std::size_t begin, std::size_t end, ClaimBuilder& part) {
        for (std::size_t t = begin; t < end; ++t) {
            if (!mesh.positive(t)) continue;
            const Tet& v = mesh.mesh().tets[t];
            const Ball ball = search.circumball(mesh.weighted(v[0]), mesh.weighted(v[1]), mesh.weighted(v[2]), mesh.weighted(v[3]));
            std::uint32_t intruder = kNone;
            const bool found = search.any_in(ball, [&](std::uint32_t q) {
                if (has(v, q)) return false;
                intruder = q;
                return mesh.in_sphere(t, q) == Sign::positive;
            });
            if (found)
                part.violated(EntityKind::tetrahedron, number(t), mesh.tet_centroid(t), [&] {
                    return fmt::format("vertex {} at {} is {}, by {:.3g} of the squared radius", intruder + 1, text_of(mesh.point(intruder)),
                                       weighted ? "in conflict with its orthogonal sphere" : "inside its circumsphere", search.depth(ball, intruder));
                });
        }
    });
    return claim.decided();
}

namespace {

/// Constraint triangles of one range with a vertex strictly inside, however little.
struct Touched {
    std::uint64_t of_hull_faces = 0, of_all = 0;
};

}  // namespace

GabrielFindings claim_gabriel_subfaces(const SuspectMesh& mesh, VertexSearch& vertices, const std::vector<ConstraintTriangle>& triangles,
                                       bool proven_by_hull) {
    const bool weighted = mesh.is_weighted();
    ClaimBuilder claim(weighted ? "weighted_gabriel_subfaces" : "gabriel_subfaces",
                       fmt::format("No vertex {} sphere {} a constraint triangle (on the hull, between regions, or listed).",
                                   weighted ? "is in conflict with the smallest" : "lies inside the equatorial", weighted ? "orthogonal to" : "of"));
    claim.checked(triangles.size());
    if (proven_by_hull) return {claim.decided(), 0};
    const BallSearch& search = vertices.get();
    std::vector<Touched> parts((triangles.size() + kSmallGrain - 1) / kSmallGrain);
    look_in_ranges(mesh.workers(), triangles.size(), kSmallGrain, claim, [&](std::size_t begin, std::size_t end, ClaimBuilder& part) {
        Touched& touch = parts[begin / kSmallGrain];
        for (std::size_t i = begin; i < end; ++i) {
            const ConstraintTriangle& t = triangles[i];
            const WeightedPoint a = mesh.weighted(t.v[0]), b = mesh.weighted(t.v[1]), c = mesh.weighted(t.v[2]);
            const Ball ball = search.equatorial_ball(a, b, c);
            const auto side = [&](std::uint32_t q) {
                return weighted ? equatorial_power_test(a, b, c, mesh.weighted(q)) : side_of_equatorial_sphere(a.point, b.point, c.point, mesh.point(q));
            };
            if (!(ball.a > 0)) continue;  // collinear corners span no sphere; such a triangle is no face of a positive tetrahedron
            std::uint32_t intruder = kNone;
            bool inside = false;
            const bool encroached = search.any_in(ball, [&](std::uint32_t q) {
                if (q == t.v[0] || q == t.v[1] || q == t.v[2]) return false;
                if (side(q) != Sign::positive) return false;
                inside = true;
                intruder = q;
                return search.depth(ball, q) > kGabrielMargin;
            });
            touch.of_hull_faces += inside && t.on_hull;
            touch.of_all += inside && !encroached;
            if (encroached)
                part.violated(EntityKind::triangle, t.listed == kNone ? 0 : number(t.listed), mesh.centroid(t.v.data(), 3), [&] {
                    return fmt::format("vertex {} at {} is {} sphere of {} {} {}, by {:.3g} of the squared radius", intruder + 1, text_of(mesh.point(intruder)),
                                       weighted ? "in conflict with the orthogonal" : "inside the equatorial", t.v[0] + 1, t.v[1] + 1, t.v[2] + 1,
                                       search.depth(ball, intruder));
                });
        }
    });
    std::uint64_t touched_hull_faces = 0, touched = 0;
    for (const Touched& part : parts) touched_hull_faces += part.of_hull_faces, touched += part.of_all;
    if (touched > 0) claim.note(fmt::format("{} more have a vertex inside by less than {:g} of the squared radius", touched, kGabrielMargin));
    return {claim.decided(), touched_hull_faces};
}

Claim claim_gabriel_subsegments(const SuspectMesh& mesh, VertexSearch& vertices, const std::vector<ConstraintSegment>& segments,
                                bool proven_by_hull) {
    const bool weighted = mesh.is_weighted();
    ClaimBuilder claim(weighted ? "weighted_gabriel_subsegments" : "gabriel_subsegments",
                       fmt::format("No vertex {} sphere {} a constraint edge (where constraint triangles bend or meet, or listed).",
                                   weighted ? "is in conflict with the smallest" : "lies inside the diametral", weighted ? "orthogonal to" : "of"));
    claim.checked(segments.size());
    if (proven_by_hull) return claim.decided();
    const BallSearch& search = vertices.get();
    std::vector<std::uint64_t> parts((segments.size() + kSmallGrain - 1) / kSmallGrain, 0);
    look_in_ranges(mesh.workers(), segments.size(), kSmallGrain, claim, [&](std::size_t begin, std::size_t end, ClaimBuilder& part) {
        for (std::size_t i = begin; i < end; ++i) {
            const ConstraintSegment& s = segments[i];
            const WeightedPoint a = mesh.weighted(s.v[0]), b = mesh.weighted(s.v[1]);
            if (a.point == b.point) continue;
            const Ball ball = search.diametral_ball(a, b);
            const auto side = [&](std::uint32_t q) {
                return weighted ? diametral_power_test(a, b, mesh.weighted(q)) : side_of_diametral_sphere(a.point, b.point, mesh.point(q));
            };
            std::uint32_t intruder = kNone;
            bool inside = false;
            const bool encroached = search.any_in(ball, [&](std::uint32_t q) {
                if (q == s.v[0] || q == s.v[1] || side(q) != Sign::positive) return false;
                inside = true;
                intruder = q;
                return search.depth(ball, q) > kGabrielMargin;
            });
            parts[begin / kSmallGrain] += inside && !encroached;
            if (encroached)
                part.violated(EntityKind::edge, s.listed == kNone ? 0 : number(s.listed), mesh.centroid(s.v.data(), 2), [&] {
                    return fmt::format("vertex {} at {} is {} sphere of {} {}, by {:.3g} of the squared radius", intruder + 1, text_of(mesh.point(intruder)),
                                       weighted ? "in conflict with the orthogonal" : "inside the diametral", s.v[0] + 1, s.v[1] + 1, search.depth(ball, intruder));
                });
        }
    });
    const std::uint64_t touched = std::accumulate(parts.begin(), parts.end(), std::uint64_t{0});
    if (touched > 0) claim.note(fmt::format("{} more have a vertex inside by less than {:g} of the squared radius", touched, kGabrielMargin));
    return claim.decided();
}

}  // namespace wellmesh::certifying
