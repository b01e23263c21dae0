// SPDX-License-Identifier: Apache-2.0
// What Python asks of two pictures or two fields: figures of their difference, maps of it, and the differences of two meshes as
// fields. A field of a mesh, of its limit or of kernels is an object that is asked for values at many places at once, in
// parallel and until Ctrl-C.
#include <cmath>
#include <limits>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "bind.h"
#include "picture.h"
#include "subvol/detail/printable.h"
#include "subvol/field_metrics.h"
#include "subvol/flip.h"
#include "subvol/image_metrics.h"
#include "subvol/mesh_field.h"
#include "subvol/points_field.h"
#include "subvol/probe.h"
#include "subvol/ssim.h"

namespace subvol::python {
namespace {

/// A field in world space with the object that it refers to. probe: that object, if it is best asked for many places at once
struct Field {
    std::shared_ptr<const void> owner;
    FieldView view;
    std::string name;
    std::shared_ptr<const LimitProbe> probe{};
};

Field field_of_mesh(const HexMesh& mesh, const std::string& name, const py::object& progress) {
    auto field = result_of(progress, [&](Progress* listener) {
        report_progress(listener, "tree of cells", 0);
        return std::make_shared<const MeshField>(with_scalar_field(mesh, name), name);
    });
    FieldView view = field->view();
    return {std::move(field), std::move(view), name};
}

/// The limit itself, or the curved pieces by which the command compares fields, which are faster.
Field field_of_limit(const HexMesh& mesh, const std::string& name, const std::string& scheme, bool exact,
                     const py::object& progress) {
    RefineOptions options{.scheme = {.kind = scheme_named(scheme)}};
    if (exact) {
        auto probe = result_of(progress, [&](Progress* listener) {
            return std::make_shared<const LimitProbe>(with_scalar_field(mesh, name),
                                                      ProbeOptions{.limit = {.scheme = options.scheme, .progress = listener}});
        });
        const auto at = [&limit = *probe](const Vec3& x) { return limit.at(std::span(&x, 1)); };
        FieldView view{.value = [at](const Vec3& x) -> std::optional<double> {
                           const ProbeResult found = at(x);
                           return found.inside(0) ? std::optional(found.fields.front().values.front()) : std::nullopt;
                       },
                       .gradient = [at](const Vec3& x) -> std::optional<Vec3> {
                           const ProbeResult found = at(x);
                           return found.inside(0) ? std::optional(found.fields.front().gradients.front()) : std::nullopt;
                       },
                       .box = probe->box()};
        return {probe, std::move(view), name, probe};
    }
    auto field = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return std::make_shared<const LimitField>(mesh, name, options);
    });
    FieldView view = view_of(*field);
    return {std::move(field), std::move(view), name};
}

Field field_of_points(const RbfVolume& volume, std::size_t channel) {
    const py::gil_scoped_release without_gil;
    auto field = std::make_shared<const PointsField>(volume, channel);
    FieldView view = field->view();
    return {std::move(field), std::move(view), volume.channels[channel].name};
}

bool is_finite(const Vec3& x) {
    return std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z);
}

/// Calls use(i, value, gradient) for each place in the field, in parallel, until Ctrl-C. Either is asked for, or both at once.
template <class Use>
void each_inside(const Field& field, const std::vector<Vec3>& places, bool gradients, const Use& use) {
    run(py::none(), [&](Progress* listener) {
        if (field.probe) {
            std::vector<Vec3> finite;
            std::vector<std::size_t> numbers_of;
            for (std::size_t i = 0; i < places.size(); ++i) {
                if (!is_finite(places[i])) continue;
                finite.push_back(places[i]);
                numbers_of.push_back(i);
            }
            if (finite.empty()) return;
            const ProbeResult found = field.probe->at(finite, listener);
            const ProbedField& only = found.fields.front();
            for (std::size_t i = 0; i < finite.size(); ++i) {
                if (found.inside(i)) use(numbers_of[i], only.values[i], only.gradients[i]);
            }
            return;
        }
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, places.size(), 64), [&](const auto& range) {
            if (listener->cancelled()) return;  // `run` raises what cancelled it
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                if (!is_finite(places[i])) continue;
                if (gradients) {
                    if (const auto slope = gradient_at(field.view, places[i])) use(i, 0.0, *slope);
                } else if (const auto value = field.view.value(places[i])) {
                    use(i, *value, Vec3(0.0));
                }
            }
        });
    });
}

/// Values at places of the world (nan outside the field), and whether there is one.
py::tuple values_at(const Field& field, const py::object& at) {
    const std::vector<Vec3> places = vectors(at, "at");
    std::vector<double> values(places.size(), std::numeric_limits<double>::quiet_NaN());
    std::vector<std::uint8_t> inside(places.size());
    each_inside(field, places, false, [&](std::size_t i, double value, const Vec3&) {
        values[i] = value;
        inside[i] = 1;
    });
    const py::ssize_t count = length(places.size());
    return py::make_tuple(owned(std::move(values), {count}), owned(std::move(inside), {count}).attr("view")("bool"));
}

py::array gradients_at(const Field& field, const py::object& at) {
    const std::vector<Vec3> places = vectors(at, "at");
    std::vector<Vec3> gradients(places.size(), Vec3(std::numeric_limits<double>::quiet_NaN()));
    each_inside(field, places, true, [&](std::size_t i, double, const Vec3& slope) { gradients[i] = slope; });
    return owned(std::move(gradients));
}

py::dict difference_of(const Field& test, const Field& reference, std::size_t samples, std::uint64_t seed, bool gradients,
                       const py::object& progress) {
    if (samples == 0 || samples > 1'000'000'000) {
        throw Error(ErrorCode::InvalidInput, std::to_string(samples) + " samples", "samples", "1 to a billion");
    }
    FieldDifferenceOptions options{.samples = samples, .seed = seed, .gradients = gradients};
    const FieldDifference difference = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return compare_fields(test.view, reference.view, options);
    });
    py::dict figures;
    figures["l1"] = difference.l1;
    figures["l2"] = difference.l2;
    figures["linf"] = difference.linf;
    figures["linf_at"] = py::make_tuple(difference.linf_at.x, difference.linf_at.y, difference.linf_at.z);
    figures["gradient_rmse"] = difference.gradient_rmse;
    figures["samples"] = difference.samples;
    figures["uncovered"] = difference.uncovered;
    figures["coverage"] = difference.coverage();
    return figures;
}

py::tuple mesh_difference_of(const HexMesh& test, const HexMesh& reference, const py::object& progress,
                             const py::kwargs& keywords) {
    MeshDifferenceOptions options;
    set_options(scheme_and(options.scheme), keywords);
    MeshDifference found = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return mesh_difference(test, reference, options);
    });
    const Facts report = facts_of(found);
    return py::make_tuple(std::move(found.mesh), dict_of(report));
}

/// Two pictures of the same pixels; the ones given, if they are that.
py::tuple common_of(const py::object& test, const py::object& reference) {
    const auto &a = test.cast<const Picture&>(), &b = reference.cast<const Picture&>();
    const auto of_a = a.windows(), of_b = b.windows();
    if (of_a.data == of_b.data && of_a.display == of_b.display) return py::make_tuple(test, reference);
    CommonPixels common = [&] {
        const py::gil_scoped_release without_gil;
        return common_pixels({a.image, of_a.data, of_a.display, {}}, {b.image, of_b.data, of_b.display, {}});
    }();
    return py::make_tuple(Picture{.image = std::move(common.a)}, Picture{.image = std::move(common.b)});
}

py::dict metrics_of(const Picture& a, const Picture& b) {
    const ImageMetrics metrics = [&] {
        const py::gil_scoped_release without_gil;
        return compare_images(a.image, b.image);
    }();
    py::dict figures;
    figures["mse"] = metrics.mse;
    figures["rmse"] = metrics.rmse;
    figures["mae"] = metrics.mae;
    figures["max"] = metrics.max;
    figures["psnr"] = metrics.psnr;
    return figures;
}

py::tuple as_map(double mean, MetricMap map) {
    return py::make_tuple(mean, owned(std::move(map.values), {length(map.height), length(map.width)}));
}

}  // namespace

void bind_compare(py::module_& module) {
    py::class_<Field>(module, "Field", "A scalar field in world space.")
        .def_static("of_mesh", &field_of_mesh, py::arg("mesh"), py::arg("name"), py::arg("progress"))
        .def_static("of_limit", &field_of_limit, py::arg("mesh"), py::arg("name"), py::arg("scheme"), py::arg("exact"),
                    py::arg("progress"))
        .def_static("of_points", &field_of_points, py::arg("volume"), py::arg("channel"))
        .def_readonly("name", &Field::name)
        .def_property_readonly("bounds", [](const Field& field) { return read_only(as_array(field.view.box)); })
        .def("values", &values_at, py::arg("at"))
        .def("gradients", &gradients_at, py::arg("at"))
        .def("__repr__", [](const Field& field) { return "<subvol.Field: " + detail::printable(field.name) + ">"; });
    module.def("compare_fields", &difference_of, py::arg("test"), py::arg("reference"), py::arg("samples"), py::arg("seed"),
               py::arg("gradients"), py::arg("progress"));
    module.def("mesh_difference", &mesh_difference_of, py::arg("test"), py::arg("reference"), py::arg("progress"));
    MeshDifferenceOptions difference;
    describe(module, "mesh_difference", scheme_and(difference.scheme));
    module.def("common_pixels", &common_of, py::arg("test"), py::arg("reference"));
    module.def("compare_images", &metrics_of, py::arg("test"), py::arg("reference"));
    module.def(
        "ssim",
        [](const Picture& a, const Picture& b) {
            SsimResult result = [&] {
                const py::gil_scoped_release without_gil;
                return luminance_ssim(srgb8_image(a.image), srgb8_image(b.image));
            }();
            return as_map(result.mean, std::move(result.map));
        },
        py::arg("test"), py::arg("reference"));
    module.def(
        "ssim_linear",
        [](const Picture& a, const Picture& b) {
            const py::gil_scoped_release without_gil;
            return ssim(a.image, b.image).mean;
        },
        py::arg("test"), py::arg("reference"));
    module.def(
        "flip",
        [](const Picture& a, const Picture& b) {
            FlipResult result = [&] {
                const py::gil_scoped_release without_gil;
                return flip(a.image, b.image);
            }();
            return as_map(result.mean, std::move(result.map));
        },
        py::arg("test"), py::arg("reference"));
    module.def(
        "heatmap",
        [](const Picture& a, const Picture& b, double scale) {
            return Picture{.image = difference_heatmap(a.image, b.image, scale)};
        },
        py::arg("test"), py::arg("reference"), py::arg("scale"));
}

}  // namespace subvol::python
