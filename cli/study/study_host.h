// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/study_report.h"

namespace subvol::cli {

/// The machine: processor, cores, memory, system.
[[nodiscard]] ReportFacts study_host();

/// The versions of this program and of what it was built with.
[[nodiscard]] ReportFacts study_versions();

}  // namespace subvol::cli
