// SPDX-License-Identifier: Apache-2.0
#include "picture_shares.h"

#include <cstdint>
#include <utility>

#include "ranked_bricks.h"
#include "subvol/detail/points_range.h"

namespace subvol::cli {
namespace {

/// What all ranks have sent.
void add_shipped(const ShippedKernels& shipped, Ranks& ranks, Facts& facts) {
    std::vector<std::int64_t> counts{static_cast<std::int64_t>(shipped.kernels), static_cast<std::int64_t>(shipped.bytes)};
    ranks.sum(counts);
    facts["kernels_shipped"] = counts[0];
    facts["kernel_bytes_sent"] = counts[1];
}

}  // namespace

SplatResult PictureShares::splat(const RbfVolume& volume, const SplatOptions& splat, const BoundaryValues& skin,
                                 const View& view, const Optics& optics, Progress* progress, Facts& facts) {
    SplatOptions options = splat;
    const auto drawn_of = [&](const RbfVolume& band) {
        Splatter splatter(band, options);
        if (!skin.values.empty()) splatter.set_boundary_colors(skin.surface, skin.values.back());
        return splatter.draw(view, optics, progress);
    };
    if (rows_.ranks == nullptr) return drawn_of(kernels_of_rows(volume, *rows_.share, view, optics, options));
    const auto [begin, end] = rows_.share->range(volume.size());
    RbfVolume own = detail::kernels_between(volume, begin, end);
    own.boundary = volume.boundary;
    ShippedKernels shipped;
    const RbfVolume band = ship_kernels(own, view, optics, options, *rows_.ranks, shipped);
    add_shipped(shipped, *rows_.ranks, facts);
    SplatResult drawn = drawn_of(band);
    drawn.report.points = volume.size();
    return drawn;
}

SplatResult PictureShares::splat(const Bricks& bricks, const BrickFields& fields, Surface boundary,
                                 const BrickSplatOptions& options, const View& view, const Optics& optics, Facts& facts) {
    if (rows_.ranks == nullptr) return render_bricks(bricks, fields, std::move(boundary), view, optics, options);
    ShippedKernels shipped;
    SplatResult drawn = render_bricks_ranked(bricks, fields, std::move(boundary), view, optics, options, *rows_.ranks, shipped);
    add_shipped(shipped, *rows_.ranks, facts);
    return drawn;
}

BrickTets PictureShares::measure(const Bricks& bricks, const BrickTetsOptions& options) {
    return measure_tets(bricks, options, rows_);
}

void PictureShares::add_up(std::span<std::size_t> counts) {
    cli::add_up(rows_, counts);
}

void PictureShares::gather(Picture& picture) {
    if (rows_.gathered()) gather_rows(picture, *rows_.ranks);
}

}  // namespace subvol::cli
