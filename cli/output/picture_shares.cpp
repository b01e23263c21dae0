// SPDX-License-Identifier: Apache-2.0
// A picture by several processes, each of which draws the rows of its share.
//
//     alone (a part as a file)   all kernels are at hand; those that touch no row of the share are left out
//     ranks                      each rank takes a range of the kernels and sends every rank those that touch its rows
//
//              kernels 0 … n/2 ─ rank 0 ─┬──────► rows of rank 0 ─┐
//                                        ╳                        ├─► rank 0 joins the rows
//              kernels n/2 … n ─ rank 1 ─┴──────► rows of rank 1 ─┘
//
// Kernels arrive in the order of ranks, which is their order in the whole volume, so that the rows have the bits of one
// process. Without a boundary, and with shadows or ambient occlusion, a pixel may depend on any kernel: then every rank gets
// all of them. A mesh in pieces is sampled piece by piece. All ranks take part in as many rounds, because they exchange
// kernels in each; a rank without a piece left sends none. The numbers of tetrahedra of pieces, and their boxes, are gathered
// and added up likewise.
#include "picture_shares.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "part_kinds.h"
#include "subvol/detail/byte_lists.h"
#include "subvol/detail/kernel_rows.h"
#include "subvol/detail/points_range.h"
#include "subvol/splat_shares.h"

namespace subvol::cli {

namespace {

/// Kernels, and their numbers in the whole mesh.
struct NumberedKernels {
    RbfVolume volume;
    std::vector<std::uint64_t> numbers;
};

std::string packed(const RbfVolume& volume, const std::vector<std::uint64_t>& numbers) {
    if (numbers.empty()) return {};
    detail::BytePacker out;
    out.put(numbers);
    return out.take() + detail::bytes_of_kernels(volume, /*with_boundary=*/false);
}

NumberedKernels unpacked(const std::string& bytes) {
    NumberedKernels kernels;
    if (bytes.empty()) return kernels;
    detail::ByteUnpacker in(bytes, "these bytes are not kernels");
    in.take(kernels.numbers);
    kernels.volume = detail::kernels_from_bytes(in.rest());
    return kernels;
}

std::string packed(const BrickTets& tets) {
    detail::BytePacker out;
    out.put(std::array{tets.bounds});
    out.put(std::array{tets.overhang});
    out.put(std::array{tets.tets, tets.degenerate_tets, tets.inverted_tets});
    out.put(tets.of_bricks);
    return out.take();
}

BrickTets take_tets(detail::ByteUnpacker& in) {
    std::vector<Box> bounds;
    std::vector<double> overhang;
    std::vector<std::size_t> counts;
    BrickTets tets;
    in.take(bounds);
    in.take(overhang);
    in.take(counts);
    in.take(tets.of_bricks);
    tets.bounds = bounds.at(0);
    tets.overhang = overhang.at(0);
    tets.tets = counts.at(0);
    tets.degenerate_tets = counts.at(1);
    tets.inverted_tets = counts.at(2);
    return tets;
}

/// Samples this rank's pieces. All ranks take as many rounds, so that they can exchange kernels in each; those that have no
/// piece left have no kernels.
void sample_in_rounds(const MeshSource& source, const SampleOptions& options, const Ranks& ranks,
                      const std::function<void(const PieceKernels&)>& take) {
    const MeshSource::Stored stored = source.in_pieces();
    const auto [begin, end] = ranks.share().range(stored.pieces.size());
    const std::size_t rounds = ranks.share_of(0).range(stored.pieces.size()).second;  // no rank has more than the first
    SampleOptions quiet = options;
    quiet.progress = nullptr;
    for (std::size_t round = 0; round < rounds; ++round) {
        report_progress(options.progress, "sample", round, rounds);
        PieceKernels kernels;
        if (begin + round < end) kernels = sample_piece(source, stored.read(begin + round), quiet);
        take(kernels);
    }
}

}  // namespace

BrickPointsReport write_points_ranked(const std::filesystem::path& path, const MeshSource& source, const SampleOptions& options,
                                      Ranks& ranks) {
    BrickPointsReport report{.min = HUGE_VAL, .max = -HUGE_VAL};
    Surface boundary;
    if (ranks.first()) boundary = sample_boundary(gather_hull(source, options.progress), options);
    report.triangles = boundary.triangles.size();
    std::optional<detail::KernelRows> rows;
    sample_in_rounds(source, options, ranks, [&](const PieceKernels& kernels) {
        report.flat_frames += kernels.flat_frames;
        for (const std::string& bytes : ranks.gather(packed(kernels.volume, kernels.numbers))) {
            const auto [volume, numbers] = unpacked(bytes);
            if (numbers.empty()) continue;
            if (!rows) rows.emplace(path, volume, source.stored().points, boundary, std::string(), options.progress);
            rows->write(numbers, volume);
            report.points += numbers.size();
            for (const float value : volume.channels.front().values) {
                report.min = std::min(report.min, static_cast<double>(value));
                report.max = std::max(report.max, static_cast<double>(value));
            }
        }
    });
    if (rows) rows->finish();
    return report;
}

namespace {

/// `render_bricks` by all ranks: each samples a range of the pieces, one after the other, and sends every rank the kernels that
/// may touch its rows. The rows of this rank are drawn.
SplatResult render_bricks_ranked(const MeshSource& source, Surface boundary, const View& view, const Optics& optics,
                                 BrickSplatOptions options, Ranks& ranks, ShippedKernels& shipped) {
    options.rows = rows_of(ranks.share(), view.height());
    BrickPicture picture(std::move(boundary), view, optics, options);
    SampleOptions sample = options.sample;
    sample.progress = options.splat.progress;
    sample_in_rounds(source, sample, ranks, [&](const PieceKernels& own) {
        picture.count(own.volume);
        const std::vector<PixelRows> touched = picture.rows_of(own.volume);
        std::vector<std::string> to;
        for (int rank = 0; rank < ranks.size(); ++rank) {
            const std::vector<std::size_t> places = touching(touched, rows_of(ranks.share_of(rank), view.height()));
            std::vector<std::uint64_t> numbers;
            for (const std::size_t place : places) numbers.push_back(own.numbers[place]);
            to.push_back(packed(detail::chosen_kernels(own.volume, places), numbers));
            if (rank == ranks.rank()) continue;
            shipped.kernels += numbers.size();
            shipped.bytes += to.back().size();
        }
        for (const std::string& bytes : ranks.exchange(std::move(to))) {
            const auto [volume, numbers] = unpacked(bytes);
            picture.add(volume, numbers);
        }
    });
    return picture.draw([&](auto& counts) { ranks.sum(counts); });
}

/// `measure_tets` of all pieces: of ranks that draw one picture together, each measures a range of them.
BrickTets measure_tets(const MeshSource& source, const BrickTetsOptions& options, const OwnRows& rows) {
    const std::size_t pieces = source.in_pieces().pieces.size();
    if (!rows.gathered()) return subvol::measure_tets(source, options, 0, pieces);
    const auto [begin, end] = rows.share->range(pieces);
    std::string all;
    for (const std::string& bytes : rows.ranks->gather(packed(subvol::measure_tets(source, options, begin, end)))) all += bytes;
    all = rows.ranks->broadcast(std::move(all));
    BrickTets sum;
    for (detail::ByteUnpacker in(all, "these bytes are not the figures of bricks"); in.left() > 0;) sum.add(take_tets(in));
    return sum;
}

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
    options.needed_sheets = sheets_of_picture(volume, view, options);
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
        options.needed_sheets = sheets_of_picture(own, view, options, [&](auto& counts) { ranks.sum(counts); });
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
