// SPDX-License-Identifier: Apache-2.0
#include "subvol/splat_shares.h"

#include "sheet_count.h"
#include "tile_finder.h"

namespace subvol {

namespace {

/// The view whose pixels are the samples, as `Splatter` draws it.
View fine_view(const View& view, const SplatOptions& options) {
    return {view.camera(), options.samples * view.width(), options.samples * view.height()};
}

}  // namespace

static_assert(kBandRows == detail::SplatFrame::kTile_px);

std::vector<float> kernel_reaches(const RbfVolume& volume, const View& view, const SplatOptions& options) {
    return detail::depth_reaches(detail::make_scene(volume, options), fine_view(view, options));
}

std::size_t place_of_finest_reach(std::size_t kernels) {
    return detail::place_of_finest(kernels);
}

int sheets_of_picture(const RbfVolume& volume, const View& view, const SplatOptions& options, float finest_reach) {
    if (options.sheets != 0) return options.sheets;
    const auto [min, max, near] = detail::depth_range_of(detail::make_scene(volume, options), fine_view(view, options));
    return detail::sheets_for_reach(finest_reach, max - min);
}

std::vector<KernelBands> bands_of_kernels(const RbfVolume& volume, const View& view, const Optics& optics,
                                          const SplatOptions& options) {
    const detail::SplatScene scene = detail::make_scene(volume, options);
    const View fine = fine_view(view, options);
    detail::SplatFrame frame;
    frame.scene = &scene;
    frame.view = &fine;
    frame.sheets = detail::make_sheets(scene, fine, options.sheets);
    frame.tiles_x = (fine.width() + kBandRows - 1) / kBandRows;
    frame.tiles_y = (fine.height() + kBandRows - 1) / kBandRows;
    detail::eye_splats(frame.kernels, scene, fine, detail::classify(scene, optics));
    const detail::TileFinder finder(frame);
    std::vector<KernelBands> bands(volume.size());
    for (std::size_t i = 0; i < bands.size(); ++i) {
        const detail::TileRect tiles = finder.find(frame.kernels.splats[i]);
        if (tiles.x1 < tiles.x0 || tiles.y1 < tiles.y0) continue;
        bands[i] = {tiles.y0 / options.samples, tiles.y1 / options.samples};
    }
    return bands;
}

}  // namespace subvol
