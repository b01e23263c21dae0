// SPDX-License-Identifier: Apache-2.0
#include "subvol/brick_points.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "subvol/detail/kernel_rows.h"
#include "subvol/detail/part_of_progress.h"
#include "subvol/detail/ply_rows.h"
#include "subvol/detail/points_range.h"
#include "subvol/detail/sample_part.h"
#include "subvol/error.h"

// Kernels of a mesh in bricks. A kernel depends on the cells about its point: with the halo, a brick has them all, in the order
// of the whole mesh, so its own points get the bits that they have there. Other bricks own the halo's points. The boundary of
// the volume is made once, of the cells at the hull of all bricks.

namespace subvol {

namespace {

void check_halo(const Bricks& bricks, const SampleOptions& options) {
    const int needed = detail::layers_of_samples(options);
    if (bricks.halo_layers >= needed) return;
    throw Error(ErrorCode::InvalidInput,
                "its bricks have " + std::to_string(bricks.halo_layers) + " layers of halo, these kernels need " +
                    std::to_string(needed),
                bricks.path.string(), "split with --halo " + std::to_string(needed));
}

}  // namespace

BrickPoints sample_brick(const Bricks& bricks, MeshPiece brick, const SampleOptions& options) {
    check_halo(bricks, options);
    SampleResult sampled = detail::sample_part(std::move(brick.mesh), options, bricks.bounds.diagonal());
    std::vector<std::size_t> places;
    BrickPoints result;
    for (std::size_t p = 0; p < brick.owned_points.size(); ++p) {
        if (!brick.owned_points[p]) continue;
        places.push_back(p);
        result.numbers.push_back(brick.point_numbers[p]);
    }
    result.volume = std::move(sampled.volume);
    detail::keep_kernels(result.volume, places);
    result.flat_frames = sampled.report.flat_frames;
    return result;
}

Surface sample_bricks_boundary(const Bricks& bricks, const SampleOptions& options) {
    return sample_bricks_boundary(gather_hull(bricks, {}, options.progress), options);
}

Surface sample_bricks_boundary(const BrickHull& hull, const SampleOptions& options) {
    return detail::sample_hull(hull.mesh, hull.on_hull, options);
}

BrickPointsReport write_points_of_bricks(const std::filesystem::path& path, const Bricks& bricks, const SampleOptions& options,
                                         const BrickFields& fields, const BrickShare* share) {
    check_halo(bricks, options);
    const std::size_t begin = share ? share->begin : 0, end = share ? share->end : bricks.bricks.size();
    Surface boundary;
    // One part of several has the boundary, the first one, so that joining the parts has it once.
    if (begin == 0) boundary = sample_bricks_boundary(bricks, options);
    std::uint64_t points_of_share = 0;
    for (std::size_t b = begin; b < end; ++b) points_of_share += bricks.bricks[b].points;
    BrickPointsReport report{.min = HUGE_VAL, .max = -HUGE_VAL, .triangles = boundary.triangles.size()};
    std::optional<detail::KernelRows> rows;
    const auto start = [&](const RbfVolume& like) {
        rows.emplace(path, like, points_of_share, boundary, share ? share->note : std::string(), options.progress);
    };
    for (std::size_t b = begin; b < end; ++b) {
        detail::PartOfProgress progress(options.progress, "sample", b - begin, end - begin);
        report_progress(&progress, "sample", 0);
        SampleOptions of_brick = options;
        of_brick.progress = &progress;
        MeshPiece brick = read_brick(bricks, b);
        brick.mesh = fields(std::move(brick.mesh));
        const BrickPoints points = sample_brick(bricks, std::move(brick), of_brick);
        if (points.numbers.empty()) continue;  // other bricks own all its points
        if (!rows) start(points.volume);
        rows->write(points.numbers, points.volume);
        report.points += points.numbers.size();
        report.flat_frames += points.flat_frames;
        for (const float value : points.volume.channels.front().values) {
            report.min = std::min(report.min, static_cast<double>(value));
            report.max = std::max(report.max, static_cast<double>(value));
        }
    }
    if (!rows) {  // more shares than bricks
        RbfVolume none;
        none.kernel = options.kernel;
        none.channels.push_back({.name = "value"});
        start(none);
    }
    rows->finish();
    return report;
}

BrickPointsReport join_points_of_bricks(const std::filesystem::path& path, std::span<const std::filesystem::path> parts,
                                        std::uint64_t points, Progress* progress) {
    std::uint64_t bytes = 0;
    for (const std::filesystem::path& part : parts) {
        std::error_code error;
        const auto size = std::filesystem::file_size(part, error);
        bytes += error ? 0 : size;
    }
    // Each point takes at least a byte, so a false count in a damaged part ends here and not in the allocation below.
    if (points > bytes) {
        throw Error(ErrorCode::InvalidInput, "cannot be one of parts with " + std::to_string(points) + " points",
                    parts.front().string());
    }
    // Parts may come in any order, but a point that two parts have is an error.
    std::vector<bool> found(points);
    Surface boundary;
    std::optional<detail::KernelRows> rows;
    BrickPointsReport report;
    for (const std::filesystem::path& part : parts) {
        detail::NumberedPoints read = detail::read_numbered_points(part);
        if (&part == &parts.front()) boundary = std::move(read.volume.boundary);
        for (const std::uint64_t number : read.numbers) {
            if (number < points && !found[number]) {
                found[number] = true;
                continue;
            }
            throw Error(ErrorCode::InvalidInput,
                        "point " + std::to_string(number) + (number < points ? " is in another part, too" : " does not exist"),
                        part.string(), "all parts of one mesh, each once");
        }
        if (read.numbers.empty()) continue;
        if (!rows) rows.emplace(path, read.volume, points, boundary, std::string(), progress);
        rows->write(read.numbers, read.volume);
        report.points += read.numbers.size();
    }
    if (!rows) throw Error(ErrorCode::InvalidInput, "has no points, and neither have the other parts", parts.front().string());
    rows->finish();
    report.triangles = boundary.triangles.size();
    return report;
}

}  // namespace subvol
