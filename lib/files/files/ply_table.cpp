// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/ply_table.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "subvol/detail/number_text.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

const std::map<std::string_view, NumberType> kPlyTypes{
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
        const auto type = kPlyTypes.find(name);
        if (type == kPlyTypes.end()) in_.fail(in_quotes(name) + " is not a type of a property", "such as float or uchar");
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

    /// Before the numbers of a row: in text it has a line.
    void begin() {
        if (!header_.ascii || in_.at_end()) return;
        line_ = line_at_hand();
    }

    /// After them.
    void end(std::size_t row) {
        if (!header_.ascii) return;
        const std::string_view rest = line_at_hand();
        const bool same_line = rest.data() + rest.size() == line_.data() + line_.size();
        if (same_line && trimmed(rest).empty()) return;
        in_.fail(
            name_ + " " + std::to_string(row) + ": its line has " + (same_line ? "more" : "fewer") + " numbers than it should",
            "one line for each, as the header says");
    }

    double real(NumberType type, std::size_t row) {
        const Place place{name_, static_cast<std::int64_t>(row), rows_};
        if (!header_.ascii) return real_from(in_.bytes(size_of(type), place), type, header_.order);
        const double number = in_.real(place);
        if (!is_real(type) && number != std::floor(number)) {
            in_.fail(name_ + " " + std::to_string(row) + " has the number " + number_text(number) + ", which is not whole",
                     "whole numbers, as the header says");
        }
        return number;
    }

    std::size_t length(NumberType type, std::size_t row) {
        const double length = real(type, row);
        if (length >= 0 && length <= static_cast<double>(in_.bytes_left()) && length == std::floor(length))
            return static_cast<std::size_t>(length);
        in_.fail(name_ + " " + std::to_string(row) + ": a list goes beyond the end of the file");
    }

private:
    [[nodiscard]] static bool is_real(NumberType type) { return type == NumberType::Float32 || type == NumberType::Float64; }

    [[nodiscard]] std::string_view line_at_hand() const {
        TextScanner ahead = in_;
        return ahead.line();
    }

    TextScanner& in_;
    const PlyHeader& header_;
    std::string name_;
    std::size_t rows_;
    std::string_view line_;
};

}  // namespace

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
        numbers.begin();
        for (std::size_t k = 0; k < columns.size(); ++k) {
            const PlyProperty& property = element.properties[k];
            const std::size_t length = property.counts ? numbers.length(*property.counts, row) : 1;
            if (columns[k] && property.counts) columns[k]->lengths.push_back(length);
            for (std::size_t n = 0; n < length; ++n) {
                const double number = numbers.real(property.type, row);
                if (columns[k]) columns[k]->values.push_back(number);
            }
        }
        numbers.end(row);
    }
    return table;
}

void expect_ply_end(TextScanner& in) {
    TextScanner ahead = in;
    const std::string_view rest = ahead.bytes(in.bytes_left(), {"the end"});
    if (trimmed(rest).empty()) return;
    in.fail("there is more after the last element than the header says: " + std::to_string(rest.size()) + " bytes",
            "counts of elements that are those of the file");
}

Index ply_corner(const TextScanner& in, double number, std::size_t points, std::string_view of, std::size_t row) {
    if (number >= 0 && number < static_cast<double>(points) && number == std::floor(number)) return static_cast<Index>(number);
    in.fail(std::string(of) + " " + std::to_string(row) + " has the corner " + number_text(number) + ", which is not a vertex",
            points == 0 ? "there are none" : "0 to " + std::to_string(points - 1));
}

}  // namespace subvol::detail
