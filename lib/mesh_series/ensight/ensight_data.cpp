// SPDX-License-Identifier: Apache-2.0
#include "ensight_data.h"

#include "number_type.h"
#include "subvol/index.h"
#include "trimmed.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kOfLine = 80, kOfNumber = 4;

std::string_view line_text(std::string_view text) {
    return trimmed(text.substr(0, text.find('\0')));
}

}  // namespace

EnsightData::EnsightData(const std::filesystem::path& path, bool binary)
    : name_(path.string()), text_(read_text(path)), in_(text_, name_, TextScanner::Comments::None) {
    const std::string_view begin = std::string_view(text_).substr(0, kOfLine + kOfNumber);
    if (begin.find("Fortran Binary") != std::string_view::npos) {
        in_.fail_at(0, "Fortran's binary files are not supported", "text and \"C Binary\" are");
    }
    const bool says_so = begin.starts_with("C Binary");
    binary_ = says_so || binary;
    if (binary_) in_.name_bytes();
    if (says_so) static_cast<void>(in_.bytes(std::min(kOfLine, text_.size()), {"line"}));
}

bool EnsightData::at_end() {
    return binary_ ? in_.bytes_left() == 0 : in_.at_end();
}

std::string EnsightData::line() {
    if (!binary_) {
        if (in_.at_end()) fail("the file ends where a line is expected");
        return std::string(line_text(in_.line()));
    }
    return std::string(line_text(in_.bytes(kOfLine, {"line"})));
}

void EnsightData::expect_room(std::size_t count, const std::string& what) const {
    if (count <= (binary_ ? in_.bytes_left() / kOfNumber : in_.room_for(1))) return;
    fail(what + ": " + std::to_string(count) + " numbers are needed, and the file is too short");
}

std::int64_t EnsightData::integer(const std::string& what) {
    if (!binary_) return in_.integer({what});
    const std::string_view bytes = in_.bytes(kOfNumber, {what});
    if (!has_order_) {
        has_order_ = true;
        constexpr std::int64_t kMostParts = 65536;
        const std::int64_t little = integer_from(bytes, NumberType::Int32, std::endian::little);
        if (little < 0 || little > kMostParts) order_ = std::endian::big;
    }
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
    if (binary_) return integers_from(in_.bytes(count * kOfNumber, {what}), NumberType::Int32, order_);
    std::vector<std::int64_t> values;
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) values.push_back(in_.integer({what, static_cast<std::int64_t>(i + 1), count}));
    return values;
}

std::vector<double> EnsightData::reals(std::size_t count, const std::string& what) {
    expect_room(count, what);
    if (binary_) return reals_from(in_.bytes(count * kOfNumber, {what}), NumberType::Float32, order_);
    std::vector<double> values;
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i) values.push_back(in_.real({what, static_cast<std::int64_t>(i + 1), count}));
    return values;
}

}  // namespace subvol::detail
