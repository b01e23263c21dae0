// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ranks.h"
#include "report.h"

namespace subvol::cli {

/// Puts the lists that all ranks have under a key one behind the other into the report of rank 0.
void gather_list(Ranks& ranks, Report& report, const char* key);

/// Puts "ranks", "bytes_sent" and each rank's peak into the report of rank 0.
void report_ranks(Ranks& ranks, Report& report);

}  // namespace subvol::cli
