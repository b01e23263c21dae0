// SPDX-License-Identifier: Apache-2.0
// Volumes of radial basis functions (RbfVolume) in Python: sampled from meshes, reduced, read, or made from arrays, and written
// as points, kernel files or USD.
//
//     centers (n,3), frames (n,6), values by channel ─► volume, checked ─► read-only views under the channels' names
//
// A frame holds six numbers of a symmetric matrix. The dictionary of values says which channels there are; gradients, moments
// and Hessians are put into these by name. Gradients and moments that are not given are 0, Hessians are left out. Sampling
// clamps a channel of one number to the bounds of the field that it comes from. Kernels are described by JSON, and can be
// fitted to the basis function of a scheme or evaluated at offsets.
#include <algorithm>
#include <filesystem>

#include "bind.h"
#include "subvol/basis_function.h"
#include "subvol/clamp_channel.h"
#include "subvol/detail/printable.h"
#include "subvol/field_range.h"
#include "subvol/fit_kernel.h"
#include "subvol/kernel_file.h"
#include "subvol/option.h"
#include "subvol/points_io.h"
#include "subvol/reduce.h"
#include "subvol/sample.h"
#include "subvol/sample_mixed.h"
#include "subvol/usd_file.h"
#include "subvol/visible_points.h"

namespace subvol::python {
namespace {

py::array view_of_points(const std::vector<Vec3>& points, const py::handle& owner) {
    return view(reinterpret_cast<const double*>(points.data()), {length(points.size()), 3}, owner);
}

/// A dictionary of the channels' arrays; of Hessians only where there are some.
template <class Array>
py::object of_channels(const Array RbfChannel::*array, const py::object& self) {
    py::dict channels;
    for (const RbfChannel& channel : self.cast<const RbfVolume&>().channels) {
        const auto& values = channel.*array;
        using Item = typename Array::value_type;
        std::vector<py::ssize_t> shape{length(values.size())};
        if constexpr (sizeof(Item) > sizeof(float)) shape.push_back(sizeof(Item) / sizeof(float));
        if (values.empty()) continue;
        channels[py::str(channel.name)] = view(reinterpret_cast<const float*>(values.data()), std::move(shape), self);
    }
    return read_only(channels, "the channels of a volume", "RbfVolume(...) makes one with others");
}

/// Puts arrays by name into the channels of these names; one of a channel that there is not is refused.
template <class Item>
void fill_channels(std::vector<RbfChannel>& channels, std::vector<Item> RbfChannel::*array, const py::object& arrays,
                   const std::string& what) {
    constexpr std::size_t kWide = sizeof(Item) / sizeof(float);
    for_each_named(arrays, what, [&](const std::string& name, const py::handle& given) {
        const std::string where = what + "['" + name + "']";
        const auto channel = std::ranges::find(channels, name, &RbfChannel::name);
        if (channel == channels.end()) throw Error(ErrorCode::InvalidInput, "is of no channel", where, "a name of values");
        py::array_t<float> rows;
        if constexpr (kWide == 1) {
            rows = numbers<float>(given, where);
        } else {
            rows = rows_of<float>(given, kWide, where);
        }
        const auto* first = reinterpret_cast<const Item*>(rows.data());
        ((*channel).*array).assign(first, first + rows.size() / py::ssize_t(kWide));
    });
}

RbfVolume volume_of(const py::object& centers, const py::object& frames, const py::object& values, const py::object& gradients,
                    const py::object& moments, const py::object& hessians, const std::string& kernel,
                    const py::object& boundary) {
    RbfVolume volume;
    volume.centers = vectors(centers, "centers");
    const auto rows = rows_of<float>(frames, 6, "frames");
    const auto* first = reinterpret_cast<const Symmetric3*>(rows.data());
    volume.frames.assign(first, first + rows.shape(0));
    for_each_named(values, "values", [&](const std::string& name, const py::handle&) {
        volume.channels.push_back(RbfChannel{.name = name, .values = {}, .gradients = {}, .moments = {}, .hessians = {}});
    });
    fill_channels(volume.channels, &RbfChannel::values, values, "values");
    fill_channels(volume.channels, &RbfChannel::gradients, gradients, "gradients");
    fill_channels(volume.channels, &RbfChannel::moments, moments, "moments");
    fill_channels(volume.channels, &RbfChannel::hessians, hessians, "hessians");
    for (RbfChannel& channel : volume.channels) {
        if (channel.gradients.empty()) channel.gradients.resize(volume.centers.size());
        if (channel.moments.empty()) channel.moments.resize(volume.centers.size());
    }
    volume.kernel = kernel_from_json(kernel);
    if (!boundary.is_none()) {
        const py::tuple parts(boundary);
        if (parts.size() != 2) throw Error(ErrorCode::InvalidInput, "is not a surface", "boundary", "(points, triangles)");
        volume.boundary.points = vectors(parts[0], "boundary points");
        volume.boundary.triangles = index_rows<3>(parts[1], volume.boundary.points.size(), "boundary triangles");
    }
    if (volume.centers.empty()) throw Error(ErrorCode::InvalidInput, "is empty", "centers", "at least one point");
    validate(volume);
    volume.bounds = box_of(volume);
    return volume;
}

py::tuple boundary_arrays(const py::object& self) {
    const Surface& boundary = self.cast<const RbfVolume&>().boundary;
    const Index* corners = boundary.triangles.empty() ? nullptr : boundary.triangles.front().data();
    return py::make_tuple(view_of_points(boundary.points, self), view(corners, {length(boundary.triangles.size()), 3}, self));
}

std::vector<Option> keywords_of(SampleOptions& options) {
    return scheme_and(options.scheme, options_of(options));
}

/// The scheme without its rules, which are those of `reduce`.
std::vector<Option> keywords_of(ReduceOptions& options) {
    std::vector<Option> all = options_of(options);
    all.push_back(scheme_and(options.limit.scheme).front());
    return all;
}

py::tuple sample(const HexMesh& mesh, const std::optional<Camera>& footprint, const std::pair<int, int>& footprint_size,
                 const py::object& progress, const py::kwargs& given) {
    SampleOptions options;
    set_options(keywords_of(options), given);
    if (footprint) {
        options.footprint =
            Footprint{.camera = *footprint, .width_px = footprint_size.first, .height_px = footprint_size.second};
    }
    SampleResult result = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return sample_rbf_points(mesh, options);
    });
    for (std::size_t k = 0; k < std::min(mesh.attributes.size(), result.volume.channels.size()); ++k) {
        const auto bounds = mesh.attributes[k].channels == 1 ? bounds_of(mesh.attributes[k]) : std::nullopt;
        if (bounds) clamp_channel(result.volume.channels[k], bounds->min[0], bounds->max[0]);
    }
    return py::make_tuple(std::move(result.volume), result.report.flat_frames, result.report.largest_error);
}

/// given: the correction and the kernel
py::tuple sample_tets(const HexMesh& mesh, const py::object& progress, const py::kwargs& given) {
    SampleOptions chosen;
    set_options(keywords_of(chosen), given);
    MixedSampleOptions options{.correction = chosen.correction, .kernel = chosen.kernel};
    SampleResult result = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return sample_rbf_points(join_split_cells(mesh), options);
    });
    return py::make_tuple(std::move(result.volume), result.report.flat_frames);
}

py::dict as_dict(const ErrorAtSamples& error) {
    py::dict figures;
    figures["rmse"] = error.rmse;
    figures["max"] = error.max_abs;
    figures["uncovered"] = error.uncovered;
    return figures;
}

py::tuple reduce(const HexMesh& mesh, const std::string& field, const py::object& progress, const py::kwargs& given) {
    ReduceOptions options;
    set_options(keywords_of(options), given);
    ReduceResult result = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return reduce_rbf(mesh, field, options);
    });
    py::dict report;
    report["points"] = result.report.points;
    report["samples"] = result.report.samples;
    report["rounds"] = result.report.rounds;
    report["rmse"] = result.report.rmse;
    report["validation"] = as_dict(result.report.validation);
    report["reached"] = result.report.reached;
    return py::make_tuple(std::move(result.volume), report);
}

py::tuple fit(const std::string& shape, const std::string& scheme, int level, const py::kwargs& given) {
    FitOptions options;
    set_options(options_of(options), given);
    const KernelShape kind = named<KernelShape>(shape, "shape");
    const Scheme rule = scheme_named(scheme);
    const KernelFit best = [&] {
        const py::gil_scoped_release without_gil;
        return fit_kernel(sample_basis_function(rule, level), kind, options);
    }();
    py::dict errors;
    errors["mse"] = best.report.errors.mse;
    errors["rmse"] = best.report.errors.rmse;
    errors["mae"] = best.report.errors.mae;
    errors["max"] = best.report.errors.max;
    return py::make_tuple(to_json(best.kernel), errors);
}

std::string points_text(const RbfVolume& volume) {
    std::string text = "<subvol.RbfVolume: " + std::to_string(volume.size()) + " points, channels";
    for (const RbfChannel& channel : volume.channels) text += " " + detail::printable(channel.name);
    return text + (volume.boundary.triangles.empty() ? ", no boundary>" : ">");
}

}  // namespace

void bind_points(py::module_& module) {
    py::class_<RbfVolume>(module, "RbfVolume",
                          "A volume as radial basis functions. It does not change: its arrays are read-only views.")
        .def(py::init(&volume_of), py::arg("centers"), py::arg("frames"), py::arg("values"), py::arg("gradients") = py::dict(),
             py::arg("moments") = py::dict(), py::arg("hessians") = py::dict(), py::arg("kernel") = "{\"type\": \"compact\"}",
             py::arg("boundary") = py::none())
        .def("__len__", &RbfVolume::size)
        .def_property_readonly(
            "centers", [](const py::object& self) { return view_of_points(self.cast<const RbfVolume&>().centers, self); })
        .def_property_readonly(
            "frames",
            [](const py::object& self) {
                const auto& frames = self.cast<const RbfVolume&>().frames;
                return view(frames.empty() ? nullptr : frames.front().data(), {length(frames.size()), 6}, self);
            })
        .def_property_readonly("values", [](const py::object& self) { return of_channels(&RbfChannel::values, self); })
        .def_property_readonly("gradients", [](const py::object& self) { return of_channels(&RbfChannel::gradients, self); })
        .def_property_readonly("moments", [](const py::object& self) { return of_channels(&RbfChannel::moments, self); })
        .def_property_readonly("hessians", [](const py::object& self) { return of_channels(&RbfChannel::hessians, self); })
        .def_property_readonly("kernel", [](const RbfVolume& volume) { return to_json(volume.kernel); })
        .def_property_readonly("boundary", &boundary_arrays)
        .def_property_readonly("bounds", [](const RbfVolume& volume) { return read_only(as_array(volume.bounds)); })
        .def("__repr__", &points_text)
        .def(py::pickle(
            [](const py::object& self) {
                return py::make_tuple(self.attr("centers"), self.attr("frames"), self.attr("values"), self.attr("gradients"),
                                      self.attr("moments"), self.attr("hessians"), self.attr("kernel"), self.attr("boundary"),
                                      self.attr("bounds"));
            },
            [](const py::tuple& s) {
                if (s.size() != 9) throw Error(ErrorCode::InvalidInput, "is not a volume", "pickle");
                RbfVolume volume = volume_of(s[0], s[1], s[2], s[3], s[4], s[5], s[6].cast<std::string>(), s[7]);
                const std::vector<Vec3> corners = vectors(s[8], "bounds");
                if (corners.size() == 2) volume.bounds = {corners[0], corners[1]};
                return volume;
            }));
    module.def("sample", &sample, py::arg("mesh"), py::arg("footprint"), py::arg("footprint_size"), py::arg("progress"));
    module.def("sample_tets", &sample_tets, py::arg("mesh"), py::arg("progress"));
    module.def("reduce", &reduce, py::arg("mesh"), py::arg("field"), py::arg("progress"));
    module.def(
        "drop_invisible",
        [](const RbfVolume& volume, const TransferFunction& knots) {
            const py::gil_scoped_release without_gil;
            return drop_invisible(volume, 0, knots).volume;
        },
        py::arg("volume"), py::arg("knots"));
    module.def(
        "read_points",
        [](const std::string& path) {
            const py::gil_scoped_release without_gil;
            return read_points(path);
        },
        py::arg("path"));
    module.def(
        "is_points_file", [](const std::string& path) { return is_points_file(path); }, py::arg("path"));
    module.def(
        "write_points",
        [](const std::string& path, const RbfVolume& volume, const py::kwargs& given) {
            PointsWriteOptions options;
            set_options(options_of(options), given);
            const py::gil_scoped_release without_gil;
            if (std::filesystem::path(path).extension() == ".svk") {
                static_cast<void>(write_kernel_file(path, volume));
                return;
            }
            write_points(path, volume, options);
        },
        py::arg("path"), py::arg("volume"));
    module.def(
        "write_usd",
        [](const std::string& path, const std::vector<std::string>& grids, const std::vector<std::string>& files,
           const std::vector<double>& codes, const std::vector<std::array<std::array<double, 3>, 2>>& boxes,
           const TransferFunction& knots, double opacity_unit, const std::string& up) {
            UsdVolume volume{
                .grids = {}, .steps = {}, .colors = knots, .opacity_unit_world = opacity_unit, .up = named<UpAxis>(up, "up")};
            for (const std::string& grid : grids) volume.grids.push_back({grid});
            if (codes.size() != files.size()) {
                throw Error(ErrorCode::InvalidInput,
                            "there are " + std::to_string(codes.size()) + " for " + std::to_string(files.size()) + " files",
                            "codes", "one for each file, ascending");
            }
            if (boxes.size() != files.size()) {
                throw Error(ErrorCode::InvalidInput,
                            "there are " + std::to_string(boxes.size()) + " for " + std::to_string(files.size()) + " files",
                            "boxes", "one for each file");
            }
            for (std::size_t k = 0; k < files.size(); ++k) {
                const auto& [lower, upper] = boxes[k];
                volume.steps.push_back(
                    {codes[k], files[k], {Vec3(lower[0], lower[1], lower[2]), Vec3(upper[0], upper[1], upper[2])}});
            }
            const py::gil_scoped_release without_gil;
            write_usd(path, volume);
        },
        py::arg("path"), py::arg("grids"), py::arg("files"), py::arg("codes"), py::arg("boxes"), py::arg("knots"),
        py::arg("opacity_unit"), py::arg("up") = "z");
    module.def(
        "write_usd_splats",
        [](const std::string& path, const py::object& steps, const std::vector<double>& codes, const TransferFunction& knots,
           const std::string& up) {
            const UpAxis axis = named<UpAxis>(up, "up");
            std::vector<RbfVolume> volumes;
            for (const RbfVolume* const step : objects_of<RbfVolume>(steps, "steps", "an RbfVolume")) volumes.push_back(*step);
            const py::gil_scoped_release without_gil;
            write_usd(path, volumes, codes, knots, axis);
        },
        py::arg("path"), py::arg("steps"), py::arg("codes"), py::arg("knots"), py::arg("up") = "z");
    module.def("fit", &fit, py::arg("shape"), py::arg("scheme"), py::arg("level"));
    module.def(
        "named_kernel", [](const std::string& name) { return to_json(named_kernel(name)); }, py::arg("name"));
    module.def("kernel_names", &kernel_names);
    module.def(
        "kernel_values",
        [](const std::string& kernel, const py::object& offsets) {
            const Kernel with = kernel_from_json(kernel);
            std::vector<double> values;
            for (const Vec3& x : vectors(offsets, "offsets")) values.push_back(kernel_value(with, x));
            const py::ssize_t count = length(values.size());
            return owned(std::move(values), {count});
        },
        py::arg("kernel"), py::arg("offsets"));
    SampleOptions sampling;
    describe(module, "sample", keywords_of(sampling));
    ReduceOptions reduction{.rmse = 0.01};
    describe(module, "reduce", keywords_of(reduction));
    FitOptions fitting;
    describe(module, "fit", options_of(fitting));
    PointsWriteOptions writing;
    describe(module, "write_points", options_of(writing));
}

}  // namespace subvol::python
