// SPDX-License-Identifier: Apache-2.0
#include "splat_pictures.h"

#include <cstdint>
#include <optional>
#include <utility>

#include "ranked_bricks.h"
#include "ranked_splats.h"
#include "splat_arguments.h"
#include "subvol/boundary_shading.h"
#include "subvol/detail/points_range.h"
#include "subvol/progressive.h"

namespace subvol::cli {
namespace {

/// What all ranks have sent.
void report_shipped(const ShippedKernels& shipped, Ranks& ranks, Report& report) {
    std::vector<std::int64_t> counts{static_cast<std::int64_t>(shipped.kernels), static_cast<std::int64_t>(shipped.bytes)};
    ranks.sum(counts);
    report["kernels_shipped"] = counts[0];
    report["kernel_bytes_sent"] = counts[1];
}

/// One picture, of which this process draws its rows.
SplatResult draw_rows(const RbfVolume& volume, const BoundaryValues& skin, const View& view, const Optics& optics,
                      const SplatWork& work, Progress* progress, Report& report) {
    SplatOptions options = work.options;
    const auto drawn_of = [&](const RbfVolume& band) {
        Splatter splatter(band, options);
        if (!skin.values.empty()) splatter.set_boundary_colors(skin.surface, skin.values.back());
        return splatter.draw(view, optics, progress);
    };
    if (work.rows.ranks == nullptr) {
        const RbfVolume band = kernels_of_rows(volume, *work.rows.share, view, optics, options);
        return drawn_of(band);
    }
    const auto [begin, end] = work.rows.share->range(volume.size());
    RbfVolume own = detail::kernels_between(volume, begin, end);
    own.boundary = volume.boundary;
    ShippedKernels shipped;
    const RbfVolume band = ship_kernels(own, view, optics, options, *work.rows.ranks, shipped);
    report_shipped(shipped, *work.rows.ranks, report);
    SplatResult drawn = drawn_of(band);
    drawn.report.points = volume.size();
    return drawn;
}

void report_drawn(const SplatReport& drawn, const SplatWork& work, Report& report) {
    report["method"] = work.method;
    report_splats(drawn, report);
}

}  // namespace

void write_splats(LevelOfDetail& levels, const BoundaryValues& skin, const std::vector<View>& views, const Optics& optics,
                  const SplatWork& work, PictureOutput& output, Report& report) {
    std::optional<Splatter> splatter;
    const auto prepare = [&](const RbfVolume& volume) {
        splatter.emplace(volume, work.options);
        if (!skin.values.empty()) splatter->set_boundary_colors(skin.surface, skin.values.back());
    };
    if (!work.rows.share && levels.all() != nullptr) prepare(*levels.all());
    const auto draw = [&](const View& view, Progress* progress) {
        const RbfVolume& shown = levels.of(view, report);
        if (splatter && levels.has_changed()) splatter->set_kernels(shown);
        if (!splatter && !work.rows.share) prepare(shown);
        SplatResult drawn =
            splatter ? splatter->draw(view, optics, progress) : draw_rows(shown, skin, view, optics, work, progress, report);
        report_drawn(drawn.report, work, report);
        Picture picture{std::move(drawn.image), std::move(drawn.depth)};
        if (work.rows.gathered()) gather_rows(picture, *work.rows.ranks);
        return picture;
    };
    output.write(views, draw, report);
}

void write_splats(const RbfVolume& volume, double lod, const BoundaryValues& skin, const std::vector<View>& views,
                  const Optics& optics, const SplatWork& work, PictureOutput& output, Report& report) {
    LevelOfDetail levels(volume, lod, work.options.channel, report);
    write_splats(levels, skin, views, optics, work, output, report);
}

void write_splats(BricksToSplats what, const std::vector<View>& views, const Optics& optics, const SplatWork& work,
                  PictureOutput& output, Report& report) {
    what.options.rows = work.rows.of(views.front().height());
    const bool ranked = work.rows.gathered();
    const auto draw = [&](const View& view, Progress*) {
        Surface own = views.size() > 1 ? what.boundary : std::move(what.boundary);
        ShippedKernels shipped;
        SplatResult drawn = report.timed("draw", [&] {
            return ranked ? render_bricks_ranked(what.bricks, what.fields, std::move(own), view, optics, what.options,
                                                 *work.rows.ranks, shipped)
                          : render_bricks(what.bricks, what.fields, std::move(own), view, optics, what.options);
        });
        report["method"] = work.method;
        report["points"] = drawn.report.points;
        report_splats(drawn.report, report);
        Picture picture{std::move(drawn.image), std::move(drawn.depth)};
        if (ranked) {
            report_shipped(shipped, *work.rows.ranks, report);
            gather_rows(picture, *work.rows.ranks);
        }
        const BoundaryValues& skin = what.skin;
        if (!skin.values.empty()) {
            color_boundary(picture.image, skin.surface, skin.values.back(), view, optics, Shading{}, what.samples,
                           what.options.splat.clip);
        }
        return picture;
    };
    output.write(views, draw, report);
}

void write_splats_in_time(const HexMesh& mesh, const SampleOptions& sample, double seconds, const View& view,
                          const Optics& optics, const SplatWork& work, PictureOutput& output, Report& report) {
    const auto draw = [&](const View&, Progress* progress) {
        ProgressiveResult drawn = render_progressively(
            mesh, view, optics, {.seconds = seconds, .sample = sample, .splat = work.options, .progress = progress});
        report_drawn(drawn.splat.report, work, report);
        report["points"] = drawn.splat.report.points;
        report["steps"] = drawn.steps;
        report["picture_scale"] = drawn.picture_scale;
        report["footprint_px"] = drawn.footprint_px;
        return Picture{std::move(drawn.splat.image), std::move(drawn.splat.depth)};
    };
    output.write({view}, draw, report);
}

}  // namespace subvol::cli
