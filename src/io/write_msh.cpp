// SPDX-License-Identifier: Apache-2.0
// Gmsh's text formats 4.1 and 2.2. Entities are the input's: regions, facets, segments, and the vertices that have a marker. Physical groups are
// markers and regions with their names. A dimension without markers gets a group for each entity, "facet_7", because other programs drop what is in none.
// Numbers of entities and groups must be positive: those that are not become the next above the largest, and keep themselves in a name, "region_-5".
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/mixed_mesh.hpp"
#include "io/writers.hpp"

namespace wellmesh::io {
namespace {

constexpr int kLine = 1, kTriangle = 2, kTetrahedron = 4, kPoint = 15;  // Gmsh's element types

struct Box {
    Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    Vec3 high{-low.x, -low.y, -low.z};
    void add(const Vec3& p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
};

/// Elements of one dimension with one reference and one marker.
struct Entity {
    std::int32_t reference = 0, marker = 0;
    std::int64_t tag = 0, group = 0;
    std::size_t first = 0, last = 0;  // range of Dimension::order
    Box box;
    std::vector<std::uint32_t> vertices;  // that lie on it and on nothing of lower dimension, ascending
};

struct Group {
    std::int64_t tag = 0;
    std::string name;
};

/// Positive numbers for `keys` (ascending, different): a positive key is its own, the others follow the largest.
std::map<std::int32_t, std::int64_t> positive_tags(const std::vector<std::int32_t>& keys) {
    std::map<std::int32_t, std::int64_t> tags;
    std::int64_t next = std::max<std::int64_t>(keys.empty() ? 0 : keys.back(), 0);
    for (const std::int32_t key : keys) tags[key] = key > 0 ? key : ++next;
    return tags;
}

/// All elements of one dimension, in entities and groups.
template <std::size_t N>
struct Dimension {
    Dimension(const std::vector<std::array<std::uint32_t, N>>& all, const std::vector<std::int32_t>& references, const std::vector<std::int32_t>& markers,
              const TetMesh& mesh)
        : elements(all), order(all.size()) {
        std::iota(order.begin(), order.end(), 0U);
        const auto key = [&](std::uint32_t e) { return std::pair(references[e], markers.empty() ? 0 : markers[e]); };
        std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (i == 0 || key(order[i]) != std::pair(entities.back().reference, entities.back().marker)) {
                Entity& e = entities.emplace_back();
                std::tie(e.reference, e.marker) = key(order[i]);
                e.first = i;
            }
            entities.back().last = i + 1;
            for (const std::uint32_t v : elements[order[i]]) entities.back().box.add(mesh.vertices[v]);
        }
        number_entities();
        make_groups(mesh.names.of_dimension[N - 1]);
    }

    static constexpr int kDimension = static_cast<int>(N) - 1;
    static constexpr int kElementType = N == 1 ? kPoint : N == 2 ? kLine : N == 3 ? kTriangle : kTetrahedron;
    const std::vector<std::array<std::uint32_t, N>>& elements;
    std::vector<std::uint32_t> order;
    std::vector<Entity> entities;  // ascending by reference
    std::vector<Group> groups;     // ascending by marker

private:
    /// The first entity of a reference has its number; further ones (other markers, in meshes of other programs) new numbers.
    void number_entities() {
        std::vector<std::int32_t> references;
        for (const Entity& e : entities)
            if (references.empty() || references.back() != e.reference) references.push_back(e.reference);
        const auto tags = positive_tags(references);
        std::int64_t next = 0;
        for (const auto& [reference, tag] : tags) next = std::max(next, tag);
        for (std::size_t e = 0; e < entities.size(); ++e) {
            const bool again = e > 0 && entities[e].reference == entities[e - 1].reference;
            entities[e].tag = again ? ++next : tags.at(entities[e].reference);
        }
    }

    void make_groups(const std::map<std::int32_t, std::string>& names) {
        const bool marked = N == 4 || !names.empty() || std::any_of(entities.begin(), entities.end(), [](const Entity& e) { return e.marker != 0; });
        if (!marked) {
            for (Entity& e : entities) groups.push_back({e.group = e.tag, generated_entity_name(N - 1, e.reference)});
            return;
        }
        std::vector<std::int32_t> markers;
        for (const Entity& e : entities) markers.push_back(e.marker);  // 0 too: beside groups, what is in none is lost or refused by many a reader
        std::sort(markers.begin(), markers.end());
        markers.erase(std::unique(markers.begin(), markers.end()), markers.end());
        const auto tags = positive_tags(markers);
        for (Entity& e : entities) e.group = tags.at(e.marker);
        for (const std::int32_t marker : markers) {
            const auto name = names.find(marker);
            groups.push_back({tags.at(marker), name != names.end() ? name->second : generated_name(N - 1, marker)});
        }
    }
};

/// The marked vertices, each an entity of its own.
struct Points {
    explicit Points(const TetMesh& mesh) {
        for (std::size_t v = 0; v < mesh.vertex_markers.size(); ++v) {
            if (mesh.vertex_markers[v] == 0) continue;
            corners.push_back({static_cast<std::uint32_t>(v)});
            references.push_back(static_cast<std::int32_t>(v) + 1);
            markers.push_back(mesh.vertex_markers[v]);
        }
    }
    std::vector<std::array<std::uint32_t, 1>> corners;
    std::vector<std::int32_t> references, markers;
};

struct Groups {
    explicit Groups(const TetMesh& mesh)
        : marked(mesh),
          points(marked.corners, marked.references, marked.markers, mesh),
          segments(mesh.subsegments, mesh.subsegment_segments, mesh.subsegment_markers, mesh),
          facets(mesh.subfaces, mesh.subface_facets, mesh.subface_markers, mesh),
          regions(mesh.tets, mesh.tet_regions, mesh.tet_regions, mesh) {}
    template <class Function>
    void for_each(Function function) {
        function(points);
        function(segments);
        function(facets);
        function(regions);
    }
    Points marked;
    Dimension<1> points;
    Dimension<2> segments;
    Dimension<3> facets;
    Dimension<4> regions;
};

void write_integers(OutputFile& out, std::initializer_list<std::int64_t> values) {
    const char* separator = "";
    for (const std::int64_t value : values) {
        out.text(separator);
        out.integer(value);
        separator = " ";
    }
    out.character('\n');
}

/// The format has no way to write a quote within a name.
std::string quotable(std::string name) {
    for (char& c : name)
        if (c == '"' || c == '\n' || c == '\r') c = '\'';
    return name;
}

void write_head(OutputFile& out, std::string_view version, Groups& groups) {
    out.text("$MeshFormat\n");
    out.text(version);
    out.text(" 0 8\n$EndMeshFormat\n$PhysicalNames\n");
    std::size_t count = 0;
    groups.for_each([&](const auto& dimension) { count += dimension.groups.size(); });
    out.integer(static_cast<std::int64_t>(count));
    out.character('\n');
    groups.for_each([&](const auto& dimension) {
        for (const Group& g : dimension.groups) out.text(fmt::format("{} {} \"{}\"\n", dimension.kDimension, g.tag, quotable(g.name)));
    });
    out.text("$EndPhysicalNames\n");
}

void write_entities(OutputFile& out, Groups& groups) {
    out.text("$Entities\n");
    const auto count = [](const auto& dimension) { return static_cast<std::int64_t>(dimension.entities.size()); };
    write_integers(out, {count(groups.points), count(groups.segments), count(groups.facets), count(groups.regions)});
    groups.for_each([&](const auto& dimension) {
        for (const Entity& e : dimension.entities) {
            out.integer(e.tag);
            out.character(' ');
            out.point(e.box.low);
            if (dimension.kDimension > 0) {
                out.character(' ');
                out.point(e.box.high);
            }
            out.text(fmt::format(" 1 {}", e.group));
            out.text(dimension.kDimension > 0 ? " 0\n" : "\n");  // the entities that bound it are not stated
        }
    });
    out.text("$EndEntities\n");
}

/// Each vertex belongs to the entity of the lowest dimension that uses it (of several, the first).
void classify_vertices(const TetMesh& mesh, Groups& groups) {
    std::vector<char> seen(mesh.vertices.size(), 0);
    Entity* last = nullptr;
    groups.for_each([&](auto& dimension) {
        for (Entity& e : dimension.entities) {
            for (std::size_t i = e.first; i < e.last; ++i)
                for (const std::uint32_t v : dimension.elements[dimension.order[i]])
                    if (seen[v] == 0) {
                        seen[v] = 1;
                        e.vertices.push_back(v);
                    }
            std::sort(e.vertices.begin(), e.vertices.end());
            last = &e;
        }
    });
    if (last == nullptr) return;
    for (std::size_t v = 0; v < seen.size(); ++v)  // on nothing: with the last entity, so that none is lost
        if (seen[v] == 0) last->vertices.push_back(static_cast<std::uint32_t>(v));
    std::sort(last->vertices.begin(), last->vertices.end());
}

void write_nodes(OutputFile& out, const TetMesh& mesh, Groups& groups) {
    classify_vertices(mesh, groups);
    std::int64_t blocks = 0, nodes = 0;
    groups.for_each([&](const auto& dimension) {
        for (const Entity& e : dimension.entities) {
            blocks += e.vertices.empty() ? 0 : 1;
            nodes += static_cast<std::int64_t>(e.vertices.size());
        }
    });
    out.text("$Nodes\n");
    write_integers(out, {blocks, nodes, nodes > 0 ? 1 : 0, nodes});
    groups.for_each([&](const auto& dimension) {
        for (const Entity& e : dimension.entities) {
            if (e.vertices.empty()) continue;
            write_integers(out, {dimension.kDimension, e.tag, 0, static_cast<std::int64_t>(e.vertices.size())});
            out.rows(e.vertices.size(), [&](auto& row, std::size_t i) {
                row.integer(std::int64_t{e.vertices[i]} + 1);
                row.character('\n');
            });
            out.rows(e.vertices.size(), [&](auto& row, std::size_t i) {
                row.point(mesh.vertices[e.vertices[i]]);
                row.character('\n');
            });
        }
    });
    out.text("$EndNodes\n");
}

template <class Output, std::size_t N>
void write_corners(Output& out, const std::array<std::uint32_t, N>& corners) {
    for (const std::uint32_t v : corners) {
        out.character(' ');
        out.integer(std::int64_t{v} + 1);
    }
    out.character('\n');
}

std::int64_t element_count(const Groups& groups) {
    return static_cast<std::int64_t>(groups.points.elements.size() + groups.segments.elements.size() + groups.facets.elements.size() + groups.regions.elements.size());
}

/// Gmsh's post-processing section: one string, one real and three integers as tags, then a value a node.
void write_weights(OutputFile& out, const std::vector<double>& weights) {
    if (weights.empty()) return;
    out.text("$NodeData\n1\n\"weight\"\n1\n0\n3\n0\n1\n");  // time step 0, one component
    out.integer(static_cast<std::int64_t>(weights.size()));
    out.character('\n');
    for (std::size_t v = 0; v < weights.size(); ++v) {
        out.integer(static_cast<std::int64_t>(v) + 1);
        out.character(' ');
        out.real(weights[v]);
        out.character('\n');
    }
    out.text("$EndNodeData\n");
}

}  // namespace

void write_msh41(const TetMesh& mesh, OutputFile& out) {
    Groups groups(mesh);
    write_head(out, "4.1", groups);
    write_entities(out, groups);
    write_nodes(out, mesh, groups);
    const std::int64_t elements = element_count(groups);
    std::int64_t blocks = 0, number = 0;
    groups.for_each([&](const auto& dimension) { blocks += static_cast<std::int64_t>(dimension.entities.size()); });
    out.text("$Elements\n");
    write_integers(out, {blocks, elements, elements > 0 ? 1 : 0, elements});
    groups.for_each([&](const auto& dimension) {
        for (const Entity& e : dimension.entities) {
            write_integers(out, {dimension.kDimension, e.tag, dimension.kElementType, static_cast<std::int64_t>(e.last - e.first)});
            out.rows(e.last - e.first, [&](auto& row, std::size_t i) {
                row.integer(number + static_cast<std::int64_t>(i) + 1);
                write_corners(row, dimension.elements[dimension.order[e.first + i]]);
            });
            number += static_cast<std::int64_t>(e.last - e.first);
        }
    });
    out.text("$EndElements\n");
    write_weights(out, mesh.weights);
}

void write_msh22(const TetMesh& mesh, OutputFile& out) {
    Groups groups(mesh);
    write_head(out, "2.2", groups);
    out.text("$Nodes\n");
    write_integers(out, {static_cast<std::int64_t>(mesh.vertices.size())});
    out.rows(mesh.vertices.size(), [&](auto& row, std::size_t v) {
        row.integer(static_cast<std::int64_t>(v) + 1);
        row.character(' ');
        row.point(mesh.vertices[v]);
        row.character('\n');
    });
    out.text("$EndNodes\n$Elements\n");
    write_integers(out, {element_count(groups)});
    std::int64_t number = 0;
    groups.for_each([&](const auto& dimension) {
        for (const Entity& e : dimension.entities) {
            out.rows(e.last - e.first, [&](auto& row, std::size_t i) {
                row.integer(number + static_cast<std::int64_t>(i) + 1);
                row.character(' ');
                row.integer(dimension.kElementType);
                row.text(" 2 ");
                row.integer(e.group);
                row.character(' ');
                row.integer(e.tag);
                write_corners(row, dimension.elements[dimension.order[e.first + i]]);
            });
            number += static_cast<std::int64_t>(e.last - e.first);
        }
    });
    out.text("$EndElements\n");
    write_weights(out, mesh.weights);
}

}  // namespace wellmesh::io
