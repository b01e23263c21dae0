// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace subvol::detail {

/// The contents of a gzip file, of all its members. Nothing if it is damaged.
[[nodiscard]] std::optional<std::string> gunzipped(std::string_view bytes);

/// The whole file of that name, or what the file of that name with .gz contains.
///
/// throws: Error(Io) if neither can be read, Error(InvalidInput) if the second is damaged
[[nodiscard]] std::string read_maybe_gzipped(const std::filesystem::path& path);

}  // namespace subvol::detail
