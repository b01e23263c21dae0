// SPDX-License-Identifier: Apache-2.0
#include "subvol/camera.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "camera_axes.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/picture_size.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"
#include "subvol/raster.h"

namespace subvol {

using namespace detail;
namespace {

std::optional<Vec3> view_direction(std::string_view name, UpAxis up) {
    if (name == "+x") return Vec3(-1, 0, 0);
    if (name == "-x") return Vec3(1, 0, 0);
    if (name == "+y") return Vec3(0, -1, 0);
    if (name == "-y") return Vec3(0, 1, 0);
    if (name == "+z") return Vec3(0, 0, -1);
    if (name == "-z") return Vec3(0, 0, 1);
    if (name == "right") return turned_upright({-1, 0, 0}, up);
    if (name == "left") return turned_upright({1, 0, 0}, up);
    if (name == "back") return turned_upright({0, -1, 0}, up);
    if (name == "front") return turned_upright({0, 1, 0}, up);
    if (name == "top") return turned_upright({0, 0, -1}, up);
    if (name == "bottom") return turned_upright({0, 0, 1}, up);
    if (name == "iso") return turned_upright({-1, 1, -1}, up);
    return std::nullopt;
}

/// The numbers of "a,b,c"; nothing if the text is something else.
std::optional<std::vector<double>> parse_numbers(std::string_view text) {
    std::vector<double> numbers;
    for (;;) {
        const std::size_t comma = text.find(',');
        const auto number = number_from(text.substr(0, comma));
        if (!number) return std::nullopt;
        numbers.push_back(*number);
        if (comma == std::string_view::npos) return numbers;
        text.remove_prefix(comma + 1);
    }
}

Camera camera_from_numbers(const std::vector<double>& n) {
    require(n.size() == 10 || n.size() == 11, "a camera in numbers has ten of them", "ex,ey,ez,tx,ty,tz,ux,uy,uz,fovy");
    return {.eye = {n[0], n[1], n[2]},
            .target = {n[3], n[4], n[5]},
            .up = {n[6], n[7], n[8]},
            .fovy_deg = n[9],
            .ortho_height = n.size() == 11 ? n[10] : 0.0};
}

void read_number(const nlohmann::json& object, const std::string& file, const char* key, double& value) {
    const auto found = object.find(key);
    if (found == object.end()) return;
    if (!found->is_number()) throw Error(ErrorCode::InvalidInput, std::string("key '") + key + "' is not a number", file);
    value = found->get<double>();
}

void read_vector(const nlohmann::json& object, const std::string& file, const char* key, Vec3& value) {
    const auto found = object.find(key);
    if (found == object.end()) return;
    const bool ok = found->is_array() && found->size() == 3 && (*found)[0].is_number() && (*found)[1].is_number() &&
                    (*found)[2].is_number();
    if (!ok) throw Error(ErrorCode::InvalidInput, std::string("key '") + key + "' is not an array of three numbers", file);
    value = {(*found)[0].get<double>(), (*found)[1].get<double>(), (*found)[2].get<double>()};
}

nlohmann::json read_json_object(const std::string& file) {
    nlohmann::json json;
    try {
        json = nlohmann::json::parse(detail::of_limited_depth(detail::read_text(file), file));
    } catch (const nlohmann::json::exception& e) {
        throw Error(ErrorCode::InvalidInput, "is not JSON: " + detail::parser_message(e.what()), file);
    }
    if (!json.is_object()) throw Error(ErrorCode::InvalidInput, "is not a JSON object", file);
    return json;
}

Camera read_camera(const std::string& file) {
    nlohmann::json json = read_json_object(file);
    if (json.contains("camera") && json["camera"].is_object()) json = nlohmann::json(json["camera"]);  // of `render --json`
    for (const char* key : {"eye", "target"}) {
        if (!json.contains(key)) throw Error(ErrorCode::InvalidInput, std::string("key '") + key + "' is missing", file);
    }
    Camera camera;
    read_vector(json, file, "eye", camera.eye);
    read_vector(json, file, "target", camera.target);
    camera.up = upright_for(camera.target - camera.eye);
    read_vector(json, file, "up", camera.up);
    read_number(json, file, "fovy_deg", camera.fovy_deg);
    read_number(json, file, "ortho_height", camera.ortho_height);
    return camera;
}

}  // namespace

void detail::validate(const Camera& camera) {
    constexpr double kParallelSine = 1e-9;  // below it, rounding decides where `up` points
    require(finite(camera.eye) && finite(camera.target) && finite(camera.up), "eye, target and up must be finite numbers");
    require(camera.eye != camera.target, "eye and target are the same point");
    require(camera.up != Vec3(0.0), "up is zero");
    require(std::isfinite(camera.ortho_height) && camera.ortho_height >= 0, "ortho_height is negative or not finite",
            "0: perspective; else world units");
    if (camera.ortho_height == 0) {
        require(camera.fovy_deg > 0 && camera.fovy_deg < 180, "the field of view is out of range", "0 < fovy_deg < 180");
    }
    const double sine = glm::length(glm::cross(glm::normalize(camera.target - camera.eye), glm::normalize(camera.up)));
    require(sine > kParallelSine, "up is parallel to the direction of view");
}

View::View(const Camera& camera, int width, int height)
    : camera_(camera),
      width_(width),
      height_(height),
      perspective_(camera.ortho_height == 0),
      pixel_(0),
      eye_(camera.eye),
      axes_() {
    require(width >= 1 && width <= kMostSide && height >= 1 && height <= kMostSide, "the picture's size is out of range",
            "1..65536 pixels a side");
    require(std::int64_t{width} * height <= kMostPixels, "the picture has too many pixels", "at most 2^28");
    validate(camera);
    pixel_ = (perspective_ ? 2 * half_fov_tangent(camera.fovy_deg) : camera.ortho_height) / height;
    axes_ = camera_axes(camera.target - camera.eye, camera.up);
}

Vec3 View::to_eye(const Vec3& world) const {
    const Vec3 d = world - eye_;
    return {glm::dot(axes_[0], d), glm::dot(axes_[1], d), glm::dot(axes_[2], d)};
}

Vec2 View::to_pixels(const Vec3& eye_point) const {
    const double scale = 1 / (perspective_ ? eye_point.z * pixel_ : pixel_);
    return {0.5 * width_ + eye_point.x * scale, 0.5 * height_ - eye_point.y * scale};
}

Ray View::ray(double x_px, double y_px) const {
    const Vec2 s = slopes(x_px, y_px);
    const Vec3 across = s.x * axes_[0] + s.y * axes_[1];
    if (perspective_) return {eye_, axes_[2] + across, ray_end(x_px, y_px)};
    return {eye_ + across, axes_[2], ray_end(x_px, y_px)};
}

View View::resized(int width, int height) const {
    View other(camera_, width, height);
    other.ends_ = ends_;
    return other;
}

void View::end_rays(std::vector<float> depths) {
    if (depths.size() != pixel_count(width_, height_)) {
        throw Error(ErrorCode::InvalidInput, "there are " + std::to_string(depths.size()) + " depths", "ray ends",
                    "one for each of the " + std::to_string(width_) + " x " + std::to_string(height_) + " pixels");
    }
    if (std::ranges::any_of(depths, [](float depth) { return std::isnan(depth); })) {
        throw Error(ErrorCode::InvalidInput, "a depth is not a number", "ray ends", "infinity where a ray does not end");
    }
    ends_ = std::make_shared<const RayEnds>(RayEnds{width_, height_, std::move(depths)});
}

std::span<const float> View::ray_ends() const {
    return ends_ ? std::span(ends_->depths) : std::span<const float>();
}

double View::ray_end(double x_px, double y_px) const {
    if (!ends_) return std::numeric_limits<double>::infinity();
    const auto at = [](double place, int from, int to) {
        return static_cast<int>(std::clamp(std::floor(place * to / from), 0.0, to - 1.0));
    };
    return double{ends_->depths[pixel_index(ends_->width, at(x_px, width_, ends_->width), at(y_px, height_, ends_->height))]};
}

Camera parse_camera(const std::string& text, const Box& box, double aspect, UpAxis up) {
    constexpr double kViewFovyDeg = 30;
    if (const auto direction = view_direction(text, up)) return fit_camera(box, *direction, kViewFovyDeg, aspect, up);
    Camera camera;
    if (const auto numbers = parse_numbers(text)) {
        camera = camera_from_numbers(*numbers);
    } else {
        std::error_code ignored;
        if (text.empty() || !std::filesystem::exists(text, ignored)) {
            throw Error(ErrorCode::InvalidInput, "is neither a view nor ten numbers nor a file that exists",
                        "camera '" + detail::shortened(text) + "'",
                        "+x -x +y -y +z -z iso, right left back front top bottom; ex,ey,ez,tx,ty,tz,ux,uy,uz,fovy; FILE.json");
        }
        camera = read_camera(text);
    }
    validate(camera);
    return camera;
}

}  // namespace subvol
