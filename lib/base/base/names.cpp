// SPDX-License-Identifier: Apache-2.0
#include "subvol/names.h"

#include <algorithm>
#include <cctype>

#include "subvol/detail/near_name.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

char lower(char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

/// The number of letters that have to be added, removed, replaced, or exchanged with their neighbour, without regard to case
/// (optimal string alignment).
std::size_t distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (same ? 0 : 1)});
            const bool exchanged = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
            if (exchanged) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    }
    return d[a.size()][b.size()];
}

}  // namespace

std::string did_you_mean(const std::string& given, const std::vector<std::string>& names) {
    constexpr std::size_t kMostLetters = 200;  // names of files may be anything
    if (given.size() > kMostLetters) return {};
    const std::string* best = nullptr;
    std::size_t least = std::min<std::size_t>(2, (given.size() + 1) / 3) + 1;
    for (const std::string& name : names) {
        if (name.size() > kMostLetters) continue;
        const std::size_t slips = distance(given, name);
        if (slips >= least) continue;
        least = slips;
        best = &name;
    }
    return best ? ": did you mean " + *best + "?" : std::string();
}

void throw_unknown_name(const std::string& given, const std::string& where, const std::vector<std::string>& names) {
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
    throw Error(ErrorCode::InvalidInput, "'" + shortened(given) + "' is unknown" + did_you_mean(given, names), where,
                "supported: " + all);
}

}  // namespace subvol::detail
