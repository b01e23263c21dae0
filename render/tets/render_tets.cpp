// SPDX-License-Identifier: Apache-2.0
#include "subvol/render_tets.h"

#include <utility>

#include "pixel_tiles.h"
#include "subvol/detail/ray_clip.h"
#include "subvol/detail/stopwatch.h"
#include "tet_scene.h"

namespace subvol {

using namespace detail;

struct TetsRenderer::State {
    State(TetMesh tets, const Stopwatch& watch, Progress* progress)
        : box(bounds_of(tets)), scene(std::move(tets), box, progress) {
        built.tets = scene.tets().tets.size();
        built.degenerate_tets = scene.tets().shapes.degenerate;
        built.inverted_tets = scene.tets().shapes.inverted;
        built.bytes = scene.bytes();
        built.seconds_build = watch.seconds();
    }

    Box box;
    TetScene scene;
    TetsReport built;
};

TetsRenderer::TetsRenderer(const HexMesh& mesh, std::string_view field, Progress* progress) {
    validate(mesh);
    const Attribute& shown = scalar_field(mesh, field);
    const Stopwatch watch;
    report_progress(progress, "build", 0);
    state_ = std::make_unique<State>(build_tet_mesh(mesh, shown.values), watch, progress);
}

TetsRenderer::TetsRenderer(const MixedMesh& mesh, std::string_view field, Progress* progress) {
    const Stopwatch watch;
    report_progress(progress, "build", 0);
    state_ = std::make_unique<State>(build_tet_mesh(mesh, field), watch, progress);
}

TetsRenderer::~TetsRenderer() = default;
TetsRenderer::TetsRenderer(TetsRenderer&&) noexcept = default;
TetsRenderer& TetsRenderer::operator=(TetsRenderer&&) noexcept = default;

double TetsRenderer::seconds_build() const {
    return state_->built.seconds_build;
}

TetsResult TetsRenderer::draw(const View& view, const Optics& optics, const TetsOptions& options) const {
    check_samples(options.samples);
    TetsResult result{Image(view.width(), view.height()), state_->built};
    TetsReport& report = result.report;
    const Stopwatch watch;
    const RayClip clip(without_far_faces(options.clip, state_->box), state_->box.diagonal());
    const PixelRect part = rect_of(options.rows, view.width(), view.height());
    const TraceCounts counts = state_->scene.draw(view, optics, options.samples, clip, part, options.progress, result.image);
    report.rays = counts.rays;
    report.segments = counts.segments;
    report.lost_rays = counts.lost_rays;
    report.seconds_draw = watch.seconds();
    return result;
}

TetsResult render_tets(const HexMesh& mesh, std::string_view field, const View& view, const Optics& optics,
                       const TetsOptions& options) {
    check_samples(options.samples);
    return TetsRenderer(mesh, field, options.progress).draw(view, optics, options);
}

}  // namespace subvol
