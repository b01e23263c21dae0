// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/text_scanner.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <system_error>

#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/index.h"

namespace subvol::detail {

namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool is_space(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

bool is_utf8(std::string_view text) {
    while (!text.empty()) {
        const std::size_t length = utf8_length(text);
        if (length == 0) return false;
        text.remove_prefix(length);
    }
    return true;
}

std::string describe(const Place& place) {
    std::string text(place.what);
    if (place.number >= 0) text += " " + std::to_string(place.number);
    if (place.of > 0) text += " of " + std::to_string(place.of);
    return text;
}

// from_chars does not accept a leading plus.
std::string_view without_plus(std::string_view word) {
    const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
    return plus ? word.substr(1) : word;
}

}  // namespace

TextScanner::TextScanner(std::string_view text, std::string_view file, Comments comments)
    : text_(text), file_(file), comments_(comments) {
    if (text_.starts_with(kByteOrderMark)) next_ = kByteOrderMark.size();
}

void TextScanner::skip_space() {
    while (next_ < text_.size()) {
        if (is_space(text_[next_])) {
            ++next_;
        } else if (comments_ == Comments::Hash && text_[next_] == '#') {
            next_ = std::min(text_.find('\n', next_), text_.size());
        } else {
            return;
        }
    }
}

bool TextScanner::at_end() {
    skip_space();
    return next_ == text_.size();
}

std::string_view TextScanner::word() {
    skip_space();
    start_ = next_;
    while (next_ < text_.size() && !is_space(text_[next_]) && !(comments_ == Comments::Hash && text_[next_] == '#')) ++next_;
    return text_.substr(start_, next_ - start_);
}

std::string_view TextScanner::peek() {
    TextScanner ahead = *this;
    return ahead.word();
}

std::string_view TextScanner::line() {
    start_ = next_;
    const std::size_t end = std::min(text_.find('\n', next_), text_.size());
    next_ = std::min(end + 1, text_.size());
    std::string_view rest = text_.substr(start_, end - start_);
    if (rest.ends_with('\r')) rest.remove_suffix(1);
    return rest;
}

std::string_view TextScanner::bytes(std::size_t count, const Place& place) {
    start_ = next_;
    if (count > bytes_left()) fail_word(place, "", "");
    next_ += count;
    return text_.substr(start_, count);
}

double TextScanner::real(const Place& place) {
    const std::string_view found = word();
    const auto value = number_from(found);
    if (!value) fail_word(place, "a number", found);
    return *value;
}

std::int64_t TextScanner::integer(const Place& place) {
    const std::string_view found = word();
    const std::string_view digits = without_plus(found);
    const char* const end = digits.data() + digits.size();
    std::int64_t value = 0;
    const auto [stop, error] = std::from_chars(digits.data(), end, value);
    if (error == std::errc::result_out_of_range && stop == end) {
        fail(describe(place) + ": number out of range: " + in_quotes(found));
    }
    if (error != std::errc() || stop != end) fail_word(place, "an integer", found);
    return value;
}

std::size_t TextScanner::count(const Place& place) {
    const std::size_t value = as_count(integer(place), place);
    if (value > text_.size()) {  // each item takes at least one character
        fail(describe(place) + ": count out of range: " + std::to_string(value),
             "the file has " + std::to_string(text_.size()) + " bytes");
    }
    return value;
}

std::size_t TextScanner::as_count(std::int64_t value, const Place& place) const {
    if (value < 0) fail(describe(place) + ": negative count " + std::to_string(value));
    if (static_cast<std::uint64_t>(value) >= kNone) {
        fail(describe(place) + ": count out of range: " + std::to_string(value), "at most " + std::to_string(kNone - 1));
    }
    return static_cast<std::size_t>(value);
}

std::size_t TextScanner::room_for(std::size_t words) const {
    // Each word takes at least one character and a space, which may be missing after the last one.
    return (text_.size() - next_ + 1) / (2 * words);
}

void TextScanner::fail(const std::string& message, const std::string& allowed) const {
    fail_at(start_, message, allowed);
}

std::string TextScanner::place_of(std::size_t position) const {
    const auto lines_before = [&] {
        const auto end = static_cast<std::ptrdiff_t>(std::min(position, text_.size()));  // parsers of XML may point behind it
        return std::count(text_.begin(), text_.begin() + end, '\n');
    };
    std::string place(file_);
    if (places_ == Places::Bytes) place += ", byte " + std::to_string(position);
    if (places_ == Places::Lines) place += ", line " + std::to_string(1 + lines_before());
    return place;
}

void TextScanner::fail_at(std::size_t position, const std::string& message, const std::string& allowed) const {
    throw Error(ErrorCode::InvalidInput, printable(message), place_of(position), printable(allowed));
}

void TextScanner::expect_type(double number, NumberType type, const Place& place) const {
    if (!can_be(number, type))
        fail_word(place, "a number of the type " + std::string(name_of(type)), text_.substr(start_, next_ - start_));
}

void TextScanner::fail_word(const Place& place, std::string_view expected, std::string_view found) const {
    if (found.empty()) fail(describe(place) + ": unexpected end of file");
    fail(describe(place) + ": " + std::string(expected) + " is expected, not " + in_quotes(found));
}

std::string upper_case(std::string_view text) {
    std::string result(text);
    for (char& c : result) {
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
    }
    return result;
}

std::string as_utf8(std::string_view text) {
    if (is_utf8(text)) return std::string(text);
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80) {
            result += c;
        } else {
            result += static_cast<char>(0xC0 | (byte >> 6));
            result += static_cast<char>(0x80 | (byte & 0x3F));
        }
    }
    return result;
}

std::string without_controls(std::string_view text) {
    std::string result;
    while (!text.empty()) {
        const std::size_t length = std::max<std::size_t>(utf8_length(text), 1);
        const std::string_view character = text.substr(0, length);
        if (is_printable(character)) {
            result += character;
        } else {
            result += '_';
        }
        text.remove_prefix(length);
    }
    return result;
}

std::string counted(std::size_t count, std::string_view one, std::string_view many) {
    return std::to_string(count) + " " + std::string(count == 1 ? one : many);
}

}  // namespace subvol::detail
