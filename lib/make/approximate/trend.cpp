// SPDX-License-Identifier: Apache-2.0
#include "trend.h"

#include <algorithm>
#include <cmath>

namespace subvol::detail {

Trend trend_of(std::span<const Vec3> places, std::span<const double> values) {
    Trend trend;
    const auto count = static_cast<double>(places.size());
    for (std::size_t k = 0; k < places.size(); ++k) {
        trend.center += places[k] / count;
        trend.mean += values[k] / count;
    }
    Mat3 moments(0.0);
    double variance = 0;
    for (std::size_t k = 0; k < places.size(); ++k) {
        const Vec3 d = places[k] - trend.center;
        moments += glm::outerProduct(d, d);
        variance += (values[k] - trend.mean) * (values[k] - trend.mean);
    }
    constexpr std::size_t kNumbers = 4;  // of a linear function
    if (places.size() <= kNumbers || variance == 0) return trend;
    const double spread = moments[0][0] + moments[1][1] + moments[2][2];
    if (!(spread > 0)) return trend;
    constexpr double kFlat = 1e-12;  // of the spread: directions with less are not decided
    const Mat3 inverse = glm::inverse(moments + kFlat * spread * Mat3(1.0));
    double rest = 0;
    for (int pass = 0; pass < 3; ++pass) {  // the second and third take off what rounding and kFlat left
        Vec3 right(0.0);
        for (std::size_t k = 0; k < places.size(); ++k) right += (values[k] - trend.at(places[k])) * (places[k] - trend.center);
        trend.gradient += inverse * right;
    }
    for (std::size_t k = 0; k < places.size(); ++k) rest += std::pow(values[k] - trend.at(places[k]), 2);
    const double unexplained = (rest / (count - kNumbers)) / (variance / (count - 1));
    trend.gradient *= std::max(0.0, 1 - unexplained);
    return trend;
}

}  // namespace subvol::detail
