// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace subvol::detail {

/// During the last refinement: about 70 bytes for each new cell (with one field), and 600 bytes for each cell of the parent
/// mesh with its topology, which becomes eight new cells.
inline constexpr double kBytesOfRefinedCell = 70 + 600.0 / 8;

/// A few levels too many would fill the memory, and the system would kill the program without a message.
///
/// cells:  of that level
/// where:  for the message
/// throws: Error(MissingCapability) if the machine does not have the memory for it; level 0 is always taken
void check_memory(int level, double cells, double bytes_per_cell, const std::string& where = {});

}  // namespace subvol::detail
