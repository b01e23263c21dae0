// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace subvol::detail {

/// SHA-256 of bytes (FIPS 180-4), 32 bytes.
[[nodiscard]] std::string sha256(std::string_view bytes);

/// The tag of a content security policy for a page in one file: it loads nothing, its images are data, and of what is between
/// script and style tags only these two texts count. So text that found its way into the page as a tag does nothing.
[[nodiscard]] std::string html_policy(std::string_view script, std::string_view style);

}  // namespace subvol::detail
