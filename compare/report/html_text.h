// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace subvol::detail {

/// Text with the special characters of HTML and SVG escaped, also for use in quotes.
[[nodiscard]] std::string escaped(std::string_view text);

/// A PNG as a data URI.
///
/// throws: Error(Io) if it cannot be read, Error(InvalidInput) if it is larger than 16 MiB
[[nodiscard]] std::string png_uri(const std::filesystem::path& file);

}  // namespace subvol::detail
