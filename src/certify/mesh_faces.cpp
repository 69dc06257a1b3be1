// SPDX-License-Identifier: Apache-2.0
#include "certify/mesh_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

/// A face in the bucket of its lowest vertex. One word for both other vertices: compared at once, they sort faster.
struct FaceRecord {
    std::uint64_t others;  // the middle vertex above the highest one
    std::uint32_t tet;
    friend bool operator<(const FaceRecord& a, const FaceRecord& b) { return a.others != b.others ? a.others < b.others : a.tet < b.tet; }
};

Triangle sorted(Triangle t) {
    if (t[0] > t[1]) std::swap(t[0], t[1]);
    if (t[1] > t[2]) std::swap(t[1], t[2]);
    if (t[0] > t[1]) std::swap(t[0], t[1]);
    return t;
}

/// All faces of all tetrahedra, bucketed by lowest vertex (counting sort), each bucket sorted.
class FaceTable {
public:
    explicit FaceTable(const SuspectMesh& mesh) : first_(mesh.vertex_count() + 2, 0) {
        // Counted two places ahead so that, after filling, first_[v] .. first_[v + 1] is the bucket of v.
        for_faces(mesh, [&](const Triangle& k, std::uint32_t) { ++first_[std::size_t{k[0]} + 2]; });
        for (std::size_t v = 2; v < first_.size(); ++v) first_[v] += first_[v - 1];
        records_.resize(first_.back());
        for_faces(mesh, [&](const Triangle& k, std::uint32_t t) { records_[first_[std::size_t{k[0]} + 1]++] = {std::uint64_t{k[1]} << 32 | k[2], t}; });
    }

    /// Calls visit(face, tets) for every distinct face in ascending order, `tets` ascending.
    template <class Visit>
    void for_groups(Visit&& visit) {
        std::vector<std::uint32_t> tets;
        for (std::size_t v = 0; v + 2 < first_.size(); ++v) {
            FaceRecord* r = records_.data() + first_[v];
            FaceRecord* const end = records_.data() + first_[v + 1];
            sort_bucket(r, end);
            while (r != end) {
                const std::uint64_t others = r->others;
                const Triangle face{static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(others >> 32), static_cast<std::uint32_t>(others)};
                tets.clear();
                for (; r != end && r->others == others; ++r) tets.push_back(r->tet);
                visit(face, tets);
            }
        }
    }

private:
    /// Records come by ascending tetrahedron, so a stable sort by vertices is enough; buckets of a good mesh are short.
    static void sort_bucket(FaceRecord* begin, FaceRecord* end) {
        if (end - begin > 48) return std::sort(begin, end);
        for (FaceRecord* i = begin; i < end; ++i) {
            const FaceRecord record = *i;
            FaceRecord* place = i;
            for (; place > begin && record.others < place[-1].others; --place) *place = place[-1];
            *place = record;
        }
    }
    template <class Visit>
    static void for_faces(const SuspectMesh& mesh, Visit&& visit) {
        for (std::size_t t = 0; t < mesh.tet_count(); ++t) {
            const auto& v = mesh.mesh().tets[t];
            for (const auto& f : kFaceCorners) visit(sorted({v[f[0]], v[f[1]], v[f[2]]}), static_cast<std::uint32_t>(t));
        }
    }
    std::vector<std::size_t> first_;
    std::vector<FaceRecord> records_;
};

/// Corner of the tetrahedron that is not on the face; any corner if the tetrahedron repeats a vertex.
std::uint32_t apex(const std::array<std::uint32_t, 4>& tet, const Triangle& face) {
    for (const std::uint32_t v : tet)
        if (v != face[0] && v != face[1] && v != face[2]) return v;
    return tet[3];
}

struct ListedTriangle {
    Triangle v{};
    std::uint32_t number = 0;
};

/// Takes the groups of the table in order and draws all conclusions.
class FaceSurveyor {
public:
    explicit FaceSurveyor(const SuspectMesh& mesh) : mesh_(mesh) {
        const auto& subfaces = mesh.mesh().subfaces;
        listed_.reserve(subfaces.size());
        for (std::size_t i = 0; i < subfaces.size(); ++i) listed_.push_back({sorted(subfaces[i]), static_cast<std::uint32_t>(i)});
        std::sort(listed_.begin(), listed_.end(), [](const ListedTriangle& a, const ListedTriangle& b) { return a.v != b.v ? a.v < b.v : a.number < b.number; });
    }

    void operator()(const Triangle& face, const std::vector<std::uint32_t>& tets) {
        ++survey_.faces;
        ++(tets.size() == 1 ? survey_.boundary_faces : survey_.interior_faces);
        for (std::size_t i = 2; i < tets.size(); ++i)
            face_sharing_.violated(EntityKind::tetrahedron, tets[i] + std::uint64_t{1}, mesh_.centroid(face.data(), 3), [&] {
                return fmt::format("face {} {} {} belongs to {} tetrahedra: {}, {}, {}{}", face[0] + 1, face[1] + 1, face[2] + 1, tets.size(), tets[0] + 1, tets[1] + 1,
                                   tets[2] + 1, tets.size() > 3 ? ", ..." : "");
            });
        find_duplicates(face, tets);
        if (tets.size() == 2) judge_pair(face, tets[0], tets[1]);

        const std::uint32_t listed = take_listed(face);
        const bool interface = tets.size() > 1 && mesh_.region(tets[0]) != mesh_.region(tets[1]);
        if (tets.size() == 1 || interface || listed != kNone) add_constraint(face, tets, listed);
    }

    FaceSurvey finish() {
        take_listed({kNone, kNone, kNone});
        face_sharing_.checked(survey_.faces);
        opposite_sides_.checked(survey_.two_sided_faces);
        distinct_tets_.checked(mesh_.tet_count());
        listed_exist_.checked(listed_.size());
        survey_.face_sharing = face_sharing_.decided();
        survey_.opposite_sides = opposite_sides_.decided();
        survey_.distinct_tets = distinct_tets_.decided();
        survey_.listed_subfaces_exist = listed_exist_.decided();
        return std::move(survey_);
    }

private:
    /// Side of the ascending face on which the tetrahedron's apex lies. Of a positive tetrahedron it follows from the order of its corners:
    /// orient3d changes sign with each transposition, of which the apex takes 3 - i from place i to the end, the others one an inversion.
    Sign side(const Triangle& face, std::uint32_t tet) const {
        const auto& v = mesh_.mesh().tets[tet];
        const std::uint32_t top = apex(v, face);
        if (!mesh_.positive(tet)) return mesh_.predicates().orient3d(mesh_.point(face[0]), mesh_.point(face[1]), mesh_.point(face[2]), mesh_.point(top));
        const std::size_t i = v[0] == top ? 0 : v[1] == top ? 1 : v[2] == top ? 2 : 3;
        const std::uint32_t a = v[i == 0 ? 1 : 0], b = v[i <= 1 ? 2 : 1], c = v[i <= 2 ? 3 : 2];
        const std::size_t transpositions = (3 - i) + (a > b) + (a > c) + (b > c);
        return transpositions % 2 == 0 ? Sign::positive : Sign::negative;
    }

    /// A tetrahedron is looked at only at the face opposite its highest corner, so that each repetition counts once.
    void find_duplicates(const Triangle& face, const std::vector<std::uint32_t>& tets) {
        for (std::size_t i = 1; i < tets.size(); ++i) {
            const std::uint32_t top = apex(mesh_.mesh().tets[tets[i]], face);
            if (top <= face[2]) continue;
            for (std::size_t j = 0; j < i; ++j) {
                if (apex(mesh_.mesh().tets[tets[j]], face) != top) continue;
                distinct_tets_.violated(EntityKind::tetrahedron, tets[i] + std::uint64_t{1}, mesh_.tet_centroid(tets[i]),
                                        [&] { return fmt::format("has the same four vertices as tetrahedron {}", tets[j] + 1); });
                break;
            }
        }
    }

    void judge_pair(const Triangle& face, std::uint32_t t0, std::uint32_t t1) {
        ++survey_.two_sided_faces;
        const Sign s0 = side(face, t0), s1 = side(face, t1);
        if (s0 == Sign::zero || s1 == Sign::zero) return;  // a flat tetrahedron has no side; positive_tets names it
        if (s0 == s1) {
            opposite_sides_.violated(EntityKind::tetrahedron, t0 + std::uint64_t{1}, mesh_.centroid(face.data(), 3), [&] {
                return fmt::format("lies on the same side of face {} {} {} as tetrahedron {}", face[0] + 1, face[1] + 1, face[2] + 1, t1 + 1);
            });
            return;
        }
        if (!mesh_.positive(t0) || !mesh_.positive(t1)) return;
        survey_.locally_not_delaunay += mesh_.in_sphere(t0, apex(mesh_.mesh().tets[t1], face)) == Sign::positive;
    }

    /// Passes the listed triangles that come before `face` (they are no faces) and those equal to it.
    /// @return the lowest number of the latter.
    std::uint32_t take_listed(const Triangle& face) {
        for (; next_listed_ < listed_.size() && listed_[next_listed_].v < face; ++next_listed_) {
            const ListedTriangle& l = listed_[next_listed_];
            listed_exist_.violated(EntityKind::triangle, l.number + std::uint64_t{1}, mesh_.centroid(l.v.data(), 3),
                                   [&] { return fmt::format("vertices {} {} {} span no face of a tetrahedron", l.v[0] + 1, l.v[1] + 1, l.v[2] + 1); });
            if (survey_.constraints.empty() || survey_.constraints.back().v != l.v) {
                ConstraintTriangle c;
                c.v = l.v;
                c.listed = l.number;
                survey_.constraints.push_back(c);
            }
        }
        if (next_listed_ == listed_.size() || listed_[next_listed_].v != face) return kNone;
        const std::uint32_t lowest = listed_[next_listed_].number;
        while (next_listed_ < listed_.size() && listed_[next_listed_].v == face) ++next_listed_;
        return lowest;
    }

    void add_constraint(const Triangle& face, const std::vector<std::uint32_t>& tets, std::uint32_t listed) {
        ConstraintTriangle c;
        c.v = face;
        c.listed = listed;
        c.is_face = true;
        c.on_hull = tets.size() == 1;
        for (std::size_t i = 0; i < std::min<std::size_t>(2, tets.size()); ++i) {
            const std::size_t wanted = side(face, tets[i]) == Sign::negative ? 1 : 0;
            c.tets[c.tets[wanted] == kNone ? wanted : 1 - wanted] = tets[i];
        }
        survey_.constraints.push_back(c);
    }

    const SuspectMesh& mesh_;
    FaceSurvey survey_;
    std::vector<ListedTriangle> listed_;
    std::size_t next_listed_ = 0;
    ClaimBuilder face_sharing_{"face_sharing", "No face is shared by more than two tetrahedra."};
    ClaimBuilder opposite_sides_{"opposite_sides", "Two tetrahedra that share a face lie on opposite sides of it."};
    ClaimBuilder distinct_tets_{"distinct_tets", "No two tetrahedra have the same four vertices."};
    ClaimBuilder listed_exist_{"listed_subfaces_exist", "Every listed triangle is a face of a tetrahedron."};
};

struct EdgeWithOpposite {
    Edge v{};
    std::uint32_t opposite = 0;
};

Edge sorted(Edge e) {
    if (e[0] > e[1]) std::swap(e[0], e[1]);
    return e;
}

/// See find_constraint_segments. The bend is measured by rounded arithmetic: it is a tolerance, not a predicate.
bool flat_together(const SuspectMesh& mesh, const Edge& e, std::uint32_t o0, std::uint32_t o1, double flat_angle) {
    const Vec3 &p = mesh.point(e[0]), along = mesh.point(e[1]) - p;
    const Vec3 n0 = cross(along, mesh.point(o0) - p), n1 = cross(mesh.point(o1) - p, along);
    const double height = std::sqrt(std::min(squared_norm(n0), squared_norm(n1))) / norm(along);
    const double rounding = 32 * std::numeric_limits<double>::epsilon() * mesh.largest_coordinate() / height;
    return std::atan2(norm(cross(n0, n1)), dot(n0, n1)) < std::max(flat_angle, rounding);
}

}  // namespace

FaceSurvey survey_faces(const SuspectMesh& mesh) {
    FaceTable table(mesh);
    FaceSurveyor surveyor(mesh);
    table.for_groups(surveyor);
    return surveyor.finish();
}

std::vector<ConstraintSegment> find_constraint_segments(const SuspectMesh& mesh, const std::vector<ConstraintTriangle>& triangles, double flat_angle) {
    std::vector<EdgeWithOpposite> edges;
    edges.reserve(3 * triangles.size());
    for (const ConstraintTriangle& t : triangles)
        for (std::size_t i = 0; i < 3; ++i) edges.push_back({sorted(Edge{t.v[i], t.v[(i + 1) % 3]}), t.v[(i + 2) % 3]});
    std::sort(edges.begin(), edges.end(), [](const EdgeWithOpposite& a, const EdgeWithOpposite& b) { return a.v != b.v ? a.v < b.v : a.opposite < b.opposite; });
    std::vector<ConstraintSegment> segments;
    for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
        while (j < edges.size() && edges[j].v == edges[i].v) ++j;
        if (j - i == 2 && flat_together(mesh, edges[i].v, edges[i].opposite, edges[i + 1].opposite, flat_angle)) continue;
        segments.push_back({edges[i].v, kNone});
    }
    const auto& listed = mesh.mesh().subsegments;
    for (std::size_t i = 0; i < listed.size(); ++i) segments.push_back({sorted(listed[i]), static_cast<std::uint32_t>(i)});
    std::sort(segments.begin(), segments.end(), [](const ConstraintSegment& a, const ConstraintSegment& b) { return a.v != b.v ? a.v < b.v : a.listed < b.listed; });
    segments.erase(std::unique(segments.begin(), segments.end(), [](const ConstraintSegment& a, const ConstraintSegment& b) { return a.v == b.v; }), segments.end());
    return segments;
}

std::vector<Edge> edges_between(const SuspectMesh& mesh, const std::vector<bool>& wanted) {
    std::vector<Edge> edges;
    const auto drop_repetitions = [&] {
        std::sort(edges.begin(), edges.end());
        edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    };
    std::size_t limit = 1 << 16;
    for (const auto& tet : mesh.mesh().tets) {
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i + 1; j < 4; ++j)
                if (wanted[tet[i]] && wanted[tet[j]]) edges.push_back(sorted(Edge{tet[i], tet[j]}));
        if (edges.size() > limit) {  // memory stays proportional to the distinct edges
            drop_repetitions();
            limit = std::max(limit, 2 * edges.size());
        }
    }
    drop_repetitions();
    return edges;
}

Claim claim_listed_subsegments_exist(const SuspectMesh& mesh) {
    ClaimBuilder claim("listed_subsegments_exist", "Every listed edge is an edge of a tetrahedron.");
    const auto& listed = mesh.mesh().subsegments;
    claim.checked(listed.size());
    std::vector<bool> wanted(mesh.vertex_count(), false);
    for (const Edge& e : listed) wanted[e[0]] = wanted[e[1]] = true;
    const std::vector<Edge> edges = edges_between(mesh, wanted);
    for (std::size_t i = 0; i < listed.size(); ++i)
        if (!std::binary_search(edges.begin(), edges.end(), sorted(listed[i])))
            claim.violated(EntityKind::edge, i + 1, mesh.centroid(listed[i].data(), 2),
                           [&] { return fmt::format("vertices {} {} are not joined by an edge of a tetrahedron", listed[i][0] + 1, listed[i][1] + 1); });
    return claim.decided();
}

}  // namespace wellmesh::certifying
