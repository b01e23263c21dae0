// SPDX-License-Identifier: Apache-2.0
#include "level_of_detail.h"

#include <utility>

namespace subvol::cli {

LevelOfDetail::LevelOfDetail(const RbfVolume& volume, double pixels, std::size_t channel, Report& report)
    : volume_(&volume), options_{.pixels = pixels, .channel = channel} {
    if (!(pixels > 0)) return;
    hierarchy_ = report.timed("hierarchy", [&] { return build_kernel_hierarchy(volume, report.progress()); });
    report["points"] = volume.size();
}

LevelOfDetail::LevelOfDetail(KernelFile& file, std::vector<std::size_t> channels, double pixels)
    : file_(&file), channels_(std::move(channels)), options_{.pixels = pixels, .channel = channels_.front()} {
}

const RbfVolume& LevelOfDetail::few_of_file(const View& view, Report& report) {
    few_ = {};  // before the next takes memory
    StreamedKernels chosen =
        report.timed("level", [&] { return file_->choose_level(view, options_, channels_, report.progress()); });
    changed_ = true;
    few_ = std::move(chosen.volume);
    report["kernels_drawn"] = few_.size();
    report["kernels_merged"] = file_->contents().kernels - chosen.cut.kernels.size();
    report["merge_error"] = chosen.cut.error;
    report["bytes"] = file_->contents().bytes;
    report["bytes_read"] = file_->bytes_read();
    return few_;
}

const RbfVolume& LevelOfDetail::of(const View& view, Report& report) {
    if (file_ != nullptr) return few_of_file(view, report);
    const RbfVolume& volume = *volume_;
    if (!hierarchy_) return volume;
    report.timed("level", [&] {
        KernelCut cut = choose_cut(*hierarchy_, view, options_);
        changed_ = cut.nodes != cut_.nodes;  // the other kernels are those that are below none of them
        cut_ = std::move(cut);
        if (changed_ && !cut_.nodes.empty()) few_ = kernels_of_cut(*hierarchy_, volume, cut_);
    });
    report["kernels_drawn"] = cut_.size();
    report["kernels_merged"] = volume.size() - cut_.kernels.size();
    report["merge_error"] = cut_.error;
    return cut_.nodes.empty() ? volume : few_;
}

}  // namespace subvol::cli
