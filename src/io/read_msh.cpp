// SPDX-License-Identifier: Apache-2.0
// Gmsh .msh, 4.1 and 2.x, text and binary. Physical groups are markers (of several on one part the first), the file's own parts ("entities")
// entities. Linear simplices and quadrilaterals are read; cells of volume other than tetrahedra are passed over where only the surface is asked for.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/mixed_mesh.hpp"
#include "io/msh_cursor.hpp"
#include "io/msh_nodes.hpp"
#include "io/plc_building.hpp"
#include "io/readers.hpp"

namespace wellmesh::io {
namespace {

struct ElementType {
    int type;
    int dimension;
    std::size_t nodes;
    const char* name;
};
/// Gmsh's numbers of the elements that files of solvers hold.
constexpr std::array<ElementType, 19> kElementTypes{{{1, 1, 2, "line"},
                                                     {2, 2, 3, "triangle"},
                                                     {3, 2, 4, "quadrilateral"},
                                                     {4, 3, 4, "tetrahedron"},
                                                     {5, 3, 8, "hexahedron"},
                                                     {6, 3, 6, "prism"},
                                                     {7, 3, 5, "pyramid"},
                                                     {8, 1, 3, "line of second order"},
                                                     {9, 2, 6, "triangle of second order"},
                                                     {10, 2, 9, "quadrilateral of second order"},
                                                     {11, 3, 10, "tetrahedron of second order"},
                                                     {12, 3, 27, "hexahedron of second order"},
                                                     {13, 3, 18, "prism of second order"},
                                                     {14, 3, 14, "pyramid of second order"},
                                                     {15, 0, 1, "point"},
                                                     {16, 2, 8, "quadrilateral of second order"},
                                                     {17, 3, 20, "hexahedron of second order"},
                                                     {18, 3, 15, "prism of second order"},
                                                     {19, 3, 13, "pyramid of second order"}}};

class MshReader {
public:
    MshReader(const SourceFile& source, bool as_surface) : text_(source, kMshSyntax), in_(text_), as_surface_(as_surface) {}

    MixedMesh read() {
        read_format();
        TextScanner& text = in_.text();
        for (std::string_view word = text.next(); !word.empty(); word = text.next()) {
            if (word.size() < 2 || word[0] != '$') text.fail_expected(word, "a section ('$Nodes', '$Elements', ...)");
            read_section(std::string(word.substr(1)));
        }
        if (!nodes_given_) fail_in_file(in_.source(), "the file has no $Nodes");
        if (!elements_given_) fail_in_file(in_.source(), "the file has no $Elements");
        out_.relative_rounding = precision_.relative_rounding();
        resolve_generated_names(out_);
        return std::move(out_);
    }

private:
    void read_format() {
        TextScanner& text = in_.text();
        if (const std::string_view word = text.next(); word != "$MeshFormat")
            text.fail(fmt::format("expected '$MeshFormat', found {}; of Gmsh's formats 4.1 and 2.2 are read", quoted_token(word)));
        const std::string_view version = text.next();
        four_ = version == "4.1";
        if (!four_ && version != "2.2" && version != "2.1" && version != "2" && version != "2.0")
            text.fail(fmt::format("version {} of the format is not read, only 4.1 and 2.2; Gmsh writes them with -format msh41 or msh22",
                                  quoted_token(version)));
        const std::int64_t type = text.integer("the file type (0 text, 1 binary)");
        if (type != 0 && type != 1) text.fail(fmt::format("the file type is 0 or 1, not {}", type));
        if (const std::int64_t size = text.integer("the size of a real"); size != 8)
            text.fail(fmt::format("reals of {} bytes are not read, only those of 8", size));
        if (type == 1) {
            in_.set_binary(std::endian::native);
            in_.begin_data();
            const std::int64_t one = in_.integer("the integer 1");
            constexpr std::int64_t kSwappedOne = 0x01000000;
            if (one == kSwappedOne) in_.set_binary(std::endian::native == std::endian::little ? std::endian::big : std::endian::little);
            else if (one != 1) in_.fail(fmt::format("expected the integer 1, found {}", one));
        }
        end_section("MeshFormat");
    }

    void read_section(const std::string& name) {
        if (name == "PhysicalNames") {
            read_names();
        } else if (name == "Entities" && four_) {
            read_entities();
        } else if (name == "Nodes") {
            if (std::exchange(nodes_given_, true)) in_.fail("the section $Nodes is given twice");
            four_ ? nodes_.read_4() : nodes_.read_2();
        } else if (name == "Elements") {
            if (!nodes_given_) in_.fail("$Elements stand before $Nodes");
            if (std::exchange(elements_given_, true)) in_.fail("the section $Elements is given twice");
            four_ ? read_elements_4() : read_elements_2();
        } else if (name == "NodeData") {
            if (!nodes_given_) in_.fail("$NodeData stand before $Nodes");
            read_node_data();
        } else if (name == "PartitionedEntities") {
            in_.fail("a partitioned mesh is not read; save it without partitions");
        } else {
            return pass_over(name);
        }
        end_section(name);
    }

    void end_section(const std::string& name) {
        const std::string_view word = in_.text().next();
        if (word.size() < 5 || word.substr(0, 4) != "$End" || word.substr(4) != name)
            in_.fail(fmt::format("expected '$End{}', {}", name, word.empty() ? std::string("but the file ends") : "found " + quoted_token(word)));
    }

    void pass_over(const std::string& name) {
        const std::string end = "$End" + name;
        TextScanner& text = in_.text();
        if (in_.binary()) {  // data of unknown width
            const std::string& bytes = in_.source().bytes;
            const std::size_t here = bytes.size() - text.bytes_left(), at = bytes.find(end, here);
            if (at == std::string::npos) in_.fail(fmt::format("the section ${} does not end", name));
            text.skip_bytes(at - here + end.size());
            return;
        }
        for (std::string_view word = text.next(); word != end; word = text.next()) {
            if (word.empty()) in_.fail(fmt::format("the section ${} does not end", name));
            text.skip_line();
        }
    }

    static std::string unquoted(std::string_view text) {
        const std::size_t first = text.find('"'), last = text.rfind('"');
        if (first == std::string_view::npos || last == first) return std::string(text);
        return std::string(text.substr(first + 1, last - first - 1));
    }

    void read_names() {
        TextScanner& text = in_.text();
        constexpr std::size_t kLeastNameBytes = 6;  // "1 1 a\n"
        const std::size_t count = text.count("the number of physical names", kLeastNameBytes);
        for (std::size_t i = 0; i < count; ++i) {
            const std::int64_t dimension = text.integer("the dimension of a group");
            if (dimension < 0 || dimension > 3) text.fail(fmt::format("the dimension of a group is 0 to 3, not {}", dimension));
            const std::int32_t tag = text.integer32("the number of a group");
            const std::string name = unquoted(text.rest_of_line());
            if (name.empty()) text.fail("expected the name of the group in quotes, but the line ends");
            out_.names.of_dimension[static_cast<std::size_t>(dimension)].emplace(tag, name);
        }
    }

    void read_entities() {
        in_.begin_data();
        std::array<std::int64_t, 4> counts{};
        for (std::int64_t& count : counts) count = in_.size("the number of entities of a dimension");
        for (std::size_t dimension = 0; dimension < 4; ++dimension) {
            const std::size_t count = in_.count(counts[dimension], "the number of entities", 8, 4 + 3 * 8 + 8);
            for (std::size_t i = 0; i < count; ++i) {
                const std::int64_t tag = in_.integer("the number of an entity");
                const int coordinates = dimension == 0 ? 3 : 6;
                for (int k = 0; k < coordinates; ++k) (void)in_.real("a bound of the entity");
                const std::size_t groups = in_.count(in_.size("the number of groups"), "the number of groups", 2, 4);
                for (std::size_t g = 0; g < groups; ++g) {
                    const std::int64_t group = std::abs(in_.integer("a physical group"));  // the sign is an orientation
                    if (group <= std::numeric_limits<std::int32_t>::max()) group_of_[dimension].emplace(tag, static_cast<std::int32_t>(group));
                }
                if (dimension == 0) continue;
                const std::size_t bounding = in_.count(in_.size("the number of bounding entities"), "the number of bounding entities", 2, 4);
                for (std::size_t b = 0; b < bounding; ++b) (void)in_.integer("a bounding entity");
            }
        }
    }

    /// @return null: to be passed over
    const ElementType* element_type(std::int64_t type, std::int64_t element, const MshCursor& in) const {
        for (const ElementType& known : kElementTypes) {
            if (known.type != type) continue;
            const bool linear = type <= 4 || type == 15;
            if (!linear && !(as_surface_ && known.dimension == 3))
                in.fail(fmt::format("element {} is a {}; only points, lines, triangles, quadrilaterals and tetrahedra of first order are read",
                                     element, known.name));
            return &known;
        }
        in.fail(fmt::format(
            "element {} has Gmsh's type {}, which is not read; only points, lines, triangles, quadrilaterals and tetrahedra of first order are",
            element, type));
    }

    struct Element {
        const ElementType* type;
        std::int32_t marker, entity;
        std::array<std::uint32_t, 4> corners;
    };
    using Elements = RowsInOrder<Element, MshReader>;
    friend Elements;

    template <bool kWide>
    Element read_element(MshCursor& in, const ElementType& type, std::int32_t marker, std::int32_t entity) const {
        Element element{&type, marker, entity, {}};
        for (std::size_t k = 0; k < type.nodes; ++k) {
            const std::int64_t tag = kWide ? in.size("the number of a node") : in.integer("the number of a node");
            if (k < element.corners.size()) element.corners[k] = nodes_.index_of(tag, in);
        }
        return element;
    }

    void take(const Element& element) {
        const auto& [type, marker, entity, c] = element;
        if (!four_) {  // version 2 lists what is in several groups once for each, one after the other; the first group counts
            const LastElement kept{type->type, entity, c};
            if (kept == last_ && marker != last_marker_) return;
            last_ = kept;
            last_marker_ = marker;
        }
        switch (type->type) {
            case 15:
                return out_.vertices.add({c[0]}, marker, entity);
            case 1:
                return out_.lines.add({c[0], c[1]}, marker, entity);
            case 2:
                return out_.triangles.add({c[0], c[1], c[2]}, marker, entity);
            case 3:
                return out_.polygons.add({c.begin(), c.end()}, marker, entity);
            case 4:
                return out_.tets.add(c, marker, entity);
            default:
                return;  // passed over
        }
    }

    static std::int32_t reference(const MshCursor& in, std::int64_t value) {
        using Limits = std::numeric_limits<std::int32_t>;
        if (value < Limits::min() || value > Limits::max()) in.fail(fmt::format("the number {} of a group or entity doesn't fit 32 bits", value));
        return static_cast<std::int32_t>(value);
    }

    void read_elements_2() {
        const std::size_t count = in_.count(in_.text().integer("the number of elements"), "the number of elements", 8, 4 + 4);
        in_.begin_data();
        if (in_.binary()) return read_blocks_2(count);
        Elements elements{this};
        in_.read_rows(count, elements, [](std::size_t) {}, [&](MshCursor& in, std::size_t, Elements& to) {
            const std::int64_t number = in.integer("the number of an element"), type = in.integer("the type of an element");
            const std::size_t tags = in.count(in.integer("the number of tags"), "the number of tags", 2, 4);
            to.add(read_element_2(in, number, type, tags));
        });
    }

    void read_blocks_2(std::size_t count) {
        for (std::size_t i = 0; i < count;) {
            const std::int64_t type = in_.integer("the type of an element"), follow = in_.integer("the number of elements of a block"),
                               tag_count = in_.integer("the number of tags");
            if (follow < 1 || static_cast<std::uint64_t>(follow) > count - i)
                in_.fail(fmt::format("a block of {} elements, of which {} are left", follow, count - i));
            const std::size_t tags = in_.count(tag_count, "the number of tags", 2, 4);
            for (std::int64_t e = 0; e < follow; ++e, ++i) take(read_element_2(in_, in_.integer("the number of an element"), type, tags));
        }
    }

    Element read_element_2(MshCursor& in, std::int64_t number, std::int64_t type_number, std::size_t tags) const {
        const ElementType& type = *element_type(type_number, number, in);
        std::array<std::int64_t, 2> kept{0, 0};  // physical group, entity; partitions follow
        for (std::size_t t = 0; t < tags; ++t) {
            const std::int64_t tag = in.integer("a tag");
            if (t < 2) kept[t] = tag;
        }
        return read_element<false>(in, type, reference(in, std::abs(kept[0])), reference(in, kept[1]));
    }

    void read_elements_4() {
        in_.begin_data();
        const std::int64_t block_count = in_.size("the number of blocks"), elements = in_.size("the number of elements");
        (void)in_.size("the least number of an element");
        (void)in_.size("the largest number of an element");
        const std::size_t blocks = in_.count(block_count, "the number of blocks", 8, 3 * 4 + 8);
        std::int64_t read = 0;
        for (std::size_t b = 0; b < blocks; ++b) {
            const std::int64_t dimension = in_.integer("the dimension of a block"), entity = in_.integer("the entity of a block"),
                               type_number = in_.integer("the type of the elements");
            if (dimension < 0 || dimension > 3) in_.fail(fmt::format("the dimension of a block is 0 to 3, not {}", dimension));
            const std::size_t count = in_.count(in_.size("the number of elements of a block"), "the number of elements of a block", 4, 8 + 8);
            const auto& groups = group_of_[static_cast<std::size_t>(dimension)];
            const auto group = groups.find(entity);
            const std::int32_t marker = group == groups.end() ? 0 : group->second;
            Elements in_order{this};
            in_.read_rows(count, in_order, [](std::size_t) {}, [&](MshCursor& in, std::size_t, Elements& to) {
                const ElementType& type = *element_type(type_number, in.size("the number of an element"), in);
                to.add(read_element<true>(in, type, marker, reference(in, entity)));
            });
            read += static_cast<std::int64_t>(count);
        }
        if (read != elements) in_.fail(fmt::format("$Elements states {} elements, its blocks have {}", elements, read));
    }

    void read_node_data() {
        TextScanner& text = in_.text();
        std::string name;
        const std::size_t strings = text.count("the number of string tags", 2);
        for (std::size_t i = 0; i < strings; ++i) {
            (void)text.at_end();  // to the next line with text
            const std::string value = unquoted(text.rest_of_line());
            if (i == 0) name = value;
        }
        const std::size_t reals = text.count("the number of real tags", 2);
        for (std::size_t i = 0; i < reals; ++i) (void)text.real("a real tag");
        const std::size_t integers = text.count("the number of integer tags", 2);
        std::array<std::int64_t, 3> tags{0, 1, 0};  // time step, components, entries
        for (std::size_t i = 0; i < integers; ++i) {
            const std::int64_t tag = text.integer("an integer tag");
            if (i < tags.size()) tags[i] = tag;
        }
        if (tags[1] < 1 || tags[1] > 9) text.fail(fmt::format("node data have 1, 3 or 9 components, not {}", tags[1]));
        const auto components = static_cast<std::size_t>(tags[1]);
        const std::size_t entries = in_.count(tags[2], "the number of entries", 4, 4 + 8 * components);
        in_.begin_data();
        // Of a field with several time steps the last one counts. A field of some of the nodes alone is of no use here.
        const bool keep = components == 1 && entries >= out_.points.size();
        std::vector<double> values(keep ? out_.points.size() : 0, std::numeric_limits<double>::quiet_NaN());
        for (std::size_t i = 0; i < entries; ++i) {
            const std::uint32_t at = nodes_.index_of(in_.integer("the number of a node"), in_);
            for (std::size_t k = 0; k < components; ++k) {
                const double value = in_.real("a value");
                if (keep) values[at] = value;
            }
        }
        if (keep) out_.fields[name] = std::move(values);
    }

    struct LastElement {
        int type = 0;
        std::int32_t entity = 0;
        std::array<std::uint32_t, 4> corners{};
        friend bool operator==(const LastElement&, const LastElement&) = default;
    };

    TextScanner text_;
    MshCursor in_;
    TextPrecision precision_;
    bool as_surface_, four_ = false, nodes_given_ = false, elements_given_ = false;
    LastElement last_;
    std::int32_t last_marker_ = 0;
    std::array<std::map<std::int64_t, std::int32_t>, 4> group_of_;  // first physical group of each entity, by dimension
    MixedMesh out_;
    MshNodes nodes_{in_, out_.points, precision_};
};

}  // namespace

MixedMesh read_msh(const SourceFile& source, bool as_surface) { return MshReader(source, as_surface).read(); }

Plc read_msh_surface(const SourceFile& source) { return to_plc(read_msh(source, true), source); }

TetMesh read_msh_mesh(const SourceFile& source) { return to_tet_mesh(read_msh(source, false), source); }

}  // namespace wellmesh::io
