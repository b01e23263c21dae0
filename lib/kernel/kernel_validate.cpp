// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "kernel_fields.h"
#include "kernel_formulas.h"
#include "subvol/error.h"

namespace subvol {

namespace {

constexpr std::size_t kMostPerAxis = 1024;  // so that a table's places are ints

[[noreturn]] void refuse(const Kernel& kernel, const std::string& message, const std::string& allowed) {
    throw Error(ErrorCode::InvalidInput, message, std::string("kernel ") + detail::kKernelTypes[kernel.index()], allowed);
}

/// Every number is finite; lengths are positive too.
struct CheckField {
    const Kernel& kernel;

    void operator()(const std::string& name, double value) const {
        if (!std::isfinite(value)) refuse(kernel, "'" + name + "' is not a finite number", "");
        const bool length = name == "radius" || name == "extent" || name == "sigma" || name == "sigmas";
        if (length && !(value > 0)) refuse(kernel, "'" + name + "' is " + std::to_string(value), "a positive number");
    }
    void operator()(const std::string& name, const std::vector<double>& values) const {
        for (const double value : values) (*this)(name, value);
    }
    void operator()(const std::string&, std::size_t) const {}
};

void check_per_axis(const Kernel& kernel, std::size_t count) {
    if (count < 2 || count > kMostPerAxis)
        refuse(kernel, "a table has " + std::to_string(count) + " values per axis", "2 to 1024");
}

}  // namespace

void validate(const Kernel& kernel) {
    Kernel copy = kernel;
    std::visit([&](auto& k) { detail::each_field(k, CheckField{kernel}); }, copy);
    if (const auto* sum = std::get_if<GaussianSumKernel>(&kernel)) {
        if (sum->sigmas.empty() || sum->sigmas.size() != sum->amplitudes.size() || sum->sigmas.size() > kMostPerAxis)
            refuse(kernel, "its amplitudes and sigmas do not pair up", "as many of each, 1 to 1024");
    } else if (const auto* line = std::get_if<SeparableTableKernel>(&kernel)) {
        check_per_axis(kernel, line->values.size());
    } else if (const auto* table = std::get_if<TableKernel>(&kernel)) {
        check_per_axis(kernel, table->count);
        if (table->values.size() != table->count * table->count * table->count)
            refuse(kernel, "its table has " + std::to_string(table->values.size()) + " values", "count³ values");
    }
}

}  // namespace subvol
