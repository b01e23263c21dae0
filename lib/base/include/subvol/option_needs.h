// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/option_names.h"

namespace subvol {

/// A condition of an option: another one is given, or its value (the default, if it is not given) is one of these words.
struct OptionNeed {
    std::string option;
    std::vector<std::string> words{};
    bool excluded = false;  ///< the other way round: the option has no effect if that is so
    std::string instead{};  ///< or this option is given
};

/// What was given for an option, as text; nothing if it was not given.
using GivenOptions = std::function<std::optional<std::string>(std::string_view option)>;

/// Refuses an option that was given and has no effect, or cannot be given together with another one.
///
/// given:  what was given
/// usual:  the defaults of options that were not given
/// throws: Error(InvalidInput): "--kbuffer: has no effect without --order havs"
void check_needs(const Option& option, const GivenOptions& given, const GivenOptions& usual, OptionNames names);
/// The same for all options of a call; the defaults are their values.
void check_needs(const std::vector<Option>& options, const GivenOptions& given, OptionNames names);
/// The condition as users read it: "with --order havs", "not with --levels".
[[nodiscard]] std::string need_text(const OptionNeed& need, OptionNames names);

}  // namespace subvol
