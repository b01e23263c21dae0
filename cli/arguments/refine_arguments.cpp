// SPDX-License-Identifier: Apache-2.0
#include "refine_arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "choices.h"
#include "numbers.h"
#include "subvol/detail/refined_memory.h"
#include "subvol/error.h"
#include "subvol/limit.h"
#include "subvol/refine_mixed.h"
#include "text.h"

namespace subvol::cli {

void check_memory(int level, double cells, double bytes_per_cell) {
    detail::check_memory(level, cells, bytes_per_cell, "--levels");
}

std::vector<std::string> tet_schemes() {
    std::vector<std::string> schemes = names_of<TetScheme>();
    std::erase_if(schemes, [](const std::string& name) { return !is_tet_scheme(name); });
    return schemes;
}

bool is_tet_scheme(const std::string& name) {
    return !find_named<Scheme>(name) && find_named<TetScheme>(name);
}

Scheme scheme_named(const std::string& name) {
    if (is_tet_scheme(name)) {
        throw Error(ErrorCode::InvalidInput, name + " refines tetrahedra, and this verb or input has hexahedra only",
                    "--scheme", "info, subdivide, points, render, view, vdb, probe, surface, slice and page take it");
    }
    return named<Scheme>(name, "--scheme");
}

void RefineArguments::add_scheme_to(CLI::App& app) {
    std::vector<std::string> schemes = names_of<Scheme>();
    std::ranges::copy(tet_schemes(), std::back_inserter(schemes));
    app.add_option(
           "--scheme", scheme,
           "mcq (smooth, through the control points; the default), cc (Catmull-Clark), bsxw (Bajaj-Schaefer-Warren-Xu), "
           "linear; of tetrahedra as tetrahedra: tetoct, boxspline")
        ->type_name("NAME")
        ->check(offered(schemes));
    app.add_option("--tension", tension, "of mcq: 0 is linear; the default, 1/16, reproduces cubics")
        ->type_name("W")
        ->transform(number_in(0.0, 0.125));
    app.add_option("--crease-angle", crease_angle_deg,
                   "keep boundary edges sharp that bend by more than this, in degrees (tetoct, boxspline: 60)")
        ->type_name("DEG")
        ->transform(number_in(0.0, 180.0));
}

void RefineArguments::add_to(CLI::App& app, const std::string& levels_help) {
    add_scheme_to(app);
    app.add_option("--levels", levels, levels_help)->type_name("L")->transform(whole_number(0, 10));
}

RefineOptions RefineArguments::options(int default_levels, Progress* progress) const {
    return {.scheme = {scheme_named(scheme), tension, crease_angle_deg},
            .levels = levels.value_or(default_levels),
            .progress = progress};
}

WithFacts<HexMesh> refine_reported(const HexMesh& mesh, const RefineOptions& options, Vertices vertices) {
    check_memory(options.levels, static_cast<double>(mesh.cells.size()) * std::pow(8.0, options.levels),
                 detail::kBytesOfRefinedCell);
    Facts facts;
    HexMesh fine = facts.timed(options.progress, "refine", [&] {
        HexMesh refined = refine(mesh, options);
        return vertices == Vertices::OnTheLimit ? on_limit(std::move(refined), options.scheme.kind) : refined;
    });
    facts["levels"] = options.levels;
    facts["cells"] = fine.cells.size();
    return {std::move(fine), std::move(facts)};
}

}  // namespace subvol::cli
