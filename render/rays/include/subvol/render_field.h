// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"

namespace subvol {

struct MarchOptions {
    double step_world = 0.002;  ///< distance between samples, > 0; entries and exits are found by bisection to 1e-9 of it
    int samples = 1;            ///< n × n rays for each pixel on a regular grid, 1..16
    Clip clip{};                ///< how the volume is cut open
    Progress* progress = nullptr;
};

/// Marches rays through any field: the oracle for fields with a closed form. Entries and exits are found by bisection between
/// a sample inside and one outside; parts thinner than a step may be missed.
///
/// field:  the value at a place; nothing outside
/// box:    where the field may have values
/// throws: Error(InvalidInput) if an option is out of range
[[nodiscard]] Image render_field(const std::function<std::optional<double>(const Vec3&)>& field, const Box& box,
                                 const View& view, const Optics& optics, const MarchOptions& options = {});

}  // namespace subvol
