// SPDX-License-Identifier: Apache-2.0
#include "gl_boundary.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "shader_boundary_frame_glsl.h"
#include "shader_boundary_plan_comp.h"
#include "shader_boundary_points_comp.h"
#include "shader_boundary_raster_comp.h"
#include "shader_boundary_resolve_comp.h"
#include "shader_boundary_strips_comp.h"
#include "shader_gl_groups_glsl.h"
#include "subvol/raster.h"
#include "work_groups.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kEyePoint_bytes = 32, kBox_bytes = 16, kPair_bytes = 8, kPlan_bytes = 16;
constexpr GLuint kCameraBinding = 1;
constexpr std::size_t kMostPixels = std::size_t{1} << 25;  // of 128 hits each: their sum has 32 bits

GlProgram boundary_program(const char* file, const char* source, const char* defines = "") {
    return {file,
            source,
            defines,
            {{"gl_groups.glsl", kShader_gl_groups_glsl}, {"boundary_frame.glsl", kShader_boundary_frame_glsl}}};
}

std::array<Vec3, 8> corners(const Box& box) {
    std::array<Vec3, 8> result;
    for (std::size_t i = 0; i < 8; ++i) {
        for (int axis = 0; axis < 3; ++axis) result[i][axis] = ((i >> axis & 1) == 0 ? box.lower : box.upper)[axis];
    }
    return result;
}

}  // namespace

/// The same as in shaders/boundary_frame.glsl.
struct alignas(32) GlBoundary::Camera {
    std::array<double, 4> right{}, up{}, forward{}, scale{};
    std::int32_t width = 0, height = 0, perspective = 0;
    std::uint32_t points = 0, triangles = 0, most_hits = 0;

    Camera(const View& view, double near, double middle)
        : right(row(view, 0)),
          up(row(view, 1)),
          forward(row(view, 2)),
          scale{view.pixel(), middle, near - middle, 0},
          width(view.width()),
          height(view.height()),
          perspective(view.perspective()) {}

    static std::array<double, 4> row(const View& view, int axis) {
        const Vec3& a = view.axes()[static_cast<std::size_t>(axis)];
        return {a.x, a.y, a.z, view.eye()[axis]};
    }
};

GlBoundary::GlBoundary(bool on_device)
    : on_device_(on_device),
      points_program_(boundary_program("boundary_points.comp", kShader_boundary_points_comp)),
      strips_program_(boundary_program("boundary_strips.comp", kShader_boundary_strips_comp)),
      plan_program_(boundary_program("boundary_plan.comp", kShader_boundary_plan_comp)),
      count_program_(boundary_program("boundary_raster.comp", kShader_boundary_raster_comp, "#define FILL 0\n")),
      fill_program_(boundary_program("boundary_raster.comp", kShader_boundary_raster_comp, "#define FILL 1\n")),
      resolve_program_(boundary_program("boundary_resolve.comp", kShader_boundary_resolve_comp)) {
}

void GlBoundary::upload_surface(const Surface& surface) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    points_ = surface.points.size();
    const std::size_t triangles = surface.triangles.size();
    std::vector<std::uint32_t> corners(3 * triangles);
    tbb::parallel_for(std::size_t{0}, triangles, [&](std::size_t i) {
        for (std::size_t k = 0; k < 3; ++k) corners[3 * i + k] = static_cast<std::uint32_t>(surface.triangles[i][k]);
    });
    positions_.grow(points_ * sizeof(Vec3));
    positions_.upload(points_ * sizeof(Vec3), surface.points.data());
    corners_.grow(corners.size() * kWord_bytes);
    corners_.upload(corners.size() * kWord_bytes, corners.data());
    eye_points_.grow(points_ * kEyePoint_bytes);
    boxes_.grow(triangles * kBox_bytes);
    strips_.grow((triangles + 1) * kWord_bytes);
    triangles_ = triangles;  // set last: after an error all of this is done again
}

void GlBoundary::set(const PixelIntervals& intervals, const View& view) {
    pixels_ = pixel_count(view.width(), view.height());
    ranges_.grow(pixels_ * kPair_bytes);
    on_device_now_ = false;
    upload_intervals(intervals);
}

std::size_t GlBoundary::room() const {
    return intervals_.bytes() / kPair_bytes;
}

void GlBoundary::find(const Surface& surface, const View& view, double near, double middle, GlStages& stages) {
    pixels_ = pixel_count(view.width(), view.height());
    ranges_.grow(pixels_ * kPair_bytes);
    if (box_.empty()) {
        for (const Vec3& point : surface.points) box_.add(point);
    }
    on_device_now_ = on_device_ && GlBuffer::fits(surface.points.size() * kEyePoint_bytes) &&
                     GlBuffer::fits(surface.triangles.size() * kBox_bytes) && pixels_ <= kMostPixels &&
                     !(needs_clipping(corners(box_), view, near) && needs_clipping(surface.points, view, near));
    if (!on_device_now_) return upload_intervals(boundary_intervals(surface, view, near, middle));

    stages.begin("boundary");
    room_ = std::min(room_, intervals_.bytes() / kPair_bytes);  // less if the device could not provide more
    if (triangles_ == 0) upload_surface(surface);
    Camera camera(view, near, middle);
    camera.points = static_cast<std::uint32_t>(points_);
    camera.triangles = static_cast<std::uint32_t>(triangles_);
    const auto set_camera = [&] {
        camera.most_hits = static_cast<std::uint32_t>(room_);
        camera_.grow(sizeof camera);
        camera_.upload(sizeof camera, &camera);
        glBindBufferBase(GL_UNIFORM_BUFFER, kCameraBinding, camera_.id());
    };
    set_camera();
    count_hits();
    if (room_ == 0) {
        (void)found_all();
        if (!on_device_) return find(surface, view, near, middle, stages);
        set_camera();
    }
    fill();
    stages.begin("");
}

void GlBoundary::count_hits() {
    points_program_.use();
    positions_.bind(0);
    eye_points_.bind(1);
    dispatch(groups_for(points_));
    strips_program_.use();
    corners_.bind(2);
    boxes_.bind(3);
    strips_.bind(4);
    strip_total_.grow(2 * kWord_bytes);
    strip_total_.clear();
    strip_total_.bind(5);
    dispatch(groups_for(triangles_));
    scan_.exclusive_scan(strips_, static_cast<std::uint32_t>(triangles_));

    plan_.grow(kPlan_bytes);
    hit_offsets_.grow((pixels_ + 2) * kWord_bytes);
    hit_offsets_.clear();
    plan_program_.use();
    strips_.bind(0);
    plan_.bind(1);
    strip_total_.bind(2);
    hit_offsets_.bind(3);
    dispatch(1);

    count_program_.use();
    strips_.bind(0);
    eye_points_.bind(1);
    corners_.bind(2);
    boxes_.bind(3);
    hit_offsets_.bind(4);
    dispatch(plan_, 0);
    scan_.exclusive_scan(hit_offsets_, static_cast<std::uint32_t>(pixels_));
}

void GlBoundary::fill() {
    counts_.grow(pixels_ * kWord_bytes);
    counts_.clear();
    fill_program_.use();
    strips_.bind(0);
    eye_points_.bind(1);
    corners_.bind(2);
    boxes_.bind(3);
    counts_.bind(4);
    hit_offsets_.bind(5);
    intervals_.bind(6);
    dispatch(plan_, 0);
    resolve_program_.use();
    hit_offsets_.bind(0);
    intervals_.bind(1);
    ranges_.bind(2);
    dispatch(groups_for(pixels_));
}

bool GlBoundary::found_all() {
    if (!on_device_now_) return true;
    std::array<std::uint32_t, 2> found{};  // all hits; whether a pixel has too many, or the triangles
    hit_offsets_.read(sizeof found, found.data(), pixels_ * kWord_bytes);
    hits_ = found[0];
    if (found[1] != 0) {
        on_device_ = false;
        return false;
    }
    if (hits_ <= room_ && room_ > 0) return true;
    room_ = hits_ + hits_ / 8 + 1;
    intervals_.grow(room_ * kPair_bytes);
    return false;
}

void GlBoundary::upload_intervals(const PixelIntervals& found) {
    check_for_gl(found);
    std::vector<std::uint32_t> ranges(2 * pixels_);
    tbb::parallel_for(std::size_t{0}, pixels_, [&](std::size_t i) {
        ranges[2 * i] = found.offsets[i];
        ranges[2 * i + 1] = found.offsets[i + 1];
    });
    ranges_.upload(ranges.size() * kWord_bytes, ranges.data());
    intervals_.grow(found.depths.size() * sizeof(float));
    intervals_.upload(found.depths.size() * sizeof(float), found.depths.data());
    hits_ = found.hits;
}

void GlBoundary::bind(GLuint ranges, GLuint intervals) {
    ranges_.bind(ranges);
    intervals_.bind(intervals);
}

PixelIntervals GlBoundary::read(std::size_t pixels) const {
    std::vector<std::uint32_t> ranges(2 * pixels);
    ranges_.read(ranges.size() * kWord_bytes, ranges.data());
    std::vector<float> depths(intervals_.bytes() / sizeof(float));
    intervals_.read(intervals_.bytes(), depths.data());
    PixelIntervals result;
    result.hits = hits_;
    result.offsets.push_back(0);
    for (std::size_t i = 0; i < pixels; ++i) {
        const std::size_t first = std::size_t{2} * ranges[2 * i], end = std::size_t{2} * ranges[2 * i + 1];
        result.depths.insert(result.depths.end(), depths.begin() + static_cast<std::ptrdiff_t>(first),
                             depths.begin() + static_cast<std::ptrdiff_t>(end));
        result.offsets.push_back(static_cast<std::uint32_t>(result.depths.size() / 2));
    }
    return result;
}

}  // namespace subvol::detail
