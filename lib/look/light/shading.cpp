// SPDX-License-Identifier: Apache-2.0
#include "subvol/shading.h"

#include <algorithm>
#include <cmath>

namespace subvol {

Shading plain_shading() {
    return {.ambient = 0.08, .diffuse = 1.02, .head = 0.25};
}

Shading shading_for(const TransferFunction& map) {
    const auto is_first = [&](const TransferFunction::ColorKnot& knot) { return knot.rgb == map.color.front().rgb; };
    return !map.color.empty() && std::ranges::all_of(map.color, is_first) ? plain_shading() : Shading{};
}

namespace detail {

namespace {

/// x to a power that is a whole number as a rule.
double power(double x, double exponent) {
    constexpr double kMostFactors = 256;
    if (exponent != std::floor(exponent) || exponent < 0 || exponent > kMostFactors) return std::pow(x, exponent);
    double result = 1;
    for (auto left = static_cast<unsigned>(exponent); left != 0; left >>= 1, x *= x) {
        if ((left & 1) != 0) result *= x;
    }
    return result;
}

}  // namespace

SurfaceLight surface_light(const Shading& shading, const Vec3& normal, const Vec3& to_eye,
                           const std::array<float, 2>& arrives) {
    const Vec3 to_key = glm::normalize(shading.key);
    const double from_key = static_cast<double>(arrives[0]), open = static_cast<double>(arrives[1]);
    const double head = std::max(0.0, glm::dot(normal, to_eye)), side = from_key * std::max(0.0, glm::dot(normal, to_key));
    const double halfway = std::max(0.0, glm::dot(normal, glm::normalize(to_key + to_eye)));
    const double gloss = power(head, shading.shininess) + from_key * power(halfway, shading.shininess);
    const double directed = shading.head * head + (1 - shading.head) * side;
    return {static_cast<float>(open * (shading.ambient + shading.diffuse * directed)),
            static_cast<float>(open * (shading.specular * 0.5 * gloss))};
}

}  // namespace detail

}  // namespace subvol
