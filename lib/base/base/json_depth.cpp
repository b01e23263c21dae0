// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/json_depth.h"

#include "subvol/error.h"

namespace subvol::detail {

std::string_view of_limited_depth(std::string_view json, const std::string& where) {
    constexpr int kDeepest = 100;
    int depth = 0;
    bool in_text = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (in_text) {
            if (c == '\\') {
                ++i;
            } else if (c == '"') {
                in_text = false;
            }
        } else if (c == '"') {
            in_text = true;
        } else if (c == '[' || c == '{') {
            if (++depth > kDeepest) {
                throw Error(ErrorCode::InvalidInput, "its JSON is nested too deep", where,
                            "at most " + std::to_string(kDeepest) + " arrays and objects within each other");
            }
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return json;
}

}  // namespace subvol::detail
