// SPDX-License-Identifier: Apache-2.0
#include "tet_scene.h"

#include <tbb/combinable.h>

#include <utility>

#include "pixel_tiles.h"
#include "tet_packet_tracer.h"

namespace subvol::detail {

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

TetScene::TetScene(const HexMesh& mesh, std::span<const double> values, const Box& box, Progress* progress)
    : TetScene(build_tet_mesh(mesh, values), box, progress) {
}

TetScene::TetScene(TetMesh tets, const Box& box, Progress* progress) : tets_(std::move(tets)), boundary_(tets_, box) {
    report_progress(progress, "build", 1);
}

std::size_t TetScene::bytes() const {
    return tets_.tets.size() * (sizeof(TetMesh::Tet) + sizeof(tets_.links[0])) + tets_.points.size() * sizeof(TetMesh::Point) +
           tets_.boundary.size() * sizeof(TetFace);
}

TraceCounts TetScene::draw(const View& view, const Optics& optics, int samples, const RayClip& clip, const PixelRect& part,
                           Progress* progress, Image& image) const {
    tbb::combinable<TraceCounts> counts;
    for_each_tile(part, progress, [&](const PixelRect& tile) {
        TetPacketTracer tracer(tets_, boundary_, optics, clip);
        draw_tile(view, samples, tile, tracer, image);
        counts.local() += tracer.counts();
    });
    TraceCounts sum;
    counts.combine_each([&](const TraceCounts& some) { sum += some; });
    return sum;
}

}  // namespace subvol::detail
