// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "splat_frame.h"
#include "subvol/progress.h"

namespace subvol::detail {

/// Splatting as in [westover1990]: each kernel gets its colour and extinction first, from the value at its centre; its
/// footprint, the integral of its weight along each ray, gives it an opacity; kernels are composited one by one, in the order
/// of the depths of their centres. For comparison: no sheets, and no boundary, beyond which footprints reach.
///
/// Sums of weights are not divided by: a weight is divided by the kernel's integral over a lattice of its own instead.
class Footprints {
public:
    /// scene: is kept by reference
    ///
    /// throws: Error(InvalidInput) if the kernel is not radial, or the scene has cuts or shadows
    explicit Footprints(const SplatScene& scene);

    /// frame:  its memory is used again
    /// throws: Error(InvalidInput) if rays of the view end
    [[nodiscard]] Drawn draw(SplatFrame& frame, const View& view, const Classification& classification,
                             Progress* progress) const;

private:
    struct Kernel;
    [[nodiscard]] std::vector<Kernel> kernels_of(const SplatFrame& frame) const;
    [[nodiscard]] static std::vector<std::uint32_t> order_of(const SplatFrame& frame, const std::vector<Kernel>& kernels,
                                                             std::size_t tile);
    void draw_tile(const SplatFrame& frame, const std::vector<Kernel>& kernels, std::size_t tile, Drawn& drawn) const;
    [[nodiscard]] float footprint(const Kernel& kernel, const Ray& ray) const;

    const SplatScene& scene_;
    std::vector<float> table_;  // of the integral of the weight, in radii, over e in [0, 1]
};

/// throws: as Footprints
void check_footprints(const SplatScene& scene);

}  // namespace subvol::detail
