// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace subvol::detail {

/// "a, b, c and 1,996 more": names or numbers for a message, printable and shortened; at most ten of them, in some 150 letters.
[[nodiscard]] std::string listed(std::span<const std::string> names);

/// What users read of an error: "where: message (allowed)". A message has at most 300 letters and a place 200, of which the end
/// says most; what would be right has at most 1000, as the list of all formats has many.
[[nodiscard]] std::string error_sentence(std::string_view where, std::string_view message, std::string_view allowed);

}  // namespace subvol::detail
