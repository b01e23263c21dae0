// SPDX-License-Identifier: Apache-2.0
#include "subvol/share.h"

#include <algorithm>
#include <numeric>

#include "subvol/error.h"

namespace subvol {

std::pair<std::size_t, std::size_t> Share::range(std::size_t things) const {
    const auto first = static_cast<std::size_t>(number - 1), shares = static_cast<std::size_t>(count);
    // Without a product that may overflow: every share has things / shares, the first ones one more.
    const std::size_t each = things / shares, more = things % shares;
    const auto begin = [&](std::size_t share) { return share * each + std::min(share, more); };
    return {begin(first), begin(first + 1)};
}

std::pair<std::size_t, std::size_t> Share::range_by_weight(std::span<const double> weights) const {
    const double all = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::size_t begin = 0, end = 0;
    double before = 0;
    for (std::size_t layer = 0; layer < weights.size(); ++layer) {
        const double middle = before + weights[layer] / 2;
        before += weights[layer];
        const int owner = std::min(count, 1 + static_cast<int>(count * (all > 0 ? middle / all : 0)));
        if (owner < number) begin = layer + 1;
        if (owner <= number) end = layer + 1;
    }
    return {begin, end};
}

std::string Share::name() const {
    return std::to_string(number) + "/" + std::to_string(count);
}

void validate(const Share& share) {
    if (share.count >= 1 && share.number >= 1 && share.number <= share.count) return;
    throw Error(ErrorCode::InvalidInput, "there is no share " + share.name(), {}, "1/N to N/N");
}

}  // namespace subvol
