// SPDX-License-Identifier: Apache-2.0
// Elements and arrays of a VTK XML file, read from its text.
//
//     text ──► short copy without long contents ──► XML parser ──► elements
//       │                                                             │ offset of an element, taken back to the whole text
//       └──────────────────────────► contents of an array ◄───────────┘
//                                     ascii:            words ──► values
//                                     binary, appended: base64 or raw ──► header ──► blocks, decompressed ──► values
//
// The copy keeps what is needed to find an element in the whole text, so arrays are not in memory twice and errors name the
// line. The parser sees nothing behind the tag AppendedData, as those bytes need not be XML. Values are handed on part by part;
// bytes of a value that ends in the next block wait for it. A header that states more bytes or blocks than are left is refused,
// and what all arrays take is counted, as several may name the same appended bytes.
#include "subvol/detail/vtk_xml.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <limits>
#include <map>

#include "subvol/index.h"

namespace subvol::detail {

namespace {

const std::map<std::string_view, NumberType> kVtkTypes{
    {"Int8", NumberType::Int8},       {"UInt8", NumberType::UInt8},   {"Int16", NumberType::Int16},
    {"UInt16", NumberType::UInt16},   {"Int32", NumberType::Int32},   {"UInt32", NumberType::UInt32},
    {"Int64", NumberType::Int64},     {"UInt64", NumberType::UInt64}, {"Float32", NumberType::Float32},
    {"Float64", NumberType::Float64}, {"Int", NumberType::Int32},     {"Float", NumberType::Float32},
    {"String", NumberType::Int8}};

std::string_view format_of(const pugi::xml_node& array) {
    return array.attribute("format").as_string("ascii");
}

template <class T>
void each_word(TextScanner in, const std::string& name, NumberType type, const std::function<void(std::span<const T>)>& take,
               T (TextScanner::*read)(const Place&)) {
    constexpr std::size_t kWordsAtOnce = 1 << 14;
    const std::string what = "array " + name + ": value";
    std::vector<T> values;
    for (std::int64_t number = 0; !in.at_end(); ++number) {
        values.push_back((in.*read)({what, number}));
        // Integers are counts and indices, whose range is told by what they count.
        if constexpr (std::floating_point<T>) in.expect_type(values.back(), type, {what, number});
        if (values.size() < kWordsAtOnce) continue;
        take(values);
        values.clear();
    }
    take(values);
}

}  // namespace

XmlTags::XmlTags(std::string_view text) {
    constexpr std::size_t kShort = 64;  // characters; a text of no more is kept
    std::size_t begin = 0;
    while (begin < text.size()) {
        // A tag and the text after it. Within a comment it need not be a tag, but there nothing is lost either.
        const std::size_t end = std::min(text.find('<', begin + 1), text.size());
        const std::string_view part = text.substr(begin, end - begin);
        const std::size_t tag_end = part.rfind('>');
        const std::size_t word = tag_end == std::string_view::npos ? tag_end : part.find_first_not_of(" \t\r\n", tag_end + 1);
        const bool is_long = word != std::string_view::npos && part.size() - word > kShort;
        tags_ += is_long ? part.substr(0, word + 1) : part;
        begin = end;
        if (is_long) cuts_.push_back({tags_.size(), begin - tags_.size()});
    }
}

std::size_t XmlTags::place(std::size_t offset) const {
    const auto behind = std::ranges::upper_bound(cuts_, offset, {}, &Cut::offset);
    return offset + (behind == cuts_.begin() ? 0 : std::prev(behind)->length);
}

std::optional<std::uint64_t> number_attribute(const pugi::xml_node& node, const char* name) {
    std::string_view text = node.attribute(name).as_string();
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) return std::nullopt;
    text = text.substr(begin, text.find_last_not_of(" \t\r\n") + 1 - begin);
    if (text.starts_with('+')) text.remove_prefix(1);  // some programs write it
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

std::string name_of(const pugi::xml_node& array) {
    return in_quotes(array.attribute("Name").as_string(array.parent().name()));
}

void VtuArrays::fail(const pugi::xml_node& array, const std::string& message, const std::string& allowed) const {
    in_.fail_at(place(array), "array " + name_of(array) + ": " + message, allowed);
}

std::size_t VtuArrays::place(const pugi::xml_node& node) const {
    return tags_.place(static_cast<std::size_t>(node.offset_debug()));
}

std::size_t VtuArrays::size(const pugi::xml_node& array) const {
    const NumberType type = type_of(array);
    if (format_of(array) != "ascii") {
        ByteSource from = source(array);
        return layout(array, from).bytes / size_of(type);
    }
    TextScanner in = words(array);
    std::size_t size = 0;
    for (; !in.at_end(); ++size) in.word();
    return size;
}

bool VtuArrays::has_integers(const pugi::xml_node& array) const {
    const auto type = kVtkTypes.find(array.attribute("type").as_string());
    return type != kVtkTypes.end() && is_integer(type->second);
}

void VtuArrays::each_real(const pugi::xml_node& array, const std::function<void(std::span<const double>)>& take) const {
    const NumberType type = type_of(array);
    if (format_of(array) == "ascii") {
        each_word<double>(words(array), name_of(array), type, take, &TextScanner::real);
    } else {
        each_block(array, [&](std::string_view bytes) { take(reals_from(bytes, type, encoding_.order)); });
    }
}

void VtuArrays::each_integer(const pugi::xml_node& array,
                             const std::function<void(std::span<const std::int64_t>)>& take) const {
    const NumberType type = type_of(array);
    if (!is_integer(type)) fail(array, "an integer type is needed");
    if (format_of(array) == "ascii") {
        each_word<std::int64_t>(words(array), name_of(array), type, take, &TextScanner::integer);
    } else {
        each_block(array, [&](std::string_view bytes) { take(integers_from(bytes, type, encoding_.order)); });
    }
}

std::vector<double> VtuArrays::reals(const pugi::xml_node& array) const {
    std::vector<double> all;
    each_real(array, [&](std::span<const double> values) { all.insert(all.end(), values.begin(), values.end()); });
    return all;
}

std::vector<std::int64_t> VtuArrays::integers(const pugi::xml_node& array) const {
    std::vector<std::int64_t> all;
    each_integer(array, [&](std::span<const std::int64_t> values) { all.insert(all.end(), values.begin(), values.end()); });
    return all;
}

NumberType VtuArrays::type_of(const pugi::xml_node& array) const {
    const char* name = array.attribute("type").as_string();
    const auto type = kVtkTypes.find(name);
    if (type == kVtkTypes.end()) fail(array, "the type " + in_quotes(name) + " is not supported");
    return type->second;
}

// The text as in the file: numbers and base64 have no XML entities, and line ends do not matter.
std::string_view VtuArrays::content(const pugi::xml_node& array) const {
    for (const auto& child : array.children()) {
        const bool cdata = child.type() == pugi::node_cdata;
        if (!cdata && child.type() != pugi::node_pcdata) continue;
        const std::size_t begin = place(child);
        return text_.substr(begin, std::min(text_.find(cdata ? "]]>" : "<", begin), text_.size()) - begin);
    }
    return {};
}

TextScanner VtuArrays::words(const pugi::xml_node& array) const {
    const std::string_view found = content(array);
    if (found.empty()) return {found, file_, TextScanner::Comments::None};
    // The scanner includes the text before the array, so that errors name the right line.
    const auto begin = static_cast<std::size_t>(found.data() - text_.data());
    TextScanner in(text_.substr(0, begin + found.size()), file_, TextScanner::Comments::None);
    in.seek(begin);
    return in;
}

ByteSource VtuArrays::source(const pugi::xml_node& array) const {
    const std::string_view format = format_of(array);
    if (format == "binary") return {content(array), true};
    if (format != "appended") fail(array, "format " + in_quotes(format) + " is unknown", "ascii, binary or appended");
    if (encoding_.appended.empty()) fail(array, "there are no appended data");
    const auto offset = number_attribute(array, "offset");
    if (!offset) fail(array, "it has no offset into the appended data");
    if (*offset >= encoding_.appended.size()) {
        fail(array, "its offset " + std::to_string(*offset) + " is beyond the appended data",
             "the file has " + std::to_string(encoding_.appended.size()) + " bytes of them");
    }
    return {encoding_.appended.substr(*offset), encoding_.appended_base64};
}

std::uint64_t VtuArrays::header_number(const pugi::xml_node& array, ByteSource& from) const {
    const auto bytes = from.take(size_of(encoding_.header));
    if (!bytes) fail(array, "its data end inside their header");
    return static_cast<std::uint64_t>(integer_from(*bytes, encoding_.header, encoding_.order));
}

// there: of the whole text if that is where the bytes are counted, else of the array at this offset
void VtuArrays::count(NamedFiles& counts, const pugi::xml_node& array, std::size_t there, std::size_t taken) const {
    const bool whole = &counts == &encoded_;
    const auto offset = array.attribute("offset");
    const std::string source = whole ? "" : offset ? offset.as_string() : std::to_string(array.offset_debug());
    counts.take(source, there, taken, [&] { return in_.place_of(place(array)); });
}

void VtuArrays::fail_bytes(const pugi::xml_node& array, std::uint64_t bytes, const ByteSource& from) const {
    fail(array, "its " + std::to_string(bytes) + " bytes go beyond the end of the data or are damaged",
         "at most " + std::to_string(from.left()) + " bytes are left");
}

// Compressed data begin with the number of blocks, their size, the size of the last one if it is not full, and the compressed
// size of each.
VtuArrays::Layout VtuArrays::layout(const pugi::xml_node& array, ByteSource& from) const {
    const std::uint64_t first = header_number(array, from);
    if (encoding_.compressor == Compressor::None) {
        if (first > from.left()) fail_bytes(array, first, from);
        return {.bytes = first};
    }
    if (first == 0) return {};
    const std::uint64_t block = header_number(array, from);
    const std::uint64_t rest = header_number(array, from), last = rest > 0 ? rest : block;
    if (first > from.left() / size_of(encoding_.header)) {
        fail(array, "its " + std::to_string(first) + " compressed blocks go beyond the end of the data");
    }
    if (block > 0 && first - 1 > (std::numeric_limits<std::uint64_t>::max() - last) / block) {
        fail(array, "its " + std::to_string(first) + " compressed blocks of " + std::to_string(block) + " bytes are too many");
    }
    count(encoded_, array, text_.size(), first * size_of(encoding_.header));
    Layout layout{.bytes = (first - 1) * block + last, .block = block, .last = last};
    for (std::uint64_t b = 0; b < first; ++b) layout.compressed.push_back(header_number(array, from));
    return layout;
}

void VtuArrays::each_block(const pugi::xml_node& array, const TakeBytes& take) const {
    ByteSource from = source(array);
    const Layout found = layout(array, from);
    const std::size_t size = size_of(type_of(array));
    const bool plain = encoding_.compressor == Compressor::None;
    for (const std::uint64_t compressed : found.compressed)
        count(encoded_, array, text_.size(), std::min(compressed, from.left()));
    count(plain ? encoded_ : decoded_, array, plain ? text_.size() : found.bytes, found.bytes);
    std::string bytes;  // the beginning of a value that ends in the next block
    const auto take_whole = [&](std::string_view block) {
        bytes += block;
        const std::size_t whole = bytes.size() / size * size;
        take(std::string_view(bytes).substr(0, whole));
        bytes.erase(0, whole);
    };
    if (plain) {
        plain_blocks(array, found.bytes, std::move(from), take_whole);
    } else {
        compressed_blocks(array, found, std::move(from), take_whole);
    }
    if (!bytes.empty()) {
        fail(array, "its " + std::to_string(found.bytes) + " bytes are not a whole number of values of " +
                        std::to_string(size) + " bytes");
    }
}

void VtuArrays::plain_blocks(const pugi::xml_node& array, std::uint64_t size, ByteSource from, const TakeBytes& take) const {
    constexpr std::size_t kBytesAtOnce = std::size_t{3} << 16;  // whole groups of base64
    for (std::uint64_t left = size; left > 0;) {
        const auto bytes = from.take(std::min<std::uint64_t>(left, kBytesAtOnce));
        if (!bytes) fail_bytes(array, size, from);
        take(*bytes);
        left -= bytes->size();
    }
}

void VtuArrays::compressed_blocks(const pugi::xml_node& array, const Layout& layout, ByteSource from,
                                  const TakeBytes& take) const {
    const std::size_t count = layout.compressed.size();
    for (std::size_t b = 0; b < count; ++b) {
        const std::string which = "block " + std::to_string(b + 1) + " of " + std::to_string(count);
        const auto bytes = from.take(layout.compressed[b]);
        if (!bytes) fail(array, which + " goes beyond the end of the data or is damaged");
        const auto block = decompressed(encoding_.compressor, *bytes, b + 1 == count ? layout.last : layout.block);
        if (!block) fail(array, which + ": decompression failed");
        take(*block);
    }
}

namespace {

constexpr std::string_view kAppendedTag = "<AppendedData";

}  // namespace

VtkXml::VtkXml(std::string_view text, std::string_view file, const std::string& type, const std::string& needed)
    : text_(text), in_(text, file, TextScanner::Comments::None), arrays_(text, file, in_, tags_, encoding_) {
    const pugi::xml_node root = parse(type, needed);
    read_encoding(root);
    data_set_ = root.child(type.c_str());
    if (!data_set_) fail_at(root, "there is no " + type + " element");
}

void VtkXml::fail_at(const pugi::xml_node& node, const std::string& message, const std::string& allowed) const {
    in_.fail_at(place(node), message, allowed);
}

// Appended data need not be well-formed XML: the parser only gets the text before them.
pugi::xml_node VtkXml::parse(const std::string& type, const std::string& needed) {
    if (in_.at_end()) in_.fail("the file is empty");
    const std::size_t tag = text_.find(kAppendedTag);
    const std::size_t tag_end = tag == std::string_view::npos ? tag : text_.find('>', tag);
    if (tag_end == std::string_view::npos) {
        tags_ = XmlTags(text_);
    } else {
        tags_ = XmlTags(text_.substr(0, tag_end + 1));
        tags_.text() += text_[tag_end - 1] == '/' ? "</VTKFile>" : "</AppendedData></VTKFile>";
        find_appended(tag_end + 1);
    }
    std::string& xml = tags_.text();
    const auto result = document_.load_buffer_inplace(xml.data(), xml.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result) {
        const auto offset = std::min(tags_.place(static_cast<std::size_t>(result.offset)), text_.size());
        in_.fail_at(offset, std::string("not well-formed XML: ") + result.description());
    }
    const pugi::xml_node root = document_.document_element();
    if (std::string_view(root.name()) != "VTKFile") {
        fail_at(root, "not a VTK XML file: its root element is " + in_quotes(root.name()), "VTKFile is needed");
    }
    const char* found = root.attribute("type").as_string();
    const char* article = std::string_view("AEIOU").find(type.front()) == std::string_view::npos ? "a " : "an ";
    if (type != found) fail_at(root, in_quotes(found) + " is not " + article + type, needed);
    return root;
}

void VtkXml::find_appended(std::size_t tag_end) {
    const std::size_t begin = text_.find_first_not_of(" \t\r\n", tag_end);
    if (begin == std::string_view::npos || text_[begin] != '_') return;
    encoding_.appended = text_.substr(begin + 1);
}

void VtkXml::read_encoding(const pugi::xml_node& root) {
    const std::string_view order = root.attribute("byte_order").as_string("LittleEndian");
    if (order != "LittleEndian" && order != "BigEndian") {
        fail_at(root, "byte_order " + in_quotes(order) + " is unknown", "LittleEndian or BigEndian");
    }
    encoding_.order = order == "BigEndian" ? std::endian::big : std::endian::little;
    const std::string_view header = root.attribute("header_type").as_string("UInt32");
    if (header != "UInt32" && header != "UInt64") {
        fail_at(root, "header_type " + in_quotes(header) + " is unknown", "UInt32 or UInt64");
    }
    encoding_.header = header == "UInt64" ? NumberType::UInt64 : NumberType::UInt32;
    const char* name = root.attribute("compressor").as_string();
    const auto compressor = compressor_named(name);
    if (!compressor) fail_at(root, "compressor " + in_quotes(name) + " is not supported", "zlib, LZMA and LZ4 are");
    encoding_.compressor = *compressor;
    const pugi::xml_node appended = root.child("AppendedData");
    const std::string_view encoding = appended.attribute("encoding").as_string("base64");
    if (encoding != "raw" && encoding != "base64") {
        fail_at(appended, "encoding " + in_quotes(encoding) + " is unknown", "raw or base64");
    }
    encoding_.appended_base64 = encoding == "base64";
    if (encoding_.appended_base64) encoding_.appended = encoding_.appended.substr(0, encoding_.appended.find('<'));
}

bool VtkXml::is_older_than(int major, int minor) const {
    const std::string_view version = data_set_.parent().attribute("version").as_string("0.1");
    std::array<int, 2> parts{};
    const auto [dot, error] = std::from_chars(version.data(), version.data() + version.size(), parts[0]);
    const char* end = version.data() + version.size();
    if (error == std::errc() && dot != end) std::from_chars(dot + 1, end, parts[1]);
    return parts < std::array{major, minor};
}

std::size_t VtkXml::count(const pugi::xml_node& piece, const char* name) const {
    const auto count = number_attribute(piece, name);
    if (!count) fail_at(piece, std::string(name) + " is missing or not a count");
    if (*count >= kNone) fail_at(piece, std::string(name) + ": count out of range: " + std::to_string(*count));
    return *count;
}

pugi::xml_node VtkXml::array(const pugi::xml_node& parent, const char* name) const {
    if (!parent) fail_at(data_set_, std::string("there is no element with an array ") + in_quotes(name));
    const pugi::xml_node array = parent.find_child_by_attribute("Name", name);
    if (!array) fail_at(parent, std::string("its ") + parent.name() + " have no array " + in_quotes(name));
    return array;
}

pugi::xml_node VtkXml::coordinates(const pugi::xml_node& piece, std::size_t points) const {
    const pugi::xml_node array = piece.child("Points").child("DataArray");
    if (!array) fail_at(piece, "the piece has no Points");
    expect_size(array, arrays_.size(array), 3 * points, "3 coordinates of " + std::to_string(points) + " points");
    return array;
}

void VtkXml::expect_size(const pugi::xml_node& array, std::size_t size, std::size_t needed, const std::string& what) const {
    if (size == needed) return;
    arrays_.fail(array, "it has " + counted(size, "value", "values"), std::to_string(needed) + " are needed: " + what);
}

}  // namespace subvol::detail
