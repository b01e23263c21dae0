// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace subvol::detail {

/// ": did you mean NAME?" for the name of a list that is nearest to a given one, if it is near enough to be a slip: the same
/// without regard to case, or up to two letters missing, added, wrong or exchanged; else an empty text.
[[nodiscard]] std::string did_you_mean(const std::string& given, const std::vector<std::string>& names);

}  // namespace subvol::detail
