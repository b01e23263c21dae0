// SPDX-License-Identifier: Apache-2.0
#include "thin_samples.h"

#include <algorithm>

#include "bucket_sort.h"
#include "kernel_tree.h"
#include "space_order.h"

namespace subvol::detail {

SampleGroups group_by_kernel(const RbfVolume& volume, const FieldSamples& samples) {
    const KernelTree tree(volume.centers, volume.frames);
    std::vector<std::size_t> owner(samples.size(), volume.size());
    parallel_each(samples.size(), [&](std::size_t i) {
        double nearest = 1;
        tree.visit_at(samples.points[i], [&](std::size_t slot, const Vec3&, const Vec3&, double e) {
            if (e >= nearest) return;
            nearest = e;
            owner[i] = tree.kernel(slot);
        });
    });
    SampleGroups groups{.order = std::vector<Index>(samples.size()), .starts = std::vector<std::size_t>(volume.size() + 2)};
    for (const std::size_t kernel : owner) ++groups.starts[kernel + 1];
    for (std::size_t k = 0; k <= volume.size(); ++k) groups.starts[k + 1] += groups.starts[k];
    auto next = groups.starts;
    for (const Index i : space_order(samples.points)) groups.order[next[owner[i]]++] = i;
    return groups;
}

ThinSamples thin_samples(const FieldSamples& samples, std::span<const Index> order, std::span<const std::size_t> starts,
                         std::size_t most) {
    const std::size_t groups = starts.size() - 1;
    ThinSamples result;
    result.starts.assign(groups + 1, 0);
    for (std::size_t g = 0; g < groups; ++g)
        result.starts[g + 1] = result.starts[g] + std::min(starts[g + 1] - starts[g], most);
    auto& points = result.samples.points;
    auto &values = result.samples.values, &weights = result.samples.weights;
    points.resize(result.starts.back());
    values.resize(points.size());
    weights.resize(points.size());
    parallel_each(groups, [&](std::size_t g) {
        const std::size_t all = starts[g + 1] - starts[g], first = result.starts[g], count = result.starts[g + 1] - first;
        double whole = 0, chosen = 0;
        for (std::size_t k = 0; k < all; ++k) whole += samples.weights[order[starts[g] + k]];
        for (std::size_t k = 0; k < count; ++k) {
            const Index i = order[starts[g] + k * all / count];
            points[first + k] = samples.points[i];
            values[first + k] = samples.values[i];
            chosen += weights[first + k] = samples.weights[i];
        }
        for (std::size_t k = 0; k < count; ++k) weights[first + k] *= chosen > 0 ? whole / chosen : 1;
    });
    return result;
}

}  // namespace subvol::detail
