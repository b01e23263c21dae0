// SPDX-License-Identifier: Apache-2.0
#include "subvol/view_options.h"

#include <charconv>
#include <cstdint>
#include <limits>
#include <string_view>
#include <utility>

#include "subvol/camera_fit.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/picture_size.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {
namespace {

/// The largest number for one of too many digits.
std::int64_t pixels_of(std::string_view digits, const std::string& text, const std::string& where) {
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    const bool digits_only = !digits.empty() && digits.find_first_not_of("0123456789") == std::string_view::npos;
    if (!digits_only || number == 0) {
        throw Error(ErrorCode::InvalidInput, "'" + detail::shortened(text) + "' is not a picture size", where,
                    "write it as 640x480 or 512");
    }
    return error == std::errc() ? number : std::numeric_limits<std::int64_t>::max();
}

}  // namespace

PictureSize parse_size(const std::string& text, const std::string& where) {
    using detail::kMostPixels, detail::kMostSide;
    const std::size_t cross = text.find('x');
    const std::int64_t width = pixels_of(std::string_view(text).substr(0, cross), text, where);
    const std::int64_t height =
        cross == std::string::npos ? width : pixels_of(std::string_view(text).substr(cross + 1), text, where);
    if (width > kMostSide || height > kMostSide || width * height > kMostPixels) {
        throw Error(ErrorCode::InvalidInput, "'" + detail::shortened(text) + "' is too large a picture", where,
                    "1 to " + std::to_string(kMostSide) + " pixels a side, " + std::to_string(kMostPixels) + " in all");
    }
    return {static_cast<int>(width), static_cast<int>(height)};
}

std::vector<Option> options_of(ViewOptions& options) {
    constexpr int kMostFrames = 100'000;
    PictureSize& size = options.size;
    return {
        Option("size",
               WordValue{[&size] { return std::to_string(size.width) + "x" + std::to_string(size.height); },
                         [&size](const std::string& text, const std::string& where) { size = parse_size(text, where); }})
            .help("WxH", "width and height of the picture in pixels"),
        Option("camera", options.camera)
            .help("CAMERA",
                  "ex,ey,ez,tx,ty,tz,ux,uy,uz,fovy (eye, target, up, vertical field of view in degrees), or a JSON file with "
                  "eye, target, up, fovy_deg or ortho_height"),
        Option("view", options.view)
            .offer({"+x", "-x", "+y", "-y", "+z", "-z", "iso", "front", "back", "left", "right", "top", "bottom"})
            .help("SIDE", "the side to look from: +x -x +y -y +z -z iso, front (-y) back left right top bottom")
            .instead_of({"camera"}),
        Option("up", options.up)
            .help("AXIS", "the axis of the data that is up, in iso, front and all other views: x, y or z")
            .instead_of({"camera"}),
        Option("fit", options.fit).help("move the camera along its line of sight until the whole box is in the picture"),
        Option("ortho", options.orthographic)
            .help("use an orthographic camera, as high as the box needs or as the JSON file's ortho_height"),
        Option("turntable", options.turntable)
            .between(1, kMostFrames)
            .help("N",
                  "N pictures of one turn about the camera's up axis; -o NAME.png (or .exr) writes NAME_0000.png and so on, "
                  ".mp4, .webm and .gif write a video (with the program ffmpeg)")};
}

Camera camera_of_option(const std::string& option, const std::string& text, const Box& box, double aspect, UpAxis up) {
    try {
        return parse_camera(text, box, aspect, up);
    } catch (const Error& error) {
        const std::string where = error.where().empty() ? "" : error.where() + ": ";
        throw Error(error.code(), where + error.message(), option, error.allowed());
    }
}

std::string camera_text(const Camera& camera) {
    const auto& [eye, target, up, fovy, height] = camera;
    std::string text;
    for (const double number : {eye.x, eye.y, eye.z, target.x, target.y, target.z, up.x, up.y, up.z, fovy}) {
        text += (text.empty() ? "" : ",") + detail::exact_text(number);
    }
    return height > 0 ? text + "," + detail::exact_text(height) : text;
}

Facts facts_of(const Camera& camera) {
    Facts facts;
    for (const auto& [name, v] : {std::pair("eye", camera.eye), {"target", camera.target}, {"up", camera.up}}) {
        facts[name] = FactValue::List{v.x, v.y, v.z};
    }
    if (camera.ortho_height > 0) {
        facts["ortho_height"] = camera.ortho_height;
    } else {
        facts["fovy_deg"] = camera.fovy_deg;
    }
    return facts;
}

Camera find_camera(const ViewOptions& options, const Box& box, std::span<const Vec3> points, double aspect, OptionNames names) {
    const bool named = !options.camera.has_value();
    Camera camera = camera_of_option(option_name(named ? "view" : "camera", names), options.camera.value_or(options.view), box,
                                     aspect, options.up);
    const bool made_orthographic = options.orthographic && camera.ortho_height == 0;
    if (made_orthographic) camera = orthographic_camera(camera, box, aspect);
    // A named view shows the whole box, so all pictures of its turntable do.
    if (options.turntable && (options.fit || named || made_orthographic)) {
        return fit_turntable(camera, box, *options.turntable, aspect);
    }
    if (named && !points.empty()) return fit_camera_to_points(camera, points, aspect);
    return options.fit ? fit_camera(camera, box, aspect) : camera;
}

}  // namespace subvol
