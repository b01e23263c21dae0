// SPDX-License-Identifier: Apache-2.0
#include <tbb/combinable.h>

#include "boundary_scene.h"
#include "pixel_tiles.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/render_tets.h"
#include "tet_mesh.h"
#include "tet_packet_tracer.h"

namespace subvol {

using namespace detail;

namespace {

/// Draws a tile: the same as `trace_pixel` for each of its pixels, with the rays of all pixels at once.
void draw_tile(const View& view, int samples, const PixelRect& tile, TetPacketTracer& tracer, Image& image) {
    std::vector<Ray> rays;
    std::vector<Segment> seen, sums;
    const auto for_each_pixel = [&](const auto& body) {
        for (int y = tile.y0; y < tile.y1; ++y) {
            for (int x = tile.x0; x < tile.x1; ++x) body(x, y);
        }
    };
    for (int j = 0; j < samples; ++j) {
        for (int i = 0; i < samples; ++i) {
            rays.clear();
            for_each_pixel([&](int x, int y) { rays.push_back(view.ray(x + (i + 0.5) / samples, y + (j + 0.5) / samples)); });
            seen.resize(rays.size());
            sums.resize(rays.size(), {.color = Vec3(0.0), .transmittance = 0});
            tracer.trace(rays, seen);
            for (std::size_t k = 0; k < seen.size(); ++k) {
                sums[k].color += seen[k].color;
                sums[k].transmittance += seen[k].transmittance;
            }
        }
    }
    const double count = static_cast<double>(samples) * samples;
    auto sum = sums.begin();
    for_each_pixel([&](int x, int y) {
        write_pixel(image, x, y, {sum->color / count, sum->transmittance / count});
        ++sum;
    });
}

}  // namespace

struct TetsRenderer::State {
    /// build: gives the tetrahedra
    template <class Build>
    State(Progress* progress, const Build& build) {
        const Stopwatch watch;
        report_progress(progress, "build", 0);
        tets = build();
        report_progress(progress, "build", 0.8);
        box = bounds_of(tets);
        scene.emplace(tets, box);
        report_progress(progress, "build", 1);
        built.tets = tets.tets.size();
        built.degenerate_tets = tets.degenerate_tets;
        built.inverted_tets = tets.inverted_tets;
        built.bytes = tets.tets.size() * (sizeof(TetMesh::Tet) + sizeof(tets.links[0])) +
                      tets.points.size() * sizeof(TetMesh::Point) + tets.boundary.size() * sizeof(TetFace);
        built.seconds_build = watch.seconds();
    }

    TetMesh tets;
    Box box;
    std::optional<BoundaryScene> scene;
    TetsReport built;
};

TetsRenderer::TetsRenderer(const HexMesh& mesh, std::string_view field, Progress* progress)
    : state_(std::make_unique<State>(progress, [&] {
          validate(mesh);
          return build_tet_mesh(mesh, scalar_field(mesh, field).values);
      })) {
}

TetsRenderer::TetsRenderer(const MixedMesh& mesh, std::string_view field, Progress* progress)
    : state_(std::make_unique<State>(progress, [&] { return build_tet_mesh(mesh, field); })) {
}

TetsRenderer::~TetsRenderer() = default;
TetsRenderer::TetsRenderer(TetsRenderer&&) noexcept = default;
TetsRenderer& TetsRenderer::operator=(TetsRenderer&&) noexcept = default;

double TetsRenderer::seconds_build() const {
    return state_->built.seconds_build;
}

TetsResult TetsRenderer::draw(const View& view, const Optics& optics, const TetsOptions& options) const {
    check_samples(options.samples);
    TetsResult result{{}, state_->built};
    TetsReport& report = result.report;
    const Stopwatch watch;
    const RayClip clip(without_far_faces(options.clip, state_->box));
    tbb::combinable<TraceCounts> sums;
    result.image = Image(view.width(), view.height());
    for_each_tile({0, 0, view.width(), view.height()}, options.progress, [&](const PixelRect& tile) {
        TetPacketTracer tracer(state_->tets, *state_->scene, optics, clip);
        draw_tile(view, options.samples, tile, tracer, result.image);
        sums.local() += tracer.counts();
    });
    sums.combine_each([&](const TraceCounts& sum) {
        report.rays += sum.rays;
        report.segments += sum.segments;
        report.lost_rays += sum.lost_rays;
    });
    report.seconds_draw = watch.seconds();
    return result;
}

TetsResult render_tets(const HexMesh& mesh, std::string_view field, const View& view, const Optics& optics,
                       const TetsOptions& options) {
    check_samples(options.samples);
    return TetsRenderer(mesh, field, options.progress).draw(view, optics, options);
}

}  // namespace subvol
