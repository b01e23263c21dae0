// SPDX-License-Identifier: Apache-2.0
#include "picture_shares.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "part_kinds.h"
#include "ranked_bricks.h"
#include "subvol/detail/kernel_bytes.h"
#include "subvol/detail/points_range.h"

namespace subvol::cli {
namespace {

/// Whether a pixel may depend on a kernel that does not touch it.
bool needs_all(const RbfVolume& volume, const SplatOptions& options) {
    return volume.boundary.triangles.empty() || options.shadows || options.ambient_occlusion > 0;
}

/// The kernels of a volume without those that touch no row of a share; all of them if a pixel may depend on any kernel: without
/// a boundary, and with shadows or ambient occlusion. The picture of these has the bits of the whole one in the share's rows.
///
/// options: get the number of sheets of the whole picture
RbfVolume kernels_of_rows(RbfVolume volume, const Share& share, const View& view, const Optics& optics, SplatOptions& options) {
    if (needs_all(volume, options) || volume.size() == 0) return volume;
    options.sheets = sheets_of_picture(volume, view, options);
    RbfVolume chosen =
        detail::chosen_kernels(volume, touching(rows_of_kernels(volume, view, optics, options), rows_of(share, view.height())));
    chosen.boundary = std::move(volume.boundary);
    return chosen;
}

/// Sends every rank the kernels that touch its rows of the picture, in the order of all kernels, and the number of sheets of
/// the picture of all.
///
/// own:     the kernels of this rank, and the whole boundary
/// options: get the number of sheets of the whole picture
/// returns: those for this rank's rows, and the boundary
RbfVolume ship_kernels(const RbfVolume& own, const View& view, const Optics& optics, SplatOptions& options, Ranks& ranks,
                       ShippedKernels& shipped) {
    const bool all = needs_all(own, options);
    std::vector<PixelRows> touched;
    if (!all) {
        options.sheets = sheets_of_picture(own, view, options, [&](auto& counts) { ranks.sum(counts); });
        if (own.size() > 0) touched = rows_of_kernels(own, view, optics, options);
    }
    std::vector<std::string> to;
    for (int rank = 0; rank < ranks.size(); ++rank) {
        const PixelRows rows = rows_of(ranks.share_of(rank), view.height());
        const RbfVolume chosen = all ? own : detail::chosen_kernels(own, touching(touched, rows));
        to.push_back(detail::bytes_of_kernels(chosen, /*with_boundary=*/false));
        if (rank == ranks.rank()) continue;
        shipped.kernels += chosen.size();
        shipped.bytes += to.back().size();
    }
    RbfVolume result;
    const std::vector<std::string> got = ranks.exchange(std::move(to));
    for (std::size_t rank = 0; rank < got.size(); ++rank) {  // in the order of ranks the kernels are in their global order
        RbfVolume next = detail::kernels_from_bytes(got[rank]);
        if (rank == 0) {
            result = std::move(next);
        } else {
            detail::append_kernels(result, next);
        }
    }
    result.boundary = own.boundary;
    return result;
}

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
        SplatResult drawn = splatter.draw(view, optics, progress);
        drawn.report.points = volume.size();  // of the whole picture, not of these rows
        return drawn;
    };
    if (rows_.ranks == nullptr) return drawn_of(kernels_of_rows(volume, *rows_.share, view, optics, options));
    const auto [begin, end] = rows_.share->range(volume.size());
    RbfVolume own = detail::kernels_between(volume, begin, end);
    own.boundary = volume.boundary;
    ShippedKernels shipped;
    const RbfVolume band = ship_kernels(own, view, optics, options, *rows_.ranks, shipped);
    add_shipped(shipped, *rows_.ranks, facts);
    return drawn_of(band);
}

SplatResult PictureShares::splat(const MeshSource& source, Surface boundary, const BrickSplatOptions& options, const View& view,
                                 const Optics& optics, Facts& facts) {
    if (rows_.ranks == nullptr) return render_bricks(source, std::move(boundary), view, optics, options);
    ShippedKernels shipped;
    SplatResult drawn = render_bricks_ranked(source, std::move(boundary), view, optics, options, *rows_.ranks, shipped);
    add_shipped(shipped, *rows_.ranks, facts);
    return drawn;
}

BrickTets PictureShares::measure(const MeshSource& source, const BrickTetsOptions& options) {
    return measure_tets(source, options, rows_);
}

void PictureShares::add_up(std::span<std::size_t> counts) {
    if (!rows_.gathered()) return;
    std::vector<std::int64_t> sums(counts.begin(), counts.end());
    rows_.ranks->sum(sums);
    std::ranges::copy(sums, counts.begin());
}

void PictureShares::gather(Picture& picture) {
    if (!rows_.gathered()) return;
    detail::PicturePart part = rows_of(picture, rows_of(rows_.ranks->share(), picture.image.height));
    auto whole = join_ranks(PictureParts{}, std::move(part), rows_.ranks, nullptr).value;
    if (!whole) return;
    picture.image = std::move(whole->image);
    picture.depth = std::move(whole->depth);
}

}  // namespace subvol::cli
