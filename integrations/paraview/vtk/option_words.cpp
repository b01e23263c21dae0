// SPDX-License-Identifier: Apache-2.0
#include "option_words.h"

#include <algorithm>
#include <sstream>
#include <variant>

#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {

OptionWords words_of(const char* text) {
    OptionWords given;
    std::istringstream words(text != nullptr ? text : "");
    for (std::string word; words >> word;) {
        const std::size_t equals = word.find('=');
        given[word.substr(0, equals)] = equals == std::string::npos ? "1" : word.substr(equals + 1);
    }
    return given;
}

void set_options(const std::vector<Option>& known, const OptionWords& given) {
    for (const auto& [name, text] : given) {
        const auto found = std::ranges::find_if(known, [&](const Option& option) { return option.key() == name; });
        if (found == known.end()) throw Error(ErrorCode::InvalidInput, "there is no option '" + name + "'", "Options");
        if (bool* const* const on = std::get_if<bool*>(&found->value))
            **on = text != "0" && text != "false";
        else
            found->read(text, name);
    }
}

}  // namespace subvol
