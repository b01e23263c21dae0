// SPDX-License-Identifier: Apache-2.0
#include "fit_tables.h"

#include <algorithm>
#include <cmath>
#include <iomanip>

#include "text.h"

namespace subvol::cli {

namespace {

const std::vector<NamedShape> kSums{{"two_gaussians", KernelShape::GaussianSum, 2},
                                    {"three_gaussians", KernelShape::GaussianSum, 3}};

/// A row of the paper's table 1.
struct PaperRow {
    const char* name;
    Kernel kernel;
    FitErrors errors;
};

FitErrors printed(double mse, double rmse, double mae) {
    return {.mse = mse, .rmse = rmse, .mae = mae, .max = 0};
}

std::vector<PaperRow> paper_rows() {
    return {{"gaussian", GaussianKernel{.sigma = 0.43}, printed(0.000041, 0.006395, 0.002079)},
            {"bc", BcSplineKernel{0.382175, 0.253253, 1}, printed(0.000054, 0.007339, 0.002144)},
            {"bc", BcSplineKernel{0.039579, 0.028746, 2}, printed(0.000139, 0.011808, 0.002892)},
            {"bc", BcSplineKernel{-0.062800, 0.012591, 3}, printed(0.011781, 0.108542, 0.022184)},
            {"cardinal", CardinalSplineKernel{-0.507829, 1}, printed(0.000127, 0.011275, 0.002895)},
            {"cardinal", CardinalSplineKernel{-0.098673, 2}, printed(0.000156, 0.012492, 0.002944)},
            {"cardinal", CardinalSplineKernel{-0.040698, 3}, printed(0.010297, 0.101472, 0.028730)}};
}

Json without_max(const FitErrors& errors) {
    return {{"mse", errors.mse}, {"rmse", errors.rmse}, {"mae", errors.mae}};
}

Json fitted(const BasisFunction& basis, KernelShape shape, const FitOptions& options) {
    const KernelFit fit = fit_kernel(basis, shape, options);
    return {{"parameters", parameters_of(fit.kernel)}, {"double", to_json(fit.report.errors)}};
}

/// Adds our own fits of the row's kind of kernel.
void add_fits(const BasisFunction& basis, const PaperRow& row, Json& json) {
    if (const auto* bc = std::get_if<BcSplineKernel>(&row.kernel)) {
        json["fitted"] = fitted(basis, KernelShape::BcSpline, {.extent = bc->extent});
        json["fitted_with_slip"] = fitted(basis, KernelShape::BcSpline, {.extent = bc->extent, .sign_slip = true});
    } else if (const auto* cardinal = std::get_if<CardinalSplineKernel>(&row.kernel)) {
        json["fitted"] = fitted(basis, KernelShape::CardinalSpline, {.extent = cardinal->extent});
    } else {
        json["fitted"] = fitted(basis, KernelShape::Gaussian, {});
    }
}

Json table1_row(const BasisFunction& basis, const PaperRow& row) {
    const FitErrors single = kernel_errors_float32(basis, row.kernel);
    Json json{{"kernel", row.name}, {"extent", nullptr}, {"parameters", parameters_of(row.kernel)}};
    if (json["parameters"].contains("extent")) json["extent"] = json["parameters"]["extent"];
    json["paper"] = without_max(row.errors);
    json["float32"] = to_json(single);
    json["double"] = to_json(kernel_errors(basis, row.kernel));
    json["difference"] =
        without_max(printed(single.mse - row.errors.mse, single.rmse - row.errors.rmse, single.mae - row.errors.mae));
    add_fits(basis, row, json);
    return json;
}

std::string for_people(const Json& value) {
    if (!value.is_array()) return text(std::setprecision(6), value.get<double>());
    std::vector<std::string> parts;
    for (const Json& part : value) parts.push_back(for_people(part));
    return text('(', join(parts), ')');
}

/// "b .418792, c .146011": the parameters that differ between kernels of one shape.
std::string short_parameters(const Json& parameters) {
    std::vector<std::string> parts;
    for (const auto& [key, value] : parameters.items()) {
        const bool usual = key == "extent" || (key == "radius" && value == 3.0) || (key == "amplitude" && value == 1.0);
        if (!usual) parts.push_back(text(key, ' ', for_people(value)));
    }
    return join(parts);
}

std::string error_columns(const Json& errors) {
    return text(std::fixed, std::setprecision(6), errors["rmse"].get<double>(), ' ', errors["mae"].get<double>(), "  ");
}

std::string table1_line(const Json& row) {
    const std::string extent = row["extent"].is_null() ? "" : text(row["extent"].get<double>());
    return text(std::left, std::setw(9), row["kernel"].get<std::string>(), std::setw(3), extent, error_columns(row["paper"]),
                error_columns(row["float32"]), error_columns(row["double"]), std::right, std::scientific, std::setprecision(1),
                std::setw(8), row["difference"]["rmse"].get<double>(), "  ", short_parameters(row["parameters"]));
}

/// The lines of the row's own fits.
std::vector<std::string> fit_lines(const Json& row) {
    std::vector<std::string> lines;
    for (const auto& [key, label] : {std::pair{"fitted", "fitted"}, {"fitted_with_slip", "fitted with the sign slip"}}) {
        if (!row.contains(key)) continue;
        lines.push_back(text("  ", std::left, std::setw(29), label, std::setw(25), "", error_columns(row[key]["double"]),
                             std::setw(10), "", short_parameters(row[key]["parameters"])));
    }
    return lines;
}

}  // namespace

std::vector<std::string> shape_names() {
    std::vector<std::string> names = names_of<KernelShape>();
    auto place = std::ranges::find(names, name_of(KernelShape::GaussianSum));
    for (const NamedShape& sum : kSums) place = names.insert(place, sum.name) + 1;
    return names;
}

std::optional<NamedShape> shape_named(const std::string& name) {
    const auto sum = std::ranges::find(kSums, name, &NamedShape::name);
    if (sum != kSums.end()) return *sum;
    const auto shape = find_named<KernelShape>(name);
    return shape ? std::optional(NamedShape{name, *shape}) : std::nullopt;
}

KernelFit fit_shape(const BasisFunction& basis, const NamedShape& named, FitOptions options) {
    options.terms = named.terms.value_or(options.terms);
    return fit_kernel(basis, named.shape, options);
}

Json to_json(const FitErrors& errors) {
    return {{"mse", errors.mse}, {"rmse", errors.rmse}, {"mae", errors.mae}, {"max", errors.max}};
}

Json parameters_of(const Kernel& kernel) {
    constexpr std::size_t kLong = 16;
    Json fields = Json::object();
    const Json definition = Json::parse(subvol::to_json(kernel));
    for (const auto& [key, value] : definition.items()) {
        if (key != "type" && !(value.is_array() && value.size() > kLong)) fields[key] = value;
    }
    return fields;
}

FitTable table1(const BasisFunction& basis) {
    FitTable table;
    table.lines = {"kernel   r  paper              float32            double             float32",
                   "            RMSE     MAE       RMSE     MAE       RMSE     MAE       - paper   parameters"};
    for (const PaperRow& row : paper_rows()) {
        const Json& fitted = table.rows.emplace_back(table1_row(basis, row));
        table.lines.push_back(table1_line(fitted));
        std::ranges::move(fit_lines(fitted), std::back_inserter(table.lines));
    }
    return table;
}

FitTable kernels_table(const BasisFunction& basis) {
    FitTable table;
    table.lines.push_back(text(std::left, std::setw(18), "kernel", "numbers RMSE     MAE       max     parameters"));
    const auto add = [&](const std::string& name, const Json& parameters, const FitErrors& errors, int numbers) {
        Json row{{"kernel", name}, {"numbers", numbers}, {"parameters", parameters}, {"double", to_json(errors)}};
        table.lines.push_back(text(std::left, std::setw(20), name, std::right, std::setw(4), numbers ? text(numbers) : "", "  ",
                                   error_columns(row["double"]), std::fixed, std::setprecision(4), errors.max, "  ",
                                   short_parameters(parameters)));
        table.rows.push_back(std::move(row));
    };
    const Kernel paper = GaussianKernel{.sigma = 0.43};
    add("paper_gaussian", parameters_of(paper), kernel_errors(basis, paper), 1);
    const auto add_fitted = [&](const std::string& name) {
        const KernelFit fit = fit_shape(basis, shape_named(name).value());
        add(name, parameters_of(fit.kernel), fit.report.errors, fit.report.parameters);
    };
    for (const char* name :
         {"gaussian", "scaled_gaussian", "bc", "cardinal", "wendland_c2", "wendland_c4", "two_gaussians", "three_gaussians"}) {
        add_fitted(name);
    }
    add("radial_bound", Json::object(), radial_bound(basis), 0);
    for (const char* name : {"separable_gaussian", "separable_table"}) add_fitted(name);
    for (const int rank : {2, 3, 4}) {
        const TuckerFit fit = fit_tucker(basis, rank);
        add(text("tucker_", rank), {{"rank", rank}}, fit.report.errors, fit.report.parameters);
    }
    return table;
}

}  // namespace subvol::cli
