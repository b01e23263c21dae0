// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "label_net.h"
#include "subvol/progress.h"

namespace subvol::detail {

/// The places of a net's points after so many rounds of smoothing.
///
/// volumes: of the materials in voxels, from material 1 on; walls move until these are met. Without rounds they are met
[[nodiscard]] std::vector<Vec3> smoothed_places(const LabelNet& net, int rounds, std::span<const double> volumes,
                                                Progress* progress);

/// The two triangles of a quad: those of its shorter diagonal.
[[nodiscard]] std::array<std::array<Index, 3>, 2> split_quad(const LabelNet::Quad& quad, const std::vector<Vec3>& places);

/// The volumes of the materials in voxels, from material 1 on.
[[nodiscard]] std::vector<double> volumes_of(const LabelNet& net, const std::vector<Vec3>& places, std::size_t materials);

}  // namespace subvol::detail
