// SPDX-License-Identifier: Apache-2.0
#include "vtk_xml.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "subvol/index.h"

namespace subvol::detail {

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
