// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace subvol::detail {

/// The length of the UTF-8 sequence that `text` begins with; 0 if it begins with none.
[[nodiscard]] std::size_t utf8_length(std::string_view text);

/// Text of a file for messages: control characters and bytes that are not UTF-8 as \xNN, so that no terminal obeys them and
/// JSON stays UTF-8.
[[nodiscard]] std::string printable(std::string_view text);

/// At most 40 characters of it, printable.
[[nodiscard]] std::string shortened(std::string_view text);

/// The same in quotes.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// The message of an exception of the JSON library; what it quotes of the text is shortened.
[[nodiscard]] std::string parser_message(std::string_view what);

}  // namespace subvol::detail
