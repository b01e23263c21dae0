#include "subvol/kernel.h"

#include <cmath>

namespace subvol {

bool is_radial(const Kernel& kernel) {
    return !(std::holds_alternative<SeparableGaussianKernel>(kernel) ||
             std::holds_alternative<CubicConvolutionKernel>(kernel) || std::holds_alternative<SeparableTableKernel>(kernel) ||
             std::holds_alternative<TableKernel>(kernel));
}

double support_radius(const Kernel& kernel) {
    if (const auto* compact = std::get_if<CompactKernel>(&kernel)) return compact->radius;
    return 3;
}

double radial_value(const Kernel& kernel, double rho) {
    if (const auto* compact = std::get_if<CompactKernel>(&kernel)) {
        const double left = 1 - rho * rho / (compact->radius * compact->radius);
        return left > 0 ? left * left * left : 0;
    }
    return 0;
}

double kernel_value(const Kernel& kernel, const Vec3& x) {
    return radial_value(kernel, std::sqrt(x.x * x.x + x.y * x.y + x.z * x.z));
}

}  // namespace subvol
