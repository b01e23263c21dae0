// SPDX-License-Identifier: Apache-2.0

#include "subvol/error.h"
#include "subvol/kernel.h"

namespace subvol {

namespace {

// Where no parameters are given, the type's own defaults are its best fit.
const std::vector<std::pair<std::string, Kernel>>& named() {
    static const std::vector<std::pair<std::string, Kernel>> kKernels{
        {"gaussian", GaussianKernel{}},
        {"compact", CompactKernel{}},
        {"bc", BcSplineKernel{}},
        {"paper_bc", BcSplineKernel{.b = 0.039579, .c = 0.028746, .extent = 2}},
        {"cardinal", CardinalSplineKernel{}},
        {"wendland_c2", WendlandC2Kernel{}},
        {"wendland_c4", WendlandC4Kernel{.radius = 1.89735, .amplitude = 0.89744}},
        {"two_gaussians", GaussianSumKernel{.amplitudes = {1.01121, -0.15767}, .sigmas = {0.5015, 0.74912}}},
        {"separable_gaussian", SeparableGaussianKernel{}},
        {"cubic", CubicConvolutionKernel{}},
    };
    return kKernels;
}

}  // namespace

std::vector<std::string> kernel_names() {
    std::vector<std::string> names;
    for (const auto& [name, kernel] : named()) names.push_back(name);
    return names;
}

Kernel named_kernel(const std::string& name) {
    std::string all;
    for (const auto& [known, kernel] : named()) {
        if (known == name) return kernel;
        all += (all.empty() ? "" : ", ") + known;
    }
    throw Error(ErrorCode::InvalidInput, "there is no kernel '" + name + "'", {}, all);
}

}  // namespace subvol
