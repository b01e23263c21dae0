// SPDX-License-Identifier: Apache-2.0
#include "xml_tags.h"

#include <algorithm>

namespace subvol::detail {

XmlTags::XmlTags(std::string_view text) {
    constexpr std::size_t kShort = 64;  // characters that are not worth a cut
    std::size_t begin = 0;
    while (begin < text.size()) {
        // A tag and what follows it. In comments and the like it may be no tag; there nothing is lost either.
        const std::size_t end = std::min(text.find('<', begin + 1), text.size());
        const std::string_view part = text.substr(begin, end - begin);
        const std::size_t tag_end = part.rfind('>');
        const std::size_t word = tag_end == std::string_view::npos ? tag_end : part.find_first_not_of(" \t\r\n", tag_end + 1);
        const bool is_long = word != std::string_view::npos && part.size() - word > kShort;
        tags_ += is_long ? part.substr(0, word + 1) : part;
        begin = end;
        if (is_long) cuts_.push_back({tags_.size(), begin - tags_.size()});
    }
}

std::size_t XmlTags::place(std::size_t offset) const {
    const auto behind = std::ranges::upper_bound(cuts_, offset, {}, &Cut::offset);
    return offset + (behind == cuts_.begin() ? 0 : std::prev(behind)->length);
}

}  // namespace subvol::detail
