// SPDX-License-Identifier: Apache-2.0
#include "certify/mesh_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <utility>

#include "certify/sound_star.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

Triangle sorted(Triangle t) {
    if (t[0] > t[1]) std::swap(t[0], t[1]);
    if (t[1] > t[2]) std::swap(t[1], t[2]);
    if (t[0] > t[1]) std::swap(t[0], t[1]);
    return t;
}

struct ListedTriangle {
    Triangle v{};
    std::uint32_t number = 0;
};

std::vector<ListedTriangle> listed_triangles(const SuspectMesh& mesh) {
    const auto& subfaces = mesh.mesh().subfaces;
    std::vector<ListedTriangle> listed;
    listed.reserve(subfaces.size());
    for (std::size_t i = 0; i < subfaces.size(); ++i) listed.push_back({sorted(subfaces[i]), static_cast<std::uint32_t>(i)});
    std::sort(listed.begin(), listed.end(), [](const ListedTriangle& a, const ListedTriangle& b) {
        const auto order = a.v <=> b.v;
        return order < 0 || (order == 0 && a.number < b.number);
    });
    return listed;
}

/// What the faces of a range of vertices say: each face belongs to its lowest vertex.
struct Findings {
    std::uint64_t faces = 0, interior_faces = 0, boundary_faces = 0, locally_not_delaunay = 0, two_sided_faces = 0;
    std::vector<ConstraintTriangle> constraints;
    ClaimBuilder face_sharing, opposite_sides, distinct_tets, listed_exist;
    EdgeLengths edges;
    bool in_order = true;  ///< all stars are sound
};

void report_not_a_face(const SuspectMesh& mesh, const ListedTriangle& l, Findings& found) {
    found.listed_exist.violated(EntityKind::triangle, l.number + std::uint64_t{1}, mesh.centroid(l.v.data(), 3),
                                [&] { return fmt::format("vertices {} {} {} span no face of a tetrahedron", l.v[0] + 1, l.v[1] + 1, l.v[2] + 1); });
}

void report(const SuspectMesh& mesh, SoundStar& star, std::uint32_t vertex, std::span<const ListedTriangle> listed, bool several_regions,
            Findings& found) {
    const std::span<const SoundStar::Face> faces = star.faces();
    found.faces += faces.size();
    found.interior_faces += star.pairs();
    found.two_sided_faces += star.pairs();
    found.boundary_faces += faces.size() - star.pairs();
    found.locally_not_delaunay += star.count_not_delaunay();
    found.edges.add(mesh, vertex, star.edges());
    if (listed.empty() && !several_regions && star.pairs() == faces.size()) return;
    const std::size_t first = found.constraints.size();
    for (std::size_t i = 0; i < listed.size();) {
        const ListedTriangle& l = listed[i];
        if (SoundStar::Face* face = star.find(l.v[1], l.v[2])) {
            face->listed = l.number;
        } else {
            found.constraints.push_back({l.v, {kNone, kNone}, l.number, false, false});
        }
        for (const Triangle v = l.v; i < listed.size() && listed[i].v == v; ++i)
            if (star.find(v[1], v[2]) == nullptr) report_not_a_face(mesh, listed[i], found);
    }
    for (const SoundStar::Face& f : faces) {
        const bool on_hull = f.tets[1] == kNone;
        if (!on_hull && f.listed == kNone && !(several_regions && mesh.region(f.tets[0]) != mesh.region(f.tets[1]))) continue;
        ConstraintTriangle c{{vertex, star.edges()[f.middle].vertex, star.edges()[f.highest].vertex}, f.tets, f.listed, true, on_hull};
        if (!f.first_is_positive) std::swap(c.tets[0], c.tets[1]);
        found.constraints.push_back(c);
    }
    std::sort(found.constraints.begin() + static_cast<std::ptrdiff_t>(first), found.constraints.end(),
              [](const ConstraintTriangle& a, const ConstraintTriangle& b) { return a.v < b.v; });
}

/// The faces at one vertex whatever the tetrahedra are like, in ascending order.
class AnyFaces {
public:
    AnyFaces(const SuspectMesh& mesh, Findings& found) : mesh_(mesh), found_(found) {}

    void survey(std::uint32_t vertex, std::span<const std::uint32_t> tets, std::span<const ListedTriangle> listed) {
        listed_ = listed;
        records_.clear();
        for (const std::uint32_t t : tets) {
            const auto v = AscendingTet(mesh_.mesh().tets[t]).v;
            const auto add = [&](std::uint32_t middle, std::uint32_t highest) { records_.push_back({std::uint64_t{middle} << 32 | highest, t}); };
            if (v[0] == vertex) add(v[1], v[2]), add(v[1], v[3]), add(v[2], v[3]);
            if (v[1] == vertex) add(v[2], v[3]);
        }
        std::sort(records_.begin(), records_.end());
        for (std::size_t i = 0, j = 0; i < records_.size(); i = j) {
            tets_.clear();
            for (; j < records_.size() && records_[j].first == records_[i].first; ++j) tets_.push_back(records_[j].second);
            judge({vertex, static_cast<std::uint32_t>(records_[i].first >> 32), static_cast<std::uint32_t>(records_[i].first)}, tets_);
        }
        take_listed({kNone, kNone, kNone});
    }

private:
    void judge(const Triangle& face, const std::vector<std::uint32_t>& tets) {
        ++found_.faces;
        ++(tets.size() == 1 ? found_.boundary_faces : found_.interior_faces);
        for (std::size_t i = 2; i < tets.size(); ++i)
            found_.face_sharing.violated(EntityKind::tetrahedron, tets[i] + std::uint64_t{1}, mesh_.centroid(face.data(), 3), [&] {
                return fmt::format("face {} {} {} belongs to {} tetrahedra: {}, {}, {}{}", face[0] + 1, face[1] + 1, face[2] + 1, tets.size(), tets[0] + 1, tets[1] + 1,
                                   tets[2] + 1, tets.size() > 3 ? ", ..." : "");
            });
        find_duplicates(face, tets);
        if (tets.size() == 2) judge_pair(face, tets[0], tets[1]);
        const std::uint32_t listed = take_listed(face);
        const bool interface = tets.size() > 1 && mesh_.region(tets[0]) != mesh_.region(tets[1]);
        if (tets.size() == 1 || interface || listed != kNone) add_constraint(face, tets, listed);
    }

    /// Side of the ascending face on which the tetrahedron's apex lies.
    Sign side(const Triangle& face, std::uint32_t tet) const {
        return mesh_.predicates().orient3d(mesh_.point(face[0]), mesh_.point(face[1]), mesh_.point(face[2]), mesh_.point(apex(mesh_.mesh().tets[tet], face)));
    }

    /// A tetrahedron is looked at only at the face opposite its highest corner, so that each repetition counts once.
    void find_duplicates(const Triangle& face, const std::vector<std::uint32_t>& tets) {
        for (std::size_t i = 1; i < tets.size(); ++i) {
            const std::uint32_t top = apex(mesh_.mesh().tets[tets[i]], face);
            if (top <= face[2]) continue;
            for (std::size_t j = 0; j < i; ++j) {
                if (apex(mesh_.mesh().tets[tets[j]], face) != top) continue;
                found_.distinct_tets.violated(EntityKind::tetrahedron, tets[i] + std::uint64_t{1}, mesh_.tet_centroid(tets[i]),
                                              [&] { return fmt::format("has the same four vertices as tetrahedron {}", tets[j] + 1); });
                break;
            }
        }
    }

    void judge_pair(const Triangle& face, std::uint32_t t0, std::uint32_t t1) {
        ++found_.two_sided_faces;
        const Sign s0 = side(face, t0), s1 = side(face, t1);
        if (s0 == Sign::zero || s1 == Sign::zero) return;  // a flat tetrahedron has no side; positive_tets names it
        if (s0 == s1) {
            found_.opposite_sides.violated(EntityKind::tetrahedron, t0 + std::uint64_t{1}, mesh_.centroid(face.data(), 3), [&] {
                return fmt::format("lies on the same side of face {} {} {} as tetrahedron {}", face[0] + 1, face[1] + 1, face[2] + 1, t1 + 1);
            });
            return;
        }
        if (!mesh_.positive(t0) || !mesh_.positive(t1)) return;
        found_.locally_not_delaunay += mesh_.in_sphere(t0, apex(mesh_.mesh().tets[t1], face)) == Sign::positive;
    }

    /// Passes the listed triangles that come before `face` (they are no faces) and those equal to it.
    /// @return the lowest number of the latter.
    std::uint32_t take_listed(const Triangle& face) {
        for (; !listed_.empty() && listed_.front().v < face; listed_ = listed_.subspan(1)) {
            const ListedTriangle& l = listed_.front();
            report_not_a_face(mesh_, l, found_);
            if (found_.constraints.empty() || found_.constraints.back().v != l.v) found_.constraints.push_back({l.v, {kNone, kNone}, l.number, false, false});
        }
        if (listed_.empty() || listed_.front().v != face) return kNone;
        const std::uint32_t lowest = listed_.front().number;
        while (!listed_.empty() && listed_.front().v == face) listed_ = listed_.subspan(1);
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
        found_.constraints.push_back(c);
    }

    const SuspectMesh& mesh_;
    Findings& found_;
    std::span<const ListedTriangle> listed_;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> records_;  // the middle vertex above the highest one, and the tetrahedron
    std::vector<std::uint32_t> tets_;
};

class VertexRange {
public:
    VertexRange(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<TetClass>& classes)
        : mesh_(mesh), stars_(stars), classes_(classes), listed_(listed_triangles(mesh)) {
        const auto& regions = mesh.mesh().tet_regions;
        several_regions_ = std::any_of(regions.begin(), regions.end(), [&](std::int32_t r) { return r != regions.front(); });
    }
    [[nodiscard]] std::size_t listed() const { return listed_.size(); }

    void operator()(std::uint32_t begin, std::uint32_t end, SoundStar& star, Findings& found) const {
        AnyFaces any(mesh_, found);
        auto l = std::lower_bound(listed_.begin(), listed_.end(), begin, [](const ListedTriangle& t, std::uint32_t v) { return t.v[0] < v; });
        for (std::uint32_t v = begin; v < end; ++v) {
            const auto first = l;
            while (l != listed_.end() && l->v[0] == v) ++l;
            const std::span<const ListedTriangle> here(first, l);
            if (star.collect(v, stars_, classes_)) {
                report(mesh_, star, v, here, several_regions_, found);
            } else {
                any.survey(v, stars_.of(v), here);
                found.in_order = false;
            }
        }
    }

private:
    const SuspectMesh& mesh_;
    const TetsByCorner& stars_;
    const std::vector<TetClass>& classes_;
    std::vector<ListedTriangle> listed_;
    bool several_regions_ = false;
};

}  // namespace

FaceSurvey survey_faces(const SuspectMesh& mesh, const TetsByCorner& stars, const std::vector<TetClass>& classes) {
    const VertexRange look(mesh, stars, classes);
    std::vector<Findings> parts((mesh.vertex_count() + kVertexGrain - 1) / kVertexGrain);
    ScratchPool<SoundStar> pool;
    mesh.workers().for_ranges(mesh.vertex_count(), kVertexGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        std::unique_ptr<SoundStar> star = pool.take([&] { return std::make_unique<SoundStar>(mesh); });
        look(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), *star, parts[piece]);
        pool.give_back(std::move(star));
    });
    FaceSurvey survey;
    ClaimBuilder face_sharing("face_sharing", "No face is shared by more than two tetrahedra.");
    ClaimBuilder opposite_sides("opposite_sides", "Two tetrahedra that share a face lie on opposite sides of it.");
    ClaimBuilder distinct_tets("distinct_tets", "No two tetrahedra have the same four vertices.");
    ClaimBuilder listed_exist("listed_subfaces_exist", "Every listed triangle is a face of a tetrahedron.");
    EdgeLengths edges;
    bool in_order = true;
    for (Findings& part : parts) {
        in_order = in_order && part.in_order;
        edges.add(part.edges);
        survey.faces += part.faces;
        survey.interior_faces += part.interior_faces;
        survey.boundary_faces += part.boundary_faces;
        survey.locally_not_delaunay += part.locally_not_delaunay;
        survey.two_sided_faces += part.two_sided_faces;
        survey.constraints.insert(survey.constraints.end(), part.constraints.begin(), part.constraints.end());
        part.constraints = {};
        face_sharing.absorb(std::move(part.face_sharing));
        opposite_sides.absorb(std::move(part.opposite_sides));
        distinct_tets.absorb(std::move(part.distinct_tets));
        listed_exist.absorb(std::move(part.listed_exist));
    }
    if (in_order) survey.edges = edges;
    face_sharing.checked(survey.faces);
    opposite_sides.checked(survey.two_sided_faces);
    distinct_tets.checked(mesh.tet_count());
    listed_exist.checked(look.listed());
    survey.face_sharing = face_sharing.decided();
    survey.opposite_sides = opposite_sides.decided();
    survey.distinct_tets = distinct_tets.decided();
    survey.listed_subfaces_exist = listed_exist.decided();
    return survey;
}

}  // namespace wellmesh::certifying
