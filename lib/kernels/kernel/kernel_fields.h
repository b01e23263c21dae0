// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/kernel.h"

namespace subvol::detail {

// The fields of each kernel, listed once: each_field calls visit(name, value) for every field.

template <class Visit>
void each_field(CompactKernel& k, Visit&& visit) {
    visit("radius", k.radius);
}

template <class Visit>
void each_field(GaussianKernel& k, Visit&& visit) {
    visit("sigma", k.sigma);
    visit("amplitude", k.amplitude);
    visit("radius", k.radius);
}

template <class Visit>
void each_field(GaussianSumKernel& k, Visit&& visit) {
    visit("amplitudes", k.amplitudes);
    visit("sigmas", k.sigmas);
    visit("radius", k.radius);
}

template <class Visit>
void each_field(BcSplineKernel& k, Visit&& visit) {
    visit("b", k.b);
    visit("c", k.c);
    visit("extent", k.extent);
}

template <class Visit>
void each_field(CardinalSplineKernel& k, Visit&& visit) {
    visit("a", k.a);
    visit("extent", k.extent);
}

template <class Visit>
void each_field(WendlandC2Kernel& k, Visit&& visit) {
    visit("radius", k.radius);
    visit("amplitude", k.amplitude);
}

template <class Visit>
void each_field(WendlandC4Kernel& k, Visit&& visit) {
    visit("radius", k.radius);
    visit("amplitude", k.amplitude);
}

template <class Visit>
void each_field(SeparableGaussianKernel& k, Visit&& visit) {
    visit("a", k.a);
    visit("b", k.b);
    visit("sigma", k.sigma);
    visit("radius", k.radius);
}

template <class Visit>
void each_field(CubicConvolutionKernel& k, Visit&& visit) {
    visit("a", k.a);
}

template <class Visit>
void each_field(SeparableTableKernel& k, Visit&& visit) {
    visit("radius", k.radius);
    visit("values", k.values);
}

template <class Visit>
void each_field(TableKernel& k, Visit&& visit) {
    visit("radius", k.radius);
    visit("count", k.count);
    visit("values", k.values);
}

/// The kernels' names in files, in the order of the variant.
inline constexpr const char* kKernelTypes[] = {"compact",           "gaussian",        "gaussian_sum", "bc_spline",
                                               "cardinal_spline",   "wendland_c2",     "wendland_c4",  "separable_gaussian",
                                               "cubic_convolution", "separable_table", "table"};
static_assert(std::size(kKernelTypes) == std::variant_size_v<Kernel>);

}  // namespace subvol::detail
