// SPDX-License-Identifier: Apache-2.0
#include "subvol/splat_shares.h"

#include "sheet_count.h"
#include "tile_finder.h"

namespace subvol {

namespace {

/// The view whose pixels are the samples, as `Splatter` draws it.
View fine_view(const View& view, const SplatOptions& options) {
    return view.resized(options.samples * view.width(), options.samples * view.height());
}

}  // namespace

static_assert(kRowsOfTile == detail::SplatFrame::kTile_px);

PixelRows rows_of(const Share& share, int height) {
    const auto tiles = static_cast<std::size_t>((height + kRowsOfTile - 1) / kRowsOfTile);
    const auto [begin, end] = share.range(tiles);
    return {std::min(kRowsOfTile * static_cast<int>(begin), height), std::min(kRowsOfTile * static_cast<int>(end), height)};
}

int sheets_of_picture(const RbfVolume& volume, const View& view, const SplatOptions& options, const detail::SumCounts& sum) {
    if (options.sheets != 0) return options.sheets;
    const detail::SplatScene scene = detail::make_scene(volume, options);
    const View fine = fine_view(view, options);
    detail::SheetCounts counts{{}, scene.bends};
    detail::count_reaches(scene, fine, volume, counts.reaches);
    counts.add_up(sum);
    return detail::sheets_needed(scene, detail::depth_range_of(scene, fine), counts);
}

std::vector<PixelRows> rows_of_kernels(const RbfVolume& volume, const View& view, const Optics& optics,
                                       const SplatOptions& options) {
    const detail::SplatScene scene = detail::make_scene(volume, options);
    const View fine = fine_view(view, options);
    detail::SplatFrame frame;
    frame.scene = &scene;
    frame.view = &fine;
    frame.sheets = detail::make_sheets(scene, fine, options.sheets);
    frame.tiles_x = (fine.width() + kRowsOfTile - 1) / kRowsOfTile;
    frame.tiles_y = (fine.height() + kRowsOfTile - 1) / kRowsOfTile;
    detail::eye_splats(frame.kernels, scene, fine, detail::classify(scene, optics));
    const detail::TileFinder finder(frame);
    std::vector<PixelRows> rows(volume.size(), PixelRows{0, 0});
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const detail::TileRect tiles = finder.find(frame.kernels.splats[i]);
        if (tiles.x1 < tiles.x0 || tiles.y1 < tiles.y0) continue;
        rows[i] = {kRowsOfTile * (tiles.y0 / options.samples), kRowsOfTile * (tiles.y1 / options.samples + 1)};
    }
    return rows;
}

std::vector<std::size_t> touching(std::span<const PixelRows> kernels, const PixelRows& rows) {
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < kernels.size() && rows.first < rows.end; ++i) {
        if (kernels[i].first < rows.end && kernels[i].end > rows.first) numbers.push_back(i);
    }
    return numbers;
}

}  // namespace subvol
