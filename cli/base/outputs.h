// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace subvol::cli {

struct Range {
    double min = 0, max = 0;
};

/// Refuses an output before any work is done for it: a file name that ends in none of `extensions`, a folder that is not there
/// or that nothing can be written to.
///
/// throws: Error(InvalidInput), Error(Io)
void check_output(const std::filesystem::path& path, const std::vector<std::string>& extensions,
                  const std::vector<std::string>& planned = {});

/// Makes a folder for outputs, and those above it, if need be.
///
/// throws: Error(Io) if it cannot be made, or nothing can be written to it
void make_folder(const std::filesystem::path& path);

}  // namespace subvol::cli
