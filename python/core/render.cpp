// SPDX-License-Identifier: Apache-2.0
#include "bind.h"
#include "picture.h"
#include "subvol/boundary_shading.h"
#include "subvol/boundary_values.h"
#include "subvol/kernel_hierarchy.h"
#include "subvol/progressive.h"
#include "subvol/render_dense.h"
#include "subvol/render_grid.h"
#include "subvol/render_projected.h"
#include "subvol/render_tets.h"
#include "subvol/splat.h"
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

/// Camera, width, height, transfer function, opacity unit (world), cuts: what every renderer is given.
struct Scene {
    Scene(const Camera& camera, const std::pair<int, int>& size, const TransferFunction& knots, double unit_world,
          const std::vector<SixNumbers>& clip_planes, const std::optional<SixNumbers>& clip_box,
          const std::vector<SixNumbers>& slices, bool around_slices)
        : view(camera, size.first, size.second),
          optics(knots, unit_world),
          clip(clip_of(clip_planes, clip_box, slices, around_slices)) {}
    View view;
    Optics optics;
    Clip clip;
};

SplatMethod backend_named(const std::string& name) {
    if (name == "auto") return SplatMethod::Auto;
    if (name == "cpu") return SplatMethod::Cpu;
    if (name == "gl") return SplatMethod::Gl;
    if (name == "sheets") return SplatMethod::Sheets;
    if (name == "footprints") return SplatMethod::Footprints;
    throw unknown_word(name, "backend", "auto, cpu, gl, sheets or footprints");
}

SplatOptions splat_options(const std::string& backend, const std::optional<int>& device, int samples, int sheets,
                           std::size_t channel, const std::optional<std::size_t>& color_channel, bool shade) {
    SplatOptions options{.method = backend_named(backend),
                         .device = device,
                         .samples = samples,
                         .sheets = sheets,
                         .channel = channel,
                         .color_channel = color_channel};
    if (shade) options.shading = Shading{};
    return options;
}

Picture picture_of(SplatResult result) {
    Picture picture{std::move(result.image), std::move(result.depth)};
    picture.report["backend"] = result.report.backend;
    picture.report["device"] = result.report.device;
    picture.report["points"] = result.report.points;
    picture.report["sheets"] = result.report.sheets;
    picture.report["seconds"] = result.report.seconds_prepare + result.report.seconds_draw;
    return picture;
}

void check_channel(const RbfVolume& volume, std::size_t channel) {
    if (channel < volume.channels.size()) return;
    throw Error(ErrorCode::InvalidInput, "there is no channel " + std::to_string(channel), "channel",
                "0 to " + std::to_string(volume.channels.size() - 1));
}

Picture splat(const RbfVolume& volume, const Scene& scene, const std::string& backend, const std::optional<int>& device,
              int samples, int sheets, std::size_t channel, const std::optional<std::size_t>& color_channel, bool shade,
              bool shadows, double ambient_occlusion, double lod, const BoundaryValues* skin, const py::object& progress) {
    check_channel(volume, channel);
    if (color_channel) check_channel(volume, *color_channel);
    SplatOptions options = splat_options(backend, device, samples, sheets, channel, color_channel, shade);
    options.clip = scene.clip;
    options.shadows = shadows;
    options.ambient_occlusion = ambient_occlusion;
    const bool merges = !(lod == 0);
    KernelCut cut;
    Picture picture = picture_of(result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        RbfVolume few;
        Splatter splatter(volume, options);
        if (skin != nullptr) splatter.set_boundary_colors(skin->surface, skin->values.back());
        if (merges) {
            const KernelHierarchy hierarchy = build_kernel_hierarchy(volume, listener);
            cut = choose_cut(hierarchy, scene.view, {.pixels = lod, .channel = channel});
            few = kernels_of_cut(hierarchy, volume, cut);
            if (!cut.nodes.empty()) splatter.set_kernels(few);
        }
        return splatter.draw(scene.view, scene.optics);
    }));
    if (merges) {
        picture.report["points"] = volume.size();
        picture.report["kernels_drawn"] = cut.size();
        picture.report["kernels_merged"] = volume.size() - cut.kernels.size();
        picture.report["merge_error"] = cut.error;
    }
    return picture;
}

Picture splat_in_time(const HexMesh& mesh, const Scene& scene, double seconds, const std::string& scheme,
                      const std::string& backend, const std::optional<int>& device, int samples, int sheets, bool shade,
                      const py::object& progress) {
    ProgressiveOptions options{.seconds = seconds, .splat = splat_options(backend, device, samples, sheets, 0, {}, shade)};
    options.sample.scheme.kind = scheme_named(scheme);
    options.splat.clip = scene.clip;
    ProgressiveResult result = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return render_progressively(mesh, scene.view, scene.optics, options);
    });
    const int steps = result.steps, scale = result.picture_scale;
    Picture picture = picture_of(std::move(result.splat));
    picture.report["steps"] = steps;
    picture.report["picture_scale"] = scale;
    picture.report["footprint_px"] = result.footprint_px;
    return picture;
}

Picture tets(const HexMesh& mesh, const std::string& field, const Scene& scene, int samples, const py::object& progress) {
    TetsResult result = result_of(progress, [&](Progress* listener) {
        return TetsRenderer(mesh, field, listener)
            .draw(scene.view, scene.optics, {.samples = samples, .clip = scene.clip, .progress = listener});
    });
    Picture picture{std::move(result.image)};
    picture.report["tets"] = result.report.tets;
    picture.report["degenerate_tets"] = result.report.degenerate_tets;
    picture.report["inverted_tets"] = result.report.inverted_tets;
    picture.report["rays"] = result.report.rays;
    picture.report["lost_rays"] = result.report.lost_rays;
    picture.report["seconds"] = result.report.seconds_build + result.report.seconds_draw;
    return picture;
}

ProjectedOrder order_named(const std::string& name) {
    if (name == "centroid") return ProjectedOrder::Centroid;
    if (name == "topological") return ProjectedOrder::Topological;
    if (name == "lists") return ProjectedOrder::Lists;
    if (name == "havs") return ProjectedOrder::Havs;
    throw unknown_word(name, "order", "centroid, topological, lists or havs");
}

Picture projected(const HexMesh& mesh, const std::string& field, const Scene& scene, const std::string& order,
                  const std::optional<int>& device, int samples, const std::optional<double>& seconds,
                  const py::object& progress) {
    ProjectedOptions options{.order = order_named(order), .device = device, .samples = samples, .clip = scene.clip};
    const ProjectedResult result = result_of(progress, [&](Progress* listener) {
        ProjectedRenderer renderer(mesh, field, device, listener);
        if (seconds) {
            return render_progressively(renderer, scene.view, scene.optics,
                                        {.seconds = *seconds, .projected = options, .progress = listener})
                .projected;
        }
        options.progress = listener;
        return renderer.draw(scene.view, scene.optics, options);
    });
    Picture picture{result.image};
    picture.report["device"] = result.report.device;
    picture.report["tets"] = result.report.tets;
    picture.report["cycles"] = result.report.cycles;
    picture.report["late_faces"] = result.report.late_faces;
    picture.report["seconds"] =
        result.report.seconds_build + result.report.seconds_prepare + result.report.seconds_sort + result.report.seconds_draw;
    return picture;
}

Picture dense(const HexMesh& mesh, const std::string& field, const Scene& scene, const std::string& scheme, double tension,
              const std::optional<double>& crease_angle, const std::optional<int>& levels, double image_tolerance, int samples,
              const py::object& progress) {
    DenseOptions options{.refine = refine_options(scheme, 0, tension, crease_angle),
                         .levels = levels,
                         .image_tolerance = image_tolerance,
                         .samples = samples,
                         .clip = scene.clip};
    DenseResult result = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return render_dense(mesh, field, scene.view, scene.optics, options);
    });
    Picture picture{std::move(result.image)};
    picture.report["levels"] = result.report.levels;
    picture.report["converged"] = result.report.converged;
    picture.report["rays"] = result.report.rays;
    picture.report["lost_rays"] = result.report.lost_rays;
    picture.report["seconds"] = result.report.seconds_build + result.report.seconds_draw;
    return picture;
}

Picture grid(const Voxels& voxels, const Scene& scene, int samples, const py::object& progress) {
    GridResult result = result_of(progress, [&](Progress* listener) {
        return render_grid(voxels, scene.view, scene.optics, {.samples = samples, .clip = scene.clip, .progress = listener});
    });
    Picture picture{std::move(result.image)};
    picture.report["rays"] = result.report.rays;
    picture.report["cells"] = result.report.cells;
    picture.report["seconds"] = result.report.seconds_draw;
    return picture;
}

/// The boundary of a body that is lit, and the limit's values on it, as the command has them.
BoundaryValues skin(const HexMesh& mesh, const std::string& scheme, double tension, const std::optional<double>& crease_angle,
                    const std::optional<int>& levels) {
    const py::gil_scoped_release without_gil;
    return boundary_values(mesh, refine_options(scheme, picture_levels(mesh, levels), tension, crease_angle));
}

Picture lit(const Picture& picture, const BoundaryValues& skin, const Scene& scene, int samples) {
    Picture result{picture.image, picture.depth, picture.report.attr("copy")()};
    const py::gil_scoped_release without_gil;
    light_boundary(result.image, skin.surface, scene.view, Shading{}, samples, scene.clip);
    return result;
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
    py::class_<Scene>(module, "Scene", "What every renderer is given: camera, size, transfer function, opacity unit.")
        .def(py::init<const Camera&, const std::pair<int, int>&, const TransferFunction&, double,
                      const std::vector<SixNumbers>&, const std::optional<SixNumbers>&, const std::vector<SixNumbers>&, bool>(),
             py::arg("camera"), py::arg("size"), py::arg("knots"), py::arg("opacity_unit"), py::arg("clip"),
             py::arg("clip_box"), py::arg("slices"), py::arg("around"));
    py::class_<BoundaryValues>(module, "BoundaryValues", "A boundary with the limit's values on it.");
    module.def("splat", &splat, py::arg("volume"), py::arg("scene"), py::arg("backend"), py::arg("device"), py::arg("samples"),
               py::arg("sheets"), py::arg("channel"), py::arg("color_channel"), py::arg("shade"), py::arg("shadows"),
               py::arg("ambient_occlusion"), py::arg("lod"), py::arg("skin").none(true), py::arg("progress"));
    module.def("splat_in_time", &splat_in_time, py::arg("mesh"), py::arg("scene"), py::arg("seconds"), py::arg("scheme"),
               py::arg("backend"), py::arg("device"), py::arg("samples"), py::arg("sheets"), py::arg("shade"),
               py::arg("progress"));
    module.def("tets", &tets, py::arg("mesh"), py::arg("field"), py::arg("scene"), py::arg("samples"), py::arg("progress"));
    module.def("projected", &projected, py::arg("mesh"), py::arg("field"), py::arg("scene"), py::arg("order"),
               py::arg("device"), py::arg("samples"), py::arg("seconds"), py::arg("progress"));
    module.def("dense", &dense, py::arg("mesh"), py::arg("field"), py::arg("scene"), py::arg("scheme"), py::arg("tension"),
               py::arg("crease_angle"), py::arg("levels"), py::arg("image_tolerance"), py::arg("samples"), py::arg("progress"));
    module.def("grid", &grid, py::arg("voxels"), py::arg("scene"), py::arg("samples"), py::arg("progress"));
    module.def("skin", &skin, py::arg("mesh"), py::arg("scheme"), py::arg("tension"), py::arg("crease_angle"),
               py::arg("levels"));
    module.def("lit", &lit, py::arg("picture"), py::arg("skin"), py::arg("scene"), py::arg("samples"));
    module.def("gl_devices", &devices);
}

}  // namespace subvol::python
