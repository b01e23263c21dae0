// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "subvol/study_run.h"

namespace subvol::detail {

/// Cases that a line joins, in its order: they differ in the option that is swept, and in what follows from it.
///
/// cases: indices of a study's cases, those of one series of a plot
/// x:     the key of the horizontal axis; if it is an option of the cases it is the one that is swept, else that is the number
///        with the most values
[[nodiscard]] std::vector<std::vector<std::size_t>> strands_of(const Study& study, std::span<const std::size_t> cases,
                                                               const std::string& x);

}  // namespace subvol::detail
