// SPDX-License-Identifier: Apache-2.0
#include "study_work.h"

#include <sys/resource.h>

#include <algorithm>

#include "report.h"
#include "sample_arguments.h"
#include "subvol/detail/stopwatch.h"

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

SampleOptions study_sampling(const StudyCase& item, const HexMesh& mesh) {
    SampleOptions options{.per_edge = std::max(item.whole("per_edge"), 1),
                          .spacing_world = world_of_voxels(item.number("spacing_voxels"), bounds(mesh)),
                          .centers = item.flag("centers")};
    for (const Option& option : options_of(options)) {
        if ((option.name == "correction" || option.name == "kernel") && item.has(option.key()))
            option.read(item.text(option.key()), option.key());
    }
    if (item.has("boundary_levels")) options.boundary_levels = item.whole("boundary_levels");
    return options;
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
