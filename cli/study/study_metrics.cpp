// SPDX-License-Identifier: Apache-2.0
#include "study_metrics.h"

#include <algorithm>
#include <sstream>
#include <vector>

#include "subvol/flip.h"
#include "subvol/image_metrics.h"
#include "subvol/image_regions.h"
#include "subvol/ssim.h"

namespace subvol::cli {
namespace {

bool any(const PixelMask& mask) {
    return std::ranges::any_of(mask, [](auto pixel) { return pixel != 0; });
}

}  // namespace

std::map<std::string, double> picture_metrics(const Image& image, const Image& reference, const std::string& names) {
    const ImageMetrics all = compare_images(image, reference);
    const ImageRegions regions = silhouette_regions(reference);
    std::optional<FlipResult> seen;
    const auto flip_of = [&]() -> const FlipResult& {
        if (!seen) seen = flip(image, reference);
        return *seen;
    };
    std::map<std::string, double> metrics;
    const auto in_region = [&](const std::string& name, const PixelMask& mask) {
        if (!any(mask)) return;  // the picture has no interior or no edge
        metrics[name] = name.starts_with("psnr") ? compare_images(image, reference, mask).psnr : mean_of(flip_of().map, mask);
    };
    std::istringstream in(names);
    for (std::string name; std::getline(in, name, ',');) {
        if (name == "mse") metrics[name] = all.mse;
        if (name == "rmse") metrics[name] = all.rmse;
        if (name == "mae") metrics[name] = all.mae;
        if (name == "max") metrics[name] = all.max;
        if (name == "psnr") metrics[name] = all.psnr;
        if (name == "ssim") metrics[name] = ssim(srgb8_image(image), srgb8_image(reference)).mean;
        if (name == "flip") metrics[name] = flip_of().mean;
        if (name == "flip_hdr") metrics[name] = hdr_flip(image, reference).mean;
        if (name == "optical_depth") metrics[name] = optical_depth_error(image, reference);
        if (name.ends_with("_interior")) in_region(name, regions.interior);
        if (name.ends_with("_edge")) in_region(name, regions.edge);
    }
    return metrics;
}

}  // namespace subvol::cli
