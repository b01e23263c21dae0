// SPDX-License-Identifier: Apache-2.0
#include "tet_scene.h"

#include <hwy/cache_control.h>
#include <tbb/combinable.h>

#include <bit>
#include <utility>

#include "pixel_tiles.h"

namespace subvol::detail {

TetPacketTracer::TetPacketTracer(const TetMesh& mesh, const BoundaryScene& scene, const Optics& optics, const RayClip& clip)
    : mesh_(mesh), clip_(clip), one_by_one_(mesh, scene, optics, clip) {
    lanes_.reserve(TetPacket::kLanes);
    for (std::size_t i = 0; i < TetPacket::kLanes; ++i) lanes_.emplace_back(mesh, scene, optics);
}

TraceCounts TetPacketTracer::counts() const {
    TraceCounts sum = one_by_one_.counts();
    return sum += counts_;
}

void TetPacketTracer::trace(std::span<const Ray> rays, std::span<Segment> seen) {
    rays_ = rays;
    seen_ = seen;
    next_ = 0;
    for (std::size_t i = 0; i < TetPacket::kLanes; ++i) next_ray(i);
    while (walking_ != 0) {
        const TetPacketEnds ends = step(mesh_, packet_);
        for (std::uint32_t left = walking_; left != 0; left &= left - 1) {
            const auto i = static_cast<std::size_t>(std::countr_zero(left));
            const std::uint32_t bit = left & -left;
            Lane& lane = lanes_[i];
            hwy::Prefetch(&mesh_.links[static_cast<std::size_t>(packet_.tet[i])]);
            hwy::Prefetch(&mesh_.points[static_cast<std::size_t>(packet_.apex[i])]);
            ++lane.steps;
            if (ends.undecided & bit || lane.steps > mesh_.tet_count()) {
                trace_alone(i);
                continue;
            }
            if (packet_.length[i] > 0) lane.compositor.add(packet_.front[i], packet_.back[i], packet_.length[i]);
            if (ends.boundary & bit || lane.compositor.opaque()) end_walk(i);
        }
    }
}

void TetPacketTracer::next_ray(std::size_t i) {
    Lane& lane = lanes_[i];
    walking_ &= ~(1u << i);
    packet_.walking[i] = 0;
    for (; next_ < rays_.size(); ++next_) {
        const Ray& ray = rays_[next_];
        seen_[next_] = {};
        clip_.cut(ray, cut_);
        if (!cut_.whole()) {
            seen_[next_] = one_by_one_.trace(ray);
            continue;
        }
        lane.plane = RayPlane(ray);
        lane.ends.find(lane.plane, ray);
        if (lane.ends.empty()) continue;
        lane.ray = next_++;
        lane.state = {};
        lane.segments = 0;
        const auto axes = lane.plane.axes();
        for (std::size_t k = 0; k < 3; ++k) {
            packet_.axis[k][i] = axes[k];
            packet_.origin[k][i] = ray.origin[axes[k]];
        }
        packet_.slope_x[i] = lane.plane.slope_x();
        packet_.slope_y[i] = lane.plane.slope_y();
        packet_.per_depth[i] = lane.plane.per_depth();
        packet_.speed[i] = glm::length(ray.direction);
        if (!begin_walk(i)) return finish(i);
        return;
    }
}

bool TetPacketTracer::begin_walk(std::size_t i) {
    Lane& lane = lanes_[i];
    lane.start = lane.ends.first_unwalked();
    if (lane.start == kNone) return false;
    const CrossedFace face = *cross_face(mesh_, lane.plane, lane.start);
    const Crossing first = face.crossing();
    for (std::size_t k = 0; k < 3; ++k) {
        packet_.x[k][i] = face.corner[k].x;
        packet_.y[k][i] = face.corner[k].y;
        packet_.t[k][i] = face.corner[k].t;
        packet_.value[k][i] = face.corner[k].value;
        packet_.side[k][i] = face.side[k].area;
        packet_.id[k][i] = static_cast<std::int64_t>(face.corner[k].id);
    }
    packet_.tet[i] = static_cast<std::int64_t>(lane.start / 4);
    packet_.apex[i] = static_cast<std::int64_t>(mesh_.corners_of_tet(lane.start / 4)[lane.start % 4]);
    packet_.here_t[i] = packet_.reached[i] = lane.first_t = first.t;
    packet_.here_value[i] = first.value;
    packet_.lit_t[i] = std::max(lane.state.t, first.t);
    packet_.walking[i] = -1;
    walking_ |= 1u << i;
    lane.steps = 0;
    lane.compositor.start(lane.state.light);
    return true;
}

void TetPacketTracer::end_walk(std::size_t i) {
    Lane& lane = lanes_[i];
    lane.segments += lane.steps;
    const bool opaque = lane.compositor.opaque();
    const double last_t = packet_.here_t[i];
    if (!opaque && (last_t < lane.first_t || packet_.reached[i] > last_t)) return trace_alone(i);
    lane.state = {lane.compositor.finish(), packet_.lit_t[i]};
    if (opaque) return finish(i);
    const auto tet = static_cast<Index>(packet_.tet[i]);
    const auto& corner = mesh_.corners_of_tet(tet);
    const auto dropped = static_cast<Index>(packet_.dropped[i]);
    const auto k = static_cast<Index>(std::find(corner.begin(), corner.end() - 1, dropped) - corner.begin());
    lane.ends.mark_walked(lane.plane, lane.start, 4 * tet + k);
    if (!begin_walk(i)) finish(i);
}

void TetPacketTracer::finish(std::size_t i) {
    const Lane& lane = lanes_[i];
    seen_[lane.ray] = lane.state.light;
    ++counts_.rays;
    counts_.segments += lane.segments;
    next_ray(i);
}

void TetPacketTracer::trace_alone(std::size_t i) {
    const std::size_t ray = lanes_[i].ray;
    seen_[ray] = one_by_one_.trace(rays_[ray]);
    next_ray(i);
}

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
