// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

namespace subvol::detail {

/// The whole file. What has no size, such as a pipe, is read to its end, which has to come within 200 MB.
///
/// throws: Error(Io) if it cannot be opened or read, Error(InvalidInput) if it is too long or larger than this machine's memory
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

/// So many bytes of a regular file, from a place on; fewer if it is shorter.
///
/// throws: Error(Io) if it cannot be opened or read
[[nodiscard]] std::string read_range(const std::filesystem::path& path, std::uint64_t first, std::size_t count);

/// What is wrong with a file that another file names: only regular files are read there, since pipes and devices may have no
/// end. Empty if nothing is, or there is no such file.
[[nodiscard]] std::string not_regular(const std::filesystem::path& path);

/// The whole file, which no user named: another file did, or it lies beside one.
///
/// throws: Error(InvalidInput) if it is not a regular file, otherwise as `read_text`
[[nodiscard]] std::string read_regular(const std::filesystem::path& path);

/// The path of a file that another file names, relative to the folder of that one.
///
/// place:  says where it is named; called for messages
/// throws: Error(InvalidInput) if there is no such regular file
[[nodiscard]] std::filesystem::path named_file(const std::filesystem::path& folder, const std::string& name,
                                               const std::function<std::string()>& place);

}  // namespace subvol::detail
