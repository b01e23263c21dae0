// SPDX-License-Identifier: Apache-2.0
#include "picture_comparison.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "input.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/image_regions.h"
#include "subvol/oiio_compare.h"
#include "subvol/option.h"
#include "subvol/placed_image.h"
#include "text.h"

namespace subvol::cli {
namespace {

const std::vector<std::string> kHeatmaps{"abs", "flip", "ssim"};
constexpr const char* kEncoded = "srgb8.";

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
    add_option(app, Option("heatmap", heatmap).help("FILE", "write a picture of the differences (.png, .exr)"))->group(group);
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
    for (const PictureMetric& metric : picture_metrics()) {
        if (metric.flag.empty()) continue;
        const std::string flag(metric.flag);
        app.add_flag_callback(
               "--" + flag, [this, flag] { asked.insert(flag); }, std::string(metric.help))
            ->group(group);
    }
    add_option(
        app,
        Option("oiio", oiio).help("also the figures of OpenImageIO's idiff: warnings, failures, Yee's perceptual failures"))
        ->group(group);
    add_option(app, Option("edge-band", edge_band_px)
                        .between(1, 1000)
                        .help("N", "measure separately within N pixels of the second picture's silhouette, and inside it"))
        ->group(group);
    add_option(app, Option("background", background)
                        .help("R,G,B", "with --edge-band: the background of pictures without alpha (linear RGB)"))
        ->group(group)
        ->transform(number_list(3, "0,0,0"));
    only_with(app, "background", {"edge-band"});
}

void PictureComparison::check() const {
    check_choice("--heatmap-of", heatmap_of, kHeatmaps);
    (void)parse_vector("--background", background);
    if (!heatmap.empty()) check_output(heatmap, {".png", ".exr"});
}

bool PictureComparison::takes(const PictureMetric& metric) const {
    return metric.flag.empty() || asked.contains(std::string(metric.flag));
}

std::vector<std::string> PictureComparison::names() const {
    std::vector<std::string> all;
    const auto add = [&](const std::string& prefix, const auto& chosen) {
        for (const PictureMetric& metric : picture_metrics()) {
            if (takes(metric) && chosen(metric)) all.push_back(prefix + std::string(metric.name));
        }
    };
    add("", [](const PictureMetric&) { return true; });
    add(kEncoded, [](const PictureMetric& metric) { return metric.encoded; });
    for (const char* region : {"interior.", "edge."}) {
        if (edge_band_px) add(region, [](const PictureMetric& metric) { return metric.masked; });
    }
    if (oiio) all.insert(all.end(), {"oiio.warnings", "oiio.failures", "oiio.yee_failures"});
    return all;
}

Figures PictureComparison::measure(const std::string& test, const std::string& reference, Report& report) const {
    const CommonPixels common = report.timed("read", [&] { return read_common(test, reference, report); });
    const Image &a = common.a, &b = common.b;
    const PicturePair pair(a, b, pixels_per_degree);
    Figures figures;
    for (const PictureMetric& metric : picture_metrics()) {
        if (!takes(metric)) continue;
        const std::string stage(metric.stage);
        figures.put(std::string(metric.name), report.timed(stage.c_str(), [&] { return metric.measure(pair); }));
    }
    if (asked.contains("hdr")) {
        const HdrFlipResult& found = pair.hdr_flip();
        report["exposures"] = {{"start", found.start}, {"stop", found.stop}, {"count", found.exposures}};
    }
    report.timed("srgb8", [&] {
        for (const PictureMetric& metric : picture_metrics()) {
            if (metric.encoded) figures.put(kEncoded + std::string(metric.name), metric.of(pair.on_screen(), {}));
        }
    });
    report["pixels_per_degree"] = pixels_per_degree;  // of flip
    if (edge_band_px) measure_regions(pair, figures);
    if (asked.contains("optical-depth")) warn_of_opaque(pair, report);
    if (oiio) {
        report.timed("oiio", [&] {
            const OiioMetrics metrics = compare_oiio(a, b);
            figures.put("oiio.warnings", static_cast<double>(metrics.warnings));
            figures.put("oiio.failures", static_cast<double>(metrics.failures));
            figures.put("oiio.yee_failures", static_cast<double>(compare_yee(a, b)));
        });
    }
    if (!heatmap.empty()) draw(pair, report);
    return figures;
}

void PictureComparison::warn_of_opaque(const PicturePair& pair, Report& report) {
    const std::size_t saturated =
        std::max(subvol::optical_depth(pair.test()).saturated, subvol::optical_depth(pair.reference()).saturated);
    if (saturated == 0) return;
    report.warn(text(saturated,
                     " pixels are nearly opaque, so their optical depth is inaccurate; render with a larger "
                     "--opacity-unit"));
}

void PictureComparison::measure_regions(const PicturePair& pair, Figures& figures) const {
    const ImageRegions regions = silhouette_regions(pair.reference(), *edge_band_px, parse_vector("--background", background));
    const auto put = [&](const std::string& name, const PixelMask& mask) {
        if (std::ranges::find(mask, 1) == mask.end()) {
            throw Error(ErrorCode::InvalidInput, "the second picture's object has no " + name, "--edge-band",
                        "a narrower band, or another --background");
        }
        for (const PictureMetric& metric : picture_metrics()) {
            if (metric.masked) figures.put(name + "." + std::string(metric.name), metric.of(pair, mask));
        }
    };
    put("interior", regions.interior);
    put("edge", regions.edge);
}

void PictureComparison::draw(const PicturePair& pair, Report& report) const {
    const MetricMap map = heatmap_of == "abs"    ? difference_map(pair.test(), pair.reference())
                          : heatmap_of == "flip" ? pair.flip().map
                                                 : dissimilarity(pair.on_screen().luminance_ssim().map);
    report.timed("write", [&] { write_image(heatmap, subvol::heatmap(map, heatmap_scale.value_or(0))); });
    report["heatmap"] = heatmap;
}

}  // namespace subvol::cli
