// SPDX-License-Identifier: Apache-2.0
#include "study_host.h"

#include <sys/utsname.h>
#include <tbb/global_control.h>
#include <tbb/version.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <set>

#include "commit.h"
#include "subvol/gl_device.h"
#include "subvol/version.h"
#include "text.h"

namespace subvol::cli {
namespace {

std::string processor() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with("model name")) continue;
        const std::size_t colon = line.find(": ");
        if (colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

/// The date of the report; SOURCE_DATE_EPOCH sets it.
std::string today() {
    const char* epoch = std::getenv("SOURCE_DATE_EPOCH");
    const std::time_t now = epoch ? std::strtoll(epoch, nullptr, 10) : std::time(nullptr);
    std::array<char, 16> text{};
    std::strftime(text.data(), text.size(), "%Y-%m-%d", std::gmtime(&now));
    return text.data();
}

std::string opengl() {
    std::vector<std::string> names;
    for (const GlDevice& device : gl_devices()) names.push_back(device.renderer);
    return names.empty() ? "none" : join(names);
}

}  // namespace

ReportFacts study_host() {
    utsname system{};
    uname(&system);
    const double memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    return {{"processor", processor()},
            {"cores", text(sysconf(_SC_NPROCESSORS_ONLN))},
            {"threads used", text(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism))},
            {"memory", text(std::round(memory / (1 << 30)), " GiB")},
            {"OpenGL", opengl()},
            {"system", text(system.sysname, ' ', system.release, ' ', system.machine)}};
}

ReportFacts study_versions() {
    return {{"subvol", SUBVOL_VERSION},
            {"commit", SUBVOL_COMMIT},
            {"date", today()},
            {"oneTBB", TBB_runtime_version()},
            {"compiler", __VERSION__}};
}

}  // namespace subvol::cli
