// SPDX-License-Identifier: Apache-2.0
#include "io/vtk_xml.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include <fmt/format.h>
#include <zlib.h>

#include "io/base64.hpp"
#include "io/byte_order.hpp"
#include "io/number_parsing.hpp"

namespace wellmesh::io {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";
/// Deflate never expands by more; what claims to is no data of that compressor.
constexpr std::uint64_t kMostExpansion = 1032;

/// Calls `visit` with a value of the C++ type that VTK's name stands for. @return false: unknown name
template <class Visit>
bool with_type(std::string_view name, Visit visit) {
    if (name == "Float32") return visit(float{}), true;
    if (name == "Float64") return visit(double{}), true;
    if (name == "Int8") return visit(std::int8_t{}), true;
    if (name == "UInt8") return visit(std::uint8_t{}), true;
    if (name == "Int16") return visit(std::int16_t{}), true;
    if (name == "UInt16") return visit(std::uint16_t{}), true;
    if (name == "Int32") return visit(std::int32_t{}), true;
    if (name == "UInt32") return visit(std::uint32_t{}), true;
    if (name == "Int64") return visit(std::int64_t{}), true;
    if (name == "UInt64") return visit(std::uint64_t{}), true;
    return false;
}

std::uint64_t line_of(const SourceFile& source, std::size_t offset) {
    const auto end = source.bytes.begin() + static_cast<std::ptrdiff_t>(std::min(offset, source.bytes.size()));
    return 1 + static_cast<std::uint64_t>(std::count(source.bytes.begin(), end, '\n'));
}

/// Appends what `block` holds, as it comes: a stated size is not believed. @return whether the block is sound and holds no more than `most`
bool inflate_block(std::string_view block, std::uint64_t most, std::string& out) {
    constexpr std::size_t kInflatedChunk = 16384;
    z_stream stream{};
    if (::inflateInit(&stream) != Z_OK) return false;
    std::string input(block);  // zlib's interface wants it writable
    stream.next_in = reinterpret_cast<Bytef*>(input.data());
    stream.avail_in = static_cast<uInt>(input.size());
    const std::size_t before = out.size();
    int status = Z_OK;
    while (status == Z_OK && out.size() - before <= most) {
        const std::size_t used = out.size();
        out.resize(used + kInflatedChunk);
        stream.next_out = reinterpret_cast<Bytef*>(out.data() + used);
        stream.avail_out = static_cast<uInt>(kInflatedChunk);
        status = ::inflate(&stream, Z_NO_FLUSH);
        out.resize(used + kInflatedChunk - stream.avail_out);
    }
    ::inflateEnd(&stream);
    return status == Z_STREAM_END && out.size() - before <= most;
}

}  // namespace

VtkXml::VtkXml(const SourceFile& source, const char* type) : source_(source) {
    // Raw data are no XML: what is parsed ends where they begin, and the tags left open are closed.
    const std::string& bytes = source.bytes;
    std::string text;
    if (const std::size_t tag = bytes.find("<AppendedData"); tag != std::string::npos) {
        const std::size_t close = bytes.find('>', tag), mark = close == std::string::npos ? close : bytes.find('_', close);
        if (mark == std::string::npos) fail_at_line(source, line_of(source, tag), "the appended data do not begin with '_'");
        text = bytes.substr(0, close + 1) + "</AppendedData></VTKFile>";
        appended_ = std::string_view(bytes).substr(mark + 1);
    } else {
        text = bytes;
    }
    const pugi::xml_parse_result parsed = document_.load_buffer(text.data(), text.size(), pugi::parse_default);
    if (!parsed)
        fail_at_line(source, line_of(source, static_cast<std::size_t>(parsed.offset)), fmt::format("this is no XML: {}", parsed.description()));
    const pugi::xml_node root = document_.child("VTKFile");
    if (!root) fail_in_file(source, "the file has no element <VTKFile>");
    if (const std::string_view is = root.attribute("type").value(); is != type)
        fail(root, fmt::format("the file's type is {}, expected '{}'", quoted_token(is), type));
    grid_ = root.child(type);
    if (!grid_) fail(root, fmt::format("the file has no element <{}>", type));
    order_ = std::string_view(root.attribute("byte_order").as_string("LittleEndian")) == "BigEndian" ? std::endian::big : std::endian::little;
    header_bytes_ = std::string_view(root.attribute("header_type").as_string("UInt32")) == "UInt64" ? 8 : 4;
    const std::string_view compressor = root.attribute("compressor").value();
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
        fail(root, fmt::format("the compressor {} is not read, only 'vtkZLibDataCompressor' and none", quoted_token(compressor)));
    compressed_ = !compressor.empty();
    const pugi::xml_node appended = root.child("AppendedData");
    const std::string_view encoding = appended.attribute("encoding").as_string("base64");
    if (appended && encoding != "base64" && encoding != "raw")
        fail(appended, fmt::format("the encoding {} of appended data is unknown", quoted_token(encoding)));
    appended_base64_ = encoding == "base64";
}

void VtkXml::fail(pugi::xml_node node, const std::string& message) const {
    const std::ptrdiff_t offset = node.offset_debug();
    if (offset < 0) fail_in_file(source_, message);
    fail_at_line(source_, line_of(source_, static_cast<std::size_t>(offset)), message);
}

pugi::xml_node VtkXml::find_array(pugi::xml_node parent, const char* name) {
    return name == nullptr ? parent.child("DataArray") : parent.find_child_by_attribute("DataArray", "Name", name);
}

std::size_t VtkXml::count(pugi::xml_node node, const char* attribute) const {
    const pugi::xml_attribute a = node.attribute(attribute);
    const auto value = parse_integer(a.value());
    if (!a || !value || *value < 0)
        fail(node, fmt::format("expected a number in the attribute {} of <{}>, found {}", attribute, node.name(), quoted_token(a.value())));
    if (static_cast<std::uint64_t>(*value) > kMostExpansion * source_.bytes.size())
        fail(node, fmt::format("{} is stated as {}, more than the file can hold", attribute, *value));
    return static_cast<std::size_t>(*value);
}

std::vector<double> VtkXml::reals(pugi::xml_node array, TextPrecision* precision) const { return values<double>(array, precision); }

std::vector<std::int64_t> VtkXml::integers(pugi::xml_node array) const { return values<std::int64_t>(array, nullptr); }

template <class Value>
std::vector<Value> VtkXml::values(pugi::xml_node array, TextPrecision* precision) const {
    const std::string_view format = array.attribute("format").as_string("ascii"), type = array.attribute("type").value();
    const char* name = array.attribute("Name").value();
    std::vector<Value> out;
    if (format == "ascii") {
        if (!with_type(type, [](auto) {})) fail(array, fmt::format("the array '{}' has the type {}, which is not read", name, quoted_token(type)));
        const std::string_view text = array.text().get();
        for (std::size_t at = text.find_first_not_of(kBlanks); at != std::string_view::npos;) {
            const std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
            const std::string_view token = text.substr(at, end - at);
            if constexpr (std::is_integral_v<Value>) {
                const auto value = parse_integral_real(token);
                if (!value) fail(array, fmt::format("expected an integer in the array '{}', found {}", name, quoted_token(token)));
                out.push_back(*value);
            } else {
                const ParsedReal value = parse_real(token);
                if (value.fault == NumberFault::not_a_number || value.fault == NumberFault::too_large)
                    fail(array, fmt::format("expected a number in the array '{}', found {}", name, quoted_token(token)));
                out.push_back(value.fault == NumberFault::none ? value.value : std::numeric_limits<double>::quiet_NaN());
                if (precision != nullptr && value.fault == NumberFault::none) precision->note(token, value.value);
            }
            at = text.find_first_not_of(kBlanks, end);
        }
        return out;
    }
    const std::string bytes = binary(array);
    const auto convert = [&](auto sample) {
        using Stored = decltype(sample);
        if (bytes.size() % sizeof(Stored) != 0)
            fail(array, fmt::format("the array '{}' has {} bytes, no multiple of {}", name, bytes.size(), sizeof(Stored)));
        if (std::is_integral_v<Value> && !std::is_integral_v<Stored>)
            fail(array, fmt::format("the array '{}' has the type {}, expected integers", name, quoted_token(type)));
        out.reserve(bytes.size() / sizeof(Stored));
        for (std::size_t at = 0; at < bytes.size(); at += sizeof(Stored)) out.push_back(static_cast<Value>(load<Stored>(bytes, at, order_)));
    };
    if (!with_type(type, convert)) fail(array, fmt::format("the array '{}' has the type {}, which is not read", name, quoted_token(type)));
    if constexpr (std::is_floating_point_v<Value>) {
        if (precision != nullptr)
            for (const Value value : out)
                if (std::isfinite(value)) precision->note(value);
    }
    return out;
}

std::string VtkXml::binary(pugi::xml_node array) const {
    const std::string_view format = array.attribute("format").value();
    const char* name = array.attribute("Name").value();
    std::string_view text;
    bool base64 = true;
    if (format == "binary") {
        text = array.text().get();
        text = text.substr(std::min(text.find_first_not_of(kBlanks), text.size()));
    } else if (format == "appended") {
        const auto offset = parse_integer(array.attribute("offset").value());
        if (!offset || *offset < 0 || static_cast<std::uint64_t>(*offset) >= appended_.size())
            fail(array, fmt::format("the array '{}' begins at {}, but there are {} bytes of appended data", name,
                                    quoted_token(array.attribute("offset").value()), appended_.size()));
        text = appended_.substr(static_cast<std::size_t>(*offset));
        base64 = appended_base64_;
    } else {
        fail(array, fmt::format("the array '{}' has the format {}, which is unknown", name, quoted_token(format)));
    }
    return compressed_ ? inflated(array, text, base64) : decoded(array, text, base64);
}

std::uint64_t VtkXml::header_value(std::string_view bytes, std::size_t index) const {
    const std::size_t at = index * header_bytes_;
    return header_bytes_ == 8 ? load<std::uint64_t>(bytes, at, order_) : load<std::uint32_t>(bytes, at, order_);
}

/// [bytes] data
std::string VtkXml::decoded(pugi::xml_node array, std::string_view text, bool base64) const {
    const char* name = array.attribute("Name").value();
    const std::string header = base64 ? decode_base64(text, header_bytes_) : std::string(text.substr(0, header_bytes_));
    if (base64 && text.empty()) return {};
    if (header.size() < header_bytes_) fail(array, fmt::format("the data of the array '{}' end within their head", name));
    const std::uint64_t size = header_value(header, 0);
    if (size > text.size()) fail(array, fmt::format("the array '{}' states {} bytes, more than the file has", name, size));
    std::string all = base64 ? decode_base64(text, header_bytes_ + size) : std::string(text.substr(0, header_bytes_ + size));
    if (all.size() < header_bytes_ + size)
        fail(array, fmt::format("the array '{}' states {} bytes, {} are there", name, size, all.size() - header_bytes_));
    all.erase(0, header_bytes_);
    return all;
}

/// [blocks] [bytes of a block] [bytes of the last one, 0: as the others] [compressed bytes of each] data. The head is a base64 stream of its own.
std::string VtkXml::inflated(pugi::xml_node array, std::string_view text, bool base64) const {
    const char* name = array.attribute("Name").value();
    if (base64 && text.empty()) return {};
    const auto head = [&](std::size_t numbers, std::size_t& used) {
        used = numbers * header_bytes_;
        std::string bytes = base64 ? decode_base64(text, numbers * header_bytes_, used) : std::string(text.substr(0, numbers * header_bytes_));
        if (bytes.size() < numbers * header_bytes_) fail(array, fmt::format("the data of the array '{}' end within their head", name));
        return bytes;
    };
    std::size_t used = 0;
    const std::uint64_t blocks = header_value(head(1, used), 0);
    if (blocks > text.size() / header_bytes_) fail(array, fmt::format("the array '{}' states {} blocks, more than the file can hold", name, blocks));
    const std::string sizes = head(3 + static_cast<std::size_t>(blocks), used);
    const std::uint64_t block_size = header_value(sizes, 1), last_size = header_value(sizes, 2);
    std::uint64_t compressed = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
        const std::uint64_t size = header_value(sizes, 3 + b);
        if (size > text.size() || compressed > text.size())
            fail(array, fmt::format("a block of the array '{}' states {} bytes, more than the file has", name, size));
        compressed += size;
    }
    text = text.substr(std::min(used, text.size()));
    const std::string data = base64 ? decode_base64(text, compressed) : std::string(text.substr(0, compressed));
    if (data.size() < compressed) fail(array, fmt::format("the array '{}' states {} compressed bytes, {} are there", name, compressed, data.size()));
    std::string out;
    std::size_t at = 0;
    for (std::size_t b = 0; b < blocks; ++b) {
        const auto size = static_cast<std::size_t>(header_value(sizes, 3 + b));
        const std::uint64_t stated = b + 1 == blocks && last_size != 0 ? last_size : block_size;
        if (stated > kMostExpansion * size + 64)
            fail(array, fmt::format("a block of the array '{}' claims to hold {} bytes in {}", name, stated, size));
        const std::size_t before = out.size();
        if (!inflate_block(std::string_view(data).substr(at, size), stated, out) || out.size() - before != stated)
            fail(array, fmt::format("block {} of the array '{}' is damaged", b + 1, name));
        at += size;
    }
    return out;
}

}  // namespace wellmesh::io
