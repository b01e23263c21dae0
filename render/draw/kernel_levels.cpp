// SPDX-License-Identifier: Apache-2.0
#include "kernel_levels.h"

#include <utility>

namespace subvol::detail {

KernelLevels::KernelLevels(const RbfVolume& volume, double pixels, std::size_t channel, Progress* progress, Facts& facts)
    : volume_(&volume), options_{.pixels = pixels, .channel = channel} {
    if (!(pixels > 0)) return;
    hierarchy_ = facts.timed(progress, "hierarchy", [&] { return build_kernel_hierarchy(volume, progress); });
    facts["points"] = volume.size();
}

KernelLevels::KernelLevels(KernelFile& file, std::vector<std::size_t> channels, double pixels)
    : file_(&file), channels_(std::move(channels)), options_{.pixels = pixels, .channel = channels_.front()} {
}

const RbfVolume& KernelLevels::read_kernels(const View& view, Progress* progress, Facts& facts) {
    few_ = {};  // before the next takes memory
    StreamedKernels chosen =
        facts.timed(progress, "level", [&] { return file_->choose_level(view, options_, channels_, progress); });
    ++version_;
    few_ = std::move(chosen.volume);
    facts["kernels_drawn"] = few_.size();
    facts["kernels_merged"] = file_->contents().kernels - chosen.cut.kernels.size();
    facts["merge_error"] = chosen.cut.error;
    facts["bytes"] = file_->contents().bytes;
    facts["bytes_read"] = file_->bytes_read();
    return few_;
}

const RbfVolume& KernelLevels::kernels(const View& view, Progress* progress, Facts& facts) {
    if (file_ != nullptr) return read_kernels(view, progress, facts);
    const RbfVolume& volume = *volume_;
    if (!hierarchy_) return volume;
    facts.timed(progress, "level", [&] {
        KernelCut cut = choose_cut(*hierarchy_, view, options_);
        const bool changed = cut.nodes != cut_.nodes;  // the other kernels are those that are below none of them
        cut_ = std::move(cut);
        if (changed) ++version_;
        if (changed && !cut_.nodes.empty()) few_ = kernels_of_cut(*hierarchy_, volume, cut_);
    });
    facts["kernels_drawn"] = cut_.size();
    facts["kernels_merged"] = volume.size() - cut_.kernels.size();
    facts["merge_error"] = cut_.error;
    return cut_.nodes.empty() ? volume : few_;
}

}  // namespace subvol::detail
