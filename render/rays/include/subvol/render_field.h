// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>

#include "subvol/camera.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"

namespace subvol {

/// step_world: distance between samples, > 0; ends are found by bisection to 1e-9 of it
struct MarchOptions {
    double step_world = 0.002;
    int samples = 1;
    Progress* progress = nullptr;
};

/// Marches rays through any field: the oracle for fields with a closed form. Entries and exits are found by bisection between
/// samples inside and outside; what is thinner than a step may be missed.
///
/// box: where the field may have values
[[nodiscard]] Image render_field(const std::function<std::optional<double>(const Vec3&)>& field, const Box& box,
                                 const View& view, const Optics& optics, const MarchOptions& options = {});

}  // namespace subvol
