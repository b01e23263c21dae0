// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "subvol/clip.h"
#include "subvol/render_projected.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// The options of the reference methods: tets, pt, dense, grid.
struct ReferenceArguments {
    int samples = 0;  // 0: not given
    double image_tolerance = 1e-3;
    std::string order = "topological";
    int kbuffer = 6;
    std::optional<double> lod;
    Clip clip{};  // of all of them, as settled

    void add_to(CLI::App& app);

    /// throws: Error(InvalidInput) if the order is unknown
    [[nodiscard]] ProjectedOrder projected_order() const;

    /// Of pt.
    ///
    /// throws: Error(InvalidInput) if the order is unknown or cannot leave faces out, or --lod is not a fraction
    [[nodiscard]] ProjectedOptions projected_options() const;
};

}  // namespace subvol::cli
