// SPDX-License-Identifier: Apache-2.0
#include "refine_arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>

#include "options.h"
#include "subvol/detail/refined_memory.h"
#include "subvol/error.h"
#include "subvol/mesh_kernels.h"
#include "subvol/option.h"
#include "subvol/part_of_limit.h"
#include "subvol/refine_mixed.h"

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

std::vector<Option> RefineArguments::described() {
    std::vector<std::string> schemes = names_of<Scheme>();
    std::ranges::copy(tet_schemes(), std::back_inserter(schemes));
    RefineOptions any;
    std::vector<Option> all = options_of(rules);
    const std::string sentence = all.front().sentence;
    all.front() = Option("scheme", scheme)  // those of tetrahedra, too
                      .offer(std::move(schemes))
                      .help("NAME", sentence + "; of tetrahedra as tetrahedra: tetoct, boxspline");
    all.push_back(options_of(any).back());
    all.back().value = &levels;  // which may be left out
    return all;
}

void RefineArguments::add_scheme_to(CLI::App& app) {
    std::vector<Option> scheme_only = described();
    scheme_only.pop_back();
    add_options(app, scheme_only);
}

void RefineArguments::add_to(CLI::App& app, const std::string& levels_help) {
    add_scheme_to(app);
    add_option(app, described().back().help("L", levels_help));
}

RefineOptions RefineArguments::options(int default_levels, Progress* progress) const {
    RefineOptions options{.scheme = rules, .levels = levels.value_or(default_levels), .progress = progress};
    options.scheme.kind = scheme_named(scheme);
    if (options.scheme.crease_angle_deg == 180) options.scheme.crease_angle_deg.reset();  // no edge bends by more
    return options;
}

WithFacts<HexMesh> refine_reported(const HexMesh& mesh, const RefineOptions& options, Vertices vertices,
                                   std::span<const std::uint8_t> part) {
    const bool on_limit = vertices == Vertices::OnTheLimit;
    if (on_limit && part.empty()) return refined_on_limit(mesh, options, "--levels");
    const auto cells = part.empty() ? static_cast<std::ptrdiff_t>(mesh.cells.size()) : std::ranges::count(part, 1);
    check_memory(options.levels, static_cast<double>(cells) * std::pow(8.0, options.levels), detail::kBytesOfRefinedCell);
    Facts facts;
    HexMesh fine = facts.timed(options.progress, "refine", [&] {
        return part.empty() ? refine(mesh, options) : refined_part(mesh, part, options, on_limit);
    });
    facts["levels"] = options.levels;
    facts["cells"] = fine.cells.size();
    return {std::move(fine), std::move(facts)};
}

}  // namespace subvol::cli
