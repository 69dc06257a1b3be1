// SPDX-License-Identifier: Apache-2.0
#include "exudation/boundary_spheres.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/vec3_math.hpp"

namespace wellmesh {

// |p - c|^2 - r^2 with c = base + offset and r^2 = |offset|^2 - w: the base is orthogonal to the sphere.
double BoundarySpheres::Sphere::power(const Vec3& p) const {
    const Vec3 q = p - base;
    return squared_norm(q) - 2 * dot(q, offset) + base_weight;
}

BoundarySpheres::BoundarySpheres(const WeightedMesh& mesh, const TetMesh& lists, const std::vector<double>& reach)
    : mesh_(mesh),
      reach_(reach),
      constraints_([&] {
          std::vector<Constraint> all;
          all.reserve(mesh.constraint_faces().size() + lists.subsegments.size());
          for (const ConstraintFace& f : mesh.constraint_faces()) all.push_back({VertexId{f[0]}, VertexId{f[1]}, VertexId{f[2]}});
          for (const auto& s : lists.subsegments) all.push_back({VertexId{s[0]}, VertexId{s[1]}, VertexId{s[1]}});
          return all;
      }()),
      sphere_boxes_([&] {
          std::vector<Box> boxes;
          boxes.reserve(constraints_.size());
          for (const Constraint& c : constraints_) boxes.push_back(reachable_box(c));
          return boxes;
      }()),
      vertex_boxes_([&] {
          std::vector<Box> boxes(mesh.vertex_count());
          for (std::size_t v = 0; v < boxes.size(); ++v) {
              boxes[v].add(mesh.point(VertexId{v}));
              boxes[v] = boxes[v].grown(std::sqrt(reach[v]));
          }
          return boxes;
      }()),
      spheres_(sphere_boxes_),
      vertices_(vertex_boxes_) {
    first_.assign(mesh.vertex_count() + 1, 0);
    const auto for_corners = [&](auto&& visit) {
        for (std::size_t i = 0; i < constraints_.size(); ++i)
            for (std::size_t k = 0; k < (is_segment(constraints_[i]) ? 2U : 3U); ++k) visit(constraints_[i][k].index(), static_cast<std::uint32_t>(i));
    };
    for_corners([&](std::size_t v, std::uint32_t) { ++first_[v + 1]; });
    for (std::size_t v = 1; v < first_.size(); ++v) first_[v] += first_[v - 1];
    own_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for_corners([&](std::size_t v, std::uint32_t i) { own_[next[v]++] = i; });
}

BoundarySpheres::Sphere BoundarySpheres::sphere(const Constraint& c, const std::array<double, 3>& weights) const {
    const Vec3 &a = mesh_.point(c[0]), u = mesh_.point(c[1]) - a, v = mesh_.point(c[2]) - a;
    const double lift_u = squared_norm(u) - weights[1] + weights[0], lift_v = squared_norm(v) - weights[2] + weights[0];
    if (is_segment(c)) return {a, (lift_u / (2 * squared_norm(u))) * u, weights[0]};
    const Vec3 n = cross(u, v);
    return {a, (1 / (2 * squared_norm(n))) * (lift_u * cross(v, n) + lift_v * cross(n, u)), weights[0]};
}

BoundarySpheres::Sphere BoundarySpheres::sphere_with(const Constraint& c, VertexId p, double weight) const {
    std::array<double, 3> weights{};
    for (std::size_t i = 0; i < 3; ++i) weights[i] = c[i] == p ? weight : mesh_.weight(c[i]);
    return sphere(c, weights);
}

/// Of the spheres for all weights within reach: centres are affine in the weights, so they lie in the box of the extreme ones; radii
/// are at most the largest offset. The margins are for the rounding of offsets and of centres.
Box BoundarySpheres::reachable_box(const Constraint& c) const {
    Box box;
    double radius = 0;
    for (unsigned extreme = 0; extreme < 8; ++extreme) {
        std::array<double, 3> weights{};
        for (unsigned i = 0; i < 3; ++i) weights[i] = (extreme >> i & 1U) != 0 ? reach_[c[i].index()] : 0;
        if (is_segment(c)) weights[2] = weights[1];
        const Sphere s = sphere(c, weights);
        box.add(s.base + s.offset);
        radius = std::max(radius, norm(s.offset));
    }
    double largest = 0;
    for (const Vec3& p : {box.low, box.high}) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return box.grown((1 + 1e-9) * radius + 16 * std::numeric_limits<double>::epsilon() * largest);
}

bool BoundarySpheres::conflicts(const Constraint& c, VertexId p, double weight, VertexId q) const {
    const auto at = [&](VertexId v) { return WeightedPoint{mesh_.point(v), v == p ? weight : mesh_.weight(v)}; };
    const Sign sign = is_segment(c) ? diametral_power_test(at(c[0]), at(c[1]), at(q)) : equatorial_power_test(at(c[0]), at(c[1]), at(c[2]), at(q));
    return sign == Sign::positive;
}

template <class Visit>
void BoundarySpheres::for_pairs(VertexId p, Visit&& visit) const {
    const Box& reachable = vertex_boxes_[p.index()];
    spheres_.query([&](const Box& b) { return b.meets(reachable); },
                   [&](std::uint32_t i) {
                       if (!has(constraints_[i], p)) visit(constraints_[i], p);
                   });
    for (std::uint32_t k = first_[p.index()]; k < first_[p.index() + 1]; ++k) {
        const Constraint& c = constraints_[own_[k]];
        vertices_.query([&](const Box& b) { return b.meets(sphere_boxes_[own_[k]]); },
                        [&](std::uint32_t v) {
                            if (!has(c, VertexId{v})) visit(c, VertexId{v});
                        });
    }
}

double BoundarySpheres::limit(VertexId p) const {
    const double now = mesh_.weight(p), most = reach_[p.index()];
    double limit = most;
    for_pairs(p, [&](const Constraint& c, VertexId q) {
        if (q == p) {
            limit = std::min(limit, sphere_with(c, p, now).power(mesh_.point(p)));
            return;
        }
        const double spare = sphere_with(c, p, now).power(mesh_.point(q)) - mesh_.weight(q);
        const double at_most = sphere_with(c, p, most).power(mesh_.point(q)) - mesh_.weight(q);
        if (at_most < 0) limit = std::min(limit, spare > 0 ? now + (most - now) * (spare / (spare - at_most)) : now);
    });
    return limit;
}

bool BoundarySpheres::allows(VertexId p, double weight) const {
    bool good = true;
    for_pairs(p, [&](const Constraint& c, VertexId q) { good = good && !conflicts(c, p, weight, q); });
    return good;
}

}  // namespace wellmesh
