// SPDX-License-Identifier: Apache-2.0
#include "subvol/kernel.h"

#include <cmath>

#include "kernel_formulas.h"
#include "shader_kernel_formulas_glsl.h"
#include "subvol/detail/kernel_code.h"

namespace subvol {

using namespace detail;

namespace detail {

KernelFormulas formulas_of(const Kernel& kernel) {
    using F = KernelFormulas;
    return std::visit(Overloaded{
                          [](const CompactKernel& k) {
                              return F{KERNEL_COMPACT, {k.radius, 0, 0, 0}, {}};
                          },
                          [](const GaussianKernel& k) {
                              return F{KERNEL_GAUSSIAN, {k.radius, k.sigma, k.amplitude, 0}, {}};
                          },
                          [](const GaussianSumKernel& k) {
                              return F{KERNEL_GAUSSIAN_SUM, {k.radius, k.sigmas.size(), 0, 0}, k.amplitudes, k.sigmas};
                          },
                          [](const BcSplineKernel& k) {
                              return F{KERNEL_CUBIC, {k.extent, k.b, k.c, 0}, {}};
                          },
                          // Keys' cubic with parameter a is Mitchell and Netravali's with B = 0, C = −a.
                          [](const CardinalSplineKernel& k) {
                              return F{KERNEL_CUBIC, {k.extent, 0, -k.a, 0}, {}};
                          },
                          [](const WendlandC2Kernel& k) {
                              return F{KERNEL_WENDLAND_C2, {k.radius, k.amplitude, 0, 0}, {}};
                          },
                          [](const WendlandC4Kernel& k) {
                              return F{KERNEL_WENDLAND_C4, {k.radius, k.amplitude, 0, 0}, {}};
                          },
                          [](const SeparableGaussianKernel& k) {
                              return F{KERNEL_SEPARABLE_GAUSSIAN, {k.radius, k.sigma, k.a, k.b}, {}};
                          },
                          [](const CubicConvolutionKernel& k) {
                              return F{KERNEL_SEPARABLE_CUBIC, {2, 0, -k.a, 0}, {}};
                          },
                          [](const SeparableTableKernel& k) {
                              return F{KERNEL_SEPARABLE_TABLE, {k.radius, k.values.size(), 0, 0}, k.values};
                          },
                          [](const TableKernel& k) {
                              return F{KERNEL_TABLE, {k.radius, k.count, 0, 0}, k.values};
                          },
                      },
                      kernel);
}

}  // namespace detail

bool is_radial(const Kernel& kernel) {
    return detail::formulas_of(kernel).kind < KERNEL_SEPARABLE_GAUSSIAN;
}

double support_radius(const Kernel& kernel) {
    return detail::formulas_of(kernel).parameters.x;
}

double kernel_value(const Kernel& kernel, const Vec3& x) {
    auto formulas = detail::formulas_of(kernel);
    return formulas.kernel_value(formulas.kind, formulas.parameters, x);
}

double radial_value(const Kernel& kernel, double rho) {
    return kernel_value(kernel, {rho, 0, 0});
}

Vec3 kernel_gradient(const Kernel& kernel, const Vec3& x) {
    auto formulas = detail::formulas_of(kernel);
    return formulas.kernel_gradient(formulas.kind, formulas.parameters, x);
}

KernelCode detail::kernel_code(const Kernel& kernel) {
    validate(kernel);
    const auto formulas = detail::formulas_of(kernel);
    const auto& p = formulas.parameters;
    KernelCode code{.type = formulas.kind, .parameters = {p.x, p.y, p.z, p.w}, .table = {}};
    code.table.assign(formulas.first.begin(), formulas.first.end());
    code.table.insert(code.table.end(), formulas.second.begin(), formulas.second.end());
    return code;
}

std::string detail::kernel_glsl() {
    return std::string("#define real float\n#define real3 vec3\n#define real4 vec4\nfloat kernel_table(int i);\n#line 1\n") +
           kShader_kernel_formulas_glsl;
}

}  // namespace subvol
