// SPDX-License-Identifier: Apache-2.0
// PLY, ascii and binary of either byte order, with any elements and properties: x, y, z of "vertex" and the list vertex_indices
// (or vertex_index) of "face" are used, everything else is passed over by its declared type.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "io/byte_order.hpp"
#include "io/number_parsing.hpp"
#include "io/plc_building.hpp"
#include "io/readers.hpp"
#include "io/text_rows.hpp"

namespace wellmesh::io {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

struct TypeName {
    std::string_view name;
    Type type;
};
constexpr std::array<TypeName, 18> kTypes{{{"char", Type::int8}, {"int8", Type::int8}, {"uchar", Type::uint8}, {"uint8", Type::uint8},
                                           {"short", Type::int16}, {"int16", Type::int16}, {"ushort", Type::uint16}, {"uint16", Type::uint16},
                                           {"int", Type::int32}, {"int32", Type::int32}, {"uint", Type::uint32}, {"uint32", Type::uint32},
                                           {"int64", Type::int64}, {"uint64", Type::uint64}, {"float", Type::float32},
                                           {"float32", Type::float32}, {"double", Type::float64}, {"float64", Type::float64}}};

std::size_t size_of(Type type) {
    switch (type) {
        case Type::int8:
        case Type::uint8: return 1;
        case Type::int16:
        case Type::uint16: return 2;
        case Type::int32:
        case Type::uint32:
        case Type::float32: return 4;
        case Type::int64:
        case Type::uint64:
        case Type::float64: return 8;
    }
    return 8;
}

bool is_real(Type type) {
    return type == Type::float32 || type == Type::float64;
}

struct Property {
    std::string name;
    Type type = Type::float32;         // of the value, or of a list's items
    std::optional<Type> count_type{};  // of a list
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
    /// Bytes that one element takes at least: bounds `count` by the size of the file.
    [[nodiscard]] std::size_t least_bytes(bool text) const {
        std::size_t bytes = 0;
        for (const Property& p : properties) bytes += text ? 2 : size_of(p.count_type.value_or(p.type));
        return bytes;
    }
    [[nodiscard]] std::optional<std::size_t> find(std::string_view property) const {
        for (std::size_t i = 0; i < properties.size(); ++i)
            if (properties[i].name == property) return i;
        return std::nullopt;
    }
};

class PlyReader {
public:
    explicit PlyReader(const SourceFile& source) : source_(source), in_(source, {.hash_comments = false}), plc_(make_surface(source)) {}

    /// @param with_faces  whether a file without faces is an error
    Plc read(bool with_faces) {
        read_header();
        require(with_faces);
        for (const Element& element : elements_) read_element(element);
        check_end();
        resolve();
        plc_.relative_rounding = rounding();
        normalise_zeros(plc_.vertices);
        return std::move(plc_);
    }

private:
    void read_header() {
        if (in_.next() != "ply") in_.fail("expected the word 'ply'");
        bool format_known = false;
        while (true) {
            const std::string_view word = in_.next();
            if (word == "end_header") break;
            if (word == "comment" || word == "obj_info") {
                in_.skip_line();
            } else if (word == "format") {
                read_format();
                format_known = true;
            } else if (word == "element") {
                Element& element = elements_.emplace_back();
                element.name = std::string(in_.next_on_line());
                const std::int64_t count = in_.to_integer(in_.next_on_line(), "the number of elements");
                if (count < 0) in_.fail(fmt::format("the number of elements cannot be negative: {}", count));
                element.count = static_cast<std::size_t>(count);
            } else if (word == "property") {
                if (elements_.empty()) in_.fail("a property stands before the first element");
                elements_.back().properties.push_back(read_property());
            } else {
                in_.fail_expected(word, "a PLY header line (element, property, comment, end_header)");
            }
            if (!in_.at_end_of_line()) in_.fail_expected(in_.next_on_line(), "the end of the header line");
        }
        if (!format_known) in_.fail("the header has no 'format' line");
        check_counts();
        byte_ = source_.bytes.size() - in_.bytes_left();
        if (text_) return;
        in_.skip_line();  // trailing blanks; data begin after the line end
        byte_ = source_.bytes.size() - in_.bytes_left();
        const std::string_view rest = std::string_view(source_.bytes).substr(byte_);
        byte_ += rest.starts_with("\r\n") ? 2U : rest.empty() ? 0U : 1U;
    }

    void read_format() {
        const std::string_view format = in_.next_on_line();
        if (format == "ascii")
            text_ = true;
        else if (format == "binary_little_endian")
            order_ = std::endian::little;
        else if (format == "binary_big_endian")
            order_ = std::endian::big;
        else
            in_.fail_expected(format, "ascii, binary_little_endian or binary_big_endian");
        const std::string_view version = in_.next_on_line();
        if (version != "1.0") in_.fail_expected(version, "version 1.0");
    }

    Type read_type() {
        const std::string_view name = in_.next_on_line();
        for (const TypeName& known : kTypes)
            if (known.name == name) return known.type;
        in_.fail_expected(name, "a PLY type (char uchar short ushort int uint float double)");
    }

    Property read_property() {
        Property property;
        if (TextScanner ahead = in_; ahead.next_on_line() == "list") {
            (void)in_.next_on_line();
            property.count_type = read_type();
            if (is_real(*property.count_type)) in_.fail("the length of a list cannot be a real");
        }
        property.type = read_type();
        property.name = std::string(in_.next_on_line());
        if (property.name.empty()) in_.fail_expected({}, "the name of the property");
        return property;
    }

    void check_counts() const {
        for (const Element& element : elements_) {
            const std::size_t least = element.least_bytes(text_);
            if (least > 0 && element.count > (in_.bytes_left() + 1) / least)
                in_.fail(fmt::format("{} elements '{}' are stated, but the {} bytes that follow cannot hold them", element.count, element.name,
                                     in_.bytes_left()));
        }
    }

    void require(bool with_faces) const {
        const auto find = [&](std::string_view name) {
            return std::find_if(elements_.begin(), elements_.end(), [&](const Element& e) { return e.name == name; });
        };
        const auto vertex = find("vertex"), face = find("face");
        if (vertex == elements_.end()) in_.fail("the header has no element 'vertex'");
        for (const char* const name : {"x", "y", "z"}) {
            const auto at = vertex->find(name);
            if (!at || vertex->properties[*at].count_type) in_.fail(fmt::format("element 'vertex' has no property '{}'", name));
        }
        if (vertex->count > kMostVertices) in_.fail("more vertices than 32-bit numbers hold");
        if (!with_faces) return;
        if (face == elements_.end()) in_.fail("the header has no element 'face': points alone are no surface");
        const auto list = indices_of(*face);
        if (!list || !face->properties[*list].count_type) in_.fail("element 'face' has no list 'vertex_indices'");
        if (is_real(face->properties[*list].type)) in_.fail("the vertex numbers of 'face' cannot be reals");
    }

    static std::optional<std::size_t> indices_of(const Element& face) {
        const auto at = face.find("vertex_indices");
        return at ? at : face.find("vertex_index");
    }

    void read_element(const Element& element) {
        if (element.properties.empty()) return;  // takes no bytes, whatever its count
        if (element.name == "vertex" && plc_.vertices.empty())
            read_vertices(element);
        else if (element.name == "face" && plc_.facets.empty() && indices_of(element))
            read_faces(element);
        else
            read_items(element, [](std::size_t) {}, [&](TextScanner& in, std::size_t item, TextPrecision&) {
                for (const Property& property : element.properties) pass_property(in, item, element, property);
            });
    }

    /// Calls make_room(m) before it calls read(in, item, precision) for items below m; of text several at once (read_rows()).
    template <class MakeRoom, class Read>
    void read_items(const Element& element, const MakeRoom& make_room, const Read& read) {
        if (text_) return read_rows(in_, element.count, precision_, make_room, read);
        constexpr std::size_t kRoom = 1024;
        for (std::size_t item = 0; item < element.count; ++item) {
            if (item % kRoom == 0) make_room(std::min(element.count, item + kRoom));
            read(in_, item, precision_);
        }
    }

    void read_vertices(const Element& element) {
        constexpr std::size_t kNoAxis = 3;
        std::vector<std::size_t> axis_of(element.properties.size(), kNoAxis);
        for (std::size_t axis = 0; axis < 3; ++axis) axis_of[*element.find(std::array{"x", "y", "z"}[axis])] = axis;
        for (std::size_t i = 0; i < axis_of.size(); ++i) float32_ = float32_ || (axis_of[i] != kNoAxis && element.properties[i].type == Type::float32);
        plc_.vertices.reserve(element.count);
        const auto make_room = [&](std::size_t items) {
            plc_.vertices.resize(items);
            if (text_) plc_.vertex_lines.resize(items);
        };
        read_items(element, make_room, [&](TextScanner& in, std::size_t item, TextPrecision& precision) {
            std::array<double, 4> c{};
            for (std::size_t i = 0; i < axis_of.size(); ++i) {
                if (axis_of[i] == kNoAxis)
                    pass_property(in, item, element, element.properties[i]);
                else
                    c[axis_of[i]] = read_coordinate(in, item, element, element.properties[i].type, precision);
            }
            if (text_) plc_.vertex_lines[item] = in.line32();
            plc_.vertices[item] = {c[0], c[1], c[2]};
        });
    }

    void read_faces(const Element& element) {
        const std::size_t list = *indices_of(element);
        plc_.facets.reserve(element.count);
        const auto make_room = [&](std::size_t items) {
            plc_.facets.resize(items);
            if (text_) plc_.facet_lines.resize(items);
        };
        read_items(element, make_room, [&](TextScanner& in, std::size_t item, TextPrecision&) {
            for (std::size_t i = 0; i < element.properties.size(); ++i) {
                const Property& property = element.properties[i];
                if (i != list) {
                    pass_property(in, item, element, property);
                    continue;
                }
                const std::size_t corners = read_length(in, item, element, property);
                std::vector<std::uint32_t> polygon(corners);
                for (std::uint32_t& corner : polygon) corner = read_corner(in, item, element, property.type);
                if (text_) plc_.facet_lines[item] = in.line32();
                plc_.facets[item] = polygon_facet(std::move(polygon), 0);
            }
        });
    }

    double read_coordinate(TextScanner& in, std::size_t item, const Element& element, Type type, TextPrecision& precision) {
        if (text_) {
            const std::string_view token = in.next();
            const double value = in.to_real(token, "a coordinate");
            precision.note(token, value);
            return value;
        }
        const double value = read_binary_real(item, element, type);
        if (!std::isfinite(value)) fail_binary(item, element, fmt::format("coordinate {} is not finite", value));
        return value;
    }

    std::uint32_t read_corner(TextScanner& in, std::size_t item, const Element& element, Type type) {
        const std::int64_t number = text_ ? in.integer("a vertex number") : read_binary_integer(item, element, type);
        if (number < 0 || number > static_cast<std::int64_t>(kMostVertices)) fail_corner(in, item, number);
        return static_cast<std::uint32_t>(number);
    }

    /// Faces may stand before vertices, so ranges are checked in the end.
    void resolve() const {
        for (std::size_t f = 0; f < plc_.facets.size(); ++f)
            for (const std::uint32_t v : plc_.facets[f].polygons.front())
                if (v >= plc_.vertices.size()) {
                    const std::string message = corner_message(v, f);
                    if (text_) fail_at_line(source_, plc_.facet_lines[f], message);
                    fail_in_file(source_, message);
                }
    }

    [[nodiscard]] std::string corner_message(std::int64_t number, std::size_t face) const {
        return fmt::format("face {} uses vertex {}, which does not exist ({} vertices, counted from 0)", face, number, plc_.vertices.size());
    }
    [[noreturn]] void fail_corner(const TextScanner& in, std::size_t item, std::int64_t number) const {
        if (text_) in.fail(corner_message(number, item));
        fail_at_byte(source_, byte_, corner_message(number, item));
    }
    [[noreturn]] void fail_binary(std::size_t item, const Element& element, const std::string& what) const {
        fail_at_byte(source_, byte_, fmt::format("{} {}: {}", element.name, item, what));
    }

    std::size_t read_length(TextScanner& in, std::size_t item, const Element& element, const Property& property) {
        if (text_) return in.count("the length of a list", 2);
        const std::int64_t length = read_binary_integer(item, element, *property.count_type);
        if (length < 0) fail_binary(item, element, fmt::format("list '{}' has the length {}", property.name, length));
        if (static_cast<std::uint64_t>(length) > (source_.bytes.size() - byte_) / size_of(property.type))
            fail_binary(item, element, fmt::format("list '{}' has {} items, more than the file has bytes for", property.name, length));
        return static_cast<std::size_t>(length);
    }

    void pass_property(TextScanner& in, std::size_t item, const Element& element, const Property& property) {
        const std::size_t values = property.count_type ? read_length(in, item, element, property) : 1;
        if (text_) {
            // Properties that are not used may well be nan; they only have to be there.
            for (std::size_t i = 0; i < values; ++i)
                if (in.next().empty()) in.fail_expected({}, fmt::format("'{}' of {} {}", property.name, element.name, item).c_str());
            return;
        }
        need_bytes(item, element, values * size_of(property.type));
        byte_ += values * size_of(property.type);
    }

    void need_bytes(std::size_t item, const Element& element, std::size_t bytes) const {
        if (source_.bytes.size() - byte_ < bytes) fail_binary(item, element, "the file ends");
    }

    template <class T>
    T take(std::size_t item, const Element& element) {
        need_bytes(item, element, sizeof(T));
        return load<T>(source_.bytes, std::exchange(byte_, byte_ + sizeof(T)), order_);
    }

    double read_binary_real(std::size_t item, const Element& element, Type type) {
        if (type == Type::float32) return static_cast<double>(take<float>(item, element));
        if (type == Type::float64) return take<double>(item, element);
        return static_cast<double>(read_binary_integer(item, element, type));
    }

    std::int64_t read_binary_integer(std::size_t item, const Element& element, Type type) {
        switch (type) {
            case Type::int8: return take<std::int8_t>(item, element);
            case Type::uint8: return take<std::uint8_t>(item, element);
            case Type::int16: return take<std::int16_t>(item, element);
            case Type::uint16: return take<std::uint16_t>(item, element);
            case Type::int32: return take<std::int32_t>(item, element);
            case Type::uint32: return take<std::uint32_t>(item, element);
            case Type::int64: return take<std::int64_t>(item, element);
            case Type::uint64: return static_cast<std::int64_t>(take<std::uint64_t>(item, element) & 0x7fffffffffffffffULL);
            case Type::float32:
            case Type::float64: break;
        }
        fail_binary(item, element, "a real stands where an integer is needed");
    }

    void check_end() {
        if (text_) {
            if (!in_.at_end()) in_.fail_expected(in_.next(), "nothing after the elements that the header states");
            return;
        }
        // Some writers end binary files with a line end.
        if (source_.bytes.find_first_not_of("\r\n", byte_) != std::string::npos)
            fail_at_byte(source_, byte_, fmt::format("{} bytes follow the elements that the header states", source_.bytes.size() - byte_));
    }

    /// Text that is exact is so whatever the declared type; other text of floats carries both roundings, the larger counts.
    [[nodiscard]] double rounding() const {
        const double declared = float32_ ? kFloat32Rounding : 0;
        if (!text_) return declared;
        const double of_text = precision_.relative_rounding();
        return of_text == 0 ? 0 : std::max(of_text, declared);
    }

    const SourceFile& source_;
    TextScanner in_;  // of the header, and of text data
    TextPrecision precision_;
    Plc plc_;
    std::vector<Element> elements_;
    bool text_ = false, float32_ = false;
    std::endian order_ = std::endian::little;
    std::size_t byte_ = 0;  // cursor of binary data
};

}  // namespace

Plc read_ply(const SourceFile& source) {
    return PlyReader(source).read(true);
}

std::vector<Vec3> read_ply_points(const SourceFile& source) {
    return std::move(PlyReader(source).read(false).vertices);
}

}  // namespace wellmesh::io
