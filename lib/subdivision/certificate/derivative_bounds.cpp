// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "derivative_form.h"

namespace subvol::detail {

namespace {

constexpr AxisType kFirst{0, 2}, kSecond{1, 2}, kInside{2, 2};

struct Bound {
    BoxType type;
    double kappa;
};

// A test proves each of them again (`proves`), 1e-3 lower, so that another rounding of B does not matter.
constexpr std::array<Bound, 18> kBounds{{
    {{kInside, kInside, kInside}, 0.767},
    {{kInside, kInside, kSecond}, 0.782},
    {{kInside, kSecond, kSecond}, 0.837},
    {{kSecond, kInside, kInside}, 0.837},
    {{kSecond, kInside, kSecond}, 0.895},
    {{kSecond, kSecond, kSecond}, 0.895},
    {{kInside, kInside, kFirst}, 0.782},
    {{kInside, kSecond, kFirst}, 0.782},
    {{kInside, kFirst, kFirst}, 0.782},
    {{kSecond, kInside, kFirst}, 0.837},
    {{kSecond, kSecond, kFirst}, 0.895},
    {{kSecond, kFirst, kFirst}, 0.895},
    {{kFirst, kInside, kInside}, 0.837},
    {{kFirst, kInside, kSecond}, 0.895},
    {{kFirst, kSecond, kSecond}, 0.895},
    {{kFirst, kInside, kFirst}, 0.895},
    {{kFirst, kSecond, kFirst}, 0.895},
    {{kFirst, kFirst, kFirst}, 0.895},
}};

}  // namespace

std::optional<double> derivative_bound(const BoxType& type) {
    const auto found = std::ranges::find(kBounds, type, &Bound::type);
    return found == kBounds.end() ? std::nullopt : std::optional(found->kappa);
}

std::vector<BoxType> bounded_types() {
    std::vector<BoxType> types;
    for (const Bound& bound : kBounds) types.push_back(bound.type);
    return types;
}

}  // namespace subvol::detail
