// SPDX-License-Identifier: Apache-2.0
#include "ranked_bricks.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <type_traits>

#include "subvol/detail/kernel_bytes.h"
#include "subvol/detail/kernel_rows.h"
#include "subvol/detail/points_range.h"
#include "subvol/splat_shares.h"

namespace subvol::cli {
namespace {

/// Kernels with their numbers in the whole mesh: the numbers behind their count, then the kernels.
std::string packed(const RbfVolume& volume, const std::vector<std::uint64_t>& numbers) {
    if (numbers.empty()) return {};
    const std::uint64_t count = numbers.size();
    std::string bytes(reinterpret_cast<const char*>(&count), sizeof count);
    bytes.append(reinterpret_cast<const char*>(numbers.data()), count * sizeof count);
    return bytes += detail::bytes_of_kernels(volume, /*with_boundary=*/false);
}

struct NumberedKernels {
    RbfVolume volume;
    std::vector<std::uint64_t> numbers;
};

NumberedKernels unpacked(const std::string& bytes) {
    NumberedKernels kernels;
    if (bytes.empty()) return kernels;
    std::uint64_t count = 0;
    std::memcpy(&count, bytes.data(), sizeof count);
    kernels.numbers.resize(count);
    std::memcpy(kernels.numbers.data(), bytes.data() + sizeof count, count * sizeof count);
    kernels.volume = detail::kernels_from_bytes(std::string_view(bytes).substr((count + 1) * sizeof count));
    return kernels;
}

/// The figures of bricks, then their number and their boxes.
struct PackedTets {
    Box bounds;
    double overhang = 0;
    std::size_t tets = 0, degenerate_tets = 0, inverted_tets = 0, bricks = 0;
};
static_assert(std::is_trivially_copyable_v<PackedTets>);

std::string packed(const BrickTets& of) {
    const PackedTets figures{of.bounds, of.overhang, of.tets, of.degenerate_tets, of.inverted_tets, of.of_bricks.size()};
    std::string bytes(reinterpret_cast<const char*>(&figures), sizeof figures);
    return bytes.append(reinterpret_cast<const char*>(of.of_bricks.data()), of.of_bricks.size() * sizeof(Box));
}

/// at: where they begin; gets where they end
BrickTets unpacked_tets(const std::string& bytes, std::size_t& at) {
    PackedTets of;
    std::memcpy(&of, bytes.data() + at, sizeof of);
    at += sizeof of;
    BrickTets tets{.bounds = of.bounds,
                   .of_bricks = std::vector<Box>(of.bricks),
                   .overhang = of.overhang,
                   .tets = of.tets,
                   .degenerate_tets = of.degenerate_tets,
                   .inverted_tets = of.inverted_tets};
    if (of.bricks > 0) std::memcpy(tets.of_bricks.data(), bytes.data() + at, of.bricks * sizeof(Box));
    at += of.bricks * sizeof(Box);
    return tets;
}

/// Samples this rank's bricks. All ranks take as many rounds, so that they can exchange kernels in each; those that have no
/// brick left have no kernels.
void sample_in_rounds(const Bricks& bricks, const SampleOptions& options, const BrickFields& fields, const Ranks& ranks,
                      const std::function<void(const BrickPoints&)>& take) {
    const auto [begin, end] = ranks.share().range(bricks.bricks.size());
    const std::size_t rounds = ranks.share_of(0).range(bricks.bricks.size()).second;  // no rank has more than the first
    SampleOptions quiet = options;
    quiet.progress = nullptr;
    for (std::size_t round = 0; round < rounds; ++round) {
        report_progress(options.progress, "sample", static_cast<double>(round) / static_cast<double>(rounds));
        BrickPoints points;
        if (begin + round < end) {
            BrickMesh brick = read_brick(bricks, begin + round);
            brick.mesh = fields(std::move(brick.mesh));
            points = sample_brick(bricks, std::move(brick), quiet);
        }
        take(points);
    }
}

}  // namespace

BrickPointsReport write_points_ranked(const std::filesystem::path& path, const Bricks& bricks, const SampleOptions& options,
                                      const BrickFields& fields, Ranks& ranks) {
    BrickPointsReport report{.min = HUGE_VAL, .max = -HUGE_VAL};
    Surface boundary;
    if (ranks.first()) boundary = sample_bricks_boundary(bricks, options);
    report.triangles = boundary.triangles.size();
    std::optional<detail::KernelRows> rows;
    sample_in_rounds(bricks, options, fields, ranks, [&](const BrickPoints& points) {
        report.flat_frames += points.flat_frames;
        for (const std::string& bytes : ranks.gather(packed(points.volume, points.numbers))) {
            const auto [volume, numbers] = unpacked(bytes);
            if (numbers.empty()) continue;
            if (!rows) rows.emplace(path, volume, bricks.points, boundary, std::string(), options.progress);
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

SplatResult render_bricks_ranked(const Bricks& bricks, const BrickFields& fields, Surface boundary, const View& view,
                                 const Optics& optics, BrickSplatOptions options, Ranks& ranks, ShippedKernels& shipped) {
    options.rows = rows_of(ranks.share(), view.height());
    BrickPicture picture(std::move(boundary), view, optics, options);
    std::vector<float> reaches;
    SampleOptions sample = options.sample;
    sample.progress = options.splat.progress;
    std::vector<std::int64_t> points(1);
    sample_in_rounds(bricks, sample, fields, ranks, [&](const BrickPoints& own) {
        points[0] += static_cast<std::int64_t>(own.numbers.size());
        if (options.splat.sheets == 0) {
            const std::vector<float> more = picture.reaches(own.volume);
            reaches.insert(reaches.end(), more.begin(), more.end());
        }
        const std::vector<PixelRows> touched = picture.rows_of(own.volume);
        std::vector<std::string> to;
        for (int rank = 0; rank < ranks.size(); ++rank) {
            const PixelRows rows = rows_of(ranks.share_of(rank), view.height());
            std::vector<std::size_t> places;
            std::vector<std::uint64_t> numbers;
            for (std::size_t i = 0; i < touched.size(); ++i) {
                if (touched[i].first >= rows.end || touched[i].end <= rows.first) continue;
                places.push_back(i);
                numbers.push_back(own.numbers[i]);
            }
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
    ranks.sum(points);
    const auto count = static_cast<std::size_t>(points[0]);
    float finest = 0;
    if (options.splat.sheets == 0 && count > 0) finest = ranks.in_place(reaches, place_of_finest_reach(count));
    SplatResult drawn = picture.draw(finest);
    drawn.report.points = count;
    return drawn;
}

BrickTets measure_tets(const Bricks& bricks, const BrickTetsOptions& options, const OwnRows& rows) {
    if (!rows.gathered()) return subvol::measure_tets(bricks, options, 0, bricks.bricks.size());
    const auto [begin, end] = rows.share->range(bricks.bricks.size());
    std::string all;
    for (const std::string& bytes : rows.ranks->gather(packed(subvol::measure_tets(bricks, options, begin, end)))) all += bytes;
    all = rows.ranks->broadcast(std::move(all));
    BrickTets sum;
    for (std::size_t at = 0; at < all.size();) sum.add(unpacked_tets(all, at));
    return sum;
}

}  // namespace subvol::cli
