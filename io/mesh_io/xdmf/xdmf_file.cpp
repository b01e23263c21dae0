// SPDX-License-Identifier: Apache-2.0
// The elements of an XDMF file, and the values of its data items. An element may stand for another one, by a path in the same
// file; paths are a small part of XPath, and all elements that are looked at are counted, so that their number can be limited.
//
//     data item ─┬─ XML       words of the text
//                ├─ HDF       a dataset of another file, whole or some of its rows
//                ├─ Binary    bytes of another file from a position on
//                ├─ HyperSlab start, stride and count along each dimension of another item
//                └─ Function  an expression of other items
//
// Items are nested to a fixed depth. What is read and what is made of it is counted against the sizes of the files, as values
// may be named many times. At the end the number of values must be that of the item's Dimensions.
#include "xdmf_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "xdmf_function.h"

namespace subvol::detail {

namespace {

/// What `follow_path` follows, for messages.
constexpr const char* kPlainPaths =
    "a path as /Xdmf/Domain/Grid[2]/*, with tests [2], [@Name=\"a\"], [self::A or self::B] and // at its start alone";

// One of: the place among the elements that passed the tests before, from 1; a value of an attribute; a choice of names.
struct PathTest {
    std::size_t number = 0;
    std::string_view attribute, value;
    std::vector<std::string_view> names;
};

struct PathStep {
    std::string_view name;  // or *
    std::vector<PathTest> tests;
};

bool is_path_name(std::string_view name) {
    return !name.empty() && name.find_first_of("()[]@=\"' \t\r\n|.") == std::string_view::npos;
}

std::optional<PathTest> parse_test(std::string_view text) {
    PathTest test;
    text = trimmed(text);
    if (text.starts_with('@')) {
        const std::size_t equals = text.find('=');
        if (equals == std::string_view::npos) return std::nullopt;
        test.attribute = trimmed(text.substr(1, equals - 1));
        test.value = trimmed(text.substr(equals + 1));
        const bool quoted = test.value.size() > 1 && (test.value.front() == '"' || test.value.front() == '\'') &&
                            test.value.find(test.value.front(), 1) == test.value.size() - 1;
        if (!quoted || !is_path_name(test.attribute)) return std::nullopt;
        test.value = test.value.substr(1, test.value.size() - 2);
        return test;
    }
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), test.number);
    if (error == std::errc() && end == text.data() + text.size()) {
        return test.number > 0 ? std::optional(test) : std::nullopt;
    }
    constexpr std::string_view kSelf = "self::", kOr = " or ";
    for (std::string_view rest = text; !rest.empty();) {
        const std::size_t end_of_name = std::min(rest.find(kOr), rest.size());
        const std::string_view name = trimmed(rest.substr(0, end_of_name));
        if (!name.starts_with(kSelf) || !is_path_name(name.substr(kSelf.size()))) return std::nullopt;
        test.names.push_back(name.substr(kSelf.size()));
        rest.remove_prefix(std::min(end_of_name + kOr.size(), rest.size()));
    }
    if (test.names.empty()) return std::nullopt;
    return test;
}

// The end of a test in brackets; what is in quotes may have brackets.
std::size_t end_of_test(std::string_view text) {
    char quote = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (quote != 0) {
            if (text[i] == quote) quote = 0;
        } else if (text[i] == '"' || text[i] == '\'') {
            quote = text[i];
        } else if (text[i] == ']') {
            return i;
        }
    }
    return std::string_view::npos;
}

// The steps of a path without the slash at its start.
std::optional<std::vector<PathStep>> parse_steps(std::string_view path) {
    std::vector<PathStep> steps;
    while (true) {
        const std::size_t end = std::min(path.find_first_of("/["), path.size());
        PathStep step{path.substr(0, end), {}};
        if (step.name != "*" && !is_path_name(step.name)) return std::nullopt;
        path.remove_prefix(end);
        while (path.starts_with('[')) {
            path.remove_prefix(1);
            const std::size_t close = end_of_test(path);
            if (close == std::string_view::npos) return std::nullopt;
            auto test = parse_test(path.substr(0, close));
            if (!test) return std::nullopt;
            step.tests.push_back(std::move(*test));
            path.remove_prefix(close + 1);
        }
        steps.push_back(std::move(step));
        if (path.empty()) return steps;
        if (!path.starts_with('/')) return std::nullopt;
        path.remove_prefix(1);
    }
}

// Adds the children of an element that a step takes.
void take_step(const pugi::xml_node& parent, const PathStep& step, std::vector<std::size_t>& passed,
               std::vector<pugi::xml_node>& taken, std::size_t& visited) {
    passed.assign(step.tests.size(), 0);
    for (const auto& child : parent.children()) {
        ++visited;
        if (child.type() != pugi::node_element) continue;
        const std::string_view name = child.name();
        bool takes = step.name == "*" || name == step.name;
        for (std::size_t t = 0; t < step.tests.size() && takes; ++t) {
            const PathTest& test = step.tests[t];
            ++passed[t];  // of those that passed the earlier tests
            ++visited;
            if (test.number > 0) {
                takes = passed[t] == test.number;
            } else if (!test.names.empty()) {
                takes = std::ranges::find(test.names, name) != test.names.end();
            } else {
                const auto attribute = child.find_attribute([&](const pugi::xml_attribute& other) {
                    ++visited;
                    return std::string_view(other.name()) == test.attribute;
                });
                takes = attribute && std::string_view(attribute.value()) == test.value;
            }
        }
        if (takes) taken.push_back(child);
    }
}

// The elements at a path, in the order of the file. Paths are a small part of XPath, which could take any time.
//
// visited: is increased by the number of elements that were looked at
// returns: nothing if the path is not of this kind
std::optional<std::vector<pugi::xml_node>> follow_path(const pugi::xml_node& document, std::string_view path,
                                                       std::size_t& visited) {
    constexpr std::size_t kLongest = 1000;
    const bool anywhere = path.starts_with("//");
    if (!path.starts_with('/') || path.size() > kLongest) return std::nullopt;
    const auto steps = parse_steps(path.substr(anywhere ? 2 : 1));
    if (!steps) return std::nullopt;
    std::vector<pugi::xml_node> here{document}, next;
    for (std::size_t k = 0; anywhere && k < here.size(); ++k) {  // each level after the one above it
        for (const auto& child : here[k].children()) {
            ++visited;
            if (child.type() == pugi::node_element) here.push_back(child);
        }
    }
    std::vector<std::size_t> passed;
    for (const PathStep& step : *steps) {
        next.clear();
        for (const auto& parent : here) take_step(parent, step, passed, next, visited);
        std::swap(here, next);
    }
    std::ranges::stable_sort(here, {}, [](const pugi::xml_node& node) { return node.offset_debug(); });
    return here;
}

constexpr int kMostNestedItems = 16;

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

/// The entities that the file itself declares, <!ENTITY name "value">; external ones are not read.
std::map<std::string, std::string, std::less<>> entities_of(std::string_view declarations) {
    constexpr std::string_view kBegin = "<!ENTITY";
    std::map<std::string, std::string, std::less<>> entities;
    for (std::size_t at = declarations.find(kBegin), next = at; at != std::string_view::npos; at = next) {
        next = declarations.find(kBegin, at + 1);
        const std::string_view rest = declarations.substr(0, next).substr(at + kBegin.size());
        const std::size_t first = rest.find_first_not_of(" \t\r\n"), mark = rest.find_first_of("\"'>");
        if (first == std::string_view::npos || mark == std::string_view::npos || rest[mark] == '>') continue;
        const std::string_view name = rest.substr(first, rest.find_first_of(" \t\r\n", first) - first);
        const std::size_t end = rest.find(rest[mark], mark + 1);
        const bool only_blanks =
            rest.substr(first + name.size(), mark - first - name.size()).find_first_not_of(" \t\r\n") == std::string_view::npos;
        if (end == std::string_view::npos || !only_blanks) continue;  // "SYSTEM", or a parameter
        entities.try_emplace(std::string(name), rest.substr(mark + 1, end - mark - 1));
    }
    return entities;
}

/// Puts the values of the file's own entities in the place of &name;, which pugixml does not. Nothing if there are none.
///
/// throws: Error(InvalidInput) if values name each other without end, or make much of little
std::optional<std::string> with_entities(std::string_view text, const std::string& name) {
    constexpr int kMostDepth = 8;
    constexpr std::size_t kMostOfName = 256;
    const std::size_t begin = text.find("<!DOCTYPE");
    if (begin == std::string_view::npos) return std::nullopt;
    const std::size_t open = text.find('[', begin), close = text.find("]", open);
    if (open == std::string_view::npos || close == std::string_view::npos || text.find('>', begin) < open) return std::nullopt;
    const auto entities = entities_of(text.substr(open, close - open));
    if (entities.empty()) return std::nullopt;
    const std::size_t most_bytes = 4 * text.size() + (1 << 20);
    std::string result(text.substr(0, close));
    const auto add = [&](const auto& self, std::string_view part, int depth) -> void {
        while (!part.empty()) {
            const std::size_t mark = part.find('&');
            const std::size_t end = mark == std::string_view::npos ? mark : part.substr(0, mark + kMostOfName).find(';', mark);
            const auto known =
                end == std::string_view::npos ? entities.end() : entities.find(part.substr(mark + 1, end - mark - 1));
            const std::size_t plain = known != entities.end() ? mark : mark == std::string_view::npos ? part.size() : mark + 1;
            result += part.substr(0, plain);
            if (result.size() > most_bytes || depth > kMostDepth)
                throw Error(ErrorCode::InvalidInput, "its entities make much more text than the file has", name);
            if (known != entities.end()) self(self, known->second, depth + 1);
            part.remove_prefix(known != entities.end() ? end + 1 : plain);
        }
    };
    add(add, text.substr(close), 0);
    return result;
}

}  // namespace

std::string kind_of(const pugi::xml_node& node, std::initializer_list<const char*> names) {
    for (const char* name : names) {
        if (const auto attribute = node.attribute(name)) return upper_case(trimmed(attribute.as_string()));
    }
    return {};
}

XdmfFile::XdmfFile(std::string_view given, const std::filesystem::path& path)
    : path_(path), name_(path.string()), expanded_(with_entities(given, name_)), text_(expanded_ ? *expanded_ : given) {
    const std::string_view text = text_;
    const auto parsed = document_.load_buffer(text.data(), text.size());
    if (!parsed) {
        const TextScanner in(text, name_, TextScanner::Comments::None);
        in.fail_at(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, parsed.offset)),
                   std::string("not well-formed XML: ") + parsed.description());
    }
    domain_ = document_.child("Xdmf").child("Domain");
    if (!domain_) throw Error(ErrorCode::InvalidInput, "not an XDMF file: there is no Domain in an element Xdmf", name_);
}

std::string XdmfFile::place_of(const pugi::xml_node& node) const {
    const TextScanner in(text_, name_, TextScanner::Comments::None);
    return in.place_of(static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, node.offset_debug())));
}

void XdmfFile::fail_at(const pugi::xml_node& node, const std::string& message, const std::string& allowed) const {
    throw Error(ErrorCode::InvalidInput, printable(message), place_of(node), printable(allowed));
}

// Each path is followed once: the steps of a file name the same mesh.
std::vector<pugi::xml_node> XdmfFile::at_path(const pugi::xml_node& node, std::string_view path) const {
    auto known = paths_.find(path);
    if (known == paths_.end()) {
        auto found = follow_path(document_, path, visited_);
        if (!found) fail_at(node, "what it refers to is not a part of this file, or no plain path", kPlainPaths);
        known = paths_.emplace(path, std::move(*found)).first;
    }
    visit(node, known->second.size());
    return known->second;
}

void XdmfFile::visit(const pugi::xml_node& node, std::size_t count) const {
    constexpr std::size_t kMostVisited = 30'000'000;
    visited_ += count;
    if (visited_ > kMostVisited) fail_at(node, "its elements refer to others too often");
}

std::vector<pugi::xml_node> XdmfFile::included(const pugi::xml_node& node) const {
    std::string_view path = trimmed(node.attribute("xpointer").as_string());
    if (path.starts_with("xpointer(") && path.ends_with(")")) path = path.substr(9, path.size() - 10);
    if (node.attribute("href")) fail_at(node, "what it includes is not a part of this file");
    return at_path(node, trimmed(path));
}

// An element may stand for another one, by its path.
pugi::xml_node XdmfFile::resolved(pugi::xml_node node) const {
    for (int depth = 0; depth < kMostNestedItems; ++depth) {
        auto reference = node.attribute("Reference");
        if (!reference) reference = node.attribute("reference");
        if (!reference) return node;
        std::string_view path = trimmed(reference.as_string());
        if (path == "XML") path = trimmed(node.text().get());
        const auto found = at_path(node, path);
        if (found.empty()) fail_at(node, "there is no element " + in_quotes(path));
        node = found.front();
    }
    fail_at(node, "elements refer to each other");
}

std::vector<pugi::xml_node> XdmfFile::children(const pugi::xml_node& parent, const char* name) const {
    std::vector<pugi::xml_node> found;
    for (const auto& child : parent.children()) {
        visit(child, 1);
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

std::vector<double> XdmfFile::words(const pugi::xml_node& item) {
    const std::string text = item.text().get();
    TextScanner in(text, name_, TextScanner::Comments::None);
    std::vector<double> values;
    values.reserve(in.room_for(1));
    try {
        while (!in.at_end()) values.push_back(in.real({"value", static_cast<std::int64_t>(values.size())}));
    } catch (const Error&) {
        fail_at(item, "value " + std::to_string(values.size()) + " is not a number");
    }
    take(item, std::to_string(item.offset_debug()), values.size() * sizeof(double), values.size() * sizeof(double));
    return values;
}

std::filesystem::path XdmfFile::beside(const pugi::xml_node& item, const std::string& file) {
    named_.count([&] { return place_of(item); });
    return named_file(path_.parent_path(), file, [&] { return place_of(item); });
}

// Values may be read many times, as those of columns are of tables: they count less than those that are kept.
void XdmfFile::take(const pugi::xml_node& item, const std::string& source, std::size_t there, std::size_t read) {
    constexpr std::size_t kReadAgain = 16;
    named_.take(source, there, read / kReadAgain, [&] { return place_of(item); });
}

XdmfFile::Dataset XdmfFile::dataset_of(const pugi::xml_node& item) {
    const std::string text = as_utf8(trimmed(item.text().get()));
    const std::size_t colon = text.find(':');
    if (colon == std::string::npos || text.find('|') != std::string::npos) {
        fail_at(item, in_quotes(text) + " does not name a dataset", "FILE:/PATH is needed");
    }
    const std::filesystem::path path = beside(item, text.substr(0, colon));
    auto& file = heavy_[NamedFiles::identity(path)];
    if (!file) {
        file = std::make_unique<Hdf5File>(open_hdf5(path), path.string());
        file->allow_columns();
    }
    return {file.get(), std::filesystem::path(text.substr(colon + 1)).lexically_normal().string()};
}

// first, count: rows; without a count all of them
std::vector<double> XdmfFile::of_hdf5(const pugi::xml_node& item, std::size_t first, std::optional<std::size_t> count) {
    const auto [file, path] = dataset_of(item);
    auto values = file->reals(path, first, count ? *count : file->rows(path));
    const Hdf5Dataset dataset = file->dataset(path);
    const std::size_t there = std::min(product(dataset.lengths), std::max(values.size(), dataset.most_bytes));
    take(item, file->name() + ":" + path, there * sizeof(double), values.size() * sizeof(double));
    return values;
}

std::vector<double> XdmfFile::of_binary(const pugi::xml_node& item, std::size_t count) {
    const std::filesystem::path path = beside(item, as_utf8(trimmed(item.text().get())));
    const auto seek = item.attribute("Seek").as_ullong(0);
    const NumberType type = type_of(item);
    const std::size_t size = std::filesystem::file_size(path);
    if (seek > size || count > (size - seek) / size_of(type)) {
        fail_at(item, "its file is too short for " + counted(count, "value", "values"));
    }
    take(item, NamedFiles::identity(path), size * sizeof(double), count * sizeof(double));
    const std::endian order = kind_of(item, {"Endian"}) == "BIG" ? std::endian::big : std::endian::little;
    return reals_from(read_range(path, seek, count * size_of(type)), type, order);
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
    const bool hdf5 = kind_of(parts[1], {"Format"}) == "HDF";
    std::vector<std::size_t> lengths = sizes(parts[1], "Dimensions");
    if (hdf5) {
        const Dataset dataset = dataset_of(parts[1]);
        lengths = dataset.file->dataset(dataset.path).lengths;
    }
    if (lengths.size() != rank) fail_at(parts[0], "its rank differs from that of the values");
    std::vector<std::size_t> counts(rank), index(rank, 0);
    for (std::size_t d = 0; d < rank; ++d) {
        const std::size_t start = at(0, d), stride = at(1, d), count = counts[d] = at(2, d);
        const bool inside = count == 0 || (count <= lengths[d] && start < lengths[d] &&
                                           (count == 1 || stride <= (lengths[d] - 1 - start) / (count - 1)));
        if (!inside) fail_at(parts[0], "the hyperslab does not lie in its values");
    }
    const std::size_t total = product(counts), first = hdf5 && total > 0 ? at(0, 0) : 0;
    if (hdf5) lengths[0] = total == 0 ? 0 : (counts[0] - 1) * at(1, 0) + 1;
    const std::vector<double> all = hdf5 ? of_hdf5(parts[1], first, lengths[0]) : values(parts[1]);
    if (!hdf5 && product(lengths) != all.size()) {
        fail_at(parts[1], "it does not have the values that its Dimensions say");
    }
    if (total > all.size()) fail_at(parts[0], "the hyperslab repeats values");
    std::vector<double> chosen;
    chosen.reserve(total);
    for (std::size_t k = 0; k < total; ++k) {
        std::size_t offset = 0;
        for (std::size_t d = 0; d < rank; ++d) {
            offset = offset * lengths[d] + at(0, d) + index[d] * at(1, d) - (d == 0 ? first : 0);
        }
        chosen.push_back(all[offset]);
        for (std::size_t d = rank; d-- > 0;) {
            if (++index[d] < counts[d]) break;
            index[d] = 0;
        }
    }
    return chosen;
}

std::vector<double> XdmfFile::values(const pugi::xml_node& given) {
    const pugi::xml_node item = resolved(given);
    if (depth_ > kMostNestedItems) fail_at(item, "data items are nested too deeply");
    struct Deeper {
        int& depth;
        explicit Deeper(int& at) : depth(++at) {}
        Deeper(const Deeper&) = delete;
        Deeper& operator=(const Deeper&) = delete;
        ~Deeper() { --depth; }
    } const deeper(depth_);
    const std::string kind = kind_of(item, {"ItemType", "Type"}), format = kind_of(item, {"Format"});
    std::vector<double> found;
    const std::vector<std::size_t> lengths = sizes(item, "Dimensions");
    if (kind == "HYPERSLAB") {
        found = of_slab(item);
    } else if (kind == "FUNCTION") {
        std::vector<std::vector<double>> arguments;
        for (const auto& argument : children(item, "DataItem")) arguments.push_back(values(argument));
        found = value_of_xdmf_function(item.attribute("Function").as_string(), arguments,
                                       [&](const std::string& message) { fail_at(item, message); });
    } else if (!kind.empty() && kind != "UNIFORM") {
        fail_at(item, "data items of type " + in_quotes(kind) + " are not supported", "Uniform, HyperSlab and Function are");
    } else if (format == "HDF") {
        found = of_hdf5(item, 0, std::nullopt);
    } else if (format == "BINARY") {
        found = of_binary(item, product(lengths));
    } else if (format.empty() || format == "XML") {
        found = words(item);
    } else {
        fail_at(item, "data items of the format " + in_quotes(format) + " are not supported", "XML, HDF and Binary are");
    }
    if (depth_ == 1) named_.take({}, 0, found.size() * sizeof(double), [&] { return place_of(item); });
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
