// SPDX-License-Identifier: Apache-2.0
#include "io/vtk_file.hpp"

#include <algorithm>
#include <bit>
#include <map>

namespace wellmesh::io {

std::string escaped(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '&') out += "&amp;";
        else if (c == '<') out += "&lt;";
        else if (c == '"') out += "&quot;";
        else if (static_cast<unsigned char>(c) < 0x20) out += ' ';  // XML has no way to write most of them
        else out += c;
    }
    return out;
}

void VtkFile::begin(const Names& names, std::string_view counts) {
    text("<?xml version=\"1.0\"?>\n");
    text(fmt::format("<VTKFile type=\"{0}\" version=\"1.0\" byte_order=\"{1}\" header_type=\"UInt64\">\n<{0}>\n", type_,
                     std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian"));
    std::map<std::string, std::string> groups;  // one array a name, whatever the number of its groups
    for (std::size_t dimension = 0; dimension < 4; ++dimension)
        for (const auto& [marker, name] : names.of_dimension[dimension]) groups[name] += fmt::format(" {} {}", marker, dimension);
    if (!groups.empty()) {
        text("<FieldData>\n");
        for (const auto& [name, pairs] : groups)
            text(fmt::format("<DataArray type=\"Int32\" Name=\"{}\" NumberOfTuples=\"{}\" format=\"ascii\">{} </DataArray>\n", escaped(name),
                             std::count(pairs.begin(), pairs.end(), ' '), pairs));
        text("</FieldData>\n");
    }
    text(fmt::format("<Piece {}>\n<Points>\n", counts));
}

void VtkFile::finish(OutputFile& out) {
    text(fmt::format("</Piece>\n</{}>\n<AppendedData encoding=\"raw\">\n_", type_));
    out.text(text_);
    for (const Array& array : arrays_) {
        const std::uint64_t size = array.bytes;
        out.bytes(&size, sizeof size);
        array.write(out);
    }
    out.text("\n</AppendedData>\n</VTKFile>\n");
}

}  // namespace wellmesh::io
