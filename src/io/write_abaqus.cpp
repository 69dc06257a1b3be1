// SPDX-License-Identifier: Apache-2.0
// Abaqus .inp: nodes, tetrahedra (C3D4) in an element set for each region, a surface for each facet marker and a node set for each marker of segments
// and vertices. Set names are the names of the input, as far as Abaqus allows: letters, digits, '_' and '-', at most 80, different from each other.
// Faces of tetrahedra count as Abaqus does: S1 is 1-2-3, S2 1-4-2, S3 2-4-3, S4 3-4-1.
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/mixed_mesh.hpp"
#include "io/writers.hpp"

namespace wellmesh::io {
namespace {

constexpr std::size_t kLongestName = 80;
constexpr std::size_t kPerLine = 16;  // numbers that a line of a set may have

class SetNames {
public:
    /// A name that Abaqus takes and that no other set has: it does not tell upper from lower case.
    std::string unique(std::string_view wanted) {
        std::string name;
        for (const char c : wanted.substr(0, kLongestName)) {
            const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
            const bool digit = c >= '0' && c <= '9';
            if (name.empty() && !letter) name += "S_";
            name += letter || digit || c == '-' ? c : '_';
        }
        if (name.empty()) name += "S";
        std::string candidate = name.substr(0, kLongestName);
        for (int i = 2; !used_.insert(lower(candidate)).second; ++i) candidate = fmt::format("{}_{}", name.substr(0, kLongestName - 12), i);
        return candidate;
    }

private:
    static std::string lower(std::string text) {
        for (char& c : text)
            if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
        return text;
    }
    std::set<std::string> used_;
};

using Face = std::array<std::uint32_t, 3>;
Face sorted(Face face) {
    std::sort(face.begin(), face.end());
    return face;
}

class AbaqusWriter {
public:
    AbaqusWriter(const TetMesh& mesh, OutputFile& out) : mesh_(mesh), out_(out) {}

    void write() {
        out_.text("*HEADING\nTetrahedral mesh\n*NODE\n");
        for (std::size_t v = 0; v < mesh_.vertices.size(); ++v) {
            out_.integer(static_cast<std::int64_t>(v) + 1);
            for (const double c : {mesh_.vertices[v].x, mesh_.vertices[v].y, mesh_.vertices[v].z}) {
                out_.text(", ");
                out_.real(c);
            }
            out_.character('\n');
        }
        write_regions();
        write_surfaces();
        write_node_sets(1);
        write_node_sets(0);
    }

private:
    std::string name_of(std::size_t dimension, std::int32_t marker) const {
        const std::string* name = mesh_.names.find(dimension, marker);
        return name != nullptr ? *name : generated_name(dimension, marker);
    }

    void write_regions() {
        std::map<std::int32_t, std::vector<std::uint32_t>> regions;
        for (std::size_t t = 0; t < mesh_.tets.size(); ++t) regions[mesh_.tet_regions[t]].push_back(static_cast<std::uint32_t>(t));
        for (const auto& [region, tets] : regions) {
            out_.text(fmt::format("*ELEMENT, TYPE=C3D4, ELSET={}\n", sets_.unique(name_of(3, region))));
            for (const std::uint32_t t : tets) {
                out_.integer(std::int64_t{t} + 1);
                for (const std::uint32_t v : mesh_.tets[t]) {
                    out_.text(", ");
                    out_.integer(std::int64_t{v} + 1);
                }
                out_.character('\n');
            }
        }
    }

    /// The marker of a subface, or the number of its facet where no facet has a marker.
    [[nodiscard]] bool facets_are_marked() const {
        return !mesh_.names.of_dimension[2].empty() ||
               std::any_of(mesh_.subface_markers.begin(), mesh_.subface_markers.end(), [](std::int32_t m) { return m != 0; });
    }

    /// A subface between two regions belongs to both tetrahedra; the surface takes the side of the lower number.
    void write_surfaces() {
        constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}}};
        const bool marked = facets_are_marked();
        std::vector<std::pair<Face, std::int32_t>> subfaces;
        for (std::size_t f = 0; f < mesh_.subfaces.size(); ++f) {
            const std::int32_t marker = marked ? mesh_.subface_markers[f] : mesh_.subface_facets[f];
            if (marker != 0 || mesh_.names.find(2, 0) != nullptr) subfaces.emplace_back(sorted(mesh_.subfaces[f]), marker);
        }
        std::stable_sort(subfaces.begin(), subfaces.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
        std::vector<char> done(subfaces.size(), 0);
        std::map<std::int32_t, std::array<std::vector<std::uint32_t>, 4>> sides;  // tetrahedra by marker and side
        for (std::size_t t = 0; t < mesh_.tets.size(); ++t)
            for (std::size_t k = 0; k < 4; ++k) {
                const auto& c = mesh_.tets[t];
                const Face face = sorted({c[kFaces[k][0]], c[kFaces[k][1]], c[kFaces[k][2]]});
                const auto at = std::lower_bound(subfaces.begin(), subfaces.end(), face, [](const auto& s, const Face& f) { return s.first < f; });
                if (at == subfaces.end() || at->first != face || done[static_cast<std::size_t>(at - subfaces.begin())]) continue;
                done[static_cast<std::size_t>(at - subfaces.begin())] = 1;
                sides[at->second][k].push_back(static_cast<std::uint32_t>(t));
            }
        for (const auto& [marker, tets] : sides) {
            const std::string name = sets_.unique(marked ? name_of(2, marker) : generated_entity_name(2, marker));
            std::string rows;
            for (std::size_t k = 0; k < 4; ++k) {
                if (tets[k].empty()) continue;
                const std::string set = sets_.unique(fmt::format("{}_S{}", name.substr(0, kLongestName - 3), k + 1));
                out_.text(fmt::format("*ELSET, ELSET={}\n", set));
                write_numbers(tets[k]);
                rows += fmt::format("{}, S{}\n", set, k + 1);
            }
            out_.text(fmt::format("*SURFACE, TYPE=ELEMENT, NAME={}\n{}", name, rows));
        }
    }

    /// @param dimension  1: the nodes of marked segments, 0: marked vertices
    void write_node_sets(std::size_t dimension) {
        std::map<std::int32_t, std::vector<std::uint32_t>> nodes;
        if (dimension == 1)
            for (std::size_t s = 0; s < mesh_.subsegment_markers.size(); ++s)
                if (const std::int32_t marker = mesh_.subsegment_markers[s]; marker != 0) {
                    nodes[marker].push_back(mesh_.subsegments[s][0]);
                    nodes[marker].push_back(mesh_.subsegments[s][1]);
                }
        if (dimension == 0)
            for (std::size_t v = 0; v < mesh_.vertex_markers.size(); ++v)
                if (mesh_.vertex_markers[v] != 0) nodes[mesh_.vertex_markers[v]].push_back(static_cast<std::uint32_t>(v));
        for (auto& [marker, list] : nodes) {
            std::sort(list.begin(), list.end());
            list.erase(std::unique(list.begin(), list.end()), list.end());
            out_.text(fmt::format("*NSET, NSET={}\n", sets_.unique(name_of(dimension, marker))));
            write_numbers(list);
        }
    }

    void write_numbers(const std::vector<std::uint32_t>& numbers) {
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            out_.integer(std::int64_t{numbers[i]} + 1);
            out_.text(i + 1 == numbers.size() || (i + 1) % kPerLine == 0 ? "\n" : ", ");
        }
    }

    const TetMesh& mesh_;
    OutputFile& out_;
    SetNames sets_;
};

}  // namespace

void write_abaqus(const TetMesh& mesh, OutputFile& out) { AbaqusWriter(mesh, out).write(); }

}  // namespace wellmesh::io
