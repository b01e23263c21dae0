// SPDX-License-Identifier: Apache-2.0
#include "subvol/brick_points.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "subvol/detail/kernel_rows.h"
#include "subvol/detail/part_of_progress.h"
#include "subvol/detail/ply_rows.h"
#include "subvol/error.h"

// Kernels of a mesh in pieces, as one file. The boundary of the volume is made once, of the cells at the hull of all pieces.

namespace subvol {

BrickPointsReport write_points_of_bricks(const std::filesystem::path& path, const MeshSource& source,
                                         const SampleOptions& options, const BrickShare* share) {
    check_halo(source, options);
    const MeshSource::Stored stored = source.in_pieces();
    const std::size_t begin = share ? share->begin : 0, end = share ? share->end : stored.pieces.size();
    Surface boundary;
    // One part of several has the boundary, the first one, so that joining the parts has it once.
    if (begin == 0) boundary = sample_boundary(gather_hull(source, options.progress), options);
    std::uint64_t points_of_share = 0;
    for (std::size_t p = begin; p < end; ++p) points_of_share += stored.pieces[p].points;
    BrickPointsReport report{.min = HUGE_VAL, .max = -HUGE_VAL, .triangles = boundary.triangles.size()};
    std::optional<detail::KernelRows> rows;
    const auto start = [&](const RbfVolume& like) {
        rows.emplace(path, like, points_of_share, boundary, share ? share->note : std::string(), options.progress);
    };
    for (std::size_t p = begin; p < end; ++p) {
        detail::PartOfProgress progress(options.progress, "sample", p - begin, end - begin);
        report_progress(&progress, "sample", 0);
        SampleOptions of_piece = options;
        of_piece.progress = &progress;
        const PieceKernels kernels = sample_piece(source, stored.read(p), of_piece);
        if (kernels.numbers.empty()) continue;  // other pieces own all its points
        if (!rows) start(kernels.volume);
        rows->write(kernels.numbers, kernels.volume);
        report.points += kernels.numbers.size();
        report.flat_frames += kernels.flat_frames;
        for (const float value : kernels.volume.channels.front().values) {
            report.min = std::min(report.min, static_cast<double>(value));
            report.max = std::max(report.max, static_cast<double>(value));
        }
    }
    if (!rows) {  // more shares than pieces
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
