// SPDX-License-Identifier: Apache-2.0
// VTK's XML files (.vtu, .vtp): the tree of elements, and arrays of numbers in every encoding that VTK has for them.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <pugixml.hpp>

#include "io/source_file.hpp"
#include "io/text_precision.hpp"

namespace wellmesh::io {

class VtkXml {
public:
    /// @param type  "UnstructuredGrid" or "PolyData". @throws MeshError{bad_input}
    VtkXml(const SourceFile& source, const char* type);

    /// The element of that type.
    [[nodiscard]] pugi::xml_node grid() const { return grid_; }

    /// The <DataArray> called `name` in `parent`; the first one if `name` is null. Empty if there is none.
    [[nodiscard]] static pugi::xml_node find_array(pugi::xml_node parent, const char* name);

    /// All values of an array. Each byte of the file takes part in at most a bounded number of values, so memory is proportional to its size.
    /// @param precision  where the precision of coordinates is noted; may be null.
    [[nodiscard]] std::vector<double> reals(pugi::xml_node array, TextPrecision* precision = nullptr) const;
    [[nodiscard]] std::vector<std::int64_t> integers(pugi::xml_node array) const;

    /// The value of an attribute that is a number of entities. @throws MeshError{bad_input} unless the file can hold that many.
    [[nodiscard]] std::size_t count(pugi::xml_node node, const char* attribute) const;

    /// "file:line: message", the line being that of the element.
    [[noreturn]] void fail(pugi::xml_node node, const std::string& message) const;

private:
    template <class Value>
    [[nodiscard]] std::vector<Value> values(pugi::xml_node array, TextPrecision* precision) const;
    [[nodiscard]] std::string binary(pugi::xml_node array) const;
    [[nodiscard]] std::string decoded(pugi::xml_node array, std::string_view text, bool base64) const;
    [[nodiscard]] std::string inflated(pugi::xml_node array, std::string_view text, bool base64) const;
    [[nodiscard]] std::uint64_t header_value(std::string_view bytes, std::size_t index) const;

    const SourceFile& source_;
    pugi::xml_document document_;
    pugi::xml_node grid_;
    std::string_view appended_;  // after its underscore
    bool appended_base64_ = false, compressed_ = false;
    std::size_t header_bytes_ = 4;
    std::endian order_ = std::endian::little;
};

}  // namespace wellmesh::io
