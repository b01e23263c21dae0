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

/// The formulas of kernel_formulas.glsl in double precision, over one kernel's table: members, so that they read it.
struct KernelFormulas {
    using real = double;
    using real3 = Vec3;
    using real4 = glm::dvec4;

    int kind = 0;  // the `type` that the functions ask for
    real4 parameters{};
    std::span<const double> first, second{};  // the table, in two parts because a sum of Gaussians holds it so

    real kernel_table(int i) const {
        const auto at = static_cast<std::size_t>(i);
        return at < first.size() ? first[at] : second[at - first.size()];
    }
    static real sign(real t) { return t > 0 ? 1 : t < 0 ? -1 : 0; }

#include "subvol/kernel_formulas.glsl"
};

/// Views the kernel's tables: not to be kept longer than the kernel.
[[nodiscard]] KernelFormulas formulas_of(const Kernel& kernel);

/// std::visit with lambdas.
template <class... Cases>
struct Overloaded : Cases... {
    using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace subvol::detail
