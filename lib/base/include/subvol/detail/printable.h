// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace subvol::detail {

/// The length of the UTF-8 sequence that `text` begins with; 0 if it begins with none.
[[nodiscard]] std::size_t utf8_length(std::string_view text);

/// Text of a file or of a user, to be shown: control characters, marks of direction, characters that are not seen or are none,
/// and bytes that are not UTF-8 become \xNN, so that no terminal obeys them, no name looks like another one, and JSON and XML
/// can hold the text. Text that is printable stays as it is.
[[nodiscard]] std::string printable(std::string_view text);

/// Whether these bytes are one character that `printable` leaves as it is.
[[nodiscard]] bool is_printable(std::string_view character);

/// At most so many characters of it, printable.
[[nodiscard]] std::string shortened(std::string_view text, std::size_t longest = 40);

/// A message with what it quotes: printable, at most 80 characters of each quotation.
[[nodiscard]] std::string printable_message(std::string_view text);

/// The same in quotes.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// The message of an exception of the JSON library; what it quotes of the text is shortened.
[[nodiscard]] std::string parser_message(std::string_view what);

}  // namespace subvol::detail
