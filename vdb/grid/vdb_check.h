// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace subvol::detail {

/// What a file says about one of its grids.
struct GridEntry {
    std::string name;         // unique in the file
    std::string type;         // OpenVDB's name of the grid's type
    std::string parent;       // the name of the grid whose tree this one shares; empty if it has its own
    bool half = false;        // its floats are stored in 16 bits
    std::uint64_t begin = 0;  // of its description, in bytes from the file's start
};

/// Lists a file's grids and checks all of the file that OpenVDB will read, so that it can trust every length that it finds.
/// OpenVDB 10 does not check any: a block may claim more bytes than its buffer has.
///
/// types:  the types of the grids that will be read. Others are passed over without a look if the file says where they end.
/// throws: Error(Io); Error(InvalidInput) that names the byte if the file is not one that OpenVDB writes, or if it is of a
///         version that cannot be checked
/// cost:   reads all but the values
[[nodiscard]] std::vector<GridEntry> checked_grids(const std::filesystem::path& path, std::span<const std::string> types);

}  // namespace subvol::detail
