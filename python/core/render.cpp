// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>

#include "bind.h"
#include "picture.h"
#include "subvol/boundary_values.h"
#include "subvol/gl_device.h"
#include "subvol/picture_maker.h"
#include "subvol/voxels.h"

namespace subvol::python {
namespace {

using SixNumbers = std::array<double, 6>;

CutPlane plane_of(const SixNumbers& n) {
    return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
}

Clip clip_of(const std::vector<SixNumbers>& planes, const std::optional<SixNumbers>& box, const std::vector<SixNumbers>& slices,
             bool around_slices) {
    Clip clip{.around_slices = around_slices};
    for (const SixNumbers& plane : planes) clip.planes.push_back(plane_of(plane));
    for (const SixNumbers& plane : slices) clip.slices.push_back(plane_of(plane));
    if (box) clip.box = Box{{(*box)[0], (*box)[1], (*box)[2]}, {(*box)[3], (*box)[4], (*box)[5]}};
    validate(clip);
    return clip;
}

/// The look of a picture, its colours, and whether the opacities are those that the look has by itself.
struct PictureLight {
    Look look;
    Optics optics;
    bool own_opacity;
};

/// The value of a keyword of render(). throws: TypeError for another type
template <class Value>
Value value_of(const py::dict& given, const char* keyword, Value otherwise) {
    if (!given.contains(keyword)) return otherwise;
    try {
        return given[keyword].cast<Value>();
    } catch (const py::cast_error&) {
        throw py::type_error(std::string(keyword) + ": a value of type " +
                             std::string(py::str(py::type::of(given[keyword]).attr("__name__"))) + " is not accepted");
    }
}

MethodOptions method_options(Method method, const PictureLight& light, const py::dict& given) {
    MethodOptions options{.style = {.method = method, .look = {.look = light.look}}, .names = OptionNames::Keywords};
    RefineOptions refinement;
    std::vector<Option> described = scheme_and(refinement.scheme, options_of(options.kernels.sample));
    described.push_back(options_of(refinement).back());
    std::ranges::move(options_of(options.splat), std::back_inserter(described));
    std::ranges::move(options_of(options), std::back_inserter(described));
    for (const OptionUse& use : option_uses()) {
        const std::string keyword(use.keyword);
        const auto option = std::ranges::find(described, use.name, &Option::name);
        if (!keyword.empty() && option != described.end() && given.contains(keyword.c_str()))
            set_option(*option, given[keyword.c_str()], keyword);
    }
    options.kernels.sample.scheme = refinement.scheme;
    if (given.contains("levels")) options.kernels.levels = refinement.levels;
    options.style.clip = clip_of(value_of<std::vector<SixNumbers>>(given, "clip", {}),
                                 value_of<std::optional<SixNumbers>>(given, "clip_box", {}),
                                 value_of<std::vector<SixNumbers>>(given, "slice", {}), value_of(given, "around", false));
    if (light.own_opacity) options.style.look.opacity = light.optics.function().opacity;
    if (value_of(given, "shade", false)) options.splat.shading = Shading{};
    return options;
}

/// What was given for an option of the command, by its keyword.
std::optional<std::string> text_of(const py::dict& given, std::string_view name) {
    const std::string keyword = option_name(name, OptionNames::Keywords);
    if (keyword.empty() || !given.contains(keyword.c_str())) return std::nullopt;
    return std::string(py::str(given[keyword.c_str()]));
}

/// The facts under the names of the command's JSON; the seconds of all stages together.
py::dict report_of(const Facts& facts) {
    py::dict report = dict_of(facts);
    if (const FactValue* const stages = facts.find("seconds")) {
        double sum = 0;
        for (const Fact& stage : std::get<Facts>(stages->value).all()) sum += std::get<double>(stage.value.value);
        report["seconds"] = sum;
    }
    return report;
}

/// What is drawn, as Python has it: one of them.
///
/// colors:   a mesh whose field gives the colours; null: the one that is shown
/// channels: of the points
struct DrawnBody {
    const HexMesh* mesh = nullptr;
    const HexMesh* colors = nullptr;
    const RbfVolume* points = nullptr;
    std::vector<std::size_t> channels{};
    const Voxels* voxels = nullptr;
};

Picture render(const DrawnBody& drawn, const std::string& method_name, const View& view, const PictureLight& light,
               const py::dict& given, const py::object& progress) {
    const auto method = named<Method>(method_name, "method");
    HexMesh two_fields;
    PictureBody body{.kernels = drawn.points, .voxels = drawn.voxels, .channels = drawn.channels};
    if (drawn.mesh != nullptr) body.mesh = *drawn.mesh;
    check_method(method, body.kind(), OptionNames::Keywords);
    check_options(
        bit(method), body.kind(), [&](std::string_view name) { return text_of(given, name); }, OptionNames::Keywords);
    if (drawn.colors != nullptr) {
        two_fields = *drawn.mesh;
        two_fields.attributes.push_back(drawn.colors->attributes.front());
        body.mesh = two_fields;
    }
    PictureMaker maker(std::move(body), method_options(method, light, given));
    subvol::Picture picture = result_of(progress, [&](Progress* listener) { return maker.draw(view, light.optics, listener); });
    return {std::move(picture.image), std::move(picture.depth), report_of(picture.facts)};
}

/// The boundary of a body that is lit, and the limit's values on it, as the command has them.
BoundaryValues skin(const HexMesh& mesh, const std::string& scheme, double tension, const std::optional<double>& crease_angle,
                    const std::optional<int>& levels) {
    const py::gil_scoped_release without_gil;
    return boundary_values(mesh, refine_options(scheme, picture_levels(mesh, levels), tension, crease_angle));
}

py::list devices() {
    const std::vector<GlDevice> found = [] {
        const py::gil_scoped_release without_gil;
        return gl_devices();
    }();
    py::list list;
    for (const GlDevice& device : found) {
        py::dict one;
        one["renderer"] = device.renderer;
        one["hardware"] = device.hardware;
        one["version"] = device.version;
        list.append(one);
    }
    return list;
}

}  // namespace

void bind_render(py::module_& module) {
    py::class_<Voxels>(module, "Voxels", "The voxels of a grid, for the renderer.");
    py::class_<BoundaryValues>(module, "BoundaryValues", "A boundary with the limit's values on it.");
    py::class_<DrawnBody>(module, "DrawnBody", "What render() draws.")
        .def(py::init([](const HexMesh* mesh, const HexMesh* colors, const RbfVolume* points,
                         const std::vector<std::size_t>& channels, const Voxels* voxels) {
                 return DrawnBody{mesh, colors, points, channels, voxels};
             }),
             py::arg("mesh").none(true) = py::none(), py::arg("colors").none(true) = py::none(),
             py::arg("points").none(true) = py::none(), py::arg("channels") = std::vector<std::size_t>{},
             py::arg("voxels").none(true) = py::none(), py::keep_alive<1, 2>(), py::keep_alive<1, 3>(), py::keep_alive<1, 4>(),
             py::keep_alive<1, 6>());
    py::class_<PictureLight>(module, "PictureLight", "The look of a picture and its colours.")
        .def(py::init([](Look look, const TransferFunction& knots, double unit_world, bool own_opacity) {
                 return PictureLight{look, Optics(knots, unit_world), own_opacity};
             }),
             py::arg("look"), py::arg("knots"), py::arg("opacity_unit"), py::arg("own_opacity"));
    module.def(
        "render",
        [](const DrawnBody& body, const std::string& method, const Camera& camera, const std::pair<int, int>& size,
           const PictureLight& light, const py::dict& given, const py::object& progress) {
            return render(body, method, View(camera, size.first, size.second), light, given, progress);
        },
        py::arg("body"), py::arg("method"), py::arg("camera"), py::arg("size"), py::arg("light"), py::arg("given"),
        py::arg("progress"));
    module.def("skin", &skin, py::arg("mesh"), py::arg("scheme"), py::arg("tension"), py::arg("crease_angle"),
               py::arg("levels"));
    module.def(
        "draws_kernels", [](const std::string& method) { return draws_kernels(named<Method>(method, "method")); },
        py::arg("method"));
    module.def("gl_devices", &devices);
}

}  // namespace subvol::python
