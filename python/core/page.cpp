// SPDX-License-Identifier: Apache-2.0
#include "subvol/page.h"

#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <iterator>

#include "bind.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/option.h"
#include "subvol/view_options.h"

namespace subvol::python {
namespace {

/// A page of one field.
///
/// skin: the boundary with its values; None: that of the volume, where the value is that of the first kernel
py::tuple page(const RbfVolume& volume, const BoundaryValues* skin, const TransferFunction& function, const std::string& unit,
               double low, double high, const std::string& look, const Camera& camera, const std::string& up,
               double opacity_unit, const std::array<double, 3>& background, const std::string& title,
               const std::string& source, std::size_t max_bytes, const py::object& progress) {
    if (volume.channels.empty()) throw Error(ErrorCode::InvalidInput, "has no channel", "volume", "one channel");
    PageStep step{.label = {}, .volume = volume, .boundary = {}};
    if (skin != nullptr) {
        step.boundary = *skin;
    } else {
        const double value = volume.channels.front().values.empty() ? 0 : volume.channels.front().values.front();
        step.boundary = {volume.boundary, {std::vector<double>(volume.boundary.points.size(), value)}};
    }
    const std::vector<PageStep> steps{std::move(step)};
    PageOptions options{.title = title,
                        .source = source,
                        .look = named<PageLook>(look, "look"),
                        .camera = camera,
                        .up = named<UpAxis>(up, "up")};
    options.fields.push_back(
        {.name = volume.channels.front().name, .unit = unit, .function = function, .min = low, .max = high});
    options.opacity_unit_world = opacity_unit;
    options.background = {background[0], background[1], background[2]};
    options.max_bytes = max_bytes;
    const PageResult made = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return make_page(steps, options);
    });
    py::dict report;
    report["bytes"] = made.report.bytes;
    report["points"] = made.report.kernels;
    report["kept"] = made.report.kept;
    report["bits"] = made.report.bits;
    report["triangles"] = made.report.triangles;
    report["rmse"] = made.report.errors.front().rmse;
    report["max_error"] = made.report.errors.front().max_abs;
    return py::make_tuple(made.html, report);
}

/// The keywords of page() that the library describes.
struct GivenPage {
    LookChoices look{};
    ViewOptions eye{};
};

std::vector<Option> options_of(GivenPage& given) {
    std::vector<Option> all = options_of(given.look);
    std::ranges::move(options_of(given.eye), std::back_inserter(all));
    std::erase_if(all, [](const Option& option) { return option.name == "size" || option.name == "turntable"; });
    return all;
}

}  // namespace

void bind_page(py::module_& module) {
    GivenPage given;
    describe(module, "page", options_of(given));
    module.def("page", &page, py::arg("volume"), py::arg("skin"), py::arg("function"), py::arg("unit"), py::arg("low"),
               py::arg("high"), py::arg("look"), py::arg("camera"), py::arg("up"), py::arg("opacity_unit"),
               py::arg("background"), py::arg("title"), py::arg("source"), py::arg("max_bytes"), py::arg("progress"));
    module.def("write_text", &detail::write_text_file, py::arg("path"), py::arg("text"));
}

}  // namespace subvol::python
