#include "vtu_arrays.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>

namespace subvol {

namespace {

const std::map<std::string_view, NumberType> kTypes{
    {"Int8", NumberType::Int8},       {"UInt8", NumberType::UInt8},   {"Int16", NumberType::Int16},
    {"UInt16", NumberType::UInt16},   {"Int32", NumberType::Int32},   {"UInt32", NumberType::UInt32},
    {"Int64", NumberType::Int64},     {"UInt64", NumberType::UInt64}, {"Float32", NumberType::Float32},
    {"Float64", NumberType::Float64}, {"Int", NumberType::Int32},     {"Float", NumberType::Float32},
    {"String", NumberType::Int8}};

std::string_view format_of(const pugi::xml_node& array) {
    return array.attribute("format").as_string("ascii");
}

}  // namespace

std::optional<std::uint64_t> number_attribute(const pugi::xml_node& node, const char* name) {
    std::string_view text = node.attribute(name).as_string();
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return std::nullopt;
    text = text.substr(begin, text.find_last_not_of(" \t\r\n") + 1 - begin);
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

std::string name_of(const pugi::xml_node& array) {
    return in_quotes(array.attribute("Name").as_string(array.parent().name()));
}

void VtuArrays::fail(const pugi::xml_node& array, const std::string& message, const std::string& allowed) const {
    in_.fail_at(static_cast<std::size_t>(array.offset_debug()), "array " + name_of(array) + ": " + message, allowed);
}

std::vector<double> VtuArrays::reals(const pugi::xml_node& array) const {
    const NumberType type = type_of(array);
    if (format_of(array) != "ascii") return reals_from(bytes(array), type, encoding_.order);
    TextScanner in = words(array);
    const std::string what = "array " + name_of(array) + ": value";
    std::vector<double> values;
    while (!in.at_end()) values.push_back(in.real({what, static_cast<std::int64_t>(values.size())}));
    return values;
}

std::vector<std::int64_t> VtuArrays::integers(const pugi::xml_node& array) const {
    const NumberType type = type_of(array);
    if (!is_integer(type)) fail(array, "an integer type is needed");
    if (format_of(array) != "ascii") return integers_from(bytes(array), type, encoding_.order);
    TextScanner in = words(array);
    const std::string what = "array " + name_of(array) + ": value";
    std::vector<std::int64_t> values;
    while (!in.at_end()) values.push_back(in.integer({what, static_cast<std::int64_t>(values.size())}));
    return values;
}

NumberType VtuArrays::type_of(const pugi::xml_node& array) const {
    const char* name = array.attribute("type").as_string();
    const auto type = kTypes.find(name);
    if (type == kTypes.end()) fail(array, "the type " + in_quotes(name) + " is not supported");
    return type->second;
}

// As it stands in the file: neither XML's entities nor its line ends matter to numbers and base64.
std::string_view VtuArrays::content(const pugi::xml_node& array) const {
    for (const auto& child : array.children()) {
        const bool cdata = child.type() == pugi::node_cdata;
        if (!cdata && child.type() != pugi::node_pcdata) continue;
        const auto begin = static_cast<std::size_t>(child.offset_debug());
        return text_.substr(begin, std::min(text_.find(cdata ? "]]>" : "<", begin), text_.size()) - begin);
    }
    return {};
}

TextScanner VtuArrays::words(const pugi::xml_node& array) const {
    const std::string_view found = content(array);
    if (found.empty()) return {found, file_, TextScanner::Comments::None};
    // Over all that stands before too, so that a failure finds its line.
    const auto begin = static_cast<std::size_t>(found.data() - text_.data());
    TextScanner in(text_.substr(0, begin + found.size()), file_, TextScanner::Comments::None);
    in.seek(begin);
    return in;
}

std::string VtuArrays::bytes(const pugi::xml_node& array) const {
    ByteSource from = source(array);
    std::string result = encoding_.compressor == Compressor::None ? plain_block(array, std::move(from))
                                                                  : compressed_blocks(array, std::move(from));
    const std::size_t size = size_of(type_of(array));
    if (result.size() % size != 0) {
        fail(array, "its " + std::to_string(result.size()) + " bytes are no whole number of values of " + std::to_string(size));
    }
    return result;
}

ByteSource VtuArrays::source(const pugi::xml_node& array) const {
    const std::string_view format = format_of(array);
    if (format == "binary") return {content(array), true};
    if (format != "appended") fail(array, "format " + in_quotes(format) + " is unknown", "ascii, binary or appended");
    if (encoding_.appended.empty()) fail(array, "there are no appended data");
    const auto offset = number_attribute(array, "offset");
    if (!offset) fail(array, "it has no offset into the appended data");
    if (*offset >= encoding_.appended.size()) {
        fail(array, "its offset " + std::to_string(*offset) + " lies behind the appended data",
             "the file has " + std::to_string(encoding_.appended.size()) + " bytes of them");
    }
    return {encoding_.appended.substr(*offset), encoding_.appended_base64};
}

std::uint64_t VtuArrays::header_number(const pugi::xml_node& array, ByteSource& from) const {
    const auto bytes = from.take(size_of(encoding_.header));
    if (!bytes) fail(array, "its data end inside their header");
    return static_cast<std::uint64_t>(integer_from(*bytes, encoding_.header, encoding_.order));
}

std::string VtuArrays::plain_block(const pugi::xml_node& array, ByteSource from) const {
    const std::uint64_t size = header_number(array, from);
    auto bytes = from.take(size);
    if (!bytes) {
        fail(array, "its " + std::to_string(size) + " bytes go beyond the end of the data or are damaged",
             "at most " + std::to_string(from.left()) + " bytes are left");
    }
    return std::move(*bytes);
}

// The header: how many blocks, their size, that of the last one if it is not full, and the compressed size of each.
std::string VtuArrays::compressed_blocks(const pugi::xml_node& array, ByteSource from) const {
    const std::uint64_t count = header_number(array, from);
    if (count == 0) return {};
    const std::uint64_t full = header_number(array, from);
    const std::uint64_t last = header_number(array, from);
    if (count > from.left() / size_of(encoding_.header)) {
        fail(array, "its " + std::to_string(count) + " compressed blocks go beyond the end of the data");
    }
    std::vector<std::uint64_t> sizes;
    for (std::uint64_t b = 0; b < count; ++b) sizes.push_back(header_number(array, from));
    std::string result;
    for (std::uint64_t b = 0; b < count; ++b) {
        const std::string which = "block " + std::to_string(b + 1) + " of " + std::to_string(count);
        const auto bytes = from.take(sizes[b]);
        if (!bytes) fail(array, which + " goes beyond the end of the data or is damaged");
        const auto block = decompressed(encoding_.compressor, *bytes, b + 1 == count && last > 0 ? last : full);
        if (!block) fail(array, which + ": decompression failed");
        result += *block;
    }
    return result;
}

}  // namespace subvol
