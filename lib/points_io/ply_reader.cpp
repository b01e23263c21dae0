// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "number_type.h"
#include "points_file.h"
#include "subvol/detail/surface_io.h"
#include "subvol/error.h"
#include "text_scanner.h"

namespace subvol::detail {

namespace {

/// counts: the type of the lengths if the property is a list; nothing if it is a single number
struct PlyProperty {
    std::string name;
    NumberType type;
    std::optional<NumberType> counts;
};

struct PlyElement {
    std::string name;
    std::size_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    bool ascii = true;
    std::endian order = std::endian::little;
    std::vector<std::string> comments;
    std::vector<PlyElement> elements;
};

/// The values of a property, in the order of the rows. lengths: of the lists, one for each row
struct PlyColumn {
    std::vector<double> values;
    std::vector<std::size_t> lengths;
};

using PlyTable = std::map<std::string, PlyColumn, std::less<>>;

const std::map<std::string_view, NumberType> kTypes{
    {"char", NumberType::Int8},      {"uchar", NumberType::UInt8},    {"short", NumberType::Int16},
    {"ushort", NumberType::UInt16},  {"int", NumberType::Int32},      {"uint", NumberType::UInt32},
    {"float", NumberType::Float32},  {"double", NumberType::Float64}, {"int8", NumberType::Int8},
    {"uint8", NumberType::UInt8},    {"int16", NumberType::Int16},    {"uint16", NumberType::UInt16},
    {"int32", NumberType::Int32},    {"uint32", NumberType::UInt32},  {"float32", NumberType::Float32},
    {"float64", NumberType::Float64}};

/// One line of the header, word by word; errors name the place in the header.
class HeaderLine {
public:
    HeaderLine(const TextScanner& in, std::string_view line) : in_(in), rest_(line) {}

    std::string_view word() {
        const std::size_t begin = std::min(rest_.find_first_not_of(" \t"), rest_.size());
        const std::size_t end = std::min(rest_.find_first_of(" \t", begin), rest_.size());
        const std::string_view found = rest_.substr(begin, end - begin);
        rest_.remove_prefix(std::min(end + 1, rest_.size()));
        return found;
    }

    /// Skips the next word if it is the expected one.
    bool skips(std::string_view expected) {
        const std::string_view before = rest_;
        if (word() == expected) return true;
        rest_ = before;
        return false;
    }

    [[nodiscard]] std::string_view rest() const { return rest_; }

    NumberType type() {
        const std::string_view name = word();
        const auto type = kTypes.find(name);
        if (type == kTypes.end()) in_.fail(in_quotes(name) + " is not a type of a property", "such as float or uchar");
        return type->second;
    }

    std::string name() {
        const std::string_view found = word();
        if (found.empty()) in_.fail("a name is missing");
        return std::string(found);
    }

    std::size_t count() {
        const std::string_view digits = word();
        TextScanner number(digits, "", TextScanner::Comments::None);
        const bool whole = !digits.empty() && digits.size() < 19 &&
                           std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
        if (!whole) in_.fail(in_quotes(digits) + " is not a count");
        return static_cast<std::size_t>(number.integer({"count"}));
    }

private:
    const TextScanner& in_;
    std::string_view rest_;
};

void read_format(const TextScanner& in, HeaderLine& line, PlyHeader& header) {
    const std::string_view format = line.word();
    if (format != "ascii" && format != "binary_little_endian" && format != "binary_big_endian") {
        in.fail("format " + in_quotes(format) + " is unknown", "ascii, binary_little_endian or binary_big_endian");
    }
    header.ascii = format == "ascii";
    header.order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
}

PlyProperty read_property(HeaderLine& line) {
    PlyProperty property;
    if (line.skips("list")) {
        property.counts = line.type();
    }
    property.type = line.type();
    property.name = line.name();
    return property;
}

std::size_t least_row_bytes(const PlyElement& element) {
    std::size_t bytes = 0;
    for (const auto& property : element.properties) bytes += size_of(property.counts.value_or(property.type));
    return bytes;
}

void check_count(const TextScanner& in, const PlyHeader& header, const PlyElement& element) {
    const std::size_t room = header.ascii ? in.room_for(element.properties.size()) : in.bytes_left() / least_row_bytes(element);
    if (element.count <= room) return;
    in.fail("element " + in_quotes(element.name) + " goes beyond the end of the file: it should have " +
                std::to_string(element.count) + " rows",
            "there is room for " + std::to_string(room));
}

/// The numbers of an element's rows, in either encoding.
class RowNumbers {
public:
    RowNumbers(TextScanner& in, const PlyHeader& header, const PlyElement& element)
        : in_(in), header_(header), name_(in_quotes(element.name)), rows_(element.count) {}

    double real(NumberType type, std::size_t row) {
        const Place place{name_, static_cast<std::int64_t>(row), rows_};
        if (header_.ascii) return in_.real(place);
        return real_from(in_.bytes(size_of(type), place), type, header_.order);
    }

    std::size_t length(NumberType type, std::size_t row) {
        const double length = real(type, row);
        if (length >= 0 && length <= static_cast<double>(in_.bytes_left())) return static_cast<std::size_t>(length);
        in_.fail(name_ + " " + std::to_string(row) + ": a list goes beyond the end of the file");
    }

private:
    TextScanner& in_;
    const PlyHeader& header_;
    std::string name_;
    std::size_t rows_;
};

/// Reads the header to the end of its last line. in: at the start of the file
///
/// throws: Error(InvalidInput), as does everything in this file
PlyHeader read_ply_header(TextScanner& in) {
    if (in.line() != "ply") in.fail("not a PLY file: it does not begin with \"ply\"");
    PlyHeader header;
    bool has_format = false;
    for (;;) {
        if (in.bytes_left() == 0) in.fail("the header has no end_header");
        HeaderLine line(in, in.line());
        const std::string_view key = line.word();
        if (key == "end_header") break;
        if (key == "format") {
            read_format(in, line, header);
            has_format = true;
        } else if (key == "comment") {
            header.comments.emplace_back(line.rest());
        } else if (key == "element") {
            std::string name = line.name();
            header.elements.push_back({std::move(name), line.count(), {}});
        } else if (key == "property") {
            if (header.elements.empty()) in.fail("a property comes before the first element");
            header.elements.back().properties.push_back(read_property(line));
        } else if (key != "obj_info") {
            in.fail(in_quotes(key) + " is not a key of a PLY header", "element, property, comment, end_header");
        }
    }
    if (!has_format) in.fail("the header does not name a format");
    return header;
}

/// Reads the rows of the next element and keeps the properties with the names in `wanted`.
PlyTable read_ply_element(TextScanner& in, const PlyHeader& header, const PlyElement& element,
                          const std::set<std::string, std::less<>>& wanted) {
    PlyTable table;
    if (element.properties.empty()) return table;
    check_count(in, header, element);
    std::vector<PlyColumn*> columns;
    for (const auto& property : element.properties) {
        PlyColumn* const column = wanted.contains(property.name) ? &table[property.name] : nullptr;
        if (column) (property.counts ? column->lengths.reserve(element.count) : column->values.reserve(element.count));
        columns.push_back(column);
    }
    RowNumbers numbers(in, header, element);
    for (std::size_t row = 0; row < element.count; ++row) {
        for (std::size_t k = 0; k < columns.size(); ++k) {
            const PlyProperty& property = element.properties[k];
            const std::size_t length = property.counts ? numbers.length(*property.counts, row) : 1;
            if (columns[k] && property.counts) columns[k]->lengths.push_back(length);
            for (std::size_t n = 0; n < length; ++n) {
                const double number = numbers.real(property.type, row);
                if (columns[k]) columns[k]->values.push_back(number);
            }
        }
    }
    return table;
}

using Names = std::set<std::string, std::less<>>;
constexpr std::array<const char*, 6> kFrame{"sxx", "sxy", "sxz", "syy", "syz", "szz"};
constexpr std::array<const char*, 3> kGradient{"gx", "gy", "gz"};
constexpr std::array<const char*, 1> kMoment{"moment"};
constexpr std::array<const char*, 6> kHessian{"hxx", "hxy", "hxz", "hyy", "hyz", "hzz"};

std::string suffix_of(std::size_t channel) {
    return channel == 0 ? "" : "_" + std::to_string(channel);
}

class PlyReader {
public:
    PlyReader(std::string_view text, const std::filesystem::path& path, std::vector<double>* numbers)
        : path_(path), name_(path.string()), in_(text, name_, TextScanner::Comments::None), numbers_(numbers) {}

    RbfVolume read() {
        header_ = read_ply_header(in_);
        if (!header_.ascii) in_.name_bytes();
        read_comments();
        bool found = false;
        for (const PlyElement& element : header_.elements) {
            if (element.name == "vertex") {
                take_vertices(element);
                found = true;
            } else if (element.name == "boundary_vertex") {
                take_boundary_points(read_ply_element(in_, header_, element, Names{"x", "y", "z"}), element);
            } else if (element.name == "boundary_triangle") {
                take_triangles(read_ply_element(in_, header_, element, Names{"vertex_indices"}), element);
            } else {
                std::ignore = read_ply_element(in_, header_, element, {});
            }
        }
        if (!found) in_.fail("there is no element vertex");
        if (volume_.boundary.triangles.empty()) volume_.boundary = read_boundary(path_, triangles_beside_);
        return std::move(volume_);
    }

private:
    void read_comments() {
        bool has_kernel = false;
        for (const std::string_view comment : header_.comments) {
            const std::size_t space = std::min(comment.find(' '), comment.size());
            const std::string_view key = comment.substr(0, space);
            const std::string value(comment.substr(std::min(space + 1, comment.size())));
            if (key == "kernel") {
                volume_.kernel = kernel_from_json(value);
                has_kernel = true;
            } else if (key == "channel") {
                volume_.channels.push_back({.name = value});
            } else if (key == "boundary_triangles") {
                std::from_chars(value.data(), value.data() + value.size(), triangles_beside_);
            }
        }
        if (!has_kernel) in_.fail("the header has no comment with the kernel", "write points with subvol");
        if (volume_.channels.empty()) volume_.channels.push_back({.name = "value"});
    }

    [[nodiscard]] Names wanted() const {
        Names names{"x", "y", "z", "cx", "cy", "cz"};
        names.insert(kFrame.begin(), kFrame.end());
        if (numbers_ != nullptr) names.insert(kNumber);
        for (std::size_t c = 0; c < volume_.channels.size(); ++c) {
            names.insert("value" + suffix_of(c));
            for (const char* name : kGradient) names.insert(name + suffix_of(c));
            for (const char* name : kMoment) names.insert(name + suffix_of(c));
            for (const char* name : kHessian) names.insert(name + suffix_of(c));
        }
        return names;
    }

    const std::vector<double>& column(const PlyTable& table, const PlyElement& element, const std::string& name) const {
        const auto found = table.find(name);
        if (found == table.end()) {
            in_.fail("element " + in_quotes(element.name) + " has no property " + in_quotes(name));
        }
        // A list, or a name that occurs twice, has another number of values.
        if (found->second.values.size() != element.count || !found->second.lengths.empty()) {
            in_.fail("element " + in_quotes(element.name) + ": property " + in_quotes(name) + " is not one number a row");
        }
        return found->second.values;
    }

    std::vector<Vec3> points(const PlyTable& table, const PlyElement& element, const std::string& prefix) const {
        const auto& xs = column(table, element, prefix + "x");
        const auto& ys = column(table, element, prefix + "y");
        const auto& zs = column(table, element, prefix + "z");
        std::vector<Vec3> points(element.count);
        for (std::size_t i = 0; i < points.size(); ++i) points[i] = {xs[i], ys[i], zs[i]};
        return points;
    }

    // One tuple for each row. Missing numbers are 0; if all are missing, there are no tuples.
    template <std::size_t N>
    [[nodiscard]] std::vector<std::array<float, N>> tuples(const PlyTable& table, const PlyElement& element,
                                                           const std::array<const char*, N>& names,
                                                           const std::string& suffix) const {
        std::vector<std::array<float, N>> tuples;
        for (std::size_t k = 0; k < N; ++k) {
            if (!table.contains(names[k] + suffix)) continue;
            const auto& values = column(table, element, names[k] + suffix);
            tuples.resize(values.size());
            for (std::size_t i = 0; i < values.size(); ++i) tuples[i][k] = static_cast<float>(values[i]);
        }
        return tuples;
    }

    void take_vertices(const PlyElement& element) {
        const PlyTable table = read_ply_element(in_, header_, element, wanted());
        volume_.centers = points(table, element, table.contains("cx") ? "c" : "");
        for (const char* name : kFrame) std::ignore = column(table, element, name);  // all are needed
        volume_.frames = tuples(table, element, kFrame, "");
        for (std::size_t c = 0; c < volume_.channels.size(); ++c) {
            take_channel(table, element, suffix_of(c), volume_.channels[c]);
        }
        if (numbers_ != nullptr) *numbers_ = column(table, element, kNumber);
    }

    // Missing gradients and moments are 0: a kernel then represents a constant.
    void take_channel(const PlyTable& table, const PlyElement& element, const std::string& suffix, RbfChannel& channel) const {
        for (const double value : column(table, element, "value" + suffix)) channel.values.push_back(static_cast<float>(value));
        channel.gradients = tuples(table, element, kGradient, suffix);
        channel.gradients.resize(element.count);
        for (const auto& moment : tuples(table, element, kMoment, suffix)) channel.moments.push_back(moment[0]);
        channel.moments.resize(element.count);
        channel.hessians = tuples(table, element, kHessian, suffix);
    }

    void take_boundary_points(const PlyTable& table, const PlyElement& element) {
        volume_.boundary.points = points(table, element, "");
    }

    void take_triangles(const PlyTable& table, const PlyElement& element) {
        const auto found = table.find("vertex_indices");
        if (found == table.end()) in_.fail("element \"boundary_triangle\" has no property \"vertex_indices\"");
        const auto& [corners, lengths] = found->second;
        const bool all_three = std::all_of(lengths.begin(), lengths.end(), [](std::size_t length) { return length == 3; });
        if (!all_three || corners.size() != 3 * element.count) in_.fail("a boundary triangle does not have 3 corners");
        volume_.boundary.triangles.resize(element.count);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            if (!(corners[i] >= 0 && corners[i] < static_cast<double>(kNone))) {
                in_.fail("boundary triangle " + std::to_string(i / 3) + ": a corner is out of range");
            }
            volume_.boundary.triangles[i / 3][i % 3] = static_cast<Index>(corners[i]);
        }
    }

    const std::filesystem::path& path_;
    std::string name_;
    TextScanner in_;
    std::vector<double>* numbers_;
    PlyHeader header_;
    RbfVolume volume_;
    std::size_t triangles_beside_ = 0;
};

}  // namespace

RbfVolume read_ply(std::string_view text, const std::filesystem::path& path, std::vector<double>* numbers) {
    return PlyReader(text, path, numbers).read();
}

}  // namespace subvol::detail
