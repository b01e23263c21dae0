// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace subvol {

class Option;

/// How errors and help call options: as of the command, --per-edge, or as Python and studies, per_edge.
enum class OptionNames { Flags, Keywords };

/// option: without dashes before it
[[nodiscard]] std::string option_name(std::string_view option, OptionNames names);

}  // namespace subvol
