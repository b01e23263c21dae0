// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "subvol/kernel.h"
#include "subvol/surface.h"
#include "subvol/vec.h"

namespace subvol {

/// One scalar channel. What a kernel stands for at x is values + gradients·d + moments·e + ½ dᵀ hessians d, with d = x−μ and
/// e = dᵀ S⁻¹ d.
///
/// gradients: world⁻¹; moments: R²L/6, L the second moment H:JJᵀ of the field's Hessian H, in the units of the value
/// hessians:  xx xy xz yy yz zz of what is left of H when the part along S⁻¹ is taken out (world⁻²), one a point; none: that
///            part is all
struct RbfChannel {
    std::string name{};
    std::vector<float> values{};
    std::vector<std::array<float, 3>> gradients{};
    std::vector<float> moments{};
    std::vector<std::array<float, 6>> hessians{};
};

/// A subdivision volume as radial basis functions: what every renderer and exporter takes.
///
/// centers:  world
/// frames:   xx xy xz yy yz zz of S = R² J Jᵀ (world²), J's columns the world displacement per sample interval
/// kernel:   of all points: its value at ρ = R√e is their weight, its support radius is the frames' R
/// boundary: the solid's surface, outward; outside it there is nothing. Empty: the points have no known boundary
struct RbfVolume {
    std::vector<Vec3> centers;
    std::vector<std::array<float, 6>> frames;
    std::vector<RbfChannel> channels;
    Kernel kernel;
    Surface boundary;
    Box bounds;

    [[nodiscard]] std::size_t size() const { return centers.size(); }
};

/// The box of the boundary; of the centres if there is none.
[[nodiscard]] Box box_of(const RbfVolume& volume);

/// throws: Error(InvalidInput), naming the point from 0, unless there are as many of everything as points (Hessians: or none),
///         there is a channel, channels have names of their own, numbers are finite, the kernel is valid, the frames' diagonals
///         are positive and the triangles' corners there
void validate(const RbfVolume& volume);

}  // namespace subvol
