// SPDX-License-Identifier: Apache-2.0
// A mesh whose vertices say how long edges shall be: Gmsh's node data, VTK's point data.
#include <cmath>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "io/mixed_mesh.hpp"
#include "io/readers.hpp"

namespace wellmesh::io {

BackgroundMesh read_background(const SourceFile& source, MixedMesh mesh) {
    auto& fields = mesh.fields;
    // What wellmesh itself writes for vertices is no size.
    for (const char* own : {"weight", "marker", "carrier", "carrier_dimension"}) fields.erase(own);
    auto field = fields.end();
    for (const char* name : {"size", "target_size", "h"})
        if (field == fields.end()) field = fields.find(name);
    if (field == fields.end() && fields.size() == 1) field = fields.begin();
    if (field == fields.end()) {
        std::vector<std::string> names;
        for (const auto& [name, values] : fields) names.push_back("'" + name + "'");
        fail_in_file(source, fields.empty() ? std::string("the file has no field of one number a vertex, which would be the size there")
                                            : fmt::format("which of the fields {} is the size? Call it 'size'", fmt::join(names, ", ")));
    }
    BackgroundMesh out;
    out.sizes = std::move(field->second);
    for (std::size_t v = 0; v < out.sizes.size(); ++v)
        if (!std::isfinite(out.sizes[v]) || out.sizes[v] < 0)
            fail_in_file(source, fmt::format("the field '{}' has no size (a number above 0, or 0 for none) at vertex {} (from 1)", field->first, v + 1));
    out.mesh = to_tet_mesh(std::move(mesh), source);
    return out;
}

}  // namespace wellmesh::io
