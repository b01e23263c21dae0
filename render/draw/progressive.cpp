// SPDX-License-Identifier: Apache-2.0
#include "subvol/progressive.h"

#include <algorithm>
#include <optional>
#include <string>

#include "deadline.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

/// Each pixel as a square of scale² pixels.
template <class T>
std::vector<T> enlarge(const std::vector<T>& small, std::size_t channels, int small_width, int scale, int width, int height) {
    std::vector<T> large;
    large.reserve(channels * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto at = static_cast<std::size_t>(y / scale) * static_cast<std::size_t>(small_width) +
                            static_cast<std::size_t>(x / scale);
            large.insert(large.end(), small.begin() + static_cast<std::ptrdiff_t>(channels * at),
                         small.begin() + static_cast<std::ptrdiff_t>(channels * (at + 1)));
        }
    }
    return large;
}

void check(const ProgressiveOptions& options) {
    if (!(options.seconds > 0)) {
        throw Error(ErrorCode::InvalidInput, "the time is " + std::to_string(options.seconds), {},
                    "a positive number of seconds");
    }
    for (const double px : options.footprint_px) {
        if (!(px > 0))
            throw Error(ErrorCode::InvalidInput, "a footprint is " + std::to_string(px), {}, "a positive number of pixels");
    }
}

class Progressive {
public:
    Progressive(const HexMesh& mesh, const View& view, const Optics& optics, const ProgressiveOptions& options)
        : mesh_(mesh), view_(view), optics_(optics), options_(options), deadline_(options.progress, options.seconds) {}

    ProgressiveResult run() {
        RbfVolume volume = sample({});
        draw_at(volume, 4, 0);
        deadline_.arm();
        try {
            draw_at(volume, 2, 0);
            draw_at(volume, 1, 0);
            for (const double px : options_.footprint_px) {
                RbfVolume finer = sample(px);
                if (finer.size() <= volume.size()) continue;
                volume = std::move(finer);
                draw_at(volume, 1, px);
            }
        } catch (const Error& error) {
            if (error.code() != ErrorCode::Cancelled || deadline_.stopped()) throw;
        }
        result_.seconds = deadline_.elapsed();
        return std::move(result_);
    }

private:
    [[nodiscard]] RbfVolume sample(std::optional<double> footprint_px) {
        SampleOptions options = options_.sample;
        options.progress = &deadline_;
        if (footprint_px) {
            options.footprint = Footprint{.camera = view_.camera(),
                                          .width_px = view_.width(),
                                          .height_px = view_.height(),
                                          .spacing_px = *footprint_px,
                                          .least_cell_px = *footprint_px};
        }
        return sample_rbf_points(mesh_, options).volume;
    }

    [[nodiscard]] SplatOptions splat_options(int scale) {
        SplatOptions options = options_.splat;
        options.sheets = std::max(2, options.sheets / scale);
        if (scale > 1) options.samples = 1;
        options.progress = &deadline_;
        return options;
    }

    void draw_at(const RbfVolume& volume, int scale, double footprint_px) {
        const int width = (view_.width() + scale - 1) / scale, height = (view_.height() + scale - 1) / scale;
        SplatResult drawn = render_splats(volume, View(view_.camera(), width, height), optics_, splat_options(scale));
        if (scale > 1) {
            drawn.image.rgba = enlarge(drawn.image.rgba, 4, width, scale, view_.width(), view_.height());
            drawn.depth = enlarge(drawn.depth, 1, width, scale, view_.width(), view_.height());
            drawn.image.width = view_.width();
            drawn.image.height = view_.height();
        }
        result_.splat = std::move(drawn);
        result_.picture_scale = scale;
        result_.footprint_px = footprint_px;
        ++result_.steps;
        deadline_.picture(result_.splat.image);
    }

    const HexMesh& mesh_;
    const View& view_;
    const Optics& optics_;
    const ProgressiveOptions& options_;
    Deadline deadline_;
    ProgressiveResult result_;
};

}  // namespace

ProgressiveResult render_progressively(const HexMesh& mesh, const View& view, const Optics& optics,
                                       const ProgressiveOptions& options) {
    check(options);
    return Progressive(mesh, view, optics, options).run();
}

}  // namespace subvol
