// SPDX-License-Identifier: Apache-2.0
#include "subvol/shading.h"

#include <algorithm>
#include <cmath>

namespace subvol::detail {

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
    return {static_cast<float>(open * (shading.ambient + shading.diffuse * 0.5 * (head + side))),
            static_cast<float>(open * (shading.specular * 0.5 * gloss))};
}

}  // namespace subvol::detail
