// SPDX-License-Identifier: Apache-2.0
#include "ranked_bricks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>

#include "subvol/detail/byte_lists.h"
#include "subvol/detail/kernel_bytes.h"
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
        report_progress(options.progress, "sample", static_cast<double>(round) / static_cast<double>(rounds));
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

}  // namespace subvol::cli
