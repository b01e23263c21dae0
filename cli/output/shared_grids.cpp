// SPDX-License-Identifier: Apache-2.0
#include "shared_grids.h"

#include "subvol/join_grids.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

/// The grids of all ranks, joined, at rank 0; nothing elsewhere.
std::vector<VdbGrid> gathered(std::vector<VdbGrid> own, Ranks& ranks, bool half, Report& report) {
    return report.timed("gather", [&] {
        std::string bytes = vdb().bytes_of_grids(own);
        own.clear();
        std::vector<std::vector<VdbGrid>> of_ranks;
        for (std::string& one : ranks.gather(std::move(bytes))) {
            of_ranks.push_back(vdb().grids_from_bytes(one));
            one = {};
        }
        std::vector<VdbGrid> joined;
        for (std::size_t g = 0; !of_ranks.empty() && g < of_ranks.front().size(); ++g) {
            std::vector<VdbGrid> parts;
            for (std::vector<VdbGrid>& grids : of_ranks) parts.push_back(std::move(grids.at(g)));
            joined.push_back(vdb().join_grids(std::move(parts)));
            vdb().store_in_half(joined.back(), half);
        }
        return joined;
    });
}

}  // namespace

std::vector<VdbGrid> of_all_shares(std::vector<VdbGrid> own, Ranks* ranks, const PartNote& note, bool half,
                                   const VdbOutput& output, Report& report) {
    for (VdbGrid& grid : own) vdb().store_in_half(grid, false);
    if (ranks != nullptr) return gathered(std::move(own), *ranks, half, report);
    const std::string words = text_of(note);
    for (VdbGrid& grid : own) vdb().set_text_of_grid(grid, kPartNote, words);
    report["part"] = note.share.name();
    report.merge(write_share(own, output, report.progress()));
    return {};
}

}  // namespace subvol::cli
