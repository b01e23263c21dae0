// SPDX-License-Identifier: Apache-2.0
#include "ranked_splats.h"

#include <algorithm>
#include <cstring>

#include "subvol/detail/kernel_bytes.h"
#include "subvol/detail/points_range.h"
#include "subvol/splat_shares.h"

namespace subvol::cli {
namespace {

/// Whether a pixel may depend on a kernel that does not touch it.
bool needs_all(const RbfVolume& volume, const SplatOptions& options) {
    return volume.boundary.triangles.empty() || options.shadows || options.ambient_occlusion > 0;
}

int bands_in(int height) {
    return (height + kBandRows - 1) / kBandRows;
}

/// The numbers of the kernels that touch a band of a share.
std::vector<std::size_t> touching(std::span<const KernelBands> bands, const Share& share, int height) {
    const auto [begin, end] = share.range(static_cast<std::size_t>(bands_in(height)));
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < bands.size(); ++i) {
        if (bands[i].last >= static_cast<int>(begin) && bands[i].first < static_cast<int>(end)) numbers.push_back(i);
    }
    return numbers;
}

template <class T>
void append(std::string& bytes, std::span<const T> items) {
    bytes.append(reinterpret_cast<const char*>(items.data()), items.size_bytes());
}

/// The rows of a share in the lists of a picture: pixels of `each` floats.
template <class Floats>
auto rows_in(Floats& floats, const PixelRows& rows, int width, std::size_t each) {
    const auto columns = static_cast<std::size_t>(width) * each;
    return std::span(floats).subspan(static_cast<std::size_t>(rows.first) * columns,
                                     static_cast<std::size_t>(rows.end - rows.first) * columns);
}

}  // namespace

PixelRows rows_of(const Share& share, int height) {
    const auto [begin, end] = share.range(static_cast<std::size_t>(bands_in(height)));
    return {std::min(kBandRows * static_cast<int>(begin), height), std::min(kBandRows * static_cast<int>(end), height)};
}

RbfVolume kernels_of_rows(RbfVolume volume, const Share& share, const View& view, const Optics& optics, SplatOptions& options) {
    if (needs_all(volume, options) || volume.size() == 0) return volume;
    std::vector<float> reaches = kernel_reaches(volume, view, options);
    const auto finest = reaches.begin() + static_cast<std::ptrdiff_t>(place_of_finest_reach(reaches.size()));
    std::nth_element(reaches.begin(), finest, reaches.end());
    options.sheets = sheets_of_picture(volume, view, options, *finest);
    RbfVolume chosen =
        detail::chosen_kernels(volume, touching(bands_of_kernels(volume, view, optics, options), share, view.height()));
    chosen.boundary = std::move(volume.boundary);
    return chosen;
}

RbfVolume ship_kernels(const RbfVolume& own, const View& view, const Optics& optics, SplatOptions& options, Ranks& ranks,
                       ShippedKernels& shipped) {
    const bool all = needs_all(own, options);
    std::vector<std::int64_t> count{static_cast<std::int64_t>(own.size())};
    ranks.sum(count);
    std::vector<KernelBands> bands;
    if (!all && count.front() > 0) {
        if (options.sheets == 0) {
            const std::size_t place = place_of_finest_reach(static_cast<std::size_t>(count.front()));
            options.sheets = sheets_of_picture(own, view, options, ranks.in_place(kernel_reaches(own, view, options), place));
        }
        bands = bands_of_kernels(own, view, optics, options);
    }
    std::vector<std::string> to;
    for (int rank = 0; rank < ranks.size(); ++rank) {
        const RbfVolume chosen = all ? own : detail::chosen_kernels(own, touching(bands, ranks.share_of(rank), view.height()));
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
    const int width = picture.image.width, height = picture.image.height;
    const PixelRows mine = rows_of(ranks.share(), height);
    std::string bytes;
    if (!ranks.first()) {
        append<float>(bytes, rows_in(picture.image.rgba, mine, width, 4));
        if (!picture.depth.empty()) append<float>(bytes, rows_in(picture.depth, mine, width, 1));
    }
    const std::vector<std::string> got = ranks.gather(std::move(bytes));
    for (std::size_t rank = 1; rank < got.size(); ++rank) {
        const PixelRows rows = rows_of(ranks.share_of(static_cast<int>(rank)), height);
        const auto rgba = rows_in(picture.image.rgba, rows, width, 4);
        if (!rgba.empty()) std::memcpy(rgba.data(), got[rank].data(), rgba.size_bytes());
        if (picture.depth.empty()) continue;
        const auto depth = rows_in(picture.depth, rows, width, 1);
        if (!depth.empty()) std::memcpy(depth.data(), got[rank].data() + rgba.size_bytes(), depth.size_bytes());
    }
}

void add_up(const OwnRows& rows, std::span<std::size_t> counts) {
    if (!rows.gathered()) return;
    std::vector<std::int64_t> sums(counts.begin(), counts.end());
    rows.ranks->sum(sums);
    std::ranges::copy(sums, counts.begin());
}

}  // namespace subvol::cli
