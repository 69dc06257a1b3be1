// SPDX-License-Identifier: Apache-2.0
// Delaunay refinement of one plane triangulation, constrained to its fixed edges: the points that a facet gets, before any of them is in space
// [Ruppert95]. Floating point throughout: what it gets wrong, or leaves undone, the mesh shows when the points are in.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace wellmesh {

class PlanarRefiner {
public:
    struct Point {
        double x = 0, y = 0;
    };
    using Corners = std::array<std::uint32_t, 3>;
    static constexpr std::uint32_t kNone = 0xffffffffU;

    /// Takes up a triangulation. Edges with one triangle only are fixed anyway.
    /// @param triangles  counter-clockwise  @param fixed  by triangle: bit k for the edge opposite corner k
    /// @return false if it is none: an edge has three triangles, or one of them is flat
    bool begin(std::span<const Point> points, std::span<const Corners> triangles, std::span<const std::uint8_t> fixed);

    /// Puts a point on the fixed edge ab, whose halves are fixed then. @return its number, kNone if it can't be done
    std::uint32_t split_edge(std::uint32_t a, std::uint32_t b, const Point& p);

    /// Puts points at the circumcentres of triangles that are too large, until none is, but for those whose centre lies across a fixed edge, or in the
    /// diametral circle of one, or is not accepted.
    /// @param encroached  (a, b): called with such edges
    /// @param most  (centroid) -> greatest squared circumradius
    /// @param move  (corners, radius, Point& centre): puts the centre where a point can be, near by
    /// @param accepts  (Point, vertex): may the point be a neighbour of this vertex?
    /// @param inserted  called when the point that was moved last is a vertex
    /// @param may_go_on  asked now and then  @return false if that said no
    template <class Most, class Move, class Encroached, class Accepts, class Inserted, class MayGoOn>
    bool refine(const Most& most, const Move& move, const Encroached& encroached, const Accepts& accepts, const Inserted& inserted, const MayGoOn& may_go_on) {
        constexpr std::size_t kBetweenQuestions = 1024;
        queue_.clear();
        const auto look_at = [&](std::uint32_t t) {
            const Triangle& it = triangles_[t];
            const Point &a = points_[it.corners[0]], &b = points_[it.corners[1]], &c = points_[it.corners[2]];
            if (it.squared_radius > most(Point{(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3})) queue_.push_back({t, it.born});
        };
        for (std::uint32_t t = 0; t < triangles_.size(); ++t)
            if (is_live(t)) look_at(t);
        for (std::size_t next = 0; next < queue_.size(); ++next) {
            if (next % kBetweenQuestions == kBetweenQuestions - 1 && !may_go_on()) return false;
            const Waiting w = queue_[next];
            if (triangles_[w.triangle].born != w.born) continue;
            Point p = triangles_[w.triangle].centre;
            move(triangles_[w.triangle].corners, std::sqrt(triangles_[w.triangle].squared_radius), p);
            find_region(p, w.triangle);
            bool is_free = true;
            for (const RimEdge& e : rim_) {
                if (!e.fixed || !encroaches(p, e)) continue;
                encroached(e.a, e.b);
                is_free = false;
            }
            if (!is_free || !is_star_of(p, false)) continue;
            if (!std::all_of(rim_.begin(), rim_.end(), [&](const RimEdge& e) { return accepts(p, e.a); })) continue;
            (void)insert(p, kNone, kNone);
            inserted();
            for (const std::uint32_t t : made_) look_at(t);
        }
        return true;
    }

    [[nodiscard]] std::span<const Point> points() const { return points_; }
    /// Calls visit(corners) for each triangle.
    template <class Visit>
    void for_each_triangle(Visit&& visit) const {
        for (std::uint32_t t = 0; t < triangles_.size(); ++t)
            if (is_live(t)) visit(triangles_[t].corners);
    }

private:
    struct Triangle {
        Corners corners{};
        Corners across{};  ///< opposite each corner
        std::uint8_t fixed = 0;
        std::uint32_t born = 0;  ///< 0: free slot
        Point centre;
        double squared_radius = 0;
    };
    struct Waiting {
        std::uint32_t triangle = 0, born = 0;
    };
    struct RimEdge {
        std::uint32_t a = 0, b = 0;  // the region on its left
        std::uint32_t beyond = kNone;
        bool fixed = false;
    };
    [[nodiscard]] bool is_live(std::uint32_t t) const { return triangles_[t].born != 0; }
    [[nodiscard]] bool in_conflict(const Triangle& t, const Point& p) const;
    bool find_circle(Triangle& t) const;
    void find_region(const Point& p, std::uint32_t seed);
    void grow_region(const Point& p, std::uint32_t a, std::uint32_t b);
    void list_rim(std::uint32_t a, std::uint32_t b);
    [[nodiscard]] bool encroaches(const Point& p, const RimEdge& e) const;
    [[nodiscard]] bool is_star_of(const Point& p, bool is_on_rim);
    std::uint32_t insert(const Point& p, std::uint32_t a, std::uint32_t b);
    [[nodiscard]] std::uint32_t triangle_with(std::uint32_t a, std::uint32_t b) const;
    [[nodiscard]] std::uint32_t slot();

    std::vector<Point> points_;
    std::vector<Triangle> triangles_;
    std::vector<std::uint32_t> spare_;        // slots
    std::vector<std::uint32_t> triangle_of_;  // by point: one that has it
    std::vector<Waiting> queue_;
    std::uint32_t births_ = 0;
    // of one insertion
    std::vector<std::uint32_t> region_, made_;
    std::vector<std::uint32_t> in_region_;  // by triangle: the number of the search
    std::uint32_t search_ = 0;
    std::vector<RimEdge> rim_;
    std::vector<std::uint32_t> begins_at_;  // by point: the new triangle whose rim edge begins there
};

}  // namespace wellmesh
