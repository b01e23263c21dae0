// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/error_text.h"

#include <algorithm>

#include "subvol/detail/printable.h"

namespace subvol::detail {

std::string listed(std::span<const std::string> names) {
    constexpr std::size_t kMostNames = 10, kMostBytes = 150;
    std::string list;
    std::size_t count = 0;
    for (; count < std::min(kMostNames, names.size()) && list.size() < kMostBytes; ++count) {
        list += (count == 0 ? "" : ", ") + shortened(names[count]);
    }
    if (count == names.size()) return list;
    std::string more = std::to_string(names.size() - count);
    for (std::size_t k = more.size(); k > 3; k -= 3) more.insert(k - 3, ",");
    return list + " and " + more + " more";
}

std::string error_sentence(std::string_view where, std::string_view message, std::string_view allowed) {
    constexpr std::size_t kMostOfMessage = 300, kMostOfPlace = 200, kMostOfAllowed = 1000;
    // Most texts are short: they stay as they are, with whatever is in them.
    const auto cut = [](std::string_view text, std::size_t most) {
        return text.size() <= most ? std::string(text) : shortened(text, most);
    };
    std::string sentence;
    if (where.size() > kMostOfPlace) {
        where.remove_prefix(where.size() - kMostOfPlace);
        while (!where.empty() && (where.front() & 0xC0) == 0x80) where.remove_prefix(1);
        sentence = "…";
    }
    sentence += where;
    if (!where.empty()) sentence += ": ";
    sentence += cut(message, kMostOfMessage);
    if (!allowed.empty()) sentence += " (" + cut(allowed, kMostOfAllowed) + ")";
    return sentence;
}

}  // namespace subvol::detail
