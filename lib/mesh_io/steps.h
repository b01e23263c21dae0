// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/mesh_io.h"

namespace subvol::detail {

/// Which of a file's blocks are read.
class BlockChoice {
public:
    /// wanted: their names; none: all of them. there: the names of all blocks
    ///
    /// throws: Error(InvalidInput) if a block that is wanted is not there
    BlockChoice(std::span<const std::string> wanted, const std::vector<std::string>& there, std::string_view file);

    [[nodiscard]] bool takes(const std::string& name) const { return wanted_.empty() || wanted_.contains(name); }

private:
    std::set<std::string> wanted_;
};

/// The step that the options choose; of several the last one, with a warning, if they choose none.
///
/// steps:  how many there are, at least 1
/// throws: Error(InvalidInput) if there is no such step
[[nodiscard]] std::size_t chosen_step(const ReadOptions& options, std::size_t steps, std::string_view file,
                                      std::vector<std::string>& warnings);

}  // namespace subvol::detail
