// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/reduce.h"

namespace subvol::detail {

/// Samples in groups: group g is order[starts[g] .. starts[g+1]).
struct SampleGroups {
    std::vector<Index> order;
    std::vector<std::size_t> starts;
};

/// Each sample with the kernel that weighs most there; those without one come in a last group.
[[nodiscard]] SampleGroups group_by_kernel(const RbfVolume& volume, const FieldSamples& samples);

/// At most `most` samples of each group, evenly chosen, that weigh what all of it weigh; groups keep their order.
struct ThinSamples {
    FieldSamples samples;
    std::vector<std::size_t> starts;
};
[[nodiscard]] ThinSamples thin_samples(const FieldSamples& samples, std::span<const Index> order,
                                       std::span<const std::size_t> starts, std::size_t most);

}  // namespace subvol::detail
