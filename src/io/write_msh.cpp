// SPDX-License-Identifier: Apache-2.0
// Gmsh's text formats 4.1 and 2.2. Regions, facets and segments are entities of dimension 3, 2 and 1 and physical groups named
// region_N, facet_N and segment_N after their references. Gmsh wants positive tags: where a reference is not positive, all of that
// dimension are numbered 1, 2, ... in ascending order of the references, and only the names keep them.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "io/writers.hpp"

namespace wellmesh::io {
namespace {

constexpr int kLine = 1, kTriangle = 2, kTetrahedron = 4;  // Gmsh's element types

struct Box {
    Vec3 low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    Vec3 high{-low.x, -low.y, -low.z};
    void add(const Vec3& p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
};

/// Elements of one dimension with one reference.
struct Entity {
    std::int32_t reference = 0;
    std::int64_t tag = 0;
    std::size_t first = 0, last = 0;  // range of Dimension::order
    Box box;
    std::vector<std::uint32_t> vertices;  // that lie on it and on nothing of lower dimension, ascending
};

/// All elements of one dimension, grouped by reference.
template <std::size_t N>
struct Dimension {
    Dimension(const std::vector<std::array<std::uint32_t, N>>& all, const std::vector<std::int32_t>& references, const std::vector<Vec3>& points)
        : elements(all), order(all.size()) {
        std::iota(order.begin(), order.end(), 0U);
        std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return references[a] < references[b]; });
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (i == 0 || references[order[i]] != entities.back().reference) {
                entities.emplace_back().reference = references[order[i]];
                entities.back().first = i;
            }
            entities.back().last = i + 1;
            for (const std::uint32_t v : elements[order[i]]) entities.back().box.add(points[v]);
        }
        const bool keep = entities.empty() || entities.front().reference > 0;
        for (std::size_t e = 0; e < entities.size(); ++e) entities[e].tag = keep ? entities[e].reference : static_cast<std::int64_t>(e) + 1;
    }

    static constexpr int kDimension = static_cast<int>(N) - 1;
    static constexpr int kElementType = N == 2 ? kLine : N == 3 ? kTriangle : kTetrahedron;
    static constexpr std::string_view kName = N == 2 ? "segment" : N == 3 ? "facet" : "region";
    const std::vector<std::array<std::uint32_t, N>>& elements;
    std::vector<std::uint32_t> order;
    std::vector<Entity> entities;  // ascending by reference
};

struct Groups {
    explicit Groups(const TetMesh& mesh)
        : segments(mesh.subsegments, mesh.subsegment_segments, mesh.vertices),
          facets(mesh.subfaces, mesh.subface_facets, mesh.vertices),
          regions(mesh.tets, mesh.tet_regions, mesh.vertices) {}
    template <class Function>
    void for_each(Function function) {
        function(segments);
        function(facets);
        function(regions);
    }
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

void write_point(OutputFile& out, const Vec3& p) {
    out.real(p.x);
    out.character(' ');
    out.real(p.y);
    out.character(' ');
    out.real(p.z);
}

void write_head(OutputFile& out, std::string_view version, Groups& groups) {
    out.text("$MeshFormat\n");
    out.text(version);
    out.text(" 0 8\n$EndMeshFormat\n$PhysicalNames\n");
    out.integer(static_cast<std::int64_t>(groups.segments.entities.size() + groups.facets.entities.size() + groups.regions.entities.size()));
    out.character('\n');
    groups.for_each([&](const auto& dimension) {
        for (const Entity& e : dimension.entities)
            out.text(fmt::format("{} {} \"{}_{}\"\n", dimension.kDimension, e.tag, dimension.kName, e.reference));
    });
    out.text("$EndPhysicalNames\n");
}

void write_entities(OutputFile& out, Groups& groups) {
    out.text("$Entities\n");
    const auto count = [](const auto& dimension) { return static_cast<std::int64_t>(dimension.entities.size()); };
    write_integers(out, {0, count(groups.segments), count(groups.facets), count(groups.regions)});
    groups.for_each([&](const auto& dimension) {
        for (const Entity& e : dimension.entities) {
            out.integer(e.tag);
            out.character(' ');
            write_point(out, e.box.low);
            out.character(' ');
            write_point(out, e.box.high);
            out.text(fmt::format(" 1 {} 0\n", e.tag));  // one physical tag; the entities that bound it are not stated
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
            for (const std::uint32_t v : e.vertices) write_integers(out, {std::int64_t{v} + 1});
            for (const std::uint32_t v : e.vertices) {
                write_point(out, mesh.vertices[v]);
                out.character('\n');
            }
        }
    });
    out.text("$EndNodes\n");
}

template <std::size_t N>
void write_corners(OutputFile& out, const std::array<std::uint32_t, N>& corners) {
    for (const std::uint32_t v : corners) {
        out.character(' ');
        out.integer(std::int64_t{v} + 1);
    }
    out.character('\n');
}

std::int64_t element_count(const TetMesh& mesh) {
    return static_cast<std::int64_t>(mesh.subsegments.size() + mesh.subfaces.size() + mesh.tets.size());
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
    const std::int64_t elements = element_count(mesh);
    std::int64_t blocks = 0, number = 0;
    groups.for_each([&](const auto& dimension) { blocks += static_cast<std::int64_t>(dimension.entities.size()); });
    out.text("$Elements\n");
    write_integers(out, {blocks, elements, elements > 0 ? 1 : 0, elements});
    groups.for_each([&](const auto& dimension) {
        for (const Entity& e : dimension.entities) {
            write_integers(out, {dimension.kDimension, e.tag, dimension.kElementType, static_cast<std::int64_t>(e.last - e.first)});
            for (std::size_t i = e.first; i < e.last; ++i) {
                out.integer(++number);
                write_corners(out, dimension.elements[dimension.order[i]]);
            }
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
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        out.integer(static_cast<std::int64_t>(v) + 1);
        out.character(' ');
        write_point(out, mesh.vertices[v]);
        out.character('\n');
    }
    out.text("$EndNodes\n$Elements\n");
    write_integers(out, {element_count(mesh)});
    std::int64_t number = 0;
    groups.for_each([&](const auto& dimension) {
        for (const Entity& e : dimension.entities)
            for (std::size_t i = e.first; i < e.last; ++i) {
                out.integer(++number);
                out.character(' ');
                out.integer(dimension.kElementType);
                out.text(" 2 ");
                out.integer(e.tag);
                out.character(' ');
                out.integer(e.tag);
                write_corners(out, dimension.elements[dimension.order[i]]);
            }
    });
    out.text("$EndElements\n");
    write_weights(out, mesh.weights);
}

}  // namespace wellmesh::io
