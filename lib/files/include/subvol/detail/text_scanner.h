// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "subvol/detail/number_type.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/read_file.h"

namespace subvol::detail {

/// The entity that a number belongs to, for error messages: "vertex 13 of 27".
struct Place {
    std::string_view what;
    std::int64_t number = -1;  ///< below 0 for none
    std::size_t of = 0;        ///< the total, 0 for none
};

/// Splits a text into words and numbers that are separated by white space. The text must outlive the scanner.
///
/// Every failure is an Error(InvalidInput) that names the file and the line, in binary data the byte; lines are counted only
/// when an error occurs. The decimal point does not depend on the locale. A copy of a scanner keeps a place in the text.
class TextScanner {
public:
    enum class Comments { None, Hash };  // Hash: from # to the end of the line

    /// file: its name, for messages. A byte order mark is skipped.
    TextScanner(std::string_view text, std::string_view file, Comments comments);

    /// From now on errors name the byte instead of the line, for binary data.
    void name_bytes() { places_ = Places::Bytes; }
    /// From now on errors name only the file: the values are read by a library, so their place is unknown.
    void name_no_place() { places_ = Places::None; }

    [[nodiscard]] bool at_end();
    /// Empty at the end of the text.
    std::string_view word();
    [[nodiscard]] std::string_view peek();
    /// The rest of the line without its end.
    std::string_view line();
    /// The next `count` bytes, white space included.
    std::string_view bytes(std::size_t count, const Place& place);
    /// Goes to an offset into the text.
    void seek(std::size_t position) { next_ = start_ = position; }

    /// A number, possibly not finite; one that overflows a double is infinite.
    double real(const Place& place);
    std::int64_t integer(const Place& place);
    /// The number of items that follow: not negative, and within the range of Index.
    std::size_t count(const Place& place);
    /// The last number that was read, checked as `count` does.
    [[nodiscard]] std::size_t as_count(std::int64_t value, const Place& place) const;

    /// Fails unless the last number that was read may be of the type.
    void expect_type(double number, NumberType type, const Place& place) const;

    /// The size of the text in bytes.
    [[nodiscard]] std::size_t size() const { return text_.size(); }
    /// The rest of the text.
    [[nodiscard]] std::string_view rest() const { return text_.substr(next_); }
    /// The size of the rest of the text in bytes.
    [[nodiscard]] std::size_t bytes_left() const { return text_.size() - next_; }
    /// The largest number of items, of `words` words each, that the rest of the text can have: a limit for allocations.
    [[nodiscard]] std::size_t room_for(std::size_t words) const;

    /// The start of the last word or line, as an offset into the text.
    [[nodiscard]] std::size_t position() const { return start_; }
    /// How errors name a place: the file with the line or the byte.
    [[nodiscard]] std::string place_of(std::size_t position) const;
    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const;
    [[noreturn]] void fail_at(std::size_t position, const std::string& message, const std::string& allowed = {}) const;
    /// Fails because a word differs from what is expected. found: empty at the end of the text
    [[noreturn]] void fail_word(const Place& place, std::string_view expected, std::string_view found) const;

private:
    void skip_space();

    std::string_view text_;
    std::string_view file_;
    Comments comments_;
    enum class Places { Lines, Bytes, None } places_ = Places::Lines;
    std::size_t next_ = 0;
    std::size_t start_ = 0;
};

[[nodiscard]] std::string upper_case(std::string_view text);

/// The text itself if it is UTF-8; otherwise it is converted from Latin-1.
[[nodiscard]] std::string as_utf8(std::string_view text);

/// The text with an underscore in place of each character that is not printable.
[[nodiscard]] std::string without_controls(std::string_view text);

/// "1 hexahedron", "8 hexahedra"
[[nodiscard]] std::string counted(std::size_t count, std::string_view one, std::string_view many);

/// The text without the white space at its ends.
inline std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kSpace = " \t\r\n\f\v";
    const std::size_t begin = text.find_first_not_of(kSpace);
    return begin == std::string_view::npos ? std::string_view() : text.substr(begin, text.find_last_not_of(kSpace) + 1 - begin);
}

}  // namespace subvol::detail
