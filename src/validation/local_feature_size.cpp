// SPDX-License-Identifier: Apache-2.0
#include "validation/local_feature_size.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <unordered_set>

#include "core/infinity.hpp"
#include "core/vec3_math.hpp"

namespace wellmesh {
namespace {

constexpr std::uint32_t kLeaf = 4;

bool share_a_number(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    if (a.size() > b.size()) return share_a_number(b, a);
    // Facets of thousands of vertices meet segments of two: search the longer list.
    return std::any_of(a.begin(), a.end(), [&](std::uint32_t v) { return std::binary_search(b.begin(), b.end(), v); });
}

}  // namespace

LocalFeatureSize::LocalFeatureSize(const ValidPlc& plc) {
    const auto point = [&](VertexId v) { return plc.vertices[v.index()]; };
    for (std::size_t i = 0; i < plc.vertices.size(); ++i) {
        const auto feature = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back({static_cast<std::uint32_t>(i)});
        primitives_.push_back({{plc.vertices[i], {}, {}}, 1, feature});
    }
    for (const ValidSegment& s : plc.segments) {
        const auto feature = static_cast<std::uint32_t>(vertices_.size());
        vertices_.push_back({s.ends[0].value(), s.ends[1].value()});
        std::sort(vertices_.back().begin(), vertices_.back().end());
        primitives_.push_back({{point(s.ends[0]), point(s.ends[1]), {}}, 2, feature});
    }
    for (const ValidFacet& f : plc.facets) {
        const auto feature = static_cast<std::uint32_t>(vertices_.size());
        vertices_.emplace_back();
        for (const VertexId v : f.vertices) vertices_.back().push_back(v.value());
        std::sort(vertices_.back().begin(), vertices_.back().end());
        for (const auto& t : f.triangles) primitives_.push_back({{point(t[0]), point(t[1]), point(t[2])}, 3, feature});
    }
    if (primitives_.empty()) return;
    std::vector<Item> items;
    items.reserve(primitives_.size());
    for (const Primitive& p : primitives_) {
        Vec3 sum{};
        for (unsigned k = 0; k < p.size; ++k) sum = sum + p.corners[k];
        items.push_back({(1.0 / p.size) * sum, static_cast<std::uint32_t>(items.size())});
    }
    build(items, 0, static_cast<std::uint32_t>(items.size()));
    order_.reserve(items.size());
    for (const Item& item : items) order_.push_back(item.primitive);
}

std::uint32_t LocalFeatureSize::build(std::vector<Item>& items, std::uint32_t begin, std::uint32_t end) {
    Node node{{}, begin, end, 0};
    for (std::uint32_t i = begin; i < end; ++i) {
        const Primitive& p = primitives_[items[i].primitive];
        for (unsigned k = 0; k < p.size; ++k) node.box.add(p.corners[k]);
    }
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(node);
    if (end - begin <= kLeaf) return at;
    const std::size_t axis = node.box.longest_axis();
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(items.begin() + begin, items.begin() + middle, items.begin() + end, [axis](const Item& p, const Item& q) {
        const double x = coordinate(p.centre, axis), y = coordinate(q.centre, axis);
        return x != y ? x < y : p.primitive < q.primitive;
    });
    build(items, begin, middle);
    const std::uint32_t right = build(items, middle, end);
    nodes_[at].right = right;
    return at;
}

bool LocalFeatureSize::incident(std::uint32_t f, std::uint32_t g) const { return share_a_number(vertices_[f], vertices_[g]); }

double LocalFeatureSize::operator()(const Vec3& x) const {
    // Boxes and primitives by distance: primitives as negative numbers, so that they come before boxes equally far.
    using Entry = std::pair<double, std::int64_t>;
    std::vector<Entry> entries;
    entries.reserve(64);
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting(std::greater<>{}, std::move(entries));
    const auto push_node = [&](std::uint32_t n) { waiting.push({nodes_[n].box.distance_to(x), n}); };
    if (!nodes_.empty()) push_node(0);
    std::vector<std::uint32_t> met;
    // Few are met but beside an apex of many.
    constexpr std::size_t kFew = 16;
    std::unordered_set<std::uint32_t> known;  // the same once there are more
    const auto is_known = [&](std::uint32_t feature) {
        if (met.size() <= kFew) return std::find(met.begin(), met.end(), feature) != met.end();
        if (known.empty()) known.insert(met.begin(), met.end());
        return !known.insert(feature).second;
    };
    std::vector<std::uint32_t> common;  // vertices of all that were met: at the apex of a thousand features they are all incident there
    while (!waiting.empty()) {
        const auto [distance, what] = waiting.top();
        waiting.pop();
        if (what >= 0) {
            const Node& node = nodes_[static_cast<std::size_t>(what)];
            if (node.right != 0) {
                push_node(static_cast<std::uint32_t>(what) + 1);
                push_node(node.right);
                continue;
            }
            for (std::uint32_t i = node.begin; i < node.end; ++i) {
                const auto& [corners, size, feature] = primitives_[order_[i]];
                const double d = size == 1   ? norm(x - corners[0])
                                 : size == 2 ? distance_to_segment(x, corners[0], corners[1])
                                             : distance_to_triangle(x, corners[0], corners[1], corners[2]);
                waiting.push({d, -1 - static_cast<std::int64_t>(feature)});
            }
            continue;
        }
        const auto feature = static_cast<std::uint32_t>(-1 - what);
        if (is_known(feature)) continue;
        const std::vector<std::uint32_t>& own = vertices_[feature];
        if (met.empty()) common = own;
        else std::erase_if(common, [&](std::uint32_t v) { return !std::binary_search(own.begin(), own.end(), v); });
        if (common.empty() && std::any_of(met.begin(), met.end(), [&](std::uint32_t other) { return !incident(feature, other); })) return distance;
        met.push_back(feature);
    }
    return kInfinity;
}

SpacingOfPoints::SpacingOfPoints(std::vector<Vec3> points) : points_(std::move(points)) { build(0, points_.size(), 0); }

void SpacingOfPoints::build(std::size_t begin, std::size_t end, unsigned depth) {
    if (end - begin < 2) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](const Vec3& p, const Vec3& q) { return coordinate(p, depth % 3) < coordinate(q, depth % 3); });
    build(begin, middle, depth + 1);
    build(middle + 1, end, depth + 1);
}

void SpacingOfPoints::search(const Vec3& x, std::size_t begin, std::size_t end, unsigned depth, std::array<double, 2>& nearest) const {
    if (begin == end) return;
    const std::size_t middle = begin + (end - begin) / 2;
    const double d = squared_distance(x, points_[middle]);
    if (d < nearest[0]) nearest = {d, nearest[0]};
    else nearest[1] = std::min(nearest[1], d);
    const double side = coordinate(x, depth % 3) - coordinate(points_[middle], depth % 3);
    const bool left_first = side < 0;
    search(x, left_first ? begin : middle + 1, left_first ? middle : end, depth + 1, nearest);
    if (side * side <= nearest[1]) search(x, left_first ? middle + 1 : begin, left_first ? end : middle, depth + 1, nearest);
}

double SpacingOfPoints::operator()(const Vec3& x) const {
    std::array<double, 2> nearest{kInfinity, kInfinity};
    search(x, 0, points_.size(), 0, nearest);
    return std::sqrt(nearest[1]);
}

}  // namespace wellmesh
