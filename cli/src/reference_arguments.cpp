#include "reference_arguments.h"

#include "text.h"

namespace subvol::cli {

void ReferenceArguments::add_to(CLI::App& app) {
    app.add_option("--samples", samples, "tets, dense, grid: n x n rays a pixel (default 1)")
        ->type_name("N")
        ->check(CLI::Range(1, 16));
    app.add_option("--tolerance-image", image_tolerance,
                   "dense, without --levels: raise the level until the RMS of the picture's change is less (default 1e-3)")
        ->type_name("RMS")
        ->check(CLI::PositiveNumber);
    app.add_option("--order", order,
                   "pt: what sorts the tetrahedra: topological (shared faces, the default), centroid, or\n"
                   "lists (every pixel its own)")
        ->type_name("NAME");
}

PtOrder ReferenceArguments::pt_order() const {
    check_choice("--order", order, {"topological", "centroid", "lists"});
    if (order == "lists") return PtOrder::Lists;
    return order == "centroid" ? PtOrder::Centroid : PtOrder::Topological;
}

}  // namespace subvol::cli
