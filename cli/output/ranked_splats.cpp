// SPDX-License-Identifier: Apache-2.0
#include "ranked_splats.h"

#include <algorithm>

#include "part_kinds.h"
#include "subvol/detail/kernel_bytes.h"
#include "subvol/detail/points_range.h"
#include "subvol/splat_shares.h"

namespace subvol::cli {
namespace {

/// Whether a pixel may depend on a kernel that does not touch it.
bool needs_all(const RbfVolume& volume, const SplatOptions& options) {
    return volume.boundary.triangles.empty() || options.shadows || options.ambient_occlusion > 0;
}

}  // namespace

RbfVolume kernels_of_rows(RbfVolume volume, const Share& share, const View& view, const Optics& optics, SplatOptions& options) {
    if (needs_all(volume, options) || volume.size() == 0) return volume;
    options.sheets = sheets_of_picture(volume, view, options);
    RbfVolume chosen =
        detail::chosen_kernels(volume, touching(rows_of_kernels(volume, view, optics, options), rows_of(share, view.height())));
    chosen.boundary = std::move(volume.boundary);
    return chosen;
}

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

void gather_rows(Picture& picture, Ranks& ranks) {
    detail::PicturePart own = rows_of(picture, rows_of(ranks.share(), picture.image.height));
    auto whole = join_ranks(PictureParts{}, std::move(own), &ranks, nullptr).value;
    if (!whole) return;
    picture.image = std::move(whole->image);
    picture.depth = std::move(whole->depth);
}

void add_up(const OwnRows& rows, std::span<std::size_t> counts) {
    if (!rows.gathered()) return;
    std::vector<std::int64_t> sums(counts.begin(), counts.end());
    rows.ranks->sum(sums);
    std::ranges::copy(sums, counts.begin());
}

}  // namespace subvol::cli
