// SPDX-License-Identifier: Apache-2.0
// The look of pictures in Python: transfer functions (Knots), cameras, the light of a picture, and pictures themselves (Image).
//
//     keywords of the look, map, ranges ─► PictureLight (look, optics) ─► camera that frames what is visible ─► render
//     array (height, width, 3 or 4) or a file ─► Image ─► array, PNG or a file
//
// Knots come as rows {value, r, g, b} and {value, opacity} and are checked when they are made. A PictureLight takes the
// opacities over the range of the shown field and the colours over the range of the field that colours it; a map of its own
// excludes the keywords `range` and `opacity`. Images hold premultiplied linear RGBA floats, rows from the top, and numpy reads
// their memory in place, read-only. Cameras and images can be pickled; depths and reports of images are not kept then.
#include <cmath>
#include <cstring>

#include "bind.h"
#include "picture.h"
#include "subvol/camera_fit.h"
#include "subvol/detail/picture_size.h"
#include "subvol/detail/points_frame.h"
#include "subvol/image_io.h"
#include "subvol/legend.h"
#include "subvol/option.h"
#include "subvol/picture_look.h"
#include "subvol/transfer_function.h"
#include "subvol/view_options.h"

namespace subvol::python {
namespace {

TransferFunction function_of(const py::object& color, const py::object& opacity) {
    const auto colors = rows_of<double>(color, 4, "color"), alphas = rows_of<double>(opacity, 2, "opacity");
    TransferFunction function;
    for (const double* c = colors.data(); c != colors.data() + colors.size(); c += 4) {
        function.color.push_back({c[0], {c[1], c[2], c[3]}});
    }
    for (const double* a = alphas.data(); a != alphas.data() + alphas.size(); a += 2) function.opacity.push_back({a[0], a[1]});
    validate(function);
    return function;
}

py::array colors_of(const TransferFunction& function) {
    std::vector<double> rows;
    for (const auto& [value, rgb] : function.color) rows.insert(rows.end(), {value, rgb.x, rgb.y, rgb.z});
    return read_only(owned(std::move(rows), {length(function.color.size()), 4}));
}

py::array opacities_of(const TransferFunction& function) {
    std::vector<double> rows;
    for (const auto& [value, alpha] : function.opacity) rows.insert(rows.end(), {value, alpha});
    return read_only(owned(std::move(rows), {length(function.opacity.size()), 2}));
}

Vec3 vector_of(const py::object& given, const char* what) {
    const auto numbers_given = numbers<double>(given, what);
    if (numbers_given.size() != 3) throw Error(ErrorCode::InvalidInput, "has another number of numbers", what, "three");
    const double* v = numbers_given.data();
    return {v[0], v[1], v[2]};
}

Camera camera_of(const py::object& eye, const py::object& target, const py::object& up, double fovy_deg, double ortho_height) {
    const Camera camera{vector_of(eye, "eye"), vector_of(target, "target"), vector_of(up, "up"), fovy_deg, ortho_height};
    (void)View(camera, 1, 1);  // checks it
    return camera;
}

Box box_of(const py::object& bounds) {
    const std::vector<Vec3> corners = vectors(bounds, "bounds");
    if (corners.size() != 2) throw Error(ErrorCode::InvalidInput, "is not a box", "bounds", "the lower and the upper corner");
    return {corners[0], corners[1]};
}

std::string repr_of(const Camera& camera) {
    return py::str("<subvol.Camera: eye {}, target {}, {}>")
        .format(as_tuple(camera.eye), as_tuple(camera.target),
                camera.ortho_height > 0 ? py::str("{} high").format(camera.ortho_height)
                                        : py::str("{} degrees").format(camera.fovy_deg));
}

Picture picture_from(const py::object& given) {
    const Error no_picture(ErrorCode::InvalidInput, "is not a picture", "image",
                           "real numbers of linear light, (height, width, 3 or 4)");
    const py::array array = array_from(given, no_picture);
    const bool right = array.ndim() == 3 && (array.shape(2) == 3 || array.shape(2) == 4) && array.dtype().kind() == 'f';
    if (!right || array.shape(0) > detail::kMostSide || array.shape(1) > detail::kMostSide || array.size() == 0) {
        throw no_picture;
    }
    const py::array_t<float, py::array::c_style | py::array::forcecast> floats(array);
    Picture picture{.image = Image(static_cast<int>(array.shape(1)), static_cast<int>(array.shape(0)))};
    const py::ssize_t channels = array.shape(2);
    const float* from = floats.data();
    for (float* to = picture.image.rgba.data(); to != picture.image.rgba.data() + picture.image.rgba.size(); to += 4) {
        to[3] = 1;
        for (py::ssize_t c = 0; c < channels; ++c) to[c] = *from++;
    }
    return picture;
}

/// The colour behind the picture: the one given, else the one that it was drawn for, else black.
Vec3 background_of(const Picture& picture, const py::object& given) {
    if (!given.is_none()) {
        const Vec3 color = vector_of(given, "background");
        if (std::isfinite(color.x + color.y + color.z)) return color;
        throw Error(ErrorCode::InvalidInput, "is not a colour", "background", "three finite numbers, linear RGB");
    }
    return picture.report.contains("background") ? vector_of(picture.report["background"], "background") : Vec3(0.0);
}

py::bytes png_of(const Picture& picture, const py::object& background) {
    const std::vector<std::uint8_t> rgb = srgb_bytes(picture.image, background_of(picture, background));
    const py::bytes bytes(reinterpret_cast<const char*>(rgb.data()), rgb.size());
    return py::module_::import("subvol._png").attr("encode")(bytes, picture.image.width, picture.image.height);
}

/// The bytes that `write` puts into a .png.
py::array srgb_of(const Picture& picture, const py::object& background) {
    const bool alpha = py::isinstance<py::str>(background) && background.cast<std::string>() == "none";
    std::vector<std::uint8_t> bytes =
        alpha ? srgba_bytes(picture.image) : srgb_bytes(picture.image, background_of(picture, background));
    return owned(std::move(bytes), {picture.image.height, picture.image.width, alpha ? 4 : 3});
}

using Pair = std::pair<double, double>;

/// The look and the colours of a picture, as the command has them.
///
/// given:  the keywords of `LookChoices`
/// map:    None, or a function of the ends of a range: the Knots of a TransferFunction
/// shown:  the range of the field that gives the opacities; colors: of the one that gives the colours
PictureLight light_of(const py::dict& given, const py::object& map, bool own_opacity, bool has_boundary, const Pair& shown,
                      const Pair& colors, const py::object& bounds) {
    LookChoices choices;
    set_options(options_of(choices), given);
    const ValueRange field{.min = shown.first, .max = shown.second}, of_colors{.min = colors.first, .max = colors.second};
    const Box box = box_of(bounds);
    if (!map.is_none() && (choices.range || choices.opacity)) {
        throw Error(ErrorCode::InvalidInput, "has no effect with a TransferFunction, which has its own",
                    choices.range ? "range" : "opacity", "the name of a colour map for tf");
    }
    const bool plain_body = has_boundary && map.is_none();
    LookOptions options = look_options(choices, chosen_look(choices, plain_body), field);
    if (map.is_none()) return {options, picture_optics(options, box, field, of_colors)};
    auto knots = map(field.min, field.max).cast<TransferFunction>();
    knots.color = map(of_colors.min, of_colors.max).cast<TransferFunction>().color;
    if (own_opacity) options.opacity = knots.opacity;
    return {options, picture_optics(std::move(knots), options, box, field, of_colors)};
}

/// The camera of the keywords of `ViewOptions`; a named view frames what is visible of the body.
///
/// mesh, kernels: what is drawn; null: something else, whose bounds are framed
Camera camera_for(const PictureLight& light, const py::dict& given, const std::pair<int, int>& size, const HexMesh* mesh,
                  const RbfVolume* kernels, const py::object& bounds) {
    ViewOptions options;
    set_options(options_of(options), given);
    std::vector<Vec3> points;
    if (mesh != nullptr) points = framed_points(*mesh, light.options.look, light.optics);
    if (kernels != nullptr && light.options.look == Look::Solid) points = detail::outline_of(*kernels);
    return find_camera(options, box_of(bounds), points, static_cast<double>(size.first) / size.second);
}

/// The look and the camera of a picture.
void bind_light(py::module_& module) {
    py::class_<PictureLight>(module, "PictureLight", "The look of a picture and its colours.")
        .def(py::init(&light_of), py::arg("given"), py::arg("map"), py::arg("own_opacity"), py::arg("has_boundary"),
             py::arg("shown"), py::arg("colors"), py::arg("bounds"))
        .def_property_readonly("knots", [](const PictureLight& light) { return light.optics.function(); })
        .def_property_readonly("opacity_unit", [](const PictureLight& light) { return light.optics.opacity_unit(); })
        .def_property_readonly("look", [](const PictureLight& light) { return std::string(name_of(light.options.look)); })
        .def_property_readonly("background",
                               [](const PictureLight& light) { return as_tuple(subvol::background_of(light.options.look)); })
        .def("camera", &camera_for, py::arg("given"), py::arg("size"), py::arg("mesh").none(true),
             py::arg("kernels").none(true), py::arg("bounds"));
    module.def(
        "frame_of", [](const RbfVolume& volume) { return as_array(detail::frame_of(volume)); }, py::arg("volume"));
}

py::tuple window_tuple(const PixelWindow& window) {
    return py::make_tuple(window.left, window.top, window.width, window.height);
}

PixelWindow window_from(const py::handle& given) {
    const auto numbers = given.cast<std::array<int, 4>>();
    return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

/// The memory of an Image, read-only.
py::array pixels_of(const py::object& self) {
    const auto& image = self.cast<const Picture&>().image;
    return view(image.rgba.data(), {image.height, image.width, 4}, self);
}

py::tuple state_of(const py::object& self) {
    const auto& picture = self.cast<const Picture&>();
    const py::object array = pixels_of(self).attr("copy")();
    if (!picture.part) return py::make_tuple(array);
    return py::make_tuple(array, window_tuple(picture.part->data), window_tuple(picture.part->display));
}

Picture picture_from_state(const py::tuple& state) {
    Picture picture = picture_from(state[0]);
    if (state.size() > 1) picture.part = Picture::Windows{window_from(state[1]), window_from(state[2])};
    return picture;
}

Picture picture_from_file(const std::string& path) {
    Picture picture;
    const py::gil_scoped_release without_gil;
    PlacedImage read = read_placed_image(path);
    if (!read.whole()) picture.part = Picture::Windows{read.data_window, read.display_window};
    picture.image = std::move(read.image);
    return picture;
}

void write_picture(const Picture& p, const py::object& given, const py::object& background) {
    const auto path = py::module_::import("subvol._arguments").attr("path_bytes")(given).cast<std::string>();
    std::optional<Vec3> behind;
    if (!py::isinstance<py::str>(background) || background.cast<std::string>() != "none") behind = background_of(p, background);
    const py::gil_scoped_release without_gil;
    const bool exr = std::filesystem::path(path).extension() == ".exr";
    const auto depth = exr ? std::span<const float>(p.depth) : std::span<const float>();
    if (p.part) {
        write_placed_image(path, {p.image, p.part->data, p.part->display}, behind.value_or(Vec3(0.0)), depth);
    } else {
        write_image(path, p.image, behind, depth, p.camera);
    }
}

void bind_image(py::module_& module) {
    py::class_<Picture>(module, "Image", py::buffer_protocol(),
                        "A picture in linear light: RGBA floats, premultiplied, rows from the top.")
        .def(py::init(&picture_from), py::arg("array"))
        .def_buffer([](Picture& picture) {
            const auto width = py::ssize_t(picture.image.width), height = py::ssize_t(picture.image.height);
            const py::ssize_t word = sizeof(float);
            return py::buffer_info(picture.image.rgba.data(), word, py::format_descriptor<float>::format(), 3,
                                   {height, width, py::ssize_t(4)}, {4 * width * word, 4 * word, word}, true);
        })
        .def(
            "__array__",  // for those who call it; numpy takes the memory itself
            [](const py::object& self, const py::object& dtype, const py::object& copy) -> py::object {
                const py::array pixels = pixels_of(self);
                if (dtype.is_none() && !copy.equal(py::bool_(true))) return pixels;
                return pixels.attr("astype")(dtype.is_none() ? py::object(pixels.dtype()) : dtype,
                                             py::arg("copy") = copy.equal(py::bool_(true)));
            },
            py::arg("dtype") = py::none(), py::arg("copy") = py::none())
        .def_property_readonly("width", [](const Picture& p) { return p.image.width; })
        .def_property_readonly("height", [](const Picture& p) { return p.image.height; })
        .def_property_readonly("depth",
                               [](const py::object& self) -> py::object {
                                   const auto& p = self.cast<const Picture&>();
                                   if (p.depth.empty()) return py::none();
                                   return view(p.depth.data(), {p.image.height, p.image.width}, self);
                               })
        .def_property_readonly("data_window", [](const Picture& p) { return window_tuple(p.windows().data); })
        .def_property_readonly("display_window", [](const Picture& p) { return window_tuple(p.windows().display); })
        .def_property_readonly("report", [](const Picture& p) { return p.report; })
        .def("to_srgb", &srgb_of, py::arg("background") = py::none(),
             "The picture as 8-bit sRGB, (height, width, 3) uint8: what screens, matplotlib and other programs show, and what "
             "`write`\n"
             "puts into a .png.\n\n"
             "background: linear RGB behind the picture; None: that which it was drawn for; \"none\": (height, width, 4), with "
             "an\n"
             "            alpha that the colours are not multiplied by\n")
        .def("png", &png_of, py::arg("background") = py::none())
        .def("_repr_png_", [](const Picture& p) { return png_of(p, py::none()); })
        .def("write", &write_picture, py::arg("path"), py::arg("background") = py::none())
        .def("__repr__",
             [](const Picture& p) {
                 return "<subvol.Image: " + std::to_string(p.image.width) + " x " + std::to_string(p.image.height) + " pixels>";
             })
        .def(py::pickle(&state_of, &picture_from_state));
    module.def("read_image", &picture_from_file, py::arg("path"));
}

}  // namespace

void bind_look(py::module_& module) {
    py::class_<TransferFunction>(module, "Knots", "Colours and opacities of values.")
        .def(py::init(&function_of), py::arg("color"), py::arg("opacity"))
        .def_property_readonly("color", &colors_of)
        .def_property_readonly("opacity", &opacities_of);
    module.def("preset", &transfer_function_preset, py::arg("name"), py::arg("min"), py::arg("max"));
    module.def(
        "read_transfer_function",
        [](const std::string& path, const std::string& name) { return read_transfer_function(path, name); }, py::arg("path"),
        py::arg("name"));
    module.def("stretched", &stretched, py::arg("knots"), py::arg("min"), py::arg("max"));
    module.def(
        "parse_opacity",
        [](const std::string& text, double min, double max) {
            TransferFunction function;
            function.opacity = parse_opacity(text, min, max);
            return opacities_of(function);
        },
        py::arg("text"), py::arg("min"), py::arg("max"));
    module.def(
        "legend_svg",
        [](const TransferFunction& knots, const std::string& title, double min, double max, int width_px) {
            return legend_svg(knots, {.title = title, .min = min, .max = max, .width_px = width_px});
        },
        py::arg("knots"), py::arg("title"), py::arg("min"), py::arg("max"), py::arg("width_px"));

    py::class_<Camera>(module, "Camera", "A camera without a lens; pixel (0,0) is the top left.")
        .def(py::init(&camera_of), py::arg("eye"), py::arg("target"), py::arg("up") = py::make_tuple(0.0, 0.0, 1.0),
             py::arg("fovy_deg") = 40.0, py::arg("ortho_height") = 0.0)
        .def_property_readonly("eye", [](const Camera& c) { return as_tuple(c.eye); })
        .def_property_readonly("target", [](const Camera& c) { return as_tuple(c.target); })
        .def_property_readonly("up", [](const Camera& c) { return as_tuple(c.up); })
        .def_readonly("fovy_deg", &Camera::fovy_deg)
        .def_readonly("ortho_height", &Camera::ortho_height)
        .def_static(
            "parse",
            [](const std::string& text, const py::object& bounds, double aspect) {
                return parse_camera(text, box_of(bounds), aspect);
            },
            py::arg("text"), py::arg("bounds"), py::arg("aspect") = 1.0)
        .def(
            "fit",
            [](const Camera& c, const py::object& points, double aspect) {
                return fit_camera_to_points(c, vectors(points, "points"), aspect);
            },
            py::arg("points"), py::arg("aspect") = 1.0)
        .def(
            "fit_box",
            [](const Camera& c, const py::object& bounds, double aspect) { return fit_camera(c, box_of(bounds), aspect); },
            py::arg("bounds"), py::arg("aspect") = 1.0)
        .def(
            "orthographic",
            [](const Camera& c, const py::object& bounds, double aspect) {
                return orthographic_camera(c, box_of(bounds), aspect);
            },
            py::arg("bounds"), py::arg("aspect") = 1.0)
        .def(
            "turntable",
            [](const Camera& c, const py::object& center, int frames) {
                return turntable(c, vector_of(center, "center"), frames);
            },
            py::arg("center"), py::arg("frames"))
        .def_property_readonly("text", &subvol::camera_text)
        .def("__repr__", &repr_of)
        .def(py::pickle(
            [](const Camera& c) {
                return py::make_tuple(as_tuple(c.eye), as_tuple(c.target), as_tuple(c.up), c.fovy_deg, c.ortho_height);
            },
            [](const py::tuple& s) { return camera_of(s[0], s[1], s[2], s[3].cast<double>(), s[4].cast<double>()); }));
    module.attr("largest_side") = detail::kMostSide;
    bind_light(module);
    bind_image(module);
}

}  // namespace subvol::python
