#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "subvol/render_pt.h"

namespace subvol::cli {

/// How the reference methods draw: tets, pt, dense, grid.
struct ReferenceArguments {
    int samples = 1;
    double image_tolerance = 1e-3;
    std::string order = "topological";

    void add_to(CLI::App& app);

    /// throws: Error(InvalidInput) if the order is unknown
    [[nodiscard]] PtOrder pt_order() const;
};

}  // namespace subvol::cli
