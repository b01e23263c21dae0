// SPDX-License-Identifier: Apache-2.0
#include "subvol/study_measures.h"

#include <algorithm>
#include <array>
#include <set>

#include "study_keys.h"
#include "subvol/picture_metrics.h"

namespace subvol {

namespace {

constexpr std::string_view kPictures = "pictures", kFloor = "floor_", kParameter = "parameter.";
constexpr std::string_view kKernels = "splat sheets footprints";
constexpr std::string_view kMeshes = "pictures field volume voxels approximate wavelets reduce mesh values counts";
constexpr std::string_view kAtPlaces = "field voxels approximate wavelets reduce mesh";

// Methods that draw come first; a key may have several rows.
constexpr std::array kMeasures{
    StudyMeasure{"points", kMeshes, "control points", "control points of the mesh"},
    StudyMeasure{"cells", kMeshes, "cells", "cells of the mesh"},
    StudyMeasure{"primitives", kPictures, "primitives", "what is drawn: kernels, tetrahedra, micro-cells or voxels"},
    StudyMeasure{"kernels", kKernels, "kernels", "kernels that are drawn"},
    StudyMeasure{"sampled", kKernels, "kernels", "kernels before invisible ones were dropped"},
    StudyMeasure{"tets", "tets pt", "tetrahedra", "tetrahedra of the level"},
    StudyMeasure{"lost_rays", "tets dense grid", "lost rays", "rays that were lost between cells"},
    StudyMeasure{"levels_drawn", "dense", "level", "the level that was drawn"},
    StudyMeasure{"last_change", "dense", "change, RMS", "RMS of the picture's change at the last level"},
    StudyMeasure{"converged", "dense", "converged", "1 if that is below the tolerance"},
    StudyMeasure{"reference_level", kPictures, "level of the reference", "the level of the reference"},
    StudyMeasure{"reference_change", kPictures, "change of the reference, RMS",
                 "RMS of the reference's change at its last level"},
    StudyMeasure{"reference_converged", kPictures, "converged", "1 if that is below the tolerance"},
    StudyMeasure{"voxels", "grid voxels", "active voxels", "active voxels"},
    StudyMeasure{"grid_bytes", "grid voxels", "memory of the grid, bytes", "bytes of the grid in memory"},
    StudyMeasure{"voxel_size", "grid voxels", "voxel size", "size of a voxel in the world"},
    StudyMeasure{"file_bytes", "voxels", "file size, bytes", "bytes of the .vdb file"},
    StudyMeasure{"file_bytes", "approximate mesh", "file size, bytes", "bytes of the control mesh as a .vtu file (zlib)"},
    StudyMeasure{"file_bytes", "wavelets", "file size, bytes", "bytes of the .svw file"},
    StudyMeasure{"file_bytes", "reduce", "file size, bytes", "bytes of the kernels as a .ply file, without the boundary"},
    StudyMeasure{"rmse", kAtPlaces, "RMSE of the field", "root mean square difference from the limit at the places"},
    StudyMeasure{"max", kAtPlaces, "largest error of the field", "largest difference from the limit at the places"},
    StudyMeasure{"rmse_of_range", kAtPlaces, "RMSE, parts of the range", "rmse / range of the mesh's values"},
    StudyMeasure{"max_of_range", kAtPlaces, "largest error, parts of the range", "max / range of the mesh's values"},
    StudyMeasure{"uncovered", "field volume voxels approximate wavelets reduce mesh", "places without a value",
                 "places without a value, which the errors leave out"},
    StudyMeasure{"kernels", "field volume reduce counts", "kernels", "kernels"},
    StudyMeasure{"kernels", "approximate mesh", "kernels", "control points of the mesh that has the values"},
    StudyMeasure{"kernels", "wavelets", "kernels", "control values and details of the field that are not 0"},
    StudyMeasure{"spacing", "field", "spacing, cells", "distance of kernels in cells"},
    StudyMeasure{"l1", "volume", "L1 error of the field", "mean absolute difference of the fields"},
    StudyMeasure{"l2", "volume", "L2 error of the field", "root mean square difference of the fields"},
    StudyMeasure{"linf", "volume", "largest error of the field", "largest difference of the fields"},
    StudyMeasure{"gradient_rmse", "volume", "RMSE of the gradient", "root mean square difference of the gradients"},
    StudyMeasure{"mass_error", "volume", "relative error of the integral", "relative difference of the integrals"},
    StudyMeasure{"iso", "volume", "isovalue", "value of the isosurface"},
    StudyMeasure{"hausdorff", "volume", "Hausdorff distance", "Hausdorff distance of the isosurfaces in the world"},
    StudyMeasure{"sampled", "values", "points", "points after the refinement"},
    StudyMeasure{"rendered", "values", "points", "those with positive densities"},
    StudyMeasure{"rmse", "values", "RMSE of the values", "root mean square difference from the scheme's values"},
    StudyMeasure{"solid_rmse", "values", "RMSE of the solid", "rmse × √(sampled / rendered)"},
    StudyMeasure{"tets5", "counts", "tetrahedra", "five tetrahedra a small cell"},
    StudyMeasure{"tets6", "counts", "tetrahedra", "six tetrahedra a small cell"},
    StudyMeasure{"ratio5", "counts", "kernels / tetrahedra", "kernels / tets5"},
    StudyMeasure{"ratio6", "counts", "kernels / tetrahedra", "kernels / tets6"},
    StudyMeasure{"mse", "errors fit", "mean square error", "mean square difference from the basis function"},
    StudyMeasure{"rmse", "errors fit slice", "RMSE", "root mean square difference from the basis function"},
    StudyMeasure{"mae", "errors fit slice", "mean absolute error", "mean absolute difference from the basis function"},
    StudyMeasure{"max", "errors fit slice", "largest error", "largest difference from the basis function"},
    StudyMeasure{"float32_mse", "errors", "mean square error", "mse, summed in 32-bit floats as in the paper"},
    StudyMeasure{"float32_rmse", "errors", "RMSE", "rmse, summed in 32-bit floats as in the paper"},
    StudyMeasure{"float32_mae", "errors", "mean absolute error", "mae, summed in 32-bit floats as in the paper"},
    StudyMeasure{"float32_max", "errors", "largest error", "max, in 32-bit floats"},
    StudyMeasure{"numbers", "fit", "numbers", "how many numbers the kernel has"},
    StudyMeasure{"parameters", "errors fit", "parameters", "the kernel's parameters (text); `parameter.NAME` is one of them"},
    StudyMeasure{"least", "slice", "least value", "least value of the basis function"},
    StudyMeasure{"device", kPictures, "device", "what drew the picture (text)"},
    StudyMeasure{"reference", kPictures, "reference", "ID of the reference (text)"},
    StudyMeasure{"done", "", "done", "yes, or why the case failed (text)"},
    StudyMeasure{"seconds", "", "time, s", "seconds of the whole case, without reading the mesh"},
    StudyMeasure{"cpu_seconds", "", "CPU time, s", "CPU seconds of all threads"},
    StudyMeasure{"peak_bytes", "", "peak memory, bytes", "peak memory of the case's process"},
    StudyMeasure{"own_bytes", kPictures, "memory of the method, bytes", "growth of the peak after the mesh was read"},
    StudyMeasure{"prepare_seconds", kPictures, "time of preparation, s",
                 "seconds before the first picture (of all but `dense`)"},
    StudyMeasure{"draw_seconds", kPictures, "time of a picture, s", "least seconds of one picture"},
    StudyMeasure{"frames_per_second", kPictures, "pictures per second", "1 / draw_seconds"}};

bool lists(std::string_view words, std::string_view word, char between) {
    while (!words.empty()) {
        const std::size_t end = std::min(words.find(between), words.size());
        if (words.substr(0, end) == word) return true;
        words.remove_prefix(std::min(end + 1, words.size()));
    }
    return false;
}

bool is_picture(const StudyCase& study_case) {
    return method_kind(study_case.text("method")) == StudyKind::Pictures;
}

const StudyMeasure* measure_of(const StudyCase& study_case, std::string_view key) {
    const auto found = std::ranges::find_if(kMeasures, [&](const StudyMeasure& one) {
        return one.key == key && (one.methods.empty() || lists(one.methods, study_case.text("method"), ' ') ||
                                  (lists(one.methods, kPictures, ' ') && is_picture(study_case)));
    });
    return found == kMeasures.end() ? nullptr : found;
}

/// Whether a case of pictures has this metric, or its floor.
bool has_metric(const StudyCase& study_case, std::string_view key) {
    if (key.starts_with(kFloor)) key.remove_prefix(kFloor.size());
    return study_case.has("metrics") && lists(study_case.text("metrics"), key, ',');
}

}  // namespace

std::span<const StudyMeasure> study_measures() {
    return kMeasures;
}

bool measures(const Study& study, const StudyCase& study_case, const std::string& key) {
    const std::string& method = study_case.text("method");
    return measure_of(study_case, key) != nullptr || has_metric(study_case, key) ||
           (key.starts_with(kParameter) && (method == "errors" || method == "fit")) ||
           std::ranges::find(study.measured, key) != study.measured.end();
}

bool has_key(const Study& study, const StudyCase& study_case, const std::string& key) {
    return study_case.has(key) || measures(study, study_case, key);
}

std::vector<std::string> all_keys(const Study& study) {
    std::set<std::string> keys(study.measured.begin(), study.measured.end());
    for (const StudyCase& study_case : study.cases) {
        for (const auto& [key, value] : study_case.values) keys.insert(key);
        for (const StudyMeasure& one : kMeasures) {
            if (measure_of(study_case, one.key) != nullptr) keys.emplace(one.key);
        }
        for (const std::string& metric : study_metrics()) {
            if (has_metric(study_case, metric)) keys.insert({metric, std::string(kFloor) + metric});
        }
    }
    return {keys.begin(), keys.end()};
}

std::string axis_label(const Study& study, const std::string& key) {
    for (const StudyCase& study_case : study.cases) {
        if (study_case.has(key)) break;
        if (has_metric(study_case, key)) {
            const PictureMetric* const metric = find_metric(key);
            if (metric == nullptr) break;
            const char* const region = key.ends_with("_interior") ? " inside"
                                       : key.ends_with("_edge")   ? " at the silhouette"
                                                                  : "";
            return std::string(metric->quantity) + region + (metric->unit.empty() ? "" : ", " + std::string(metric->unit));
        }
        if (const StudyMeasure* const one = measure_of(study_case, key)) return std::string(one->quantity);
    }
    std::string label = key;
    std::ranges::replace(label, '_', ' ');
    return label;
}

std::string study_keys_markdown(std::span<const PictureMethod> methods) {
    std::string text = "| metric of pictures | | unit | formula | source |\n|---|---|---|---|---|\n";
    for (const PictureMetric& metric : picture_metrics()) {
        text += "| `" + std::string(metric.study) + "` | " + std::string(metric.quantity) + " | " + std::string(metric.unit) +
                " | " + std::string(metric.formula) + " | " +
                (metric.source.empty() ? "" : "[" + std::string(metric.source) + "]") + " |\n";
    }
    text += "\n| measured | by | meaning |\n|---|---|---|\n";
    for (const StudyMeasure& one : kMeasures) {
        text += "| `" + std::string(one.key) + "` | " + (one.methods.empty() ? "all" : std::string(one.methods)) + " | " +
                std::string(one.meaning) + " |\n";
    }
    text += "\n| method | options, as keys |\n|---|---|\n";
    for (const detail::StudyMethod& method : detail::all_methods(methods)) {
        text += "| `" + method.name + "` |";
        for (const detail::Key& key : method.keys) text += " `" + key.name + "`";
        text += " |\n";
    }
    return text;
}

}  // namespace subvol
