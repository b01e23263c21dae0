// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace subvol::detail {

/// The names in a list of files that were opened, the newest first; those that are gone are left out. list: empty: none
[[nodiscard]] std::vector<std::string> recent_files(const std::filesystem::path& list);

/// Puts a file first. A list that cannot be written is left as it is, because nothing depends on it.
void add_recent(const std::filesystem::path& list, const std::string& file);

}  // namespace subvol::detail
