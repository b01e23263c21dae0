// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "xdmf_file.h"

namespace subvol::detail {

constexpr int kMostNested = 16;
constexpr std::size_t kMostGrids = 100000;

/// The grids of each step, in the order of the times. A file without steps has its domain as the only one, and no times.
struct XdmfSteps {
    std::vector<double> times;
    std::vector<pugi::xml_node> grids;
};

/// throws: Error(InvalidInput) if there are no grids or too many steps, or a step has no time
[[nodiscard]] XdmfSteps xdmf_steps(XdmfFile& file);

}  // namespace subvol::detail
