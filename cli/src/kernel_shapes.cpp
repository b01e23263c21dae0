#include "kernel_shapes.h"

#include <utility>

namespace subvol::cli {
namespace {

const std::vector<std::pair<std::string, KernelShape>> kShapes{{"gaussian", KernelShape::Gaussian},
                                                               {"scaled_gaussian", KernelShape::ScaledGaussian},
                                                               {"bc", KernelShape::BcSpline},
                                                               {"cardinal", KernelShape::CardinalSpline},
                                                               {"wendland_c2", KernelShape::WendlandC2},
                                                               {"wendland_c4", KernelShape::WendlandC4},
                                                               {"two_gaussians", KernelShape::GaussianSum},
                                                               {"gaussians", KernelShape::GaussianSum},
                                                               {"separable_gaussian", KernelShape::SeparableGaussian},
                                                               {"separable_table", KernelShape::SeparableTable}};

}  // namespace

std::vector<std::string> shape_names() {
    std::vector<std::string> names;
    for (const auto& [name, shape] : kShapes) names.push_back(name);
    return names;
}

std::optional<KernelShape> shape_named(const std::string& name) {
    for (const auto& [known, shape] : kShapes) {
        if (known == name) return shape;
    }
    return std::nullopt;
}

}  // namespace subvol::cli
