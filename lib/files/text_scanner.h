// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace subvol::detail {

/// The whole file, in one read.
///
/// throws: Error(Io) if it cannot be opened or read
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

/// Where a number belongs, for the error sentence: "vertex 13 of 27". number < 0: `what` alone; of = 0: no total
struct Place {
    std::string_view what;
    std::int64_t number = -1;
    std::size_t of = 0;
};

/// Takes a text apart into words and numbers separated by white space. The text must outlive the scanner.
///
/// Every failure is an Error(InvalidInput) that names the file and the line (in binary data the byte); lines are only counted
/// then. The decimal point is a point in every locale. Copying a scanner remembers a place in the text.
class TextScanner {
public:
    enum class Comments { None, Hash };  // Hash: from # to the end of the line

    /// file: its name, for messages. A byte order mark is passed over.
    TextScanner(std::string_view text, std::string_view file, Comments comments);

    /// From now on failures name the byte instead of the line: a line means nothing in binary data.
    void name_bytes() { places_ = Places::Bytes; }
    /// From now on failures name the file alone: what is read has been taken out of it by a library.
    void name_no_place() { places_ = Places::None; }

    [[nodiscard]] bool at_end();
    /// Empty at the end of the text.
    std::string_view word();
    [[nodiscard]] std::string_view peek();
    /// The rest of the line without its end.
    std::string_view line();
    /// Exactly so many bytes, whatever they are.
    std::string_view bytes(std::size_t count, const Place& place);
    /// Goes to an offset into the text.
    void seek(std::size_t position) { next_ = start_ = position; }

    /// A number, perhaps not finite; one that overflows a double is infinite.
    double real(const Place& place);
    std::int64_t integer(const Place& place);
    /// A number of things to come: not negative, at most what an Index can count.
    std::size_t count(const Place& place);
    /// The last number, checked as `count` does.
    [[nodiscard]] std::size_t as_count(std::int64_t value, const Place& place) const;

    /// How many bytes the text has.
    [[nodiscard]] std::size_t size() const { return text_.size(); }
    /// What is left.
    [[nodiscard]] std::string_view rest() const { return text_.substr(next_); }
    /// How many bytes are left.
    [[nodiscard]] std::size_t bytes_left() const { return text_.size() - next_; }
    /// How many things of `words` words each the rest of the text can hold at most: the limit of any allocation.
    [[nodiscard]] std::size_t room_for(std::size_t words) const;

    /// The start of the last word or line, as an offset into the text.
    [[nodiscard]] std::size_t position() const { return start_; }
    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const;
    [[noreturn]] void fail_at(std::size_t position, const std::string& message, const std::string& allowed = {}) const;
    /// `fail` for a word that is not what stands there; an empty word is the end of the text.
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

/// A piece of a file, in quotes, fit for a message: printable and short.
[[nodiscard]] std::string in_quotes(std::string_view text);

[[nodiscard]] std::string upper_case(std::string_view text);

/// The text itself if it is UTF-8, else taken as Latin-1 and converted.
[[nodiscard]] std::string as_utf8(std::string_view text);

/// With an underscore for every control character.
[[nodiscard]] std::string without_controls(std::string_view text);

/// "1 hexahedron", "8 hexahedra"
[[nodiscard]] std::string counted(std::size_t count, std::string_view one, std::string_view many);

}  // namespace subvol::detail
