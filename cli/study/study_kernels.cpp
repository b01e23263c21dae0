// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <cmath>
#include <iomanip>
#include <map>

#include "fit_tables.h"
#include "study_work.h"
#include "subvol/error.h"
#include "subvol/fit_kernel.h"
#include "subvol/image_io.h"
#include "subvol/image_metrics.h"
#include "subvol/srgb.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr int kPaperLevel = 5;  // 193³ samples, as in the paper
constexpr int kSliceLevel = 6;  // 384 intervals across: the default picture has one pixel per sample

void put(const FitErrors& errors, const std::string& prefix, CaseResult& result) {
    result.metrics[prefix + "mse"] = errors.mse;
    result.metrics[prefix + "rmse"] = errors.rmse;
    result.metrics[prefix + "mae"] = errors.mae;
    if (errors.max > 0) result.metrics[prefix + "max"] = errors.max;
}

/// A number or a list of numbers, in six digits.
std::string short_number(const Json& value) {
    if (!value.is_array()) return text(std::setprecision(6), value.get<double>());
    std::vector<std::string> parts;
    for (const Json& part : value) parts.push_back(short_number(part));
    return "(" + join(parts) + ")";
}

/// Stores a kernel's parameters, without long tables.
void put_parameters(const Kernel& kernel, CaseResult& result) {
    std::string words;
    const Json parameters = parameters_of(kernel);
    for (const auto& [key, value] : parameters.items()) {
        if (value.is_number()) result.metrics["parameter." + key] = value.get<double>();
        const bool usual = (key == "radius" && value == 3.0) || (key == "amplitude" && value == 1.0);
        if (!usual) words += (words.empty() ? "" : ", ") + key + " " + short_number(value);
    }
    result.notes["parameters"] = words;
}

CaseResult errors_case(const StudyCase& item, const CasePlace&) {
    const BasisFunction basis = sample_basis_function(Scheme::Mcq, kPaperLevel);
    const Kernel kernel = study_kernel(item.text("kernel"));
    CaseResult result;
    put(kernel_errors(basis, kernel), "", result);
    put(kernel_errors_float32(basis, kernel), "float32_", result);
    put_parameters(kernel, result);
    return result;
}

CaseResult fit_case(const StudyCase& item, const CasePlace&) {
    const BasisFunction basis = sample_basis_function(Scheme::Mcq, kPaperLevel);
    const std::string& shape = item.text("shape");
    CaseResult result;
    if (shape == "radial_bound") {
        put(radial_bound(basis), "", result);
        return result;
    }
    FitReport report;
    if (shape == "tucker") {
        report = fit_tucker(basis, item.has("rank") ? item.whole("rank") : 2).report;
    } else {
        FitOptions options{.sign_slip = item.flag("sign_slip")};
        if (item.has("extent")) options.extent = item.number("extent");
        if (item.has("terms")) options.terms = item.whole("terms");
        const KernelFit fit = fit_shape(basis, shape_named(shape).value(), options);
        report = fit.report;
        put_parameters(fit.kernel, result);
    }
    put(report.errors, "", result);
    result.metrics["numbers"] = report.parameters;
    return result;
}

/// The values on the plane z = 0 over [-3,3]², as grey: black at the kernel's least value of about -.022, white at 1.
Image grey(const Image& values) {
    constexpr float kLeast = -.022f;
    Image picture = values;
    for (std::size_t i = 0; i < picture.rgba.size(); ++i) {
        if (i % 4 == 3) continue;
        const float shade = (picture.rgba[i] - kLeast) / (1 - kLeast);
        picture.rgba[i] = static_cast<float>(linear_from_srgb(std::clamp(static_cast<double>(shade), 0.0, 1.0)));
    }
    return picture;
}

template <class Value>
Image slice(int pixels, const Value& value) {
    Image image(pixels, pixels);
    for (int y = 0; y < pixels; ++y) {
        for (int x = 0; x < pixels; ++x) {
            const double u = -3 + 6. * x / (pixels - 1), v = 3 - 6. * y / (pixels - 1);
            const auto at = static_cast<float>(value(u, v));
            const auto pixel = image.pixel(x, y);
            pixel[0] = pixel[1] = pixel[2] = at;
            pixel[3] = 1;
        }
    }
    return image;
}

CaseResult slice_case(const StudyCase& item, const CasePlace& place) {
    const BasisFunction basis = sample_basis_function(Scheme::Mcq, kSliceLevel);
    const int pixels = item.whole("pixels");
    const auto index = [](double x) { return static_cast<int>(std::lround(x * (1 << kSliceLevel))); };
    const Image exact = slice(pixels, [&](double x, double y) { return basis.at(index(x), index(y), 0); });
    CaseResult result;
    std::filesystem::create_directories(place.folder / "pictures");
    const auto write = [&](const char* kind, const std::string& ending, const Image& image) {
        result.files[kind] = "pictures/" + case_file(item, ending);
        write_image(place.folder / result.files[kind], image);
    };
    if (!item.has("kernel")) {
        write("picture", ".png", grey(exact));
        double least = 0;
        for (const double value : basis.values) least = std::min(least, value);
        result.metrics["least"] = least;
        return result;
    }
    const Kernel kernel = study_kernel(item.text("kernel"));
    const Image ours = slice(pixels, [&](double x, double y) { return kernel_value(kernel, {x, y, 0}); });
    write("picture", ".png", grey(ours));
    write("reference", "_exact.png", grey(exact));
    write("difference", "_difference.png", difference_heatmap(ours, exact));
    const ImageMetrics metrics = compare_images(ours, exact);
    result.metrics = {{"rmse", metrics.rmse}, {"mae", metrics.mae}, {"max", metrics.max}};
    return result;
}

using KernelCase = CaseResult (*)(const StudyCase&, const CasePlace&);

const std::map<std::string, KernelCase> kKernelCases{{"errors", errors_case}, {"fit", fit_case}, {"slice", slice_case}};

}  // namespace

CaseResult run_kernel_case(const StudyCase& item, const CasePlace& place) {
    const auto found = kKernelCases.find(item.text("method"));
    assert(found != kKernelCases.end());
    return found->second(item, place);
}

}  // namespace subvol::cli
