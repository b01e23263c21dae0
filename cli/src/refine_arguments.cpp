#include "refine_arguments.h"

#include "text.h"

namespace subvol::cli {

void RefineArguments::add_to(CLI::App& app, const std::string& levels_help) {
    app.add_option("--scheme", scheme, "mcq (smooth, through the control points; the default) or linear")->type_name("NAME");
    app.add_option("--levels", levels, levels_help)->type_name("L")->check(CLI::Range(0, 10));
    app.add_option("--crease-angle", crease_angle_deg, "keep boundary edges sharp that bend by more than this, in degrees")
        ->type_name("DEG")
        ->check(CLI::Range(0.0, 180.0));
}

RefineOptions RefineArguments::options(int default_levels, Report& report) const {
    check_choice("--scheme", scheme, {"mcq", "linear"}, {"cc", "bsxw"});
    return {.scheme = scheme == "linear" ? Scheme::Linear : Scheme::Mcq,
            .levels = levels.value_or(default_levels),
            .crease_angle_deg = crease_angle_deg,
            .progress = report.progress()};
}

HexMesh refine_reported(const HexMesh& mesh, const RefineOptions& options, Report& report) {
    HexMesh fine = report.timed("refine", [&] { return refine(mesh, options); });
    report["levels"] = options.levels;
    report["cells"] = fine.cells.size();
    return fine;
}

}  // namespace subvol::cli
