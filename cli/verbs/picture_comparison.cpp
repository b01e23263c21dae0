// SPDX-License-Identifier: Apache-2.0
#include "picture_comparison.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>

#include "input.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/image_metrics.h"
#include "subvol/image_regions.h"
#include "subvol/oiio_compare.h"
#include "subvol/placed_image.h"
#include "subvol/ssim.h"
#include "text.h"

namespace subvol::cli {
namespace {

const std::vector<std::string> kHeatmaps{"abs", "flip", "ssim"};
const std::vector<std::string> kDifferences{"mse", "rmse", "mae", "max", "psnr"};

void put_differences(const ImageMetrics& m, const std::string& prefix, Figures& figures) {
    const std::array values{m.mse, m.rmse, m.mae, m.max, m.psnr};
    for (std::size_t k = 0; k < values.size(); ++k) figures.put(prefix + kDifferences[k], values[k]);
}

void check_finite(const Image& image, const std::string& path) {
    const std::size_t bad = count_not_finite(image);
    if (bad == 0) return;
    throw Error(ErrorCode::InvalidInput, text(bad, " pixels are infinite or not a number: nothing can be measured"), path);
}

/// The pixels that both show. The report says where they are, if that is not all of both.
CommonPixels read_common(const std::string& test, const std::string& reference, Report& report) {
    PlacedImage a = read_placed_image(test), b = read_placed_image(reference);
    const bool whole = a.whole() && b.whole();
    CommonPixels common = common_pixels(std::move(a), std::move(b));
    check_finite(common.a, test);
    check_finite(common.b, reference);
    const PixelWindow& w = common.window;
    if (!whole) report["window"] = {{"left", w.left}, {"top", w.top}, {"width", w.width}, {"height", w.height}};
    return common;
}

/// 1 − similarity: 0 where the pictures agree, as in the other maps.
MetricMap dissimilarity(MetricMap map) {
    for (float& value : map.values) value = 1 - value;
    return map;
}

}  // namespace

void PictureComparison::add_to(CLI::App& app) {
    const std::string group = "Pictures";
    app.add_option("--heatmap", heatmap, "write a picture of the differences (.png, .exr)")->group(group)->type_name("FILE");
    add_option(app, Option("heatmap-of", heatmap_of)
                        .offer(kHeatmaps)
                        .help("METRIC", "what it shows: abs (the largest channel's difference), flip, ssim (1 - ssim)")
                        .only_with("heatmap"))
        ->group(group);
    add_option(app, Option("heatmap-scale", heatmap_scale)
                        .positive()
                        .help("V", "the value of the last colour (default: the largest value)")
                        .only_with("heatmap"))
        ->group(group);
    add_option(app, Option("ppd", pixels_per_degree)
                        .between(1, 1000)
                        .help("N", "flip: pixels per degree of the viewer's sight (default 67.02)"))
        ->group(group);
    app.add_flag("--hdr", hdr, "also HDR-FLIP (hdr_flip), over all exposures that the second picture needs")->group(group);
    app.add_flag("--oiio", oiio, "also the figures of OpenImageIO's idiff: warnings, failures, Yee's perceptual failures")
        ->group(group);
    app.add_flag(
           "--optical-depth", optical_depth,
           "also the relative error of the summed optical depth -ln(1-alpha), which with --ortho is the volume's integral "
           "(optical_depth_error)")
        ->group(group);
    add_option(app, Option("edge-band", edge_band_px)
                        .between(1, 1000)
                        .help("N", "measure separately within N pixels of the second picture's silhouette, and inside it"))
        ->group(group);
    app.add_option("--background", background,
                   "with --edge-band: the background of pictures without alpha (linear RGB; default black)")
        ->group(group)
        ->type_name("R,G,B")
        ->transform(number_list(3, "0,0,0"));
    only_with(app, "--background", {"--edge-band"});
}

void PictureComparison::check() const {
    check_choice("--heatmap-of", heatmap_of, kHeatmaps);
    (void)parse_vector("--background", background);
    if (!heatmap.empty()) check_output(heatmap, {".png", ".exr"});
}

std::vector<std::string> PictureComparison::names() const {
    std::vector<std::string> all = kDifferences;
    const auto add = [&](const std::string& prefix, const std::vector<std::string>& names) {
        for (const std::string& name : names) all.push_back(prefix + name);
    };
    add("", {"ssim", "flip"});
    if (hdr) add("", {"hdr_flip"});
    add("srgb8.", kDifferences);
    add("srgb8.", {"ssim"});
    for (const char* region : {"interior.", "edge."}) {
        if (!edge_band_px) break;
        add(region, kDifferences);
        add(region, {"flip"});
    }
    if (optical_depth) add("", {"optical_depth_error"});
    if (oiio) add("oiio.", {"warnings", "failures", "yee_failures"});
    return all;
}

Figures PictureComparison::measure(const std::string& test, const std::string& reference, Report& report) const {
    const CommonPixels common = report.timed("read", [&] { return read_common(test, reference, report); });
    const Image &a = common.a, &b = common.b;
    Figures figures;
    put_differences(report.timed("differences", [&] { return compare_images(a, b); }), "", figures);
    const SsimResult similarity = report.timed("ssim", [&] { return ssim(a, b); });
    const FlipResult flips = report.timed("flip", [&] { return flip(a, b, pixels_per_degree); });
    figures.put("ssim", similarity.mean);
    figures.put("flip", flips.mean);
    if (hdr) {
        const auto found = report.timed("hdr_flip", [&] { return hdr_flip(a, b, {.pixels_per_degree = pixels_per_degree}); });
        figures.put("hdr_flip", found.mean);
        report["exposures"] = {{"start", found.start}, {"stop", found.stop}, {"count", found.exposures}};
    }
    report.timed("srgb8", [&] {
        const Image a8 = srgb8_image(a), b8 = srgb8_image(b);
        put_differences(compare_images(a8, b8), "srgb8.", figures);
        figures.put("srgb8.ssim", ssim(a8, b8).mean);
    });
    if (edge_band_px) measure_regions(a, b, flips.map, figures);
    if (optical_depth) measure_optical_depth(a, b, figures, report);
    if (oiio) {
        report.timed("oiio", [&] {
            const OiioMetrics metrics = compare_oiio(a, b);
            figures.put("oiio.warnings", static_cast<double>(metrics.warnings));
            figures.put("oiio.failures", static_cast<double>(metrics.failures));
            figures.put("oiio.yee_failures", static_cast<double>(compare_yee(a, b)));
        });
    }
    if (!heatmap.empty()) draw(a, b, flips.map, similarity.map, report);
    return figures;
}

void PictureComparison::measure_optical_depth(const Image& a, const Image& b, Figures& figures, Report& report) {
    figures.put("optical_depth_error", optical_depth_error(a, b));
    const std::size_t saturated = std::max(subvol::optical_depth(a).saturated, subvol::optical_depth(b).saturated);
    if (saturated == 0) return;
    report.warn(text(saturated,
                     " pixels are nearly opaque, so their optical depth is inaccurate; render with a larger "
                     "--opacity-unit"));
}

void PictureComparison::measure_regions(const Image& a, const Image& b, const MetricMap& flips, Figures& figures) const {
    const ImageRegions regions = silhouette_regions(b, *edge_band_px, parse_vector("--background", background));
    const auto put = [&](const std::string& name, const PixelMask& mask) {
        if (std::ranges::find(mask, 1) == mask.end()) {
            throw Error(ErrorCode::InvalidInput, "the second picture's object has no " + name, "--edge-band",
                        "a narrower band, or another --background");
        }
        put_differences(compare_images(a, b, mask), name + ".", figures);
        figures.put(name + ".flip", mean_of(flips, mask));
    };
    put("interior", regions.interior);
    put("edge", regions.edge);
}

void PictureComparison::draw(const Image& a, const Image& b, const MetricMap& flips, const MetricMap& similarities,
                             Report& report) const {
    const MetricMap map = heatmap_of == "abs"    ? difference_map(a, b)
                          : heatmap_of == "flip" ? flips
                                                 : dissimilarity(similarities);
    report.timed("write", [&] { write_image(heatmap, subvol::heatmap(map, heatmap_scale.value_or(0))); });
    report["heatmap"] = heatmap;
}

}  // namespace subvol::cli
