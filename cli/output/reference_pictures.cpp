// SPDX-License-Identifier: Apache-2.0
#include "reference_pictures.h"

#include <array>
#include <utility>

#include "subvol/boundary_shading.h"
#include "subvol/progressive.h"
#include "subvol/render_dense.h"
#include "subvol/render_grid.h"
#include "text.h"

namespace subvol::cli {
namespace {

void report_method(const char* method, const char* backend, Report& report) {
    report["method"] = method;
    report["backend"] = backend;
}

void report_rays(std::size_t rays, std::size_t lost, Report& report) {
    report["rays"] = rays;
    report["lost_rays"] = lost;
    if (lost > 0) report.warn(text(lost, " rays were lost inside the mesh"));
}

const char* name_of(ProjectedOrder order) {
    switch (order) {
        case ProjectedOrder::Centroid:
            return "centroid";
        case ProjectedOrder::Topological:
            return "topological";
        case ProjectedOrder::Lists:
            return "lists";
        case ProjectedOrder::Havs:
            return "havs";
    }
    return "";
}

void report_tets(const ProjectedReport& pt, ProjectedOrder order, Report& report) {
    report.add_seconds("prepare", pt.seconds_prepare);
    report.add_seconds("sort", pt.seconds_sort);
    report.add_seconds("draw", pt.seconds_draw);
    report["device"] = pt.device;
    report["order"] = name_of(order);
    report["tets"] = pt.tets;
    report["degenerate_tets"] = pt.degenerate_tets;
    report["inverted_tets"] = pt.inverted_tets;
    if (order == ProjectedOrder::Topological) report["cycles"] = pt.cycles;
    if (order == ProjectedOrder::Lists || order == ProjectedOrder::Havs) report["fragments"] = pt.fragments;
    if (order == ProjectedOrder::Havs) {
        report["faces"] = pt.faces;
        report["faces_drawn"] = pt.faces_drawn;
        report["late_faces"] = pt.late_faces;
    }
    if (pt.violations) report["order_violations"] = *pt.violations;
    if (pt.cycles > 0) report.warn(text("the order of the tetrahedra has cycles, which were broken ", pt.cycles, " times"));
    if (pt.late_faces > 0)
        report.warn(text(pt.late_faces, " faces came too late for the k-buffer; use a larger --kbuffer, or --order lists"));
}

}  // namespace

Picture draw_tets(const DrawTets& draw_rows, const View& view, const ReferenceArguments& arguments, const OwnRows& rows,
                  Progress* progress, Report& report) {
    TetsResult drawn = draw_rows(
        view, {.samples = arguments.samples, .clip = arguments.clip, .rows = rows.of(view.height()), .progress = progress});
    std::array counts{drawn.report.rays, drawn.report.lost_rays};
    add_up(rows, counts);
    report_method("tets", "cpu", report);
    report.add_seconds("draw", drawn.report.seconds_draw);
    report["tets"] = drawn.report.tets;
    report["degenerate_tets"] = drawn.report.degenerate_tets;
    report["inverted_tets"] = drawn.report.inverted_tets;
    report_rays(counts[0], counts[1], report);
    Picture picture{std::move(drawn.image)};
    if (rows.gathered()) gather_rows(picture, *rows.ranks);
    return picture;
}

Picture draw_projected_tets(ProjectedRenderer& renderer, const View& view, const Optics& optics,
                            const ReferenceArguments& arguments, std::optional<double> seconds, Progress* progress,
                            Report& report) {
    ProjectedOptions options = arguments.projected_options();
    ProjectedResult drawn;
    if (seconds) {
        auto best =
            render_progressively(renderer, view, optics, {.seconds = *seconds, .projected = options, .progress = progress});
        options.order = best.order;
        drawn = std::move(best.projected);
        report["steps"] = best.steps;
        report["finished"] = best.finished;
    } else {
        options.progress = progress;
        drawn = renderer.draw(view, optics, options);
    }
    report_method("pt", "gl", report);
    report_tets(drawn.report, options.order, report);
    return Picture{std::move(drawn.image)};
}

Picture draw_dense(const HexMesh& mesh, const RefineOptions& refine, std::optional<int> levels, const View& view,
                   const Optics& optics, const ReferenceArguments& arguments, Progress* progress, Report& report) {
    DenseResult drawn = render_dense(mesh, {}, view, optics,
                                     {.refine = refine,
                                      .levels = levels,
                                      .image_tolerance = arguments.image_tolerance,
                                      .samples = arguments.samples,
                                      .clip = arguments.clip,
                                      .progress = progress});
    const DenseReport& dense = drawn.report;
    report_method("dense", "cpu", report);
    report.add_seconds("prepare", dense.seconds_build);
    report.add_seconds("draw", dense.seconds_draw);
    report["levels"] = dense.levels;
    if (dense.image_change) report["image_change"] = *dense.image_change;
    report["blocks"] = dense.blocks;
    report["skipped_blocks"] = dense.skipped_blocks;
    report["micro_cells"] = dense.micro_cells;
    report["passes"] = dense.passes;
    report["bytes"] = dense.bytes;
    report_rays(dense.rays, dense.lost_rays, report);
    if (!levels && !dense.converged) {
        report.warn(text("the picture still changes by ", dense.image_change.value_or(0), " at level ", dense.levels,
                         ": --levels draws a finer one"));
    }
    return Picture{std::move(drawn.image)};
}

Picture draw_grid(const Voxels& voxels, const View& view, const Optics& optics, const ReferenceArguments& arguments,
                  Progress* progress, Report& report) {
    GridResult drawn =
        render_grid(voxels, view, optics, {.samples = arguments.samples, .clip = arguments.clip, .progress = progress});
    report_method("grid", "cpu", report);
    report.add_seconds("draw", drawn.report.seconds_draw);
    report["rays"] = drawn.report.rays;
    report["cells"] = drawn.report.cells;
    report["blocks"] = drawn.report.blocks;
    return Picture{std::move(drawn.image)};
}

DrawPicture lit(DrawPicture draw, Surface boundary, const ReferenceArguments& arguments) {
    if (boundary.triangles.empty()) return draw;
    return [draw = std::move(draw), boundary = std::move(boundary), &arguments](const View& view, Progress* progress) {
        Picture picture = draw(view, progress);
        light_boundary(picture.image, boundary, view, Shading{}, arguments.samples, arguments.clip);
        return picture;
    };
}

void write_tets(const DrawTets& draw_rows, const Surface& boundary, const std::vector<View>& views,
                const ReferenceArguments& arguments, const OwnRows& rows, PictureOutput& output, Report& report) {
    const auto draw = [&](const View& view, Progress* progress) {
        return draw_tets(draw_rows, view, arguments, rows, progress, report);
    };
    output.write(views, lit(draw, boundary, arguments), report);
}

void write_projected_tets(ProjectedRenderer& renderer, const Surface& boundary, const std::vector<View>& views,
                          const Optics& optics, const ReferenceArguments& arguments, std::optional<double> seconds,
                          PictureOutput& output, Report& report) {
    report.add_seconds("prepare", renderer.seconds_build());
    const auto draw = [&](const View& view, Progress* progress) {
        return draw_projected_tets(renderer, view, optics, arguments, seconds, progress, report);
    };
    output.write(views, lit(draw, boundary, arguments), report);
}

}  // namespace subvol::cli
