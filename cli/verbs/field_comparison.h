// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "figures.h"
#include "refine_arguments.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// The metrics of two fields.
struct FieldComparison {
    std::size_t samples = 100'000;
    int resolution = 128;
    std::optional<double> iso;
    double least_coverage = 0.99;
    RefineArguments refine;

    void add_to(CLI::App& app);

    /// The names of the figures that `measure` will give; `of_mesh`: the second is a mesh.
    [[nodiscard]] std::vector<std::string> names(bool of_mesh) const;

    [[nodiscard]] Figures measure(const std::string& test, const std::string& reference, const CommonOptions& options,
                                  Report& report) const;
};

}  // namespace subvol::cli
