// SPDX-License-Identifier: Apache-2.0
#include "subvol/color_name.h"

#include <array>
#include <charconv>
#include <optional>
#include <vector>

#include "subvol/detail/near_name.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/srgb.h"

namespace subvol {
namespace {

struct Named {
    const char* name;
    int rgb;
};
constexpr std::array<Named, 14> kNamed{{{"white", 0xffffff},
                                        {"black", 0},
                                        {"lightgrey", 0xe4e6e9},
                                        {"lightgray", 0xe4e6e9},
                                        {"grey", 0x808080},
                                        {"gray", 0x808080},
                                        {"darkgrey", 0x404040},
                                        {"darkgray", 0x404040},
                                        {"red", 0xff0000},
                                        {"green", 0x008000},
                                        {"blue", 0x0000ff},
                                        {"yellow", 0xffff00},
                                        {"navy", 0x000080},
                                        {"ivory", 0xfffff0}}};

}  // namespace

Vec3 parse_color(const std::string& text, const std::string& where) {
    const auto from_bytes = [](int rgb) { return linear_from_srgb(Vec3(rgb >> 16, rgb >> 8 & 255, rgb & 255) / 255.0); };
    for (const auto& [name, rgb] : kNamed) {
        if (text == name) return from_bytes(rgb);
    }
    if (text.starts_with('#')) {
        int rgb = 0;
        const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), rgb, 16);
        if (text.size() == 7 && text[1] != '-' && error == std::errc() && end == text.data() + text.size())
            return from_bytes(rgb);
        throw Error(ErrorCode::InvalidInput, "'" + text + "' is not a colour", where, "write it as #rrggbb");
    }
    if (text.find(',') == std::string::npos) {
        std::vector<std::string> names;
        std::string list;
        for (const auto& named : kNamed) {
            names.emplace_back(named.name);
            list += (list.empty() ? "" : ", ") + names.back();
        }
        throw Error(ErrorCode::InvalidInput, "'" + text + "' is not a colour" + detail::did_you_mean(text, names), where,
                    "three numbers 0..1 such as 1,.5,0; #rrggbb; or " + list);
    }
    Vec3 color;
    std::size_t begin = 0;
    for (int c = 0; c < 3; ++c) {
        const std::size_t comma = c < 2 ? text.find(',', begin) : text.size();
        const auto number = comma == std::string::npos ? std::nullopt : detail::number_from(text.substr(begin, comma - begin));
        if (!number || !(*number >= 0 && *number <= 1))
            throw Error(ErrorCode::InvalidInput, "'" + text + "' is not a colour", where, "three numbers, each in 0..1");
        color[c] = *number;
        begin = comma + 1;
    }
    return color;
}

}  // namespace subvol
