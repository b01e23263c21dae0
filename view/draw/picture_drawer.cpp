// SPDX-License-Identifier: Apache-2.0
#include "subvol/picture_drawer.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "picture_overlays.h"
#include "subvol/boundary_shading.h"
#include "subvol/boundary_values.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/limit.h"
#include "subvol/refine.h"
#include "subvol/render_dense.h"
#include "subvol/render_tets.h"
#include "subvol/splat.h"

namespace subvol {

using namespace detail;

ViewBody view_body(HexMesh mesh, const std::optional<std::string>& field) {
    SelectedField selected = select_field(mesh, field);
    mesh.attributes.assign(1, std::move(selected.scalar));
    const auto [min, max] = std::ranges::minmax(mesh.attributes.front().values);
    const Box box = bounds(mesh);
    return {std::move(mesh), box, {min, max}};
}

Optics optics_of(const ViewState& state, const ViewBody& body) {
    return picture_optics(state.look, body.box, body.range, body.range);
}

struct PictureDrawer::State {
    DrawSettings settings;
    std::shared_ptr<const ViewBody> body{};
    std::optional<BoundaryValues> skin{};
    std::optional<RbfVolume> volume{};
    std::optional<TetsRenderer> tets{};
    std::size_t tet_count = 0;

    /// A splatter for each way of drawing: samples, light, sheet buffers.
    using SplatterKey = std::tuple<int, bool, bool>;
    std::vector<std::pair<SplatterKey, Splatter>> splatters{};

    void take(const std::shared_ptr<const ViewBody>& next) {
        if (body == next) return;
        body = next;
        splatters.clear();  // they refer to the volume
        skin.reset();
        volume.reset();
        tets.reset();
    }

    [[nodiscard]] HexMesh refined(int levels, Progress* progress) const {
        const SchemeOptions& scheme = settings.sample.scheme;
        HexMesh fine = refine(body->mesh, {.scheme = scheme, .levels = levels, .progress = progress});
        return interpolates(scheme.kind) ? fine : on_limit(std::move(fine), scheme.kind);
    }

    const BoundaryValues& skin_of(Progress* progress) {
        if (!skin) {
            const int levels = picture_levels(body->mesh, settings.levels);
            skin = boundary_values(body->mesh, {.scheme = settings.sample.scheme, .levels = levels, .progress = progress});
        }
        return *skin;
    }

    const RbfVolume& volume_of(Progress* progress) {
        if (volume) return *volume;
        SampleOptions options = settings.sample;
        options.progress = progress;
        if (settings.levels) {  // the refined mesh with its trilinear cells takes the place of the limit
            HexMesh fine = refined(*settings.levels, progress);
            options.scheme.kind = Scheme::Linear;
            options.boundary_levels = 0;
            volume = sample_rbf_points(std::move(fine), options).volume;
        } else {
            volume = sample_rbf_points(body->mesh, options).volume;
        }
        return *volume;
    }

    Splatter& splatter(int samples, bool lit, bool sheets, Progress* progress) {
        const SplatterKey key{samples, lit, sheets};
        for (auto& [of, one] : splatters) {
            if (of == key) return one;
        }
        SplatOptions options = settings.splat;
        options.samples = samples;
        if (sheets) options.method = SplatMethod::Sheets;
        if (lit) options.shading = Shading{};
        options.progress = nullptr;
        return splatters.emplace_back(key, Splatter(volume_of(progress), options)).second;
    }

    [[nodiscard]] bool paints(const ViewState& state) const {
        return settings.painted && state.look.look == Look::Solid && state.look.opacity.empty() &&
               !state.look.opacity_unit_world && !settings.levels;
    }

    void draw_splats(const ViewState& state, const View& view, const Optics& optics, int samples, DrawnPicture& picture,
                     Progress* progress) {
        Stopwatch watch;
        const bool lit = is_lit(state.look.look), painted = paints(state);
        if (painted) (void)skin_of(progress);
        Splatter& drawer = splatter(samples, lit, state.method == "sheets", progress);
        picture.seconds_build = watch.seconds();
        SplatResult drawn = drawer.draw(view, optics, progress);
        if (painted) {
            report_progress(progress, "colors", 0);
            color_boundary(drawn.image, skin->surface, skin->values.back(), view, optics, Shading{}, samples);
        }
        picture.image = std::move(drawn.image);
        picture.depth = std::move(drawn.depth);
        picture.backend = drawn.report.backend;
        picture.points = volume->size();
        picture.seconds_draw = watch.seconds() - picture.seconds_build;
    }

    void light(const ViewState& state, const View& view, int samples, DrawnPicture& picture) {
        if (is_lit(state.look.look)) light_boundary(picture.image, skin->surface, view, Shading{}, samples);
    }

    void draw_reference(const ViewState& state, const View& view, const Optics& optics, int samples, DrawnPicture& picture,
                        Progress* progress) {
        Stopwatch watch;
        const bool lit = is_lit(state.look.look);
        if (lit && state.look.look != Look::Solid) {
            throw Error(ErrorCode::InvalidInput, "method " + state.method + " lights the boundary only", "look isosurface",
                        "method splat, or the colour map isosurface for surfaces without light");
        }
        if (lit) (void)skin_of(progress);
        if (state.method == "tets" && !tets) tets.emplace(refined(settings.levels.value_or(1), progress), "", progress);
        picture.seconds_build = watch.seconds();
        picture.backend = "cpu";
        if (state.method == "tets") {
            TetsResult drawn = tets->draw(view, optics, {.samples = samples, .progress = progress});
            picture.image = std::move(drawn.image);
            picture.points = drawn.report.tets;
        } else {
            DenseResult drawn = render_dense(body->mesh, {}, view, optics,
                                             {.refine = {.scheme = settings.sample.scheme},
                                              .levels = settings.levels,
                                              .image_tolerance = settings.image_tolerance,
                                              .samples = samples,
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
    if (state.method == "splat" || state.method == "sheets") {
        state_->draw_splats(state, view, optics, samples, picture, progress);
    } else {
        state_->draw_reference(state, view, optics, samples, picture, progress);
    }
    if (scale == 1) draw_overlays(picture, view, *body, optics);
    return picture;
}

}  // namespace subvol
