// SPDX-License-Identifier: Apache-2.0
// The lines, numbers and columns of EnSight's files, in text or in one of three binary forms: C's, Fortran's, of either order
// of bytes, which the first count shows. Texts of version 6 have numbers in columns of 8 and 12 that may touch; columns that a
// writer did not keep to are read by their blanks.
#include "ensight_data.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <tuple>
#include <utility>

#include "subvol/detail/number_type.h"
#include "subvol/detail/small_letters.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kOfLine = 80, kOfNumber = 4;

std::string_view line_text(std::string_view text) {
    return trimmed(text.substr(0, text.find('\0')));
}

// Whether a file begins with a record of one line, in either byte order.
std::optional<std::endian> order_of_records(std::string_view text) {
    if (text.size() < kOfNumber + kOfLine) return std::nullopt;
    for (const std::endian order : {std::endian::little, std::endian::big}) {
        if (integer_from(text, NumberType::UInt32, order) == kOfLine) return order;
    }
    return std::nullopt;
}

bool begins_with_c(std::string_view text) {
    return upper_case(text.substr(0, kOfLine)).starts_with("C BINARY");
}

const std::map<std::string, std::size_t, std::less<>> kNodes{{"point", 1},    {"bar2", 2},     {"bar3", 3},       {"tria3", 3},
                                                             {"tria6", 6},    {"quad4", 4},    {"quad8", 8},      {"tetra4", 4},
                                                             {"tetra10", 10}, {"pyramid5", 5}, {"pyramid13", 13}, {"penta6", 6},
                                                             {"penta15", 15}, {"hexa8", 8},    {"hexa20", 20}};

// Fortran leaves the letter of an exponent out where it has three digits: 1.5+100.
std::string with_exponent(std::string_view number) {
    std::string text(number);
    const std::size_t sign = text.find_first_of("+-", 1);
    if (sign != std::string::npos && text[sign - 1] >= '0' && text[sign - 1] <= '9') text.insert(sign, "e");
    return text;
}

}  // namespace

std::size_t nodes_of_ensight(std::string_view type) {
    const auto known = kNodes.find(type);
    return known == kNodes.end() ? 0 : known->second;
}

EnsightData::EnsightData(const std::filesystem::path& path, std::optional<EnsightForm> form, std::optional<std::size_t> step)
    : name_(path.string()), text_(read_text(path)), in_(text_, name_, TextScanner::Comments::None) {
    const std::string begin = upper_case(std::string_view(text_).substr(0, kOfLine + kOfNumber));
    const bool fortran = begin.find("FORTRAN BINARY") != std::string::npos, c = begin.starts_with("C BINARY");
    form_ = fortran ? EnsightForm::Fortran : c ? EnsightForm::C : form.value_or(EnsightForm::Text);
    if (form_ == EnsightForm::Fortran) take_records();
    if (step) take_step(*step);
    if (binary()) in_.name_bytes();
    const bool says_so = fortran || c;
    if (says_so && !step) std::ignore = in_.bytes(std::min(kOfLine, text_.size()), {"line"});
}

EnsightData::EnsightData(std::string gold, const std::string& name)
    : name_(name), text_(std::move(gold)), in_(text_, name_, TextScanner::Comments::None), form_(EnsightForm::C) {
    has_order_ = true;
    order_ = std::endian::native;
    in_.name_bytes();
    std::ignore = begins_with_c(text_) ? in_.bytes(kOfLine, {"line"}) : std::string_view();
}

// The contents of all records are what C's files have.
void EnsightData::take_records() {
    const std::optional<std::endian> order = order_of_records(text_);
    if (!order) in_.fail_at(0, "it does not begin with a record of 80 bytes, as Fortran's binary files do");
    std::string contents;
    contents.reserve(text_.size());
    const std::string_view all = text_;
    const auto length_at = [&](std::size_t at) {
        return static_cast<std::size_t>(integer_from(all.substr(at), NumberType::UInt32, *order));
    };
    for (std::size_t at = 0; at < all.size();) {
        const std::size_t room = all.size() - at;
        const std::size_t length = room < 2 * kOfNumber ? room : length_at(at);
        if (room < 2 * kOfNumber || length > room - 2 * kOfNumber || length_at(at + kOfNumber + length) != length) {
            in_.name_bytes();
            in_.fail_at(at, "a record of Fortran's binary files is expected");
        }
        contents += all.substr(at + kOfNumber, length);
        at += length + 2 * kOfNumber;
    }
    text_ = std::move(contents);
    in_ = TextScanner(text_, name_, TextScanner::Comments::None);
    order_ = *order;
    has_order_ = true;
}

// Keeps the lines between the marks of a step.
void EnsightData::take_step(std::size_t step) {
    constexpr std::string_view kBegin = "BEGIN TIME STEP", kEnd = "END TIME STEP";
    std::size_t at = 0;
    for (std::size_t k = 0; k <= step; ++k) {
        at = text_.find(kBegin, at);
        if (at == std::string::npos) {
            in_.fail_at(0, "there is no step " + std::to_string(step) + " in the file", "it has " + std::to_string(k));
        }
        at = binary() ? at + kOfLine : std::min(text_.find('\n', at), text_.size());
    }
    const std::size_t end = at > text_.size() ? std::string::npos : text_.find(kEnd, at);
    if (end == std::string::npos) in_.fail_at(0, "step " + std::to_string(step) + " does not end");
    in_ = TextScanner(std::string_view(text_).substr(0, end), name_, TextScanner::Comments::None);
    in_.seek(at);
    if (!binary()) std::ignore = in_.line();
}

void EnsightData::set_order(std::endian order) {
    order_ = order;
    has_order_ = true;
}

bool EnsightData::at_end() {
    return binary() ? in_.bytes_left() == 0 : in_.at_end();
}

std::string EnsightData::line() {
    if (!binary()) {
        if (in_.at_end()) fail("the file ends where a line is expected");
        in_line_ = false;
        return std::string(line_text(in_.line()));
    }
    return std::string(line_text(in_.bytes(kOfLine, {"line"})));
}

std::string EnsightData::description() {
    if (binary()) return line();
    if (std::exchange(in_line_, false)) std::ignore = in_.line();
    if (in_.bytes_left() == 0) fail("the file ends where a line is expected");
    return std::string(line_text(in_.line()));
}

std::string EnsightData::keyword() {
    return small_letters(line());
}

void EnsightData::expect_room(std::size_t count, const std::string& what) const {
    if (count <= (binary() ? in_.bytes_left() / kOfNumber : in_.room_for(1))) return;
    fail(what + ": " + std::to_string(count) + " numbers are needed, and the file is too short");
}

// By a number that is not large: that of a part, a count or a size. 0 has no order.
void EnsightData::find_order(std::string_view bytes) {
    if (has_order_ || bytes.size() < kOfNumber) return;
    constexpr std::int64_t kMostParts = 65536;
    const std::int64_t little = integer_from(bytes, NumberType::Int32, std::endian::little);
    has_order_ = little != 0;
    if (little < 0 || little > kMostParts) order_ = std::endian::big;
}

std::int64_t EnsightData::integer(const std::string& what) {
    in_line_ = true;
    if (!binary()) return in_.integer({what});
    const std::string_view bytes = in_.bytes(kOfNumber, {what});
    find_order(bytes);
    return integer_from(bytes, NumberType::Int32, order_);
}

std::size_t EnsightData::count(const std::string& what) {
    const std::int64_t value = integer(what);
    if (value < 0 || static_cast<std::size_t>(value) > in_.size())
        fail(what + ": count out of range: " + std::to_string(value));
    return static_cast<std::size_t>(value);
}

std::vector<std::int64_t> EnsightData::integers(std::size_t count, const std::string& what) {
    expect_room(count, what);
    if (binary()) {
        const std::string_view bytes = in_.bytes(count * kOfNumber, {what});
        find_order(bytes);
        return integers_from(bytes, NumberType::Int32, order_);
    }
    in_line_ |= count > 0;
    std::vector<std::int64_t> values;
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) values.push_back(in_.integer({what, static_cast<std::int64_t>(i + 1), count}));
    return values;
}

std::vector<double> EnsightData::reals(std::size_t count, const std::string& what) {
    expect_room(count, what);
    in_line_ |= count > 0;
    if (binary()) return reals_from(in_.bytes(count * kOfNumber, {what}), NumberType::Float32, order_);
    std::vector<double> values;
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) values.push_back(in_.real({what, static_cast<std::int64_t>(i + 1), count}));
    return values;
}

std::string_view EnsightData::column(std::size_t width, const std::string& what, bool of_reals) {
    constexpr std::size_t kMostOfLine = 256;  // lines of columns are shorter
    const std::string_view rest = in_.rest();
    const std::size_t first = rest.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) fail(what + ": the file ends");
    const std::size_t line_end = rest.substr(0, first).rfind('\n');
    const std::size_t start = line_end == std::string_view::npos ? 0 : line_end + 1;  // of the column, blanks included
    const std::size_t from = first - start;
    const std::string_view ahead = rest.substr(first, kMostOfLine);
    std::string_view number = ahead.substr(0, ahead.find_first_of(" \t\r\n"));
    // Numbers that touch end where a column ends, real ones with an exponent; else columns were not kept to.
    if (from < width && ((from + number.size()) % width == 0 || number.size() == kMostOfLine)) {
        const std::string_view in_column = number.substr(0, width - from);
        if (!of_reals || in_column.find_first_of("eEdD+-", 1) != std::string_view::npos) number = in_column;
    }
    std::ignore = in_.bytes(first, {what});
    std::ignore = in_.bytes(number.size(), {what});
    in_line_ = true;
    return number;
}

std::vector<std::int64_t> EnsightData::column_integers(std::size_t count, const std::string& what) {
    constexpr std::size_t kWidth = 8;
    if (binary()) return integers(count, what);
    std::vector<std::int64_t> values;
    for (std::size_t i = 0; i < count; ++i) {
        const std::string_view text = column(kWidth, what, false);
        values.push_back(TextScanner(text, {}, TextScanner::Comments::None).integer({what}));
    }
    return values;
}

std::vector<double> EnsightData::column_reals(std::size_t count, const std::string& what) {
    constexpr std::size_t kWidth = 12;
    if (binary()) return reals(count, what);
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) {
        const std::string text = with_exponent(column(kWidth, what, true));
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc() || end != text.data() + text.size())
            fail(what + ": a number is expected, not " + in_quotes(text));
        values.push_back(value);
    }
    return values;
}

std::string EnsightData::kind_of_ids(const std::string& owner) {
    const std::string text = keyword();
    if (!text.starts_with(owner + " id")) fail("a line \"" + owner + " id …\" is expected, not " + in_quotes(text));
    return text.substr(text.find_last_of(' ') + 1);
}

}  // namespace subvol::detail
