// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/vec4.hpp>
#include <span>

#include "subvol/kernel.h"

namespace subvol::detail {

using std::abs;
using std::exp;
using std::min;
using std::sqrt;

/// The formulas of kernel_formulas.glsl in double precision: members, so that they can read the table of one kernel.
struct KernelFormulas {
    using real = double;
    using real3 = Vec3;
    using real4 = glm::dvec4;

    int kind = 0;  // the argument `type` of the functions
    real4 parameters{};
    std::span<const double> first, second{};  // the table, in two parts because a sum of Gaussians stores it that way

    real kernel_table(int i) const {
        const auto at = static_cast<std::size_t>(i);
        return at < first.size() ? first[at] : second[at - first.size()];
    }
    static real sign(real t) { return t > 0 ? 1 : t < 0 ? -1 : 0; }

#include "subvol/kernel_formulas.glsl"
};

/// Refers to the kernel's tables, so the kernel must outlive the result.
[[nodiscard]] KernelFormulas formulas_of(const Kernel& kernel);

/// std::visit with lambdas.
template <class... Cases>
struct Overloaded : Cases... {
    using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace subvol::detail
