// SPDX-License-Identifier: Apache-2.0
#include "level_of_detail.h"

#include <utility>

namespace subvol::cli {

LevelOfDetail::LevelOfDetail(const RbfVolume& volume, double pixels, std::size_t channel, Report& report)
    : volume_(volume), options_{.pixels = pixels, .channel = channel} {
    if (!(pixels > 0)) return;
    hierarchy_ = report.timed("hierarchy", [&] { return build_kernel_hierarchy(volume, report.progress()); });
    report["points"] = volume.size();
}

const RbfVolume& LevelOfDetail::of(const View& view, Report& report) {
    if (!hierarchy_) return volume_;
    report.timed("level", [&] {
        KernelCut cut = choose_cut(*hierarchy_, view, options_);
        changed_ = cut.nodes != cut_.nodes;  // the other kernels are those that are below none of them
        cut_ = std::move(cut);
        if (changed_ && !cut_.nodes.empty()) few_ = kernels_of_cut(*hierarchy_, volume_, cut_);
    });
    report["kernels_drawn"] = cut_.size();
    report["kernels_merged"] = volume_.size() - cut_.kernels.size();
    report["merge_error"] = cut_.error;
    return cut_.nodes.empty() ? volume_ : few_;
}

}  // namespace subvol::cli
