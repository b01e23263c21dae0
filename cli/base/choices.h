// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace CLI {
class Validator;
}

namespace subvol::cli {

/// A check for an option that takes one of a few words. Another word is refused as by `check_choice`.
[[nodiscard]] CLI::Validator one_of(const std::vector<std::string>& words);

/// Words that completion offers for an option. It accepts everything: a later check, or the library, knows what is right.
[[nodiscard]] CLI::Validator offered(const std::vector<std::string>& words);

}  // namespace subvol::cli
