// SPDX-License-Identifier: Apache-2.0
#include "subvol/flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "image_difference.h"
#include "separable.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// Linear sRGB to XYZ, relative to the white of the screen: white is (1, 1, 1).
inline Vec3 xyz_over_white(const Vec3& rgb) {
    // Columns: the primaries of sRGB (IEC 61966-2-1) as fractions.
    static const Mat3 kToXyz{10135552. / 24577794, 2613072. / 12288897, 1425312. / 73733382,
                             8788810. / 24577794,  8788810. / 12288897, 8788810. / 73733382,
                             4435075. / 24577794,  887015. / 12288897,  70074185. / 73733382};
    static const Vec3 kWhite = kToXyz * Vec3(1.0);
    return kToXyz * rgb / kWhite;
}

inline Vec3 rgb_of_xyz_over_white(const Vec3& xyz) {
    static const Mat3 kInverse =
        glm::inverse(Mat3(xyz_over_white({1, 0, 0}), xyz_over_white({0, 1, 0}), xyz_over_white({0, 0, 1})));
    return kInverse * xyz;
}

/// The opponent space YCxCz: linear in light.
inline Vec3 ycxcz(const Vec3& rgb) {
    const Vec3 t = xyz_over_white(rgb);
    return {116 * t.y - 16, 500 * (t.x - t.y), 200 * (t.y - t.z)};
}

inline Vec3 rgb_of_ycxcz(const Vec3& c) {
    const double y = (c.x + 16) / 116;
    return rgb_of_xyz_over_white({y + c.y / 500, y, y - c.z / 200});
}

/// L*, a*, b* with a* and b* times L*/100, as dark colours are less colourful (the Hunt effect).
inline Vec3 hunt_lab(const Vec3& rgb) {
    constexpr double kDelta = 6. / 29;
    const auto f = [](double t) { return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4. / 29; };
    const Vec3 t = xyz_over_white(rgb);
    const double x = f(t.x), y = f(t.y), z = f(t.z), lightness = 116 * y - 16;
    return {lightness, .01 * lightness * 500 * (x - y), .01 * lightness * 200 * (y - z)};
}

/// HyAB: the sum of the difference in lightness and the distance in a*, b*.
inline double hyab(const Vec3& a, const Vec3& b) {
    return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

}  // namespace subvol::detail

namespace subvol {

using namespace detail;

using detail::Band;
using detail::convolved;
using detail::Plane;
using detail::Taps;

namespace {

// [flip2020]: exponents of the colour and the feature difference; the part of the largest colour difference that is mapped to
// kTarget; the width of the edge detector in degrees.
constexpr double kColorExponent = .7, kFeatureExponent = .5;
constexpr double kBend = .4, kTarget = .95;
constexpr double kDetectorWidth = .082;
constexpr double kPi = std::numbers::pi;

/// A term a √(π/b) exp(−π² d²/b) of a contrast sensitivity function, d in degrees.
struct Sensitivity {
    double a, b;
};
constexpr Sensitivity kAchromatic{1, .0047}, kRedGreen{1, .0053};
constexpr std::array<Sensitivity, 2> kBlueYellow{{{34.1, .04}, {13.5, .025}}};
constexpr double kWidest = .04;  // the largest b: all filters get the reach of the widest one

/// The filters for a number of pixels per degree. Each is a product of one along x and one along y; that of blue and yellow is
/// the sum of two such products.
struct Filters {
    Taps achromatic, red_green;
    std::array<Taps, 2> blue_yellow;  // times their shares, the weights of both products add up to 1
    std::array<double, 2> blue_yellow_share{};
    Taps smooth, edge, point;  // of the detectors: Gaussian, its first and its second derivative
    std::size_t halo = 0;

    explicit Filters(double ppd) {
        const auto reach = static_cast<std::size_t>(std::ceil(3 * std::sqrt(kWidest / (2 * kPi * kPi)) * ppd));
        const auto taps = [&](double b) { return detail::gaussian_taps(std::sqrt(b / 2) / kPi * ppd, reach); };
        achromatic = taps(kAchromatic.b);
        red_green = taps(kRedGreen.b);
        double total = 0;
        for (std::size_t k = 0; k < 2; ++k) {
            const auto [a, b] = kBlueYellow[k];
            blue_yellow[k] = taps(b);
            // The sum of the term over the square: its middle weight is a √(π/b); `taps` are normalised by 1/row_sum.
            const double row_sum = 1 / blue_yellow[k][reach];
            blue_yellow_share[k] = a * std::sqrt(kPi / b) * row_sum * row_sum;
            total += blue_yellow_share[k];
        }
        for (double& share : blue_yellow_share) share /= total;
        make_detectors(.5 * kDetectorWidth * ppd);
        halo = std::max(reach, smooth.size() / 2);
    }

private:
    void make_detectors(double sigma) {
        const auto reach = static_cast<std::size_t>(std::ceil(3 * sigma));
        smooth = detail::gaussian_taps(sigma, reach);
        double x = -std::ceil(3 * sigma);
        for (const double g : smooth) {
            edge.push_back(-x * g);
            point.push_back((x * x / (sigma * sigma) - 1) * g);
            ++x;
        }
        for (Taps* taps : {&edge, &point}) {
            double positive = 0, negative = 0;
            for (const double tap : *taps) (tap > 0 ? positive : negative) += std::abs(tap);
            for (double& tap : *taps) tap /= tap > 0 ? positive : negative;
        }
    }
};

/// What is compared, for the rows of a band: colours after the eye's filters, and the strength of features.
struct Seen {
    std::vector<Vec3> colors;
    std::vector<double> edges, points;
};

std::array<Plane, 3> opponent_rows(const Image& image, const Band& band) {
    std::array<Plane, 3> planes;
    planes.fill(Plane(image.width, band.rows()));
    for (std::size_t row = 0; row < band.rows(); ++row) {
        const std::size_t y = band.picture_row(row);
        for (int x = 0; x < image.width; ++x) {
            const auto pixel = image.pixel(x, y);
            const Vec3 rgb{pixel[0], pixel[1], pixel[2]};
            const Vec3 c = detail::ycxcz(glm::clamp(rgb, 0.0, 1.0));
            for (int k = 0; k < 3; ++k) planes[std::size_t(k)].at(x, row) = c[k];
        }
    }
    return planes;
}

/// The strength of a feature: the length of the responses along x and y, of the luminance Y of white 1.
std::vector<double> feature_strength(const Plane& y, const Taps& detector, const Taps& smooth, std::size_t halo) {
    const Plane along_x = convolved(y, detector, smooth, halo), along_y = convolved(y, smooth, detector, halo);
    std::vector<double> strength(along_x.values.size());
    // Y is 116 times the luminance minus 16; the offset has no effect because the detectors' weights add up to 0.
    for (std::size_t i = 0; i < strength.size(); ++i) strength[i] = std::hypot(along_x.values[i], along_y.values[i]) / 116;
    return strength;
}

Seen see(const Image& image, const Band& band, const Filters& filters) {
    const auto opponent = opponent_rows(image, band);
    const auto filtered = [&](std::size_t channel, const Taps& taps) {
        return convolved(opponent[channel], taps, taps, filters.halo);
    };
    const Plane y = filtered(0, filters.achromatic), cx = filtered(1, filters.red_green);
    const Plane cz_wide = filtered(2, filters.blue_yellow[0]), cz_narrow = filtered(2, filters.blue_yellow[1]);
    Seen seen;
    seen.colors.reserve(y.values.size());
    for (std::size_t i = 0; i < y.values.size(); ++i) {
        const double cz = filters.blue_yellow_share[0] * cz_wide.values[i] + filters.blue_yellow_share[1] * cz_narrow.values[i];
        const Vec3 rgb = detail::rgb_of_ycxcz({y.values[i], cx.values[i], cz});
        seen.colors.push_back(detail::hunt_lab(glm::clamp(rgb, 0.0, 1.0)));
    }
    seen.edges = feature_strength(opponent[0], filters.edge, filters.smooth, filters.halo);
    seen.points = feature_strength(opponent[0], filters.point, filters.smooth, filters.halo);
    return seen;
}

/// The colour difference mapped to [0,1]; small differences, which are most frequent, get most of that range.
double color_error(const Vec3& a, const Vec3& b) {
    static const double kLargest =
        std::pow(detail::hyab(detail::hunt_lab({0, 1, 0}), detail::hunt_lab({0, 0, 1})), kColorExponent);
    const double error = std::pow(detail::hyab(a, b), kColorExponent), bend = kBend * kLargest;
    if (error < bend) return error * kTarget / bend;
    return std::min(1.0, kTarget + (1 - kTarget) * (error - bend) / (kLargest - bend));
}

double feature_error(const Seen& a, const Seen& b, std::size_t i) {
    const double difference = std::max(std::abs(a.edges[i] - b.edges[i]), std::abs(a.points[i] - b.points[i]));
    return std::pow(difference / std::numbers::sqrt2, kFeatureExponent);
}

}  // namespace

FlipResult flip(const Image& test, const Image& reference, double pixels_per_degree) {
    check_finite(test, reference);
    if (!(pixels_per_degree >= 1 && pixels_per_degree <= 1000)) {
        throw Error(ErrorCode::InvalidInput, number_text(pixels_per_degree) + " pixels per degree are out of range", {},
                    "1 to 1000");
    }
    const Filters filters(pixels_per_degree);
    FlipResult result{0, MetricMap(test.width, test.height)};
    detail::for_each_band(result.map.height, filters.halo, [&](const Band& band) {
        const Seen a = see(test, band, filters), b = see(reference, band, filters);
        float* out = result.map.row(band.begin).data();
        for (std::size_t i = 0; i < a.colors.size(); ++i) {
            out[i] = static_cast<float>(std::pow(color_error(a.colors[i], b.colors[i]), 1 - feature_error(a, b, i)));
        }
    });
    result.mean = mean_of(result.map);
    return result;
}

}  // namespace subvol
