// SPDX-License-Identifier: Apache-2.0
#include "field_comparison.h"

#include <CLI/CLI.hpp>

#include "field_input.h"
#include "options.h"
#include "subvol/error.h"
#include "subvol/field_metrics.h"
#include "subvol/field_places.h"
#include "text.h"

namespace subvol::cli {

void FieldComparison::add_to(CLI::App& app) {
    const std::string group = "Fields";
    add_option(app, Option("samples", samples)
                        .between(1, 1e8)
                        .help("N", "number of random places in the second field's domain; see --seed"))
        ->group(group);
    add_option(app, Option("coverage", least_coverage)
                        .between(0, 1)
                        .help("SHARE",
                              "the least share of these places at which the first field must have a value, too, for any demand "
                              "to be met"))
        ->group(group);
    add_option(app,
               Option("iso", iso).help("V", "also the Hausdorff distance between the isosurfaces of this value (hausdorff)"))
        ->group(group);
    add_option(
        app,
        Option("resolution", resolution).between(2, 2000).help("N", "cells along the longest side for mass and isosurfaces"))
        ->group(group);
    refine.add_to(app, "compare meshes at this level; omitted: at a level within tolerance of the limit");
    for (const char* name : {"--scheme", "--tension", "--levels", "--crease-angle"}) app.get_option(name)->group(group);
}

std::vector<std::string> FieldComparison::names(bool of_mesh) const {
    std::vector<std::string> all{"l1", "l2", "linf", "gradient_rmse", "mass"};
    if (of_mesh) all.emplace_back("new_vertex_rmse");
    if (iso) all.emplace_back("hausdorff");
    return all;
}

Figures FieldComparison::measure(const std::string& test, const std::string& reference, const CommonOptions& options,
                                 Report& report) const {
    report["input"] = test;  // for errors
    const FieldInput a = report.unpack(load_field(test, options, refine, "a", report.progress()));
    report["input"] = reference;
    const FieldInput b = report.unpack(load_field(reference, options, refine, "b", report.progress()));
    const FieldDifference errors = report.timed("samples", [&] {
        return compare_fields(a.view, b.view, {.samples = samples, .seed = options.seed, .progress = report.progress()});
    });
    if (errors.samples == 0) {
        throw Error(ErrorCode::InvalidInput, "the two fields have no place in common", test + ", " + reference);
    }
    Figures figures;
    figures.put("l1", errors.l1);
    figures.put("l2", errors.l2);
    figures.put("linf", errors.linf);
    figures.put("gradient_rmse", errors.gradient_rmse);
    const MassError mass = report.timed("mass", [&] { return mass_error(a.view, b.view, resolution, report.progress()); });
    figures.put("mass", mass.relative);
    report["a"]["mass"] = mass.test;
    report["b"]["mass"] = mass.reference;
    if (b.mesh) {
        const auto places =
            report.timed("new_vertices", [&] { return new_vertices(*b.mesh, b.field, 0, scheme_named(refine.scheme)); });
        const FieldDifference at_vertices = compare_field(a.view, places);
        figures.put("new_vertex_rmse", at_vertices.l2);
        report["new_vertices"] = {{"samples", at_vertices.samples}, {"uncovered", at_vertices.uncovered}};
    }
    if (iso) {
        const auto found =
            report.timed("hausdorff", [&] { return isosurface_distance(a.view, b.view, *iso, resolution, report.progress()); });
        figures.put("hausdorff", found.distance);
        report["isosurface"] = {
            {"spacing", found.spacing}, {"triangles_a", found.test_triangles}, {"triangles_b", found.reference_triangles}};
    }
    report["samples"] = errors.samples;
    report["uncovered"] = errors.uncovered;
    report["coverage"] = errors.coverage();
    if (!(errors.coverage() >= least_coverage)) {
        report.warn(text("the figures are of a part of the reference: ", test, " has values at ", errors.samples, " of ",
                         errors.samples + errors.uncovered, " places in ", reference, ", less than --coverage ",
                         least_coverage));
    }
    return figures;
}

}  // namespace subvol::cli
