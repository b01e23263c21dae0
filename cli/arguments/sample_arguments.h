// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "refine_arguments.h"
#include "subvol/sample.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace subvol::cli {

/// The options of sampling a mesh into radial basis functions, for `points` and `render --method splat`.
struct SampleArguments {
    int per_edge = 1;
    bool centers = false;
    double spacing_world = 0;
    double spacing_voxels = 0;
    double tolerance = 0;
    std::string footprint;  // a camera
    std::string footprint_size = "512x512";
    std::string correction = "second";
    std::string values = "scheme";
    std::string kernel;        // a name or JSON; empty: the compact one
    std::string value_kernel;  // the same; empty: the paper's BC spline
    std::string threshold;     // a number; empty: the transfer function decides
    double reduce_rmse = 0;    // > 0: as few kernels as this error needs, instead of samples at a spacing
    bool move_kernels = false;

    void add_to(CLI::App& app);

    /// throws: Error(InvalidInput) if a name is unknown
    [[nodiscard]] SampleOptions options(const Box& box, const RefineOptions& refinement) const;

    /// Whether --threshold was given, with a number or without.
    [[nodiscard]] bool drops_invisible() const;

private:
    [[nodiscard]] Footprint footprint_of(const Box& box) const;

    CLI::Option* threshold_option_ = nullptr;
};

/// The kernel of a name or of JSON; `fallback` names the kernel of an empty text.
[[nodiscard]] Kernel kernel_from(const std::string& text, const char* fallback);

}  // namespace subvol::cli
