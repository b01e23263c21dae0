// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>

#include "bind.h"
#include "picture.h"
#include "subvol/camera_fit.h"
#include "subvol/detail/picture_size.h"
#include "subvol/detail/points_frame.h"
#include "subvol/image_io.h"
#include "subvol/legend.h"
#include "subvol/picture_look.h"
#include "subvol/transfer_function.h"

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
    return owned(std::move(rows), {length(function.color.size()), 4});
}

py::array opacities_of(const TransferFunction& function) {
    std::vector<double> rows;
    for (const auto& [value, alpha] : function.opacity) rows.insert(rows.end(), {value, alpha});
    return owned(std::move(rows), {length(function.opacity.size()), 2});
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

std::string camera_text(const Camera& camera) {
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
    if (!given.is_none()) return vector_of(given, "background");
    return picture.report.contains("background") ? vector_of(picture.report["background"], "background") : Vec3(0.0);
}

py::bytes png_of(const Picture& picture, const py::object& background) {
    const std::vector<std::uint8_t> rgb = srgb_bytes(picture.image, background_of(picture, background));
    const py::bytes bytes(reinterpret_cast<const char*>(rgb.data()), rgb.size());
    return py::module_::import("subvol._png").attr("encode")(bytes, picture.image.width, picture.image.height);
}

/// What pictures of a look are without options, as the command has it.
void bind_default_looks(py::module_& module) {
    py::enum_<Look>(module, "Look")
        .value("solid", Look::Solid)
        .value("volume", Look::Volume)
        .value("xray", Look::Xray)
        .value("isosurface", Look::Isosurface);
    module.def(
        "look_named", [](const std::string& name) { return named<Look>(name, "look"); }, py::arg("name"));
    module.def(
        "look_colors", [](Look look) { return subvol::colors_of(LookOptions{.look = look}); }, py::arg("look"));
    module.def(
        "look_background", [](Look look) { return as_tuple(subvol::background_of(look)); }, py::arg("look"));
    module.def(
        "look_opacity_unit", [](Look look, const py::object& bounds) { return opacity_unit_of(look, box_of(bounds)); },
        py::arg("look"), py::arg("bounds"));
    module.def(
        "solid",
        [](TransferFunction knots, bool keep_opacity, bool plain) {
            const auto opacity = knots.opacity;
            make_solid(knots, plain);
            if (keep_opacity) knots.opacity = opacity;
            return knots;
        },
        py::arg("knots"), py::arg("keep_opacity"), py::arg("plain"));
    module.def(
        "frame_of", [](const RbfVolume& volume) { return as_array(detail::frame_of(volume)); }, py::arg("volume"));
    module.def(
        "outline_of",
        [](const RbfVolume& volume) {
            std::vector<double> rows;
            for (const Vec3& p : detail::outline_of(volume)) rows.insert(rows.end(), {p.x, p.y, p.z});
            const std::size_t count = rows.size() / 3;
            return owned(std::move(rows), {length(count), 3});
        },
        py::arg("volume"));
    module.def(
        "framed_points",
        [](const HexMesh& mesh, Look look, const TransferFunction& knots, double opacity_unit) {
            const std::vector<Vec3> points = framed_points(mesh, look, Optics(knots, opacity_unit));
            std::vector<double> rows;
            for (const Vec3& p : points) rows.insert(rows.end(), {p.x, p.y, p.z});
            return owned(std::move(rows), {length(points.size()), 3});
        },
        py::arg("mesh"), py::arg("look"), py::arg("knots"), py::arg("opacity_unit"));
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
    const Vec3 behind = background_of(p, background);
    const py::gil_scoped_release without_gil;
    const bool exr = std::filesystem::path(path).extension() == ".exr";
    const auto depth = exr ? std::span<const float>(p.depth) : std::span<const float>();
    if (p.part) {
        write_placed_image(path, {p.image, p.part->data, p.part->display}, behind, depth);
    } else {
        write_image(path, p.image, behind, depth);
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
        .def("__repr__", &camera_text)
        .def(py::pickle(
            [](const Camera& c) {
                return py::make_tuple(as_tuple(c.eye), as_tuple(c.target), as_tuple(c.up), c.fovy_deg, c.ortho_height);
            },
            [](const py::tuple& s) { return camera_of(s[0], s[1], s[2], s[3].cast<double>(), s[4].cast<double>()); }));
    module.attr("largest_side") = detail::kMostSide;
    bind_default_looks(module);
    bind_image(module);
}

}  // namespace subvol::python
