// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "subvol/kernel.h"
#include "subvol/surface.h"
#include "subvol/vec.h"

namespace subvol {

/// A symmetric 3×3 matrix by its upper triangle: xx xy xz yy yz zz.
using Symmetric3 = std::array<float, 6>;

[[nodiscard]] inline Mat3 matrix(const Symmetric3& s) {
    return {Vec3(s[0], s[1], s[2]), Vec3(s[1], s[3], s[4]), Vec3(s[2], s[4], s[5])};
}

/// m: symmetric; rounded to float
[[nodiscard]] inline Symmetric3 symmetric3(const Mat3& m) {
    return {static_cast<float>(m[0][0]), static_cast<float>(m[1][0]), static_cast<float>(m[2][0]),
            static_cast<float>(m[1][1]), static_cast<float>(m[2][1]), static_cast<float>(m[2][2])};
}

/// One scalar channel. The contribution of a kernel at x is values + gradients·d + moments·e + ½ dᵀ hessians d, with d = x−μ
/// and e = dᵀ S⁻¹ d.
struct RbfChannel {
    std::string name{};
    std::vector<float> values{};
    std::vector<std::array<float, 3>> gradients{};  ///< world⁻¹
    std::vector<float> moments{};  ///< R²L/6, L the second moment H:JJᵀ of the field's Hessian H, in the units of the value
    /// H without its part along S⁻¹ (world⁻²), one per point; empty: there is only that part
    std::vector<Symmetric3> hessians{};
};

/// A subdivision volume as radial basis functions: the input of every renderer and exporter.
struct RbfVolume {
    std::vector<Vec3> centers;       ///< world
    std::vector<Symmetric3> frames;  ///< S = R² J Jᵀ (world²), J's columns the world displacement per sample interval
    std::vector<RbfChannel> channels;
    Kernel kernel;  ///< kernel of all points: its value at ρ = R√e is their weight; its support radius is the R of the frames
    Surface boundary;  ///< the solid's surface, outward; outside it there is nothing. Empty: the boundary is not known
    Box bounds;

    [[nodiscard]] std::size_t size() const { return centers.size(); }
};

/// The box of the boundary; of the centres if there is none.
[[nodiscard]] Box box_of(const RbfVolume& volume);

/// throws: Error(InvalidInput), naming the point counted from 0, unless every array has one entry per point (or, of Hessians,
///         none), there is a channel, the names of channels differ, numbers are finite, the kernel is valid, the frames are
///         positive definite (up to the rounding of floats) and the corners of the triangles exist
void validate(const RbfVolume& volume);

}  // namespace subvol
