#include "reference_pictures.h"

#include "subvol/render_dense.h"
#include "subvol/render_grid.h"
#include "subvol/render_pt.h"
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

}  // namespace

Picture draw_tets(const TetsRenderer& renderer, const View& view, const Optics& optics, const ReferenceArguments& arguments,
                  Progress* progress, Report& report) {
    TetsResult drawn = renderer.draw(view, optics, {.samples = arguments.samples, .progress = progress});
    report_method("tets", "cpu", report);
    report.add_seconds("draw", drawn.report.seconds_draw);
    report["tets"] = drawn.report.tets;
    report["degenerate_tets"] = drawn.report.degenerate_tets;
    report["inverted_tets"] = drawn.report.inverted_tets;
    report_rays(drawn.report.rays, drawn.report.lost_rays, report);
    return Picture{std::move(drawn.image)};
}

Picture draw_projected_tets(const HexMesh& mesh, const View& view, const Optics& optics, const ReferenceArguments& arguments,
                            std::optional<int> device, Progress* progress, Report& report) {
    const PtOrder order = arguments.pt_order();
    PtResult drawn = render_projected_tets(mesh, mesh.attributes.front().values, view, optics,
                                           {.order = order, .device = device, .progress = progress});
    const PtReport& pt = drawn.report;
    report_method("pt", "gl", report);
    report.add_seconds("prepare", pt.seconds_build);
    report.add_seconds("sort", pt.seconds_sort);
    report.add_seconds("draw", pt.seconds_draw);
    report["device"] = pt.device;
    report["order"] = arguments.order;
    report["tets"] = pt.tets;
    report["degenerate_tets"] = pt.degenerate_tets;
    report["inverted_tets"] = pt.inverted_tets;
    if (order == PtOrder::Topological) report["cycles"] = pt.cycles;
    if (order == PtOrder::Lists) report["fragments"] = pt.fragments;
    if (pt.violations) report["order_violations"] = *pt.violations;
    if (pt.cycles > 0) report.warn(text("the order of the tetrahedra has cycles, broken ", pt.cycles, " times"));
    return Picture{std::move(drawn.image)};
}

Picture draw_dense(const HexMesh& mesh, const RefineOptions& refine, std::optional<int> levels, const View& view,
                   const Optics& optics, const ReferenceArguments& arguments, Progress* progress, Report& report) {
    DenseResult drawn = render_dense(mesh, mesh.attributes.front().values, view, optics,
                                     {.refine = refine,
                                      .levels = levels,
                                      .image_tolerance = arguments.image_tolerance,
                                      .samples = arguments.samples,
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
    GridResult drawn = render_grid(voxels, view, optics, {.samples = arguments.samples, .progress = progress});
    report_method("grid", "cpu", report);
    report.add_seconds("draw", drawn.report.seconds_draw);
    report["rays"] = drawn.report.rays;
    report["cells"] = drawn.report.cells;
    report["blocks"] = drawn.report.blocks;
    return Picture{std::move(drawn.image)};
}

}  // namespace subvol::cli
