// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/several_errors.h"

#include <algorithm>
#include <utility>

#include "subvol/detail/printable.h"

namespace subvol::detail {

namespace {

std::vector<std::string> lines_of(const std::string& where, const std::vector<Error>& all) {
    constexpr std::size_t kMostLines = 8, kLongest = 160;
    const std::string place = where.empty() ? "" : where + ": ";
    std::vector<std::string> lines{place + std::to_string(all.size()) + " mistakes:"};
    for (std::size_t k = 0; k < std::min(all.size(), kMostLines); ++k) {
        std::string text = all[k].what();
        if (text.starts_with(place)) text.erase(0, place.size());
        lines.push_back("  " + shortened(text, kLongest));
    }
    if (all.size() > kMostLines) lines.push_back("  and " + std::to_string(all.size() - kMostLines) + " more");
    lines.front() = printable(lines.front());
    return lines;
}

std::string joined_lines(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
    return text;
}

}  // namespace

SeveralErrors::SeveralErrors(std::vector<Error> all, std::vector<std::string> lines)
    : Error(ErrorCode::InvalidInput, joined_lines(lines)), all_(std::move(all)), lines_(std::move(lines)) {
}

SeveralErrors::SeveralErrors(const std::string& where, std::vector<Error> all) : SeveralErrors(all, lines_of(where, all)) {
}

}  // namespace subvol::detail
