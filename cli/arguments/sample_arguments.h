// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "refine_arguments.h"
#include "subvol/mesh_kernels.h"
#include "subvol/reduce.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace subvol::cli {

/// The options of sampling a mesh into radial basis functions, for all verbs that make kernels.
struct SampleArguments {
    SampleOptions sampling{};
    ReduceOptions reduction{.rmse = 0};  // > 0: as few kernels as this error needs, instead of samples at a spacing
    double spacing_voxels = 0;
    std::string footprint;  // a camera
    std::string footprint_size = "512x512";
    std::string threshold;  // a number; empty: the transfer function decides

    void add_to(CLI::App& app);
    [[nodiscard]] std::vector<Option> described();

    [[nodiscard]] SampleOptions options(const Box& box, const RefineOptions& refinement) const;

    /// levels: of --levels; without a number for --threshold, what is invisible depends on the picture (`drops_invisible`)
    [[nodiscard]] KernelOptions kernel_options(const Box& box, const RefineOptions& refinement,
                                               std::optional<int> levels) const;

    /// Whether --threshold was given, and without a number.
    [[nodiscard]] bool drops_invisible() const;

private:
    [[nodiscard]] Footprint footprint_of(const Box& box) const;

    CLI::Option* threshold_option_ = nullptr;
};

/// A distance in units of 1/200 of the longest side of a box, in world units.
[[nodiscard]] double world_of_voxels(double voxels, const Box& box);

}  // namespace subvol::cli
