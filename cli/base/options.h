// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/option.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace subvol::cli {

/// Options of a command made from their descriptions: name, value, range, words, help, and the conditions under which they have
/// an effect. A wrong value is refused by our Error, whatever the parser of the command line would say.
///
/// The values are stored where the descriptions refer to, which must live as long as the command.
CLI::Option* add_option(CLI::App& app, const Option& option);
/// What a command works on: a name without dashes, for example FILE. value: a text, or a list of them
CLI::Option* add_input(CLI::App& app, const std::string& name, std::string& value, const std::string& help);
CLI::Option* add_input(CLI::App& app, const std::string& name, std::vector<std::string>& value, const std::string& help);
void add_options(CLI::App& app, const std::vector<Option>& options);

/// The options that were given to a command.
[[nodiscard]] GivenOptions given_options(const CLI::App& app);

/// Refuses an option where another one is not given, or has none of these words: it would have no effect.
///
/// The other one exists already.
void only_with(CLI::App& app, const std::string& name, const OptionNeed& need);

}  // namespace subvol::cli
