// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace subvol::detail {

/// What a parser of XML has to see of a long text: its tags, and of the numbers between two tags no more than the first word's
/// beginning, so that an array takes no second place in memory.
class XmlTags {
public:
    /// text: is not kept
    explicit XmlTags(std::string_view text = {});

    /// The parser may change it in place.
    [[nodiscard]] std::string& text() { return tags_; }

    /// Where something in `text()` stands in the whole text.
    [[nodiscard]] std::size_t place(std::size_t offset) const;

private:
    struct Cut {
        std::size_t offset;  // into tags_
        std::size_t length;  // of all up to here
    };
    std::string tags_;
    std::vector<Cut> cuts_;
};

}  // namespace subvol::detail
