// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "subvol/option_names.h"

namespace subvol {

/// Options by their names in Python, with their values as texts.
using OptionWords = std::map<std::string, std::string>;

/// Several options in one text: "per_edge=2 centers". text: may be null
[[nodiscard]] OptionWords words_of(const char* text);

/// Sets options that the library describes.
///
/// throws: subvol::Error if there is no such option, or the text is no value of it
void set_options(const std::vector<Option>& known, const OptionWords& given);

}  // namespace subvol
