// SPDX-License-Identifier: Apache-2.0
#include "subvol/brick_points.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "subvol/detail/ply_rows.h"
#include "subvol/detail/sample_part.h"
#include "subvol/error.h"

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

template <class Values>
void keep(Values& values, const std::vector<std::size_t>& places) {
    if (values.empty()) return;
    for (std::size_t i = 0; i < places.size(); ++i) values[i] = values[places[i]];
    values.resize(places.size());
}

/// A part of the progress of a whole.
class PartOfProgress : public Progress {
public:
    PartOfProgress(Progress* whole, const char* stage, std::size_t part, std::size_t of)
        : whole_(whole), stage_(stage), part_(part), of_(of) {}
    void report(std::string_view, double fraction) override {
        if (whole_) whole_->report(stage_, (static_cast<double>(part_) + fraction) / static_cast<double>(of_));
    }
    [[nodiscard]] bool cancelled() const override { return whole_ && whole_->cancelled(); }

private:
    Progress* whole_;
    const char* stage_;
    std::size_t part_, of_;
};

}  // namespace

BrickPoints sample_brick(const Bricks& bricks, BrickMesh brick, const SampleOptions& options) {
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
    keep(result.volume.centers, places);
    keep(result.volume.frames, places);
    for (RbfChannel& channel : result.volume.channels) {
        keep(channel.values, places);
        keep(channel.gradients, places);
        keep(channel.moments, places);
        keep(channel.hessians, places);
    }
    result.flat_frames = sampled.report.flat_frames;
    return result;
}

Surface sample_bricks_boundary(const Bricks& bricks, const SampleOptions& options) {
    BrickHull hull = gather_hull(bricks);
    return detail::sample_hull(std::move(hull.mesh), hull.on_hull, options);
}

BrickPointsReport write_points_of_bricks(const std::filesystem::path& path, const Bricks& bricks, const SampleOptions& options,
                                         const BrickFields& fields) {
    check_halo(bricks, options);
    const Surface boundary = sample_bricks_boundary(bricks, options);
    BrickPointsReport report{.min = HUGE_VAL, .max = -HUGE_VAL, .triangles = boundary.triangles.size()};
    std::optional<detail::PlyRows> rows;
    for (std::size_t b = 0; b < bricks.bricks.size(); ++b) {
        PartOfProgress progress(options.progress, "sample", b, bricks.bricks.size());
        progress.report({}, 0);
        if (progress.cancelled()) throw Error(ErrorCode::Cancelled, "cancelled");
        SampleOptions of_brick = options;
        of_brick.progress = &progress;
        BrickMesh brick = read_brick(bricks, b);
        brick.mesh = fields(std::move(brick.mesh));
        const BrickPoints points = sample_brick(bricks, std::move(brick), of_brick);
        if (!rows) rows.emplace(path, points.volume, bricks.points, boundary);
        rows->write(points.numbers, points.volume);
        report.points += points.numbers.size();
        report.flat_frames += points.flat_frames;
        for (const float value : points.volume.channels.front().values) {
            report.min = std::min(report.min, static_cast<double>(value));
            report.max = std::max(report.max, static_cast<double>(value));
        }
    }
    rows->finish(boundary);
    return report;
}

}  // namespace subvol
