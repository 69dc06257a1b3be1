// SPDX-License-Identifier: Apache-2.0
#include "certify/mesh_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include "core/vec3_math.hpp"

namespace wellmesh::certifying {
namespace {

Triangle sorted(Triangle t) {
    if (t[0] > t[1]) std::swap(t[0], t[1]);
    if (t[1] > t[2]) std::swap(t[1], t[2]);
    if (t[0] > t[1]) std::swap(t[0], t[1]);
    return t;
}

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

std::vector<ListedTriangle> listed_triangles(const SuspectMesh& mesh) {
    const auto& subfaces = mesh.mesh().subfaces;
    std::vector<ListedTriangle> listed;
    listed.reserve(subfaces.size());
    for (std::size_t i = 0; i < subfaces.size(); ++i) listed.push_back({sorted(subfaces[i]), static_cast<std::uint32_t>(i)});
    std::sort(listed.begin(), listed.end(), [](const ListedTriangle& a, const ListedTriangle& b) { return a.v != b.v ? a.v < b.v : a.number < b.number; });
    return listed;
}

/// What the faces of a range of vertices say: each face belongs to its lowest vertex.
struct Findings {
    std::uint64_t faces = 0, interior_faces = 0, boundary_faces = 0, locally_not_delaunay = 0, two_sided_faces = 0;
    std::vector<ConstraintTriangle> constraints;
    ClaimBuilder face_sharing, opposite_sides, distinct_tets, listed_exist;
};

/// The faces at one vertex in sound surroundings: all tetrahedra positive, no face of more than two, these on either side of it. Says so when they
/// are not, and has found nothing then.
class SoundFaces {
public:
    explicit SoundFaces(const SuspectMesh& mesh) : mesh_(mesh) {}

    /// @return whether they are sound.
    bool collect(std::uint32_t vertex, std::span<const std::uint32_t> tets) {
        vertex_ = vertex;
        faces_.clear();
        pairs_ = 0;
        const std::size_t slots = std::bit_ceil(std::max<std::size_t>(16, 4 * tets.size()));
        table_.assign(slots, kNone);
        shift_ = 64 - std::countr_zero(slots);
        for (const std::uint32_t t : tets) {
            if (!mesh_.positive(t)) return false;
            // Of a positive tetrahedron the side of a face on which its apex lies follows from the order of its corners: the apex at place i
            // takes 3 - i transpositions to the end.
            const AscendingTet tet(mesh_.mesh().tets[t]);
            const auto& v = tet.v;
            if (v[0] == vertex) {
                if (!add(v[1], v[2], v[3], t, !tet.odd) || !add(v[1], v[3], v[2], t, tet.odd) || !add(v[2], v[3], v[1], t, !tet.odd)) return false;
            } else if (v[1] == vertex) {
                if (!add(v[2], v[3], v[0], t, tet.odd)) return false;
            } else {
                break;  // from here on it is the third corner, which is the lowest of no face
            }
        }
        return true;
    }

    void report(std::span<const ListedTriangle> listed, Findings& found) {
        found.faces += faces_.size();
        found.interior_faces += pairs_;
        found.two_sided_faces += pairs_;
        found.boundary_faces += faces_.size() - pairs_;
        const bool regions = !mesh_.mesh().tet_regions.empty();
        const std::size_t first = found.constraints.size();
        for (std::size_t i = 0; i < listed.size();) {
            const ListedTriangle& l = listed[i];
            if (Face* face = find(l.v[1], l.v[2])) {
                face->listed = l.number;
            } else {
                found.constraints.push_back({l.v, {kNone, kNone}, l.number, false, false});
            }
            for (const Triangle v = l.v; i < listed.size() && listed[i].v == v; ++i)
                if (find(v[1], v[2]) == nullptr) not_a_face(mesh_, listed[i], found);
        }
        for (const Face& f : faces_) {
            const bool on_hull = f.tets[1] == kNone;
            if (!on_hull && f.listed == kNone && !(regions && mesh_.region(f.tets[0]) != mesh_.region(f.tets[1]))) continue;
            ConstraintTriangle c{{vertex_, f.middle, f.highest}, f.tets, f.listed, true, on_hull};
            if (!f.first_is_positive) std::swap(c.tets[0], c.tets[1]);
            found.constraints.push_back(c);
        }
        std::sort(found.constraints.begin() + static_cast<std::ptrdiff_t>(first), found.constraints.end(),
                  [](const ConstraintTriangle& a, const ConstraintTriangle& b) { return a.v < b.v; });
        found.locally_not_delaunay += count_not_delaunay();
    }

    static void not_a_face(const SuspectMesh& mesh, const ListedTriangle& l, Findings& found) {
        found.listed_exist.violated(EntityKind::triangle, l.number + std::uint64_t{1}, mesh.centroid(l.v.data(), 3),
                                    [&] { return fmt::format("vertices {} {} {} span no face of a tetrahedron", l.v[0] + 1, l.v[1] + 1, l.v[2] + 1); });
    }

private:
    struct Face {
        std::uint32_t middle, highest;
        std::array<std::uint32_t, 2> tets, apexes;
        std::uint32_t listed;
        bool first_is_positive;  ///< the first tetrahedron is on the side that the face's normal points to
    };

    [[nodiscard]] std::size_t place(std::uint32_t middle, std::uint32_t highest) const {
        return static_cast<std::size_t>(((std::uint64_t{middle} << 32 | highest) * 0x9E3779B97F4A7C15U) >> shift_);
    }
    bool add(std::uint32_t middle, std::uint32_t highest, std::uint32_t top, std::uint32_t tet, bool positive) {
        for (std::size_t i = place(middle, highest);; i = (i + 1) & (table_.size() - 1)) {
            if (table_[i] == kNone) {
                table_[i] = static_cast<std::uint32_t>(faces_.size());
                faces_.push_back({middle, highest, {tet, kNone}, {top, kNone}, kNone, positive});
                return true;
            }
            Face& face = faces_[table_[i]];
            if (face.middle != middle || face.highest != highest) continue;
            if (face.tets[1] != kNone || face.first_is_positive == positive) return false;
            face.tets[1] = tet;
            face.apexes[1] = top;
            ++pairs_;
            return true;
        }
    }
    [[nodiscard]] Face* find(std::uint32_t middle, std::uint32_t highest) {
        for (std::size_t i = place(middle, highest); table_[i] != kNone; i = (i + 1) & (table_.size() - 1))
            if (Face& face = faces_[table_[i]]; face.middle == middle && face.highest == highest) return &face;
        return nullptr;
    }
    /// Interior faces with an apex inside the sphere of the other side's tetrahedron.
    [[nodiscard]] std::uint64_t count_not_delaunay() const {
        std::uint64_t count = 0;
        if (mesh_.is_weighted()) {
            for (const Face& f : faces_)
                if (f.tets[1] != kNone) count += mesh_.in_sphere(f.tets[0], f.apexes[1]) == Sign::positive;
            return count;
        }
        // The first tetrahedron's corners and the other's apex, the common vertex last: an even permutation if it is (vertex, middle, highest, apex).
        const Vec3& origin = mesh_.point(vertex_);
        std::array<std::array<const Vec3*, 4>, 4> rows{};
        std::array<Sign, 4> inside{}, signs{};
        std::size_t n = 0;
        const auto evaluate = [&] {
            for (std::size_t i = n; i < 4; ++i) rows[i] = rows[0];
            mesh_.predicates().insphere_of_four_padded(rows, origin, signs);
            for (std::size_t i = 0; i < n; ++i) count += signs[i] == inside[i];
            n = 0;
        };
        for (const Face& f : faces_) {
            if (f.tets[1] == kNone) continue;
            rows[n] = {&mesh_.point(f.middle), &mesh_.point(f.highest), &mesh_.point(f.apexes[0]), &mesh_.point(f.apexes[1])};
            inside[n++] = f.first_is_positive ? Sign::positive : Sign::negative;
            if (n == 4) evaluate();
        }
        if (n > 0) evaluate();
        return count;
    }

    const SuspectMesh& mesh_;
    std::uint32_t vertex_ = 0;
    std::vector<Face> faces_;
    std::vector<std::uint32_t> table_;  // by open addressing, numbers in faces_
    int shift_ = 0;
    std::uint64_t pairs_ = 0;
};

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
            SoundFaces::not_a_face(mesh_, l, found_);
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

void survey_range(const SuspectMesh& mesh, const TetsByCorner& stars, std::span<const ListedTriangle> listed, std::uint32_t begin, std::uint32_t end, Findings& found) {
    SoundFaces sound(mesh);
    AnyFaces any(mesh, found);
    auto l = std::lower_bound(listed.begin(), listed.end(), begin, [](const ListedTriangle& t, std::uint32_t v) { return t.v[0] < v; });
    for (std::uint32_t v = begin; v < end; ++v) {
        const auto first = l;
        while (l != listed.end() && l->v[0] == v) ++l;
        const std::span<const ListedTriangle> here(first, l);
        if (sound.collect(v, stars.of(v))) sound.report(here, found);
        else any.survey(v, stars.of(v), here);
    }
}

}  // namespace

FaceSurvey survey_faces(const SuspectMesh& mesh, const TetsByCorner& stars) {
    const std::vector<ListedTriangle> listed = listed_triangles(mesh);
    std::vector<Findings> parts((mesh.vertex_count() + kVertexGrain - 1) / kVertexGrain);
    mesh.workers().for_ranges(mesh.vertex_count(), kVertexGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        survey_range(mesh, stars, listed, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), parts[piece]);
    });
    FaceSurvey survey;
    ClaimBuilder face_sharing("face_sharing", "No face is shared by more than two tetrahedra.");
    ClaimBuilder opposite_sides("opposite_sides", "Two tetrahedra that share a face lie on opposite sides of it.");
    ClaimBuilder distinct_tets("distinct_tets", "No two tetrahedra have the same four vertices.");
    ClaimBuilder listed_exist("listed_subfaces_exist", "Every listed triangle is a face of a tetrahedron.");
    for (Findings& part : parts) {
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
    face_sharing.checked(survey.faces);
    opposite_sides.checked(survey.two_sided_faces);
    distinct_tets.checked(mesh.tet_count());
    listed_exist.checked(listed.size());
    survey.face_sharing = face_sharing.decided();
    survey.opposite_sides = opposite_sides.decided();
    survey.distinct_tets = distinct_tets.decided();
    survey.listed_subfaces_exist = listed_exist.decided();
    return survey;
}

}  // namespace wellmesh::certifying
