// SPDX-License-Identifier: Apache-2.0
#include "subvol/kernel.h"

#include <cmath>

#include "kernel_fields.h"
#include "kernel_formulas.h"
#include "shader_kernel_formulas_glsl.h"
#include "subvol/detail/kernel_code.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/option.h"

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

namespace {

constexpr std::size_t kMostPerAxis = 1024;  // so that a table's places are ints

[[noreturn]] void refuse(const Kernel& kernel, const std::string& message, const std::string& allowed) {
    throw Error(ErrorCode::InvalidInput, message, std::string("kernel ") + kKernelTypes[kernel.index()], allowed);
}

/// Every number is finite; lengths are positive too.
struct CheckField {
    const Kernel& kernel;

    void operator()(const std::string& name, double value) const {
        if (!std::isfinite(value)) refuse(kernel, "'" + name + "' is not a finite number", "");
        const bool length = name == "radius" || name == "extent" || name == "sigma" || name == "sigmas";
        if (length && !(value > 0)) refuse(kernel, "'" + name + "' is " + number_text(value), "a positive number");
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

// A type without parameters here has its best fit as defaults.
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

bool is_radial(const Kernel& kernel) {
    return formulas_of(kernel).kind < KERNEL_SEPARABLE_GAUSSIAN;
}

double support_radius(const Kernel& kernel) {
    return formulas_of(kernel).parameters.x;
}

double kernel_value(const Kernel& kernel, const Vec3& x) {
    auto formulas = formulas_of(kernel);
    return formulas.kernel_value(formulas.kind, formulas.parameters, x);
}

double radial_value(const Kernel& kernel, double rho) {
    return kernel_value(kernel, {rho, 0, 0});
}

Vec3 kernel_gradient(const Kernel& kernel, const Vec3& x) {
    auto formulas = formulas_of(kernel);
    return formulas.kernel_gradient(formulas.kind, formulas.parameters, x);
}

KernelCode detail::kernel_code(const Kernel& kernel) {
    validate(kernel);
    const auto formulas = formulas_of(kernel);
    const auto& p = formulas.parameters;
    KernelCode code{.type = formulas.kind, .parameters = {p.x, p.y, p.z, p.w}, .table = {}};
    code.table.assign(formulas.first.begin(), formulas.first.end());
    code.table.insert(code.table.end(), formulas.second.begin(), formulas.second.end());
    return code;
}

std::string detail::kernel_glsl() {
    std::string code = "#define real float\n#define real3 vec3\n#define real4 vec4\nfloat kernel_table(int i);\n#line 1\n";
    return code += kShader_kernel_formulas_glsl;
}

void validate(const Kernel& kernel) {
    Kernel copy = kernel;
    std::visit([&](auto& k) { each_field(k, CheckField{kernel}); }, copy);
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

Option kernel_option(const std::string& name, Kernel& kernel) {
    const auto text = [&kernel] {
        const std::string json = to_json(kernel);
        for (const std::string& known : kernel_names()) {
            if (to_json(named_kernel(known)) == json) return known;
        }
        return json;
    };
    const auto read = [&kernel](const std::string& given, const std::string& where) {
        if (!given.starts_with('{') && !given.empty()) {
            const std::vector<std::string> names = kernel_names();
            if (std::ranges::find(names, given) == names.end()) detail::throw_unknown_name(given, where, names);
        }
        kernel = given.starts_with('{') ? kernel_from_json(given) : named_kernel(given);
    };
    return Option(name, WordValue{text, read});
}

}  // namespace subvol
