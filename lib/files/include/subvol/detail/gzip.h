// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace subvol::detail {

/// From the beginning of a text, the most bytes that it can have: a megabyte of gzip may stand for a gigabyte.
using MostBytes = std::function<std::size_t(std::string_view beginning)>;

/// The whole file of that name, or what the file of that name with .gz contains, in all its members.
///
/// most:   of what is compressed; asked after the first megabyte, of which no text of more than 64 MB is made unless it says so
/// throws: Error(Io) if neither can be read, Error(InvalidInput) if the second is damaged or contains more than `most`
[[nodiscard]] std::string read_maybe_gzipped(const std::filesystem::path& path, const MostBytes& most);

/// The first bytes of that file.
///
/// throws: as `read_maybe_gzipped`
[[nodiscard]] std::string start_of_maybe_gzipped(const std::filesystem::path& path, std::size_t bytes);

/// Decompresses all members of gzipped bytes and calls take(piece) with no more than a megabyte at a time.
///
/// returns: whether the bytes are whole; take may throw where there are more than it needs
[[nodiscard]] bool each_gunzipped(std::string_view bytes, const std::function<void(std::string_view piece)>& take);

}  // namespace subvol::detail
