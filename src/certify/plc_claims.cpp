// SPDX-License-Identifier: Apache-2.0
#include "certify/plc_claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "certify/plc_surface.hpp"
#include "certify/triangle_tree.hpp"
#include "core/vec3_math.hpp"
#include "predicates/exact_range.hpp"

namespace wellmesh::certifying {
namespace {

constexpr std::array<std::array<const char*, 2>, 8> kStatements{{
    {"plc_distance", "No constraint triangle leaves the facets of the PLC."},
    {"plc_area", "The constraint triangles have the area of the PLC's facets."},
    {"plc_vertices", "Every vertex of a facet of the PLC is a vertex of the mesh."},
    {"plc_segments", "Every segment of the PLC is a chain of mesh edges."},
    {"plc_isolated_vertices", "Every vertex of the PLC that is on no facet is a vertex of the mesh, but for leftovers of surface files."},
    {"plc_filled", "No facet of the PLC that bounds a cell lies outside the mesh."},
    {"holes_empty", "No hole seed lies inside the mesh."},
    {"region_volumes", "Every region has the volume of its cells of the PLC."},
}};

ClaimBuilder builder(std::size_t which) { return {kStatements[which][0], kStatements[which][1]}; }

double area_of(const Corners& t) { return norm(cross(t[1] - t[0], t[2] - t[0])) / 2; }
Vec3 centroid_of(const Corners& t) { return t[0] + (1.0 / 3) * ((t[1] - t[0]) + (t[2] - t[0])); }

class PlcComparison {
public:
    PlcComparison(const SurveyedMesh& surveyed, const CertifyOptions& options, const PlcSurface& surface)
        : mesh_(surveyed.mesh), stars_(surveyed.stars), places_(surveyed.places), constraints_(surveyed.triangles), surface_(surface),
          tolerance_(options.tolerance * surface.diagonal), relative_tolerance_(options.tolerance) {
        const auto separates = [&](const ConstraintTriangle& t) {
            return t.is_face && (t.on_hull || mesh_.region(t.tets[0]) != mesh_.region(t.tets[1]));
        };
        for (std::uint32_t i = 0; i < constraints_.size(); ++i)
            if (separates(constraints_[i])) separating_.push_back(i);
        const auto tree_of = [&](auto&& wanted) {
            std::vector<Corners> triangles;
            triangles.reserve(constraints_.size());
            for (const ConstraintTriangle& t : constraints_)
                if (wanted(t)) triangles.push_back({mesh_.point(t.v[0]), mesh_.point(t.v[1]), mesh_.point(t.v[2])});
            return std::make_shared<const TriangleTree>(std::move(triangles), mesh_.workers());
        };
        // Mostly they are the same: every constraint triangle is on the hull.
        const auto on_hull = [](const ConstraintTriangle& t) { return t.on_hull; };
        covered_ = tree_of([](const ConstraintTriangle&) { return true; });
        separators_ = separating_.size() == constraints_.size() ? covered_ : tree_of(separates);
        hull_ = std::all_of(constraints_.begin(), constraints_.end(), on_hull) ? covered_ : tree_of(on_hull);
        facet_wanted_.assign(surface.facets.empty() ? 0 : surface.facets.back() + std::size_t{1}, false);
        triangles_.resize(surface.facets.size());
        mesh_.workers().for_ranges(triangles_.size(), kSmallGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i) {
                const Vec3 c = centroid_of(surface.triangles.triangles()[i]);
                triangles_[i] = near_constraint(c) ? Part::covered : inside(c) ? Part::missing : Part::outside;
            }
        });
        for (std::size_t i = 0; i < triangles_.size(); ++i)
            if (triangles_[i] != Part::outside) facet_wanted_[surface.facets[i]] = true;
    }

    Claim distance() const {
        ClaimBuilder claim = builder(0);
        claim.checked(constraints_.size());
        struct Worst {
            double of_all = 0, of_vertex = 0;
            std::uint64_t far_vertices = 0;
        };
        std::vector<Worst> parts((constraints_.size() + kSmallGrain - 1) / kSmallGrain);
        const std::vector<std::uint8_t> new_corners = find_new_corners();
        const double rounding = 4 * std::numeric_limits<double>::epsilon() * mesh_.largest_coordinate();
        // The distance to any one triangle is enough to know of where it can't change what is reported.
        const auto distance_to = [&](const Vec3& p, std::uint32_t i) { return std::sqrt(squared_distance(p, surface_.triangles.triangles()[i])); };
        look_in_ranges(mesh_.workers(), constraints_.size(), kSmallGrain, claim, [&](std::size_t begin, std::size_t end, ClaimBuilder& part) {
            Worst& worst = parts[begin / kSmallGrain];
            std::uint32_t hint = 0;
            for (std::size_t i = begin; i < end; ++i) {
                const ConstraintTriangle& t = constraints_[i];
                const auto& [a, b, c] = covered_->triangles()[i];
                const std::array<Vec3, 7> probes{a, b, c, a + 0.5 * (b - a), b + 0.5 * (c - b), c + 0.5 * (a - c), centroid_of({a, b, c})};
                const std::uint32_t named = named_triangle(t);
                double off = 0;
                std::size_t where = 0;
                for (std::size_t k = 0; k < probes.size(); ++k) {
                    const bool is_new = k < 3 && (new_corners[i] >> k & 1) != 0;
                    const double harmless = std::min({tolerance_, worst.of_all, is_new ? std::min(rounding, worst.of_vertex) : tolerance_});
                    double known = distance_to(probes[k], hint);
                    const double other = known > harmless && named != hint ? distance_to(probes[k], named) : known;
                    if (other < known) known = other, hint = named;
                    if (known <= harmless) continue;
                    const auto nearest = surface_.triangles.nearest(probes[k], hint);
                    hint = nearest.triangle;
                    if (nearest.distance > off) off = nearest.distance, where = k;
                    if (!is_new) continue;
                    worst.far_vertices += nearest.distance > rounding;
                    worst.of_vertex = std::max(worst.of_vertex, nearest.distance);
                }
                worst.of_all = std::max(worst.of_all, off);
                if (off > tolerance_)
                    part.violated(EntityKind::triangle, t.listed == kNone ? 0 : t.listed + std::uint64_t{1}, probes[where], [&] {
                        return fmt::format("triangle {} {} {} is {:.3g} away from the PLC, {:.3g} of its diagonal", t.v[0] + 1, t.v[1] + 1,
                                           t.v[2] + 1, off, off / surface_.diagonal);
                    });
            }
        });
        Worst worst;
        for (const Worst& part : parts) {
            worst.of_all = std::max(worst.of_all, part.of_all);
            worst.of_vertex = std::max(worst.of_vertex, part.of_vertex);
            worst.far_vertices += part.far_vertices;
        }
        claim.note(fmt::format("largest distance {:.3g}, {:.3g} of the diagonal, tolerance {:g}", worst.of_all, worst.of_all / surface_.diagonal,
                               relative_tolerance_));
        claim.note(
            fmt::format("of a vertex {:.3g}; {} vertices are more than 4 ulp of the largest coordinate away", worst.of_vertex, worst.far_vertices));
        return claim.decided();
    }

    Claim area() const {
        ClaimBuilder claim = builder(1);
        claim.checked(surface_.facets.size());
        long double wanted = 0, removed = 0, present = 0;
        std::optional<std::uint32_t> uncovered;
        const auto& triangles = surface_.triangles.triangles();
        for (std::uint32_t i = 0; i < triangles.size(); ++i) {
            (triangles_[i] == Part::outside ? removed : wanted) += static_cast<long double>(area_of(triangles[i]));
            if (triangles_[i] == Part::missing && !uncovered) uncovered = i;
        }
        for (const Corners& t : covered_->triangles()) present += static_cast<long double>(area_of(t));
        const long double error = std::abs(present - wanted) / wanted;
        const auto allowed = static_cast<long double>(1e3 * relative_tolerance_);
        if (!(error <= allowed)) {
            const std::uint32_t facet = uncovered ? surface_.facets[*uncovered] : 0;
            const Vec3 where = uncovered ? centroid_of(triangles[*uncovered]) : mesh_.point(constraints_.front().v[0]);
            claim.violated(EntityKind::facet, uncovered ? facet + std::uint64_t{1} : 0, where, [&] {
                return uncovered ? fmt::format("facet {} is not covered at {}", facet + 1, text_of(where)) : std::string("the areas differ");
            });
        }
        claim.note(fmt::format("PLC {:.12g}, mesh {:.12g}, relative difference {:.3g}, tolerance {:.3g}; outside the mesh {:.6g}",
                               static_cast<double>(wanted), static_cast<double>(present), static_cast<double>(error), static_cast<double>(allowed),
                               static_cast<double>(removed)));
        return claim.decided();
    }

    Claim vertices(bool isolated, std::uint32_t first_number) const {
        ClaimBuilder claim = builder(isolated ? 4 : 2);
        for (const std::uint32_t v : isolated ? surface_.other_vertices : surface_.facet_vertices) {
            const Vec3& p = surface_.points[v];
            claim.checked(1);
            if (places_.first_at(p) == kNone && (near_constraint(p) || inside(p)))
                claim.violated(EntityKind::vertex, std::uint64_t{v} + first_number, p,
                               [&] { return fmt::format("PLC vertex {} at {} is missing", v + first_number, text_of(p)); });
        }
        return claim.decided();
    }

    Claim filled(const Plc& plc) const {
        ClaimBuilder claim = builder(5);
        claim.checked(surface_.facets.size());
        if (!plc.hole_seeds.empty() || plc.fill != FillRule::bounded_cells) return claim.undecided("cells may have been left out on purpose");
        for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
            if (triangles_[i] != Part::outside || surface_.dangling[i]) continue;
            const Vec3 where = centroid_of(surface_.triangles.triangles()[i]);
            claim.violated(EntityKind::facet, surface_.facets[i] + std::uint64_t{1}, where,
                           [&] { return fmt::format("facet {} is outside at {}", surface_.facets[i] + 1, text_of(where)); });
        }
        return claim.decided();
    }

    Claim holes_empty(const Plc& plc) const {
        ClaimBuilder claim = builder(6);
        claim.checked(plc.hole_seeds.size());
        for (std::size_t i = 0; i < plc.hole_seeds.size(); ++i)
            if (inside(plc.hole_seeds[i]))
                claim.violated(EntityKind::region, i + 1, plc.hole_seeds[i],
                               [&] { return fmt::format("hole seed {} at {}", i + 1, text_of(plc.hole_seeds[i])); });
        return claim.decided();
    }

    Claim segments() const;
    Claim region_volumes(std::vector<RegionVolume>& regions) const;

private:
    /// A triangle of the PLC's facet that the mesh says the constraint triangle is on: likely to be near.
    [[nodiscard]] std::uint32_t named_triangle(const ConstraintTriangle& t) const {
        const std::vector<std::int32_t>& facets = mesh_.mesh().subface_facets;
        if (t.listed >= facets.size() || facets[t.listed] <= 0) return 0;
        const auto it = std::lower_bound(surface_.facets.begin(), surface_.facets.end(), static_cast<std::uint32_t>(facets[t.listed]) - 1);
        return it == surface_.facets.end() ? 0 : static_cast<std::uint32_t>(it - surface_.facets.begin());
    }
    /// What the mesh has where a triangle of the PLC is (by its centroid).
    enum class Part : std::uint8_t { covered, missing, outside };
    struct OnEdge {
        std::uint32_t edge = 0;
        double at = 0;  ///< position along it, from 0 to 1
        std::uint32_t vertex = 0;
        friend bool operator<(const OnEdge& a, const OnEdge& b) { return std::tie(a.edge, a.at, a.vertex) < std::tie(b.edge, b.at, b.vertex); }
    };
    [[nodiscard]] std::vector<OnEdge> vertices_on_edges() const;
    /// Of each constraint triangle, which corners (bits) no earlier one has.
    [[nodiscard]] std::vector<std::uint8_t> find_new_corners() const {
        std::vector<bool> seen(mesh_.vertex_count(), false);
        std::vector<std::uint8_t> result(constraints_.size(), 0);
        for (std::size_t i = 0; i < constraints_.size(); ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t v = constraints_[i].v[k];
                if (!seen[v]) result[i] = static_cast<std::uint8_t>(result[i] | 1U << k);
                seen[v] = true;
            }
        return result;
    }

    [[nodiscard]] bool near_constraint(const Vec3& p) const { return !constraints_.empty() && covered_->nearest(p).distance <= tolerance_; }
    /// A point on a hull edge in every direction counts as inside.
    [[nodiscard]] bool inside(const Vec3& p) const { return hull_->encloses(p).value_or(true); }

    const SuspectMesh& mesh_;
    const TetsByCorner& stars_;
    const VertexPlaces& places_;
    const std::vector<ConstraintTriangle>& constraints_;
    const PlcSurface& surface_;
    double tolerance_, relative_tolerance_;
    std::shared_ptr<const TriangleTree> covered_, hull_, separators_;
    std::vector<std::uint32_t> separating_;  ///< of each triangle of separators_, the constraint: on the hull or between two regions
    std::vector<Part> triangles_;
    std::vector<bool> facet_wanted_;  ///< some triangle of it is not outside the mesh; facets without triangles may be beyond the end
};

std::vector<PlcComparison::OnEdge> PlcComparison::vertices_on_edges() const {
    std::vector<Box3> boxes;
    const Vec3 slack{tolerance_, tolerance_, tolerance_};
    for (const PlcEdge& e : surface_.edges) {
        const std::array<Vec3, 2> ends{surface_.points[e.a], surface_.points[e.b]};
        Box3 box = Box3::of(ends.data(), 2);
        boxes.push_back({box.low - slack, box.high + slack});
    }
    const BoxTree tree(boxes);
    std::vector<std::vector<OnEdge>> parts((mesh_.vertex_count() + kGrain - 1) / kGrain);
    mesh_.workers().for_ranges(mesh_.vertex_count(), kGrain, [&](std::size_t begin, std::size_t end, std::size_t piece) {
        for (auto v = static_cast<std::uint32_t>(begin); v < end; ++v) {
            const Vec3& p = mesh_.point(v);
            tree.any_meeting({p, p}, [&](std::uint32_t i) {
                const Vec3& a = surface_.points[surface_.edges[i].a];
                const Vec3& b = surface_.points[surface_.edges[i].b];
                // The ends count by place, not by distance; nothing else does near them.
                if (p == a || p == b) {
                    parts[piece].push_back({i, p == a ? 0.0 : 1.0, v});
                    return false;
                }
                const double length = squared_norm(b - a), at = dot(p - a, b - a) / length;
                if (at > 0 && at < 1 && squared_norm((p - a) - at * (b - a)) <= tolerance_ * tolerance_) parts[piece].push_back({i, at, v});
                return false;
            });
        }
    });
    std::vector<OnEdge> result;
    for (const std::vector<OnEdge>& part : parts) result.insert(result.end(), part.begin(), part.end());
    std::sort(result.begin(), result.end());
    return result;
}

Claim PlcComparison::segments() const {
    ClaimBuilder claim = builder(3);
    claim.checked(surface_.edges.size());
    const std::vector<OnEdge> on_edges = vertices_on_edges();
    const auto joined = [&](std::uint32_t v, std::uint32_t w) { return has_edge(mesh_, stars_, {std::min(v, w), std::max(v, w)}); };
    // How far to look for the next vertex of a chain: others may lie within the tolerance of the segment without being on it.
    // Where an edge much shorter than the tolerance ends, the mesh has as fine vertices: hundreds.
    constexpr std::size_t kLookAhead = 4096;
    auto begin = on_edges.begin();
    for (std::uint32_t e = 0; e < surface_.edges.size(); ++e) {
        const auto end = std::find_if(begin, on_edges.end(), [&](const OnEdge& o) { return o.edge != e; });
        const auto n = static_cast<std::size_t>(end - begin);
        std::vector<bool> reached(n, false);
        std::size_t farthest = 0;
        bool complete = false;
        for (std::size_t i = 0; i < n; ++i) {
            const OnEdge& o = begin[static_cast<std::ptrdiff_t>(i)];
            if (o.at == 0) reached[i] = true;
            for (std::size_t j = i; j-- > 0 && i - j <= kLookAhead && !reached[i];)
                reached[i] = reached[j] && joined(begin[static_cast<std::ptrdiff_t>(j)].vertex, o.vertex);
            if (reached[i]) farthest = i;
            complete = complete || (reached[i] && o.at == 1);
        }
        if (!complete) {
            const Vec3 &a = surface_.points[surface_.edges[e].a], &b = surface_.points[surface_.edges[e].b], middle = a + 0.5 * (b - a);
            const std::vector<std::uint32_t>& facets = surface_.edges[e].facets;
            const auto wanted_by = [&](std::uint32_t f) { return f < facet_wanted_.size() && facet_wanted_[f]; };
            if (std::any_of(facets.begin(), facets.end(), wanted_by) || near_constraint(middle) || inside(middle)) {
                const Vec3 where = n > 0 && reached[farthest] ? mesh_.point(begin[static_cast<std::ptrdiff_t>(farthest)].vertex) : a;
                claim.violated(EntityKind::segment, std::uint64_t{e} + 1, where, [&] {
                    return fmt::format("from {} to {}: no mesh edge leads on from {}", text_of(a), text_of(b), text_of(where));
                });
            }
        }
        begin = end;
    }
    return claim.decided();
}

/// Signed.
long double cone_volume(const Vec3& tip, const Corners& base) {
    const auto from_tip = [&](const Vec3& x) {
        return std::array<long double, 3>{static_cast<long double>(x.x) - static_cast<long double>(tip.x),
                                          static_cast<long double>(x.y) - static_cast<long double>(tip.y),
                                          static_cast<long double>(x.z) - static_cast<long double>(tip.z)};
    };
    const auto a = from_tip(base[0]), b = from_tip(base[1]), d = from_tip(base[2]);
    return (a[0] * (b[1] * d[2] - b[2] * d[1]) + a[1] * (b[2] * d[0] - b[0] * d[2]) + a[2] * (b[0] * d[1] - b[1] * d[0])) / 6;
}

Claim PlcComparison::region_volumes(std::vector<RegionVolume>& regions) const {
    ClaimBuilder claim = builder(7);
    struct Sum {
        long double volume = 0, area = 0;
        std::optional<Vec3> origin{};  // a point of its own: a small region far from another one's would drown in the cones' rounding
    };
    std::map<std::int32_t, Sum> sums;
    const auto& triangles = surface_.triangles.triangles();
    std::vector<TriangleTree::Nearest> separators(triangles.size(), {0, std::numeric_limits<double>::infinity()});
    if (!separating_.empty())
        mesh_.workers().for_ranges(triangles.size(), kSmallGrain, [&](std::size_t begin, std::size_t end, std::size_t) {
            for (std::size_t i = begin; i < end; ++i)
                separators[i] = separators_->nearest(centroid_of(triangles[i]), i == begin ? 0 : separators[i - 1].triangle);
        });
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Corners& t = triangles[i];
        const TriangleTree::Nearest& nearest = separators[i];
        if (nearest.distance > tolerance_) continue;  // between no two regions; plc_area says so if it is inside and not covered
        const ConstraintTriangle& c = constraints_[separating_[nearest.triangle]];
        const auto& [p, q, r] = separators_->triangles()[nearest.triangle];
        const bool same_way = dot(cross(q - p, r - p), cross(t[1] - t[0], t[2] - t[0])) > 0;
        for (std::size_t side = 0; side < 2; ++side) {
            if (c.tets[side] == kNone) continue;
            // Side 0 is where c's normal points to: there the triangle's outward normal is the opposite one.
            const bool outward = (side == 0) != same_way;
            Sum& sum = sums[mesh_.region(c.tets[side])];
            if (!sum.origin) sum.origin = t[0];
            const long double cone = cone_volume(*sum.origin, t);
            sum.volume += outward ? cone : -cone;
            sum.area += static_cast<long double>(area_of(t));
        }
    }
    for (RegionVolume& r : regions) {
        const Sum& sum = sums[r.region];
        r.plc_volume = static_cast<double>(sum.volume);
        claim.checked(1);
        const double allowed = static_cast<double>(sum.area) * tolerance_ + 1e-12 * std::abs(r.volume),
                     difference = std::abs(r.volume - *r.plc_volume);
        if (!(difference <= allowed))
            claim.violated(EntityKind::region, static_cast<std::uint64_t>(std::max(r.region, 0)), sum.origin.value_or(Vec3{}), [&] {
                return fmt::format("region {} has volume {:.12g}, the PLC's cells have {:.12g}: a difference of {:.3g}, allowed is {:.3g}", r.region,
                                   r.volume, *r.plc_volume, difference, allowed);
            });
    }
    claim.note("allowed difference: surface area times distance tolerance, and 1e-12 of the volume");
    return claim.decided();
}

}  // namespace

void append_plc_claims(const SurveyedMesh& surveyed, const CertifyOptions& options, const Plc* plc, Certificate& certificate) {
    const auto give_up = [&](const std::string& reason) {
        for (const auto& [name, statement] : kStatements) certificate.claims.push_back(unchecked(name, statement, reason));
    };
    if (plc == nullptr) return give_up("no PLC given");
    const PlcReading reading = read_surface(*plc, options.flat_angle_rad, options.tolerance);
    if (!reading.surface) return give_up(reading.problem);
    if (surveyed.triangles.empty()) return give_up("the mesh has no constraint triangle");
    const PlcComparison comparison(surveyed, options, *reading.surface);
    certificate.claims.push_back(comparison.distance());
    certificate.claims.push_back(comparison.area());
    certificate.claims.push_back(comparison.vertices(false, plc->first_number));
    certificate.claims.push_back(comparison.segments());
    certificate.claims.push_back(comparison.vertices(true, plc->first_number));
    certificate.claims.push_back(comparison.filled(*plc));
    certificate.claims.push_back(comparison.holes_empty(*plc));
    certificate.claims.push_back(comparison.region_volumes(certificate.regions));
}

}  // namespace wellmesh::certifying
