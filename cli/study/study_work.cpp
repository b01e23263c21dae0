// SPDX-License-Identifier: Apache-2.0
#include "study_work.h"

#include <sys/resource.h>

#include <algorithm>

#include "report.h"
#include "sample_arguments.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/option.h"
#include "subvol/picture_maker.h"

namespace subvol::cli {

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::string case_file(const StudyCase& item, const std::string& ending) {
    return item.name + "_" + item.id.substr(0, 8) + ending;
}

Kernel study_kernel(const std::string& text) {
    return text.starts_with("{") ? kernel_from_json(text) : named_kernel(text);
}

void set_options(const StudyCase& item, const std::vector<Option>& options) {
    for (const Option& option : options) {
        const auto found = item.values.find(option.key());
        if (found == item.values.end()) continue;
        if (const auto* on = std::get_if<bool>(&found->second)) {
            *std::get<bool*>(option.value) = *on;
        } else if (const auto* number = std::get_if<double>(&found->second)) {
            if (std::holds_alternative<WordValue>(option.value)) {
                option.read(detail::exact_text(*number), option.key());
            } else {
                option.set(*number, option.key());
            }
        } else {
            option.read(std::get<std::string>(found->second), option.key());
        }
    }
}

SampleOptions study_sampling(const StudyCase& item, const HexMesh& mesh, SampleOptions options) {
    set_options(item, options_of(options));
    if (item.has("spacing_voxels")) options.spacing_world = world_of_voxels(item.number("spacing_voxels"), bounds(mesh));
    return options;
}

std::vector<PictureMethod> study_picture_methods() {
    static PictureSettings any;  // reading a study changes it
    std::vector<PictureMethod> methods;
    for (const auto& row : NameTable<Method>::rows) methods.push_back({std::string(row.name), options_of(any, row.value)});
    return methods;
}

CaseResult run_case(const StudyCase& item, const CasePlace& place) {
    const StudyKind kind = method_kind(item.text("method"));
    if (kind == StudyKind::Pictures) return run_picture_case(item, place);
    const detail::Stopwatch watch;
    CaseResult result = kind == StudyKind::Fields ? run_field_case(item) : run_kernel_case(item, place);
    const double seconds = watch.seconds();
    result.costs = {
        {"seconds", seconds}, {"cpu_seconds", cpu_seconds()}, {"peak_bytes", static_cast<double>(peak_memory_bytes())}};
    return result;
}

}  // namespace subvol::cli
