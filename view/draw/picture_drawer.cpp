// SPDX-License-Identifier: Apache-2.0
#include "subvol/picture_drawer.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "few_kernels.h"
#include "picture_overlays.h"
#include "subvol/boundary_shading.h"
#include "subvol/boundary_values.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/limit.h"
#include "subvol/refine.h"
#include "subvol/render_dense.h"
#include "subvol/render_grid.h"
#include "subvol/render_projected.h"
#include "subvol/render_tets.h"
#include "subvol/sample_mixed.h"
#include "subvol/sample_tables.h"
#include "subvol/splat.h"
#include "surface_preview.h"

namespace subvol {

using namespace detail;

struct PictureDrawer::State {
    DrawSettings settings;
    std::shared_ptr<const ViewBody> body{};
    std::optional<BoundaryTables> tables{};       // of the cells of the body; made when it is moved
    std::optional<SampleTables> kernel_tables{};  // likewise
    std::optional<BoundaryValues> skin{};
    std::optional<RbfVolume> volume{};
    std::unique_ptr<FewKernels> few{};  // of the volume, for coarse pictures
    std::optional<TetsRenderer> tets{};
    std::optional<ProjectedRenderer> projected{};

    /// A splatter for each way of drawing: samples, light, sheet buffers, whether of few kernels.
    using SplatterKey = std::tuple<int, bool, bool, bool>;
    std::vector<std::pair<SplatterKey, Splatter>> splatters{};

    void take(const std::shared_ptr<const ViewBody>& next) {
        if (body == next) return;
        splatters.clear();  // they refer to the kernels
        few.reset();        // so does this
        if (body && body->shape != next->shape) {
            tables.reset();
            kernel_tables.reset();
        }
        body = next;
        skin.reset();
        volume.reset();
        tets.reset();
        projected.reset();
    }

    [[nodiscard]] HexMesh refined(int levels, Progress* progress) const {
        const SchemeOptions& scheme = settings.sample.scheme;
        HexMesh fine = refine(body->mesh, {.scheme = scheme, .levels = levels, .progress = progress});
        return interpolates(scheme.kind) ? fine : on_limit(std::move(fine), scheme.kind);
    }

    /// As boundary_values has it, up to rounding where the body has been moved.
    const BoundaryValues& skin_of(Progress* progress, DrawnPicture& picture) {
        if (skin) return *skin;
        const Stopwatch watch;
        const auto options = [&] {
            return RefineOptions{.scheme = settings.sample.scheme,
                                 .levels = picture_levels(body->mesh, body->tets ? std::optional(0) : settings.levels),
                                 .progress = progress};
        };
        if (body->moved) {
            if (!tables) tables.emplace(body->mesh, options());
            skin = tables->apply(body->mesh);
        } else {
            skin = boundary_values(body->mesh, options());
        }
        picture.seconds_boundary = watch.seconds();
        return *skin;
    }

    const RbfVolume& volume_of(Progress* progress, DrawnPicture& picture) {
        if (body->points.volume) return *body->points.volume;
        if (volume) return *volume;
        const Stopwatch watch;
        SampleOptions options = settings.sample;
        options.progress = progress;
        if (body->tets) {
            volume = sample_rbf_points(join_split_cells(body->mesh),
                                       {.correction = options.correction, .kernel = options.kernel, .progress = progress})
                         .volume;
        } else if (settings.levels) {  // the refined mesh with its trilinear cells takes the place of the limit
            HexMesh fine = refined(*settings.levels, progress);
            options.scheme.kind = Scheme::Linear;
            options.boundary_levels = 0;
            volume = sample_rbf_points(std::move(fine), options).volume;
        } else if (body->moved && SampleTables::are_for(options)) {
            if (!kernel_tables) kernel_tables.emplace(body->mesh, options);
            volume = kernel_tables->apply(body->mesh).volume;
        } else {
            volume = sample_rbf_points(body->mesh, options).volume;
        }
        picture.seconds_kernels = watch.seconds();
        return *volume;
    }

    Splatter& splatter(int samples, bool lit, bool sheets, Progress* progress, DrawnPicture& picture) {
        const RbfVolume& all = volume_of(progress, picture);
        if (picture.scale > 1 && !few && !body->moved) few = std::make_unique<FewKernels>(all);  // a moved body's soon change
        const RbfVolume* merged = picture.scale > 1 && few ? few->ready() : nullptr;
        const SplatterKey key{samples, lit, sheets, merged != nullptr};
        for (auto& [of, one] : splatters) {
            if (of == key) return one;
        }
        SplatOptions options = settings.splat;
        options.samples = samples;
        options.channel = body->channel;
        if (sheets) options.method = SplatMethod::Sheets;
        if (lit) options.shading = Shading{};
        options.progress = nullptr;
        return splatters.emplace_back(key, Splatter(merged != nullptr ? *merged : all, options)).second;
    }

    [[nodiscard]] bool paints(const ViewState& state) const {
        return settings.painted && state.look.look == Look::Solid && state.look.opacity.empty() &&
               !state.look.opacity_unit_world && !settings.levels && !body->points.volume;
    }

    void draw_splats(const ViewState& state, const View& view, const Optics& optics, int samples, DrawnPicture& picture,
                     Progress* progress) {
        Stopwatch watch;
        const bool lit = is_lit(state.look.look), painted = paints(state);
        if (painted) (void)skin_of(progress, picture);
        Splatter& drawer = splatter(samples, lit, state.method == "sheets", progress, picture);
        picture.seconds_build = watch.seconds();
        drawer.set_clip(state.clip);
        if (painted)
            drawer.set_boundary_colors(skin->surface, skin->values.back());
        else
            drawer.set_boundary_colors({}, {});
        SplatResult drawn = drawer.draw(view, optics, progress);
        picture.image = std::move(drawn.image);
        picture.depth = std::move(drawn.depth);
        picture.backend = drawn.report.backend;
        picture.points = drawn.report.points;
        picture.seconds_draw = watch.seconds() - picture.seconds_build;
    }

    /// A coarse picture of a solid, whatever the method: its boundary alone.
    void draw_preview(const View& view, const Optics& optics, const Clip& clip, DrawnPicture& picture, Progress* progress) {
        const Stopwatch watch;
        const BoundaryValues& boundary = skin_of(progress, picture);
        picture.seconds_build = watch.seconds();
        Preview preview = surface_preview(boundary, view, optics, clip);
        picture.image = std::move(preview.image);
        picture.depth = std::move(preview.depth);
        picture.backend = "cpu";
        picture.points = boundary.surface.points.size();
        picture.seconds_draw = watch.seconds() - picture.seconds_build;
    }

    void light(const ViewState& state, const View& view, int samples, DrawnPicture& picture) {
        if (is_lit(state.look.look)) light_boundary(picture.image, skin->surface, view, Shading{}, samples, state.clip);
    }

    void draw_voxels(const ViewState& state, const View& view, const Optics& optics, int samples, DrawnPicture& picture,
                     Progress* progress) {
        const Stopwatch watch;
        if (!body->points.voxels) throw Error(ErrorCode::InvalidInput, "a mesh has no voxels", "method grid", "another method");
        GridResult drawn =
            render_grid(*body->points.voxels, view, optics, {.samples = samples, .clip = state.clip, .progress = progress});
        picture.image = std::move(drawn.image);
        picture.points = drawn.report.cells;
        picture.backend = "cpu";
        picture.seconds_draw = watch.seconds();
    }

    void draw_reference(const ViewState& state, const View& view, const Optics& optics, int samples, DrawnPicture& picture,
                        Progress* progress) {
        Stopwatch watch;
        const bool lit = is_lit(state.look.look);
        if (lit && state.look.look != Look::Solid) {
            throw Error(ErrorCode::InvalidInput, "method " + state.method + " lights the boundary only", "look isosurface",
                        "method splat, or the colour map isosurface for surfaces without light");
        }
        if (body->points.volume) {
            throw Error(ErrorCode::InvalidInput, "points and voxels have no cells", "method " + state.method, "method splat");
        }
        if (lit) (void)skin_of(progress, picture);
        const auto with_cells = [&](const auto& make) {
            if (body->tets) return make(join_split_cells(body->mesh));
            return make(refined(settings.levels.value_or(1), progress));
        };
        if (state.method == "pt" && !projected)
            with_cells([&](const auto& fine) { projected.emplace(fine, "", settings.splat.device, progress); });
        if (state.method == "tets" && !tets) with_cells([&](const auto& fine) { tets.emplace(fine, "", progress); });
        picture.seconds_build = watch.seconds();
        picture.backend = "cpu";
        if (state.method == "tets") {
            TetsResult drawn = tets->draw(view, optics, {.samples = samples, .clip = state.clip, .progress = progress});
            picture.image = std::move(drawn.image);
            picture.points = drawn.report.tets;
        } else if (state.method == "pt") {
            ProjectedResult drawn =
                projected->draw(view, optics, {.samples = samples, .clip = state.clip, .progress = progress});
            picture.image = std::move(drawn.image);
            picture.points = drawn.report.tets;
            picture.backend = "gl";
        } else {
            DenseResult drawn = render_dense(body->mesh, {}, view, optics,
                                             {.refine = {.scheme = settings.sample.scheme},
                                              .levels = settings.levels,
                                              .image_tolerance = settings.image_tolerance,
                                              .samples = samples,
                                              .clip = state.clip,
                                              .progress = progress});
            picture.image = std::move(drawn.image);
            picture.points = drawn.report.micro_cells;
        }
        light(state, view, samples, picture);
        picture.seconds_draw = watch.seconds() - picture.seconds_build;
    }
};

PictureDrawer::PictureDrawer(const DrawSettings& settings) : state_(std::make_unique<State>(State{.settings = settings})) {
}
PictureDrawer::~PictureDrawer() = default;
PictureDrawer::PictureDrawer(PictureDrawer&&) noexcept = default;
PictureDrawer& PictureDrawer::operator=(PictureDrawer&&) noexcept = default;

DrawnPicture PictureDrawer::draw(const ViewState& state, const std::shared_ptr<const ViewBody>& body, int scale,
                                 Progress* progress) {
    state_->take(body);
    const Optics optics = optics_of(state, *body);
    const int width = state.width - legend_columns(state, *body, optics);
    const View view(state.camera, std::max(1, width / scale), std::max(1, state.height / scale));
    DrawnPicture picture;
    picture.scale = scale;
    picture.state = state;
    const int samples = scale > 1 ? 1 : state_->settings.samples.value_or(state.look.look == Look::Solid ? 2 : 1);
    if (scale > 1 && state_->paints(state) && state.clip.slices.empty()) {
        state_->draw_preview(view, optics, state.clip, picture, progress);
    } else if (state.method == "splat" || state.method == "sheets") {
        state_->draw_splats(state, view, optics, samples, picture, progress);
    } else if (state.method == "grid") {
        state_->draw_voxels(state, view, optics, samples, picture, progress);
    } else {
        state_->draw_reference(state, view, optics, samples, picture, progress);
    }
    if (scale == 1) draw_overlays(picture, view, *body, optics);
    return picture;
}

}  // namespace subvol
