// SPDX-License-Identifier: Apache-2.0
// What a file of points and cells of dimension 0 to 3 holds, before it is taken as a mesh or as a complex.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/source_file.hpp"
#include "wellmesh/names.hpp"
#include "wellmesh/plc.hpp"
#include "wellmesh/tet_mesh.hpp"

namespace wellmesh::io {

/// Cells of one kind. Corners count from 0 and are in range.
template <class Corners>
struct CellList {
    std::vector<Corners> corners;
    std::vector<std::int32_t> markers;   ///< 0: none
    std::vector<std::int32_t> entities;  ///< the file's number of the geometric part that the cell is a piece of; 0: not known

    void add(Corners cell, std::int32_t marker, std::int32_t entity) {
        corners.push_back(std::move(cell));
        markers.push_back(marker);
        entities.push_back(entity);
    }
};

struct MixedMesh {
    std::vector<Vec3> points;
    CellList<std::array<std::uint32_t, 1>> vertices;
    CellList<std::array<std::uint32_t, 2>> lines;
    CellList<std::array<std::uint32_t, 3>> triangles;
    CellList<std::vector<std::uint32_t>> polygons;  ///< of four corners and more
    CellList<std::array<std::uint32_t, 4>> tets;
    Names names;
    std::map<std::string, std::vector<double>> fields;  ///< of one number a point; NaN where the file has none
    double relative_rounding = 0;
};

/// Names that wellmesh gives to groups without one when it writes a file that needs them: "region_5", "facet_marker_-3". A name of that form
/// is read as the number that it states. @param dimension  of what is marked, 0 to 3
[[nodiscard]] std::string generated_name(std::size_t dimension, std::int32_t marker);
/// The same for the parts of an input without markers: "facet_7" is the seventh facet.
[[nodiscard]] std::string generated_entity_name(std::size_t dimension, std::int32_t entity);

/// Gives markers whose names are generated_name() the number that it states, and takes those names away; generated_entity_name() likewise becomes
/// the entity of unmarked cells.
void resolve_generated_names(MixedMesh& mesh);

/// The same for markers of facets and segments of a complex. @return whether any name was a generated one
bool resolve_generated_names(Plc& plc);

/// @throws MeshError{bad_input}  no tetrahedra, or polygons of more than three corners.
[[nodiscard]] TetMesh to_tet_mesh(MixedMesh mesh, const SourceFile& source);

/// Faces become facets, lines segments, vertices markers; tetrahedra are passed over. A closed surface whose faces turn alike is filled where its
/// winding number is not zero; everything else is a complex: what it encloses is filled, and what dangles is kept.
/// @throws MeshError{bad_input}  no faces.
[[nodiscard]] Plc to_plc(MixedMesh mesh, const SourceFile& source);

/// Whether every edge of the polygons has exactly two of them, which run through it in opposite directions.
[[nodiscard]] bool is_oriented_closed_surface(const std::vector<PlcFacet>& facets);

}  // namespace wellmesh::io
