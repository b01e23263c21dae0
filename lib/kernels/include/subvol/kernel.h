// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "subvol/option_names.h"
#include "subvol/vec.h"

namespace subvol {

// Kernels are small values. Lengths are in sample intervals (the scheme's lattice units), ρ = |x|; at its radius and beyond
// it a kernel is 0.

/// (1 − ρ²/R²)³: the kernel of the splatter. Below R = 1.2 it leaves holes.
struct CompactKernel {
    double radius = 1.43;
};

/// amplitude · exp(−ρ²/2σ²), cut off at `radius`.
struct GaussianKernel {
    double sigma = 0.43;
    double amplitude = 1;
    double radius = 3;
};

/// Σ amplitudeᵢ · exp(−ρ²/2σᵢ²), cut off at `radius`.
struct GaussianSumKernel {
    std::vector<double> amplitudes;
    std::vector<double> sigmas;
    double radius = 3;
};

/// The cubic of Mitchell and Netravali in ρ: its inner piece up to extent/2, its outer one up to `extent`. The pieces are not
/// rescaled, so that only an extent of 2 gives a continuous spline; other extents follow the radius in [mnmq2007].
struct BcSplineKernel {
    double b = 0.418792;
    double c = 0.146011;
    double extent = 2;
};

/// The cardinal cubic in ρ, with pieces as in BcSplineKernel.
struct CardinalSplineKernel {
    double a = -0.098647;
    double extent = 2;
};

/// amplitude · (1−s)⁴(4s+1), s = ρ/R.
struct WendlandC2Kernel {
    double radius = 1.64572;
    double amplitude = 0.92666;
};

/// amplitude · (1−s)⁶(35s²+18s+3)/3, s = ρ/R.
struct WendlandC4Kernel {
    double radius = 2;
    double amplitude = 1;
};

/// Π (a + b x²) exp(−x²/2σ²) over the axes, cut off at |x| = `radius` on each.
struct SeparableGaussianKernel {
    double a = 0.94755;
    double b = -0.74100;
    double sigma = 0.60388;
    double radius = 3;
};

/// Π of Keys' cubic convolution over the axes, support 2; a = −1/2 is Catmull-Rom.
struct CubicConvolutionKernel {
    double a = -0.5;
};

/// Π of one table over the axes: values at 0, h, 2h, … radius, linear between.
struct SeparableTableKernel {
    double radius = 3;
    std::vector<double> values;
};

/// A table on the octant [0,radius]³, count³ values with x fastest, trilinear between.
struct TableKernel {
    double radius = 3;
    std::size_t count = 0;
    std::vector<double> values;
};

using Kernel =
    std::variant<CompactKernel, GaussianKernel, GaussianSumKernel, BcSplineKernel, CardinalSplineKernel, WendlandC2Kernel,
                 WendlandC4Kernel, SeparableGaussianKernel, CubicConvolutionKernel, SeparableTableKernel, TableKernel>;

/// Whether the kernel is a function of ρ alone.
[[nodiscard]] bool is_radial(const Kernel& kernel);

/// The size of the support: a distance if the kernel is radial, otherwise along each axis.
[[nodiscard]] double support_radius(const Kernel& kernel);

/// The kernel at an offset, and at a distance. For a kernel that is not radial, `radial_value` is the value along an axis.
[[nodiscard]] double kernel_value(const Kernel& kernel, const Vec3& x);
[[nodiscard]] double radial_value(const Kernel& kernel, double rho);

/// The gradient; at a kink that of the outer piece, across a plane of symmetry 0.
[[nodiscard]] Vec3 kernel_gradient(const Kernel& kernel, const Vec3& x);

/// ∫ kernel dz from z0 to z1 at the offset (x, y), and over the whole line. Exact up to rounding.
///
/// cost: O(1); for tables O(values per axis)
[[nodiscard]] double slab_integral(const Kernel& kernel, double x, double y, double z0, double z1);
[[nodiscard]] double line_integral(const Kernel& kernel, double x, double y);

/// throws: Error(InvalidInput) if a number is not finite, a length is not positive, or a table does not have the size that it
///         states or not 2 to 1024 values per axis. The functions above take valid kernels only
void validate(const Kernel& kernel);

/// A kernel as a JSON object: its "type" and its fields by their names here. Fields left out take their defaults. What is
/// written reads back bit for bit.
///
/// throws: Error(InvalidInput) if the text is not such an object or the kernel is not valid
[[nodiscard]] std::string to_json(const Kernel& kernel);
[[nodiscard]] Kernel kernel_from_json(std::string_view text);

/// The kernels that have a name, with parameters fitted to the basis function of MCQ: gaussian, compact (the splatter's kernel,
/// not a fit), bc, paper_bc (B and C as printed in [mnmq2007]), cardinal, wendland_c2, wendland_c4, two_gaussians,
/// separable_gaussian, cubic (Catmull-Rom, not a fit).
///
/// throws: Error(InvalidInput) if there is no such name
[[nodiscard]] Kernel named_kernel(const std::string& name);
[[nodiscard]] std::vector<std::string> kernel_names();

/// An option that is a kernel: its name, or a JSON object.
[[nodiscard]] Option kernel_option(const std::string& name, Kernel& kernel);

}  // namespace subvol
