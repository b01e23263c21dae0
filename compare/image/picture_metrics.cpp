// SPDX-License-Identifier: Apache-2.0
#include "subvol/picture_metrics.h"

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>

#include "subvol/image_regions.h"

namespace subvol {
namespace {

using Mask = std::span<const std::uint8_t>;

/// One of the differences over all pixels, which are taken together, or over some.
template <double ImageMetrics::*figure>
double difference(const PicturePair& pair, Mask mask) {
    return (mask.empty() ? pair.differences() : compare_images(pair.test(), pair.reference(), mask)).*figure;
}

double mean_luminance_ssim(const PicturePair& pair, Mask) {
    return pair.luminance_ssim().mean;
}

double mean_color_ssim(const PicturePair& pair, Mask) {
    return pair.color_ssim().mean;
}

double mean_flip(const PicturePair& pair, Mask mask) {
    return mask.empty() ? pair.flip().mean : mean_of(pair.flip().map, mask);
}

double mean_hdr_flip(const PicturePair& pair, Mask) {
    return pair.hdr_flip().mean;
}

double depth_error(const PicturePair& pair, Mask) {
    return optical_depth_error(pair.test(), pair.reference());
}

constexpr PictureMetric differs(std::string_view name, double (*of)(const PicturePair&, Mask), std::string_view quantity,
                                std::string_view formula) {
    return {.name = name,
            .study = name,
            .stage = "differences",
            .of = of,
            .masked = true,
            .encoded = true,
            .quantity = quantity,
            .formula = formula};
}

constexpr std::array kMetrics{
    differs("mse", difference<&ImageMetrics::mse>, "mean square error of linear RGB",
            "mean of (a - b)² over red, green and blue of all pixels, linear RGB, peak 1"),
    differs("rmse", difference<&ImageMetrics::rmse>, "RMSE of linear RGB", "√mse, linear RGB, peak 1"),
    differs("mae", difference<&ImageMetrics::mae>, "mean absolute error of linear RGB",
            "mean of abs(a - b) over red, green and blue of all pixels, linear RGB, peak 1"),
    differs("max", difference<&ImageMetrics::max>, "largest error of linear RGB",
            "largest abs(a - b) of red, green and blue of all pixels, linear RGB, peak 1"),
    PictureMetric{.name = "psnr",
                  .study = "psnr",
                  .stage = "differences",
                  .of = difference<&ImageMetrics::psnr>,
                  .unit = "dB",
                  .more_is_better = true,
                  .masked = true,
                  .encoded = true,
                  .quantity = "PSNR of linear RGB",
                  .formula = "-10 log10(mse), linear RGB, peak 1"},
    PictureMetric{
        .name = "ssim",
        .study = "ssim",
        .stage = "ssim",
        .of = mean_luminance_ssim,
        .more_is_better = true,
        .encoded = true,
        .seen = true,
        .quantity = "SSIM of 8-bit sRGB luminance",
        .formula = "mean of (2 m n + c1)(2 s + c2) / ((m² + n² + c1)(v + w + c2)) over all windows inside the picture: m, n "
                   "the means, v, w the variances and s the covariance under a Gaussian of 11 × 11 pixels with σ = 1.5; c1 = "
                   ".01², c2 = .03²; of .2125 R + .7154 G + .0721 B, 8-bit sRGB, peak 1",
        .source = "ssim2004"},
    PictureMetric{.name = "ssim_linear",
                  .study = "ssim_linear",
                  .stage = "ssim",
                  .of = mean_color_ssim,
                  .more_is_better = true,
                  .quantity = "SSIM of linear RGB",
                  .formula = "the formula of ssim, the mean of red, green and blue, linear RGB, peak 1",
                  .source = "ssim2004"},
    PictureMetric{.name = "flip",
                  .study = "flip",
                  .stage = "flip",
                  .of = mean_flip,
                  .masked = true,
                  .quantity = "mean FLIP at 67 pixels per degree",
                  .formula = "mean LDR-FLIP of all pixels at 67.02 pixels per degree (compare: --ppd), over black",
                  .source = "flip2020"},
    PictureMetric{.name = "hdr_flip",
                  .study = "flip_hdr",
                  .stage = "hdr_flip",
                  .of = mean_hdr_flip,
                  .flag = "hdr",
                  .help = "also HDR-FLIP (hdr_flip), over all exposures that the second picture needs",
                  .quantity = "mean HDR-FLIP at 67 pixels per degree",
                  .formula = "mean over all pixels of the largest LDR-FLIP of all exposures",
                  .source = "hdrflip2021"},
    PictureMetric{.name = "optical_depth_error",
                  .study = "optical_depth",
                  .stage = "optical_depth",
                  .of = depth_error,
                  .flag = "optical-depth",
                  .help =
                      "also the relative error of the summed optical depth -ln(1-alpha), which with --ortho is the volume's "
                      "integral (optical_depth_error)",
                  .quantity = "relative error of the optical depth",
                  .formula = "abs(Σ ln(1 - a) / Σ ln(1 - b) - 1) over the alphas of all pixels"}};

constexpr std::string_view kInterior = "_interior", kEdge = "_edge";

}  // namespace

struct PicturePair::State {
    const Image& test;
    const Image& reference;
    double pixels_per_degree;
    std::optional<ImageMetrics> differences{};
    std::optional<SsimResult> luminance_ssim{}, color_ssim{};
    std::optional<FlipResult> flip{};
    std::optional<HdrFlipResult> hdr_flip{};
    std::optional<std::pair<Image, Image>> encoded{};
    std::optional<PicturePair> on_screen{};
};

PicturePair::PicturePair(const Image& test, const Image& reference, double pixels_per_degree)
    : state_(std::make_unique<State>(State{test, reference, pixels_per_degree})) {
}
PicturePair::~PicturePair() = default;
PicturePair::PicturePair(PicturePair&&) noexcept = default;
PicturePair& PicturePair::operator=(PicturePair&&) noexcept = default;

const Image& PicturePair::test() const {
    return state_->test;
}

const Image& PicturePair::reference() const {
    return state_->reference;
}

const ImageMetrics& PicturePair::differences() const {
    if (!state_->differences) state_->differences = compare_images(test(), reference());
    return *state_->differences;
}

const SsimResult& PicturePair::luminance_ssim() const {
    if (!state_->luminance_ssim) state_->luminance_ssim = subvol::luminance_ssim(test(), reference());
    return *state_->luminance_ssim;
}

const SsimResult& PicturePair::color_ssim() const {
    if (!state_->color_ssim) state_->color_ssim = subvol::ssim(test(), reference());
    return *state_->color_ssim;
}

const FlipResult& PicturePair::flip() const {
    if (!state_->flip) state_->flip = subvol::flip(test(), reference(), state_->pixels_per_degree);
    return *state_->flip;
}

const HdrFlipResult& PicturePair::hdr_flip() const {
    if (!state_->hdr_flip)
        state_->hdr_flip = subvol::hdr_flip(test(), reference(), {.pixels_per_degree = state_->pixels_per_degree});
    return *state_->hdr_flip;
}

const PicturePair& PicturePair::on_screen() const {
    if (!state_->on_screen) {
        state_->encoded.emplace(srgb8_image(test()), srgb8_image(reference()));
        state_->on_screen.emplace(state_->encoded->first, state_->encoded->second, state_->pixels_per_degree);
    }
    return *state_->on_screen;
}

std::span<const PictureMetric> picture_metrics() {
    return kMetrics;
}

std::vector<std::string> study_metrics() {
    std::vector<std::string> names;
    for (const PictureMetric& metric : kMetrics) names.emplace_back(metric.study);
    for (const PictureMetric& metric : kMetrics) {
        if (!metric.masked) continue;
        for (const std::string_view region : {kInterior, kEdge})
            names.push_back(std::string(metric.study) + std::string(region));
    }
    return names;
}

std::map<std::string, double> measure_pictures(const Image& test, const Image& reference, const std::string& names) {
    const PicturePair pair(test, reference);
    const ImageRegions regions = silhouette_regions(reference);
    std::map<std::string, double> measured;
    std::istringstream in(names);
    for (std::string name; std::getline(in, name, ',');) {
        const PixelMask* const mask = name.ends_with(kInterior) ? &regions.interior
                                      : name.ends_with(kEdge)   ? &regions.edge
                                                                : nullptr;
        const std::string plain = mask == nullptr ? name : name.substr(0, name.rfind('_'));
        const auto metric = std::ranges::find(kMetrics, plain, &PictureMetric::study);
        if (metric == kMetrics.end()) continue;
        const bool nothing = mask != nullptr && std::ranges::find(*mask, 1) == mask->end();  // it has no interior or no edge
        if (!nothing) measured[name] = metric->measure(pair, mask == nullptr ? Mask() : Mask(*mask));
    }
    return measured;
}

const PictureMetric* find_metric(std::string_view figure) {
    figure.remove_prefix(figure.rfind('.') + 1);  // of no dot it is 0
    for (const std::string_view region : {kInterior, kEdge}) {
        if (figure.ends_with(region)) figure.remove_suffix(region.size());
    }
    const auto* const metric =
        std::ranges::find_if(kMetrics, [&](const auto& one) { return one.name == figure || one.study == figure; });
    return metric == kMetrics.end() ? nullptr : metric;
}

}  // namespace subvol
