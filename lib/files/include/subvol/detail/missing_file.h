// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace subvol::detail {

/// For messages about what kind of file one is: a file that is not there is none.
///
/// throws: Error(Io) if there is no such file
void refuse_missing(const std::filesystem::path& path);

}  // namespace subvol::detail
