// SPDX-License-Identifier: Apache-2.0
// How PictureMaker draws: each family of methods from what was prepared for it (prepare_pictures.cpp), then what the boundary
// gives to a finished picture. Solids are drawn by first hits where nothing else is asked for; pictures of kernels keep
// their splatters, one for each way of drawing.
#include <array>
#include <limits>
#include <utility>

#include "kernel_origins.h"
#include "picture_facts.h"
#include "picture_state.h"
#include "subvol/boundary_shading.h"
#include "subvol/draw_shells.h"
#include "subvol/progressive.h"
#include "subvol/render_dense.h"
#include "subvol/render_grid.h"
#include "subvol/splat_shares.h"

namespace subvol {
namespace {

SplatMethod splat_method(Method method, SplatMethod otherwise) {
    if (method == Method::Sheets) return SplatMethod::Sheets;
    return method == Method::Footprints ? SplatMethod::Footprints : otherwise;
}

}  // namespace

SplatOptions PictureMaker::State::splat_options(const Optics& optics) const {
    SplatOptions splat = options.splat;
    splat.method = splat_method(method(), options.splat.method);
    splat.samples = options.style.sample_count();
    splat.clip = options.style.clip;
    splat.progress = nullptr;
    if (options.image_tolerance) splat.image_tolerance = *options.image_tolerance;
    if (is_lit(options.style.look.look)) splat.shading = shading_for(optics.function());
    const std::vector<std::size_t> shown = shown_channels();
    splat.channel = shown.front();
    splat.color_channel.reset();
    if (shown.size() > 1) splat.color_channel = shown.back();
    return splat;
}

detail::KeptSplatter& PictureMaker::State::splatter(const RbfVolume& kernels, std::size_t version, const Optics& optics) {
    const SplatOptions splat = splat_options(optics);
    const detail::SplatterKey key{method(), splat.samples, splat.shading ? splat.shading->head : -1, &kernels};
    for (detail::KeptSplatter& kept : prepared->kernels->splatters) {
        if (kept.key == key) return kept;
    }
    return prepared->kernels->splatters.emplace_back(detail::KeptSplatter{key, Splatter(kernels, splat), version});
}

void PictureMaker::State::paint(Splatter& splatter) {
    const BoundaryValues none;
    const BoundaryValues& colors = paints_splats() ? skin_of_kernels() : none;
    if (colors.values.empty())
        splatter.set_boundary_colors(none.surface, {});
    else
        splatter.set_boundary_colors(colors.surface, colors.values.back());
}

Picture PictureMaker::State::draw_splats(const View& view, const Optics& of_field, Progress* progress,
                                         const RbfVolume* stand_in) {
    Picture picture;
    const Optics optics = optics_of_kernels(of_field);
    const RbfVolume& shown =
        stand_in != nullptr ? *stand_in : prepared->kernels->levels->kernels(view, progress, picture.facts);
    SplatResult drawn;
    if (team != nullptr) {
        drawn = team->splat(shown, splat_options(optics), paints_splats() ? skin_of_kernels() : BoundaryValues{}, view, optics,
                            progress, picture.facts);
    } else {
        const bool in_memory = stand_in == nullptr && draws_all_kernels();
        detail::KeptSplatter& kept = splatter(in_memory ? *prepared->kernels->levels->all() : shown,
                                              in_memory ? 0 : prepared->kernels->levels->version(), optics);
        if (stand_in == nullptr && kept.version != prepared->kernels->levels->version()) {
            kept.splatter.set_kernels(shown);
            kept.version = prepared->kernels->levels->version();
        }
        kept.splatter.set_clip(options.style.clip);
        paint(kept.splatter);
        drawn = kept.splatter.draw(view, optics, progress);
    }
    detail::add_facts(drawn.report, method(), picture.facts);
    if (!(options.lod.value_or(0) > 0)) picture.facts["points"] = drawn.report.points;
    picture.image = std::move(drawn.image);
    picture.depth = std::move(drawn.depth);
    return picture;
}

bool PictureMaker::State::has_chosen_sheets() const {
    return (method() == Method::Splat || method() == Method::Sheets) && !is_translucent() && !is_in_pieces() &&
           team == nullptr && !options.seconds && options.splat.sheets == 0;
}

detail::SheetError PictureMaker::State::sheet_error(const Image& image, int sheets, const View& view, const Optics& of_field,
                                                    Progress* progress) {
    const Optics optics = optics_of_kernels(of_field);
    Facts unsaid;
    const RbfVolume& shown = prepared->kernels->levels->kernels(view, progress, unsaid);
    Splatter finer(shown, detail::with_more_sheets(splat_options(optics), sheets));
    paint(finer);
    return detail::difference(image, finer.draw(view, optics, progress).image);
}

Picture PictureMaker::State::draw_splats_in_time(const View& view, const Optics& optics, Progress* progress) {
    ProgressiveResult drawn = render_progressively(
        mesh_of_kernels(), view, optics_of_kernels(optics),
        {.seconds = *options.seconds, .sample = options.kernels.sample, .splat = splat_options(optics), .progress = progress});
    Picture picture{std::move(drawn.splat.image), std::move(drawn.splat.depth)};
    detail::add_facts(drawn.splat.report, method(), picture.facts);
    picture.facts["points"] = drawn.splat.report.points;
    picture.facts["steps"] = drawn.steps;
    picture.facts["picture_scale"] = drawn.picture_scale;
    picture.facts["footprint_px"] = drawn.footprint_px;
    return picture;
}

Picture PictureMaker::State::draw_piece_splats(const View& view, const Optics& of_field, Progress* progress) const {
    Picture picture;
    const Optics optics = optics_of_kernels(of_field);
    const auto relative = [by = prepared->kernels->origins](HexMesh piece) {
        detail::move_down(piece, by);
        return piece;
    };
    const MeshSource source = is_relative() ? body.mesh->changed(relative) : *body.mesh;
    BrickSplatOptions pieces{
        .sample = options.kernels.sample, .splat = splat_options(optics), .memory_bytes = options.memory_bytes, .scratch = {}};
    pieces.sample.progress = pieces.splat.progress = progress;
    if (team != nullptr) pieces.rows = team->rows(view.height());
    SplatResult drawn = picture.facts.timed(progress, "draw", [&] {
        if (team != nullptr) return team->splat(source, *prepared->pieces.boundary, pieces, view, optics, picture.facts);
        return render_bricks(source, *prepared->pieces.boundary, view, optics, pieces);
    });
    detail::add_facts(drawn.report, method(), picture.facts);
    picture.facts["points"] = drawn.report.points;
    picture.image = std::move(drawn.image);
    picture.depth = std::move(drawn.depth);
    return picture;
}

Picture PictureMaker::State::draw_tets(const View& view, const Optics& optics, Progress* progress) const {
    const TetsOptions tets_options{.samples = options.style.sample_count(),
                                   .clip = options.style.clip,
                                   .rows = team != nullptr ? team->rows(view.height()) : PixelRows{},
                                   .progress = progress};
    Picture picture;
    TetsResult drawn;
    if (is_in_pieces()) {
        BrickTetsOptions pieces = piece_tets_options(progress);
        pieces.tets = tets_options;
        drawn = render_tets(*body.mesh, *prepared->pieces.tets, view, optics, pieces);
        picture.facts.add_seconds("prepare", drawn.report.seconds_build);
    } else {
        drawn = prepared->cells.tets->draw(view, optics, tets_options);
    }
    std::array counts{drawn.report.rays, drawn.report.lost_rays};
    if (team != nullptr) team->add_up(counts);
    drawn.report.rays = counts[0];
    drawn.report.lost_rays = counts[1];
    detail::add_facts(drawn.report, picture.facts);
    picture.image = std::move(drawn.image);
    return picture;
}

Picture PictureMaker::State::draw_projected(const View& view, const Optics& optics, Progress* progress) {
    ProjectedOptions projected_options{.order = options.order,
                                       .kbuffer = options.kbuffer,
                                       .lod = options.lod.value_or(1),
                                       .samples = options.style.sample_count(),
                                       .clip = options.style.clip};
    Picture picture;
    ProjectedResult drawn;
    if (options.seconds) {
        auto best = render_progressively(*prepared->cells.projected, view, optics,
                                         {.seconds = *options.seconds, .projected = projected_options, .progress = progress});
        projected_options.order = best.order;
        drawn = std::move(best.projected);
        picture.facts["steps"] = best.steps;
        picture.facts["finished"] = best.finished;
    } else {
        projected_options.progress = progress;
        drawn = prepared->cells.projected->draw(view, optics, projected_options);
    }
    detail::add_facts(drawn.report, projected_options.order, picture.facts);
    picture.image = std::move(drawn.image);
    return picture;
}

Picture PictureMaker::State::draw_dense(const View& view, const Optics& optics, Progress* progress) const {
    const std::optional<int> level = options.kernels.levels;
    DenseResult drawn = render_dense(*mesh(), {}, view, optics,
                                     {.refine = refinement(0, progress),
                                      .levels = level,
                                      .max_levels = options.max_levels,
                                      .image_tolerance = options.image_tolerance,
                                      .samples = options.style.sample_count(),
                                      .clip = options.style.clip,
                                      .progress = progress});
    Picture picture{std::move(drawn.image)};
    detail::add_facts(drawn.report, level.has_value(), picture.facts);
    return picture;
}

Picture PictureMaker::State::draw_grid(const View& view, const Optics& optics, Progress* progress) const {
    GridResult drawn = render_grid(*body.voxels, view, optics,
                                   {.samples = options.style.sample_count(), .clip = options.style.clip, .progress = progress});
    Picture picture{std::move(drawn.image)};
    detail::add_facts(drawn.report, picture.facts);
    return picture;
}

Picture PictureMaker::State::draw_translucent(const View& view, const Optics& optics) const {
    Picture picture{Image(view.width(), view.height())};
    picture.facts["method"] = name_of(method());
    picture.facts["backend"] = "cpu";
    picture.depth.assign(picture.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    ColoredSurface colored{prepared->skin->surface, prepared->skin->values.back()};
    for (const double value : prepared->skin->values.front())
        colored.opacities.push_back(static_cast<float>(alpha_at(optics.function(), value)));
    draw_shells(
        picture.image, picture.depth, colored, {}, view, optics,
        {.shading = shading_for(optics.function()), .samples = options.style.sample_count(), .clip = options.style.clip});
    return picture;
}

std::optional<Picture> PictureMaker::State::draw_first_hits(const View& view, const Optics& optics, Progress* progress) const {
    PixelRows rows;
    if (team != nullptr) {  // and some rows beside them, whose depths decide about lines that are drawn afterwards
        rows = team->rows(view.height());
        rows = {rows.first - kRowsOfTile, rows.end + kRowsOfTile};
    }
    Picture picture;
    BoundaryCut cut{.clip = options.style.clip};
    cut.value_at = [this](const Vec3& place) -> std::optional<double> {
        const std::optional<double> value = prepared->kernels->at_cuts->value(place);
        return value && is_relative() ? *value + prepared->kernels->origins[1] : value;
    };
    BoundaryPicture drawn = picture.facts.timed(progress, "draw", [&] {
        return draw_boundary(prepared->skin->surface, prepared->skin->values.back(), view, optics,
                             shading_for(optics.function()), options.style.sample_count(), rows, progress, cut);
    });
    std::array inside{drawn.rays_inside};
    if (team != nullptr) team->add_up(inside);
    if (inside.front() > 0) return std::nullopt;
    detail::add_facts_of_first_hits(prepared->skin->surface, picture.facts);
    picture.image = std::move(drawn.image);
    picture.depth = std::move(drawn.depth);
    return picture;
}

Picture PictureMaker::State::drawn_rows(const View& view, const Optics& optics, Progress* progress, const RbfVolume* stand_in) {
    if (is_translucent()) return draw_translucent(view, optics);
    switch (method()) {
        case Method::Splat:
        case Method::Sheets:
        case Method::Footprints:
            if (is_in_pieces()) return draw_piece_splats(view, optics, progress);
            return options.seconds ? draw_splats_in_time(view, optics, progress)
                                   : draw_splats(view, optics, progress, stand_in);
        case Method::Tets:
            return draw_tets(view, optics, progress);
        case Method::Projected:
            return draw_projected(view, optics, progress);
        case Method::Dense:
            return draw_dense(view, optics, progress);
        case Method::Grid:
            break;
    }
    return draw_grid(view, optics, progress);
}

void PictureMaker::State::finish(Picture& picture, const View& view, const Optics& optics) const {
    const int samples = options.style.sample_count();
    const Clip& clip = options.style.clip;
    if (is_translucent()) return;
    if (lights_boundary()) {
        light_boundary(picture.image, prepared->skin->surface, view, shading_for(optics.function()), samples, clip);
    } else if (is_in_pieces() && paints_finished() && !prepared->skin->values.empty()) {
        color_boundary(picture.image, prepared->skin->surface, prepared->skin->values.back(), view, optics,
                       shading_for(optics.function()), samples, clip);
    }
}

}  // namespace subvol
