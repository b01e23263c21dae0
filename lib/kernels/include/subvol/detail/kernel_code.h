// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <vector>

#include "subvol/kernel.h"

namespace subvol::detail {

/// A kernel as numbers: `type`, `p` and the table of kernel_formulas.glsl. For shaders, and for loops without std::variant.
struct KernelCode {
    int type = 0;
    std::array<double, 4> parameters{};
    std::vector<double> table;
};

/// throws: Error(InvalidInput) if the kernel is not valid
[[nodiscard]] KernelCode kernel_code(const Kernel& kernel);

/// The formulas as GLSL 4.3 text, to be inserted after a shader's version line. They define
///
///     float kernel_radial(int type, vec4 p, float rho);        // radial kernels only
///     float kernel_radial_slope(int type, vec4 p, float rho);  // φ′(ρ)/ρ, radial kernels only
///     float kernel_value(int type, vec4 p, vec3 x);
///     vec3 kernel_gradient(int type, vec4 p, vec3 x);
///
/// and need `float kernel_table(int i)`, which reads KernelCode::table (never called for a kernel without a table).
/// Their names and macros begin with kernel_ and KERNEL_; `real`, `real3` and `real4` are macros.
[[nodiscard]] std::string kernel_glsl();

}  // namespace subvol::detail
