// SPDX-License-Identifier: Apache-2.0
#include "xdmf_file.h"

#include <algorithm>
#include <cmath>

#include "structured_grid.h"
#include "subvol/error.h"
#include "text_scanner.h"
#include "trimmed.h"

namespace subvol::detail {

namespace {

constexpr int kMostNestedItems = 16;
constexpr std::size_t kLongestPath = 300;

std::size_t product(const std::vector<std::size_t>& sizes) {
    std::size_t result = 1;
    for (const std::size_t size : sizes) {
        if (size == 0) return 0;
        if (result > (std::size_t{1} << 40) / size) return kNone;
        result *= size;
    }
    return result;
}

NumberType type_of(const pugi::xml_node& item) {
    const std::string type = kind_of(item, {"NumberType", "DataType"});
    const int precision = item.attribute("Precision").as_int(type == "CHAR" || type == "UCHAR" ? 1 : 4);
    const bool wide = precision == 8;
    if (type == "INT")
        return wide             ? NumberType::Int64
               : precision == 2 ? NumberType::Int16
               : precision == 1 ? NumberType::Int8
                                : NumberType::Int32;
    if (type == "UINT")
        return wide             ? NumberType::UInt64
               : precision == 2 ? NumberType::UInt16
               : precision == 1 ? NumberType::UInt8
                                : NumberType::UInt32;
    if (type == "SHORT") return NumberType::Int16;
    if (type == "USHORT") return NumberType::UInt16;
    if (type == "CHAR") return NumberType::Int8;
    if (type == "UCHAR") return NumberType::UInt8;
    return wide ? NumberType::Float64 : NumberType::Float32;
}

}  // namespace

std::string kind_of(const pugi::xml_node& node, std::initializer_list<const char*> names) {
    for (const char* name : names) {
        if (const auto attribute = node.attribute(name)) return upper_case(trimmed(attribute.as_string()));
    }
    return {};
}

XdmfFile::XdmfFile(std::string_view text, const std::filesystem::path& path) : text_(text), path_(path), name_(path.string()) {
    const auto parsed = document_.load_buffer(text.data(), text.size());
    if (!parsed) {
        const TextScanner in(text, name_, TextScanner::Comments::None);
        in.fail_at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, parsed.offset)),
                   std::string("not well-formed XML: ") + parsed.description());
    }
    domain_ = document_.child("Xdmf").child("Domain");
    if (!domain_) throw Error(ErrorCode::InvalidInput, "not an XDMF file: there is no Domain in an element Xdmf", name_);
}

void XdmfFile::fail_at(const pugi::xml_node& node, const std::string& message, const std::string& allowed) const {
    const TextScanner in(text_, name_, TextScanner::Comments::None);
    in.fail_at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, node.offset_debug())), message, allowed);
}

// XPath could take any time: only plain paths are followed.
std::vector<pugi::xml_node> XdmfFile::included(const pugi::xml_node& node) const {
    std::string path = node.attribute("xpointer").as_string();
    if (path.starts_with("xpointer(") && path.ends_with(")")) path = path.substr(9, path.size() - 10);
    const bool plain = path.size() <= kLongestPath && path.starts_with("/") && path.find("//", 1) == std::string::npos &&
                       std::ranges::count(path, '[') <= kMostNestedItems && path.find("..") == std::string::npos;
    if (!plain || node.attribute("href")) fail_at(node, "what it includes is not a part of this file");
    std::vector<pugi::xml_node> nodes;
    try {
        for (const auto& found : document_.select_nodes(path.c_str())) {
            if (found.node()) nodes.push_back(found.node());
        }
    } catch (const pugi::xpath_exception& error) {
        fail_at(node, "its path is not valid: " + printable(error.what()));
    }
    return nodes;
}

// An element may stand for another one, by its path.
pugi::xml_node XdmfFile::resolved(pugi::xml_node node) const {
    for (int depth = 0; depth < kMostNestedItems; ++depth) {
        const auto reference = node.attribute("Reference");
        if (!reference) return node;
        std::string path(trimmed(reference.as_string()));
        if (path == "XML") path = trimmed(node.text().get());
        const bool plain = path.size() <= kLongestPath && path.starts_with("/") && path.find("//", 1) == std::string::npos;
        if (!plain) fail_at(node, "what it refers to is not a part of this file");
        try {
            const pugi::xml_node next = document_.select_node(path.c_str()).node();
            if (!next) fail_at(node, "there is no element " + in_quotes(path));
            node = next;
        } catch (const pugi::xpath_exception&) {
            fail_at(node, "its path is not valid");
        }
    }
    fail_at(node, "elements refer to each other");
}

std::vector<pugi::xml_node> XdmfFile::children(const pugi::xml_node& parent, const char* name) const {
    std::vector<pugi::xml_node> found;
    for (const auto& child : parent.children()) {
        if (std::string_view(child.name()) == name) found.push_back(resolved(child));
        if (!std::string_view(child.name()).ends_with("include")) continue;  // of any namespace
        for (const auto& other : included(child)) {
            if (std::string_view(other.name()) == name) found.push_back(resolved(other));
        }
    }
    return found;
}

pugi::xml_node XdmfFile::child(const pugi::xml_node& parent, const char* name) const {
    const auto all = children(parent, name);
    return all.empty() ? pugi::xml_node() : all.front();
}

std::vector<std::size_t> XdmfFile::sizes(const pugi::xml_node& node, const char* attribute) const {
    const std::string text = node.attribute(attribute).as_string();
    TextScanner in(text, name_, TextScanner::Comments::None);
    std::vector<std::size_t> sizes;
    while (!in.at_end()) {
        const std::string_view word = in.word();
        const bool digits = word.size() < 16 && std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
        if (!digits || sizes.size() > 8) {
            fail_at(node, std::string(attribute) + " " + in_quotes(text) + " are not sizes");
        }
        sizes.push_back(std::stoull(std::string(word)));
    }
    return sizes;
}

std::vector<double> XdmfFile::words(const pugi::xml_node& item) const {
    const std::string text = item.text().get();
    TextScanner in(text, name_, TextScanner::Comments::None);
    std::vector<double> values;
    values.reserve(in.room_for(1));
    try {
        while (!in.at_end()) values.push_back(in.real({"value", static_cast<std::int64_t>(values.size())}));
    } catch (const Error&) {
        fail_at(item, "value " + std::to_string(values.size()) + " is not a number");
    }
    return values;
}

std::filesystem::path XdmfFile::beside(const pugi::xml_node& item, const std::string& file) const {
    const std::filesystem::path path = path_.parent_path() / file;
    std::error_code none;
    if (file.empty() || !std::filesystem::is_regular_file(path, none)) {
        fail_at(item, file.empty() ? "no file is named" : "there is no file " + in_quotes(file),
                "names are relative to the folder of this file");
    }
    return path;
}

// first, count: rows; without a count all of them. lengths: of the dimensions, if wanted
std::vector<double> XdmfFile::of_hdf5(const pugi::xml_node& item, std::size_t first, std::optional<std::size_t> count,
                                      std::vector<std::size_t>* lengths) {
    const std::string text = as_utf8(trimmed(item.text().get()));
    const std::size_t colon = text.find(':');
    if (colon == std::string::npos || text.find('|') != std::string::npos) {
        fail_at(item, in_quotes(text) + " does not name a dataset", "FILE:/PATH is needed");
    }
    const std::filesystem::path path = beside(item, text.substr(0, colon));
    auto& file = heavy_[path];
    if (!file) file = std::make_unique<Hdf5File>(open_hdf5(path), path.string());
    const std::string dataset = text.substr(colon + 1);
    if (lengths != nullptr) *lengths = file->dataset(dataset).lengths;
    return file->reals(dataset, first, count ? *count : file->rows(dataset));
}

std::vector<double> XdmfFile::of_binary(const pugi::xml_node& item, std::size_t count) const {
    const std::string bytes = read_text(beside(item, as_utf8(trimmed(item.text().get()))));
    const auto seek = item.attribute("Seek").as_ullong(0);
    const NumberType type = type_of(item);
    if (seek > bytes.size() || count > (bytes.size() - seek) / size_of(type)) {
        fail_at(item, "its file is too short for " + counted(count, "value", "values"));
    }
    const std::endian order = kind_of(item, {"Endian"}) == "BIG" ? std::endian::big : std::endian::little;
    return reals_from(std::string_view(bytes).substr(seek, count * size_of(type)), type, order);
}

// A part of another item: where it starts along each dimension, the distance of its places, and their number.
std::vector<double> XdmfFile::of_slab(const pugi::xml_node& item) {
    const auto parts = children(item, "DataItem");
    if (parts.size() != 2) fail_at(item, "a hyperslab needs two data items: its place, and the values");
    const auto place = values(parts[0]);
    const std::size_t rank = place.size() / 3;
    const bool sound = rank > 0 && place.size() == 3 * rank &&
                       std::ranges::all_of(place, [](double v) { return v >= 0 && v < 1e12 && v == std::floor(v); });
    if (!sound) fail_at(parts[0], "it is not the start, stride and count of a hyperslab");
    const auto at = [&](std::size_t row, std::size_t d) { return static_cast<std::size_t>(place[row * rank + d]); };
    std::vector<std::size_t> lengths = sizes(parts[1], "Dimensions");
    std::vector<double> all;
    std::size_t first = 0;
    if (kind_of(parts[1], {"Format"}) == "HDF") {
        first = at(0, 0);
        const std::size_t rows = at(2, 0) == 0 ? 0 : (at(2, 0) - 1) * std::max<std::size_t>(1, at(1, 0)) + 1;
        all = of_hdf5(parts[1], first, rows, &lengths);
        if (!lengths.empty()) lengths[0] = first + rows;
    } else {
        all = values(parts[1]);
        if (product(lengths) != all.size()) fail_at(parts[1], "it does not have the values that its Dimensions say");
    }
    if (lengths.size() != rank) fail_at(parts[0], "its rank differs from that of the values");
    for (std::size_t d = 0; d < rank; ++d) {
        const std::size_t count = at(2, d);
        if (count > lengths[d] || (count > 0 && at(0, d) + (count - 1) * at(1, d) >= lengths[d])) {
            fail_at(parts[0], "the hyperslab does not lie in its values");
        }
    }
    std::vector<double> chosen;
    std::vector<std::size_t> index(rank, 0);
    std::size_t total = 1;
    for (std::size_t d = 0; d < rank; ++d) total *= at(2, d);
    if (total > all.size()) fail_at(parts[0], "the hyperslab repeats values");
    chosen.reserve(total);
    for (std::size_t k = 0; k < total; ++k) {
        std::size_t offset = 0;
        for (std::size_t d = 0; d < rank; ++d) {
            const std::size_t i = at(0, d) + index[d] * at(1, d) - (d == 0 ? first : 0);
            offset = offset * (d == 0 ? 1 : lengths[d]) + i;
        }
        chosen.push_back(all[offset]);
        for (std::size_t d = rank; d-- > 0;) {
            if (++index[d] < at(2, d)) break;
            index[d] = 0;
        }
    }
    return chosen;
}

std::vector<double> XdmfFile::values(const pugi::xml_node& given) {
    const pugi::xml_node item = resolved(given);
    if (depth_ > kMostNestedItems) fail_at(item, "data items are nested too deeply");
    ++depth_;
    const std::string kind = kind_of(item, {"ItemType", "Type"}), format = kind_of(item, {"Format"});
    std::vector<double> found;
    const std::vector<std::size_t> lengths = sizes(item, "Dimensions");
    if (kind == "HYPERSLAB") {
        found = of_slab(item);
    } else if (!kind.empty() && kind != "UNIFORM") {
        fail_at(item, "data items of type " + in_quotes(kind) + " are not supported", "Uniform and HyperSlab are");
    } else if (format == "HDF") {
        found = of_hdf5(item, 0, std::nullopt, nullptr);
    } else if (format == "BINARY") {
        found = of_binary(item, product(lengths));
    } else if (format.empty() || format == "XML") {
        found = words(item);
    } else {
        fail_at(item, "data items of the format " + in_quotes(format) + " are not supported", "XML, HDF and Binary are");
    }
    --depth_;
    if (!lengths.empty() && product(lengths) != found.size()) {
        fail_at(item, "it has " + counted(found.size(), "value", "values") + ", but its Dimensions say " +
                          std::to_string(product(lengths)));
    }
    return found;
}

std::vector<std::vector<double>> XdmfFile::items(const pugi::xml_node& element, std::size_t count) {
    const auto nodes = children(element, "DataItem");
    if (nodes.size() != count) {
        fail_at(element, "it has " + counted(nodes.size(), "data item", "data items"), std::to_string(count) + " needed");
    }
    std::vector<std::vector<double>> all;
    for (const auto& node : nodes) all.push_back(values(node));
    return all;
}

}  // namespace subvol::detail
