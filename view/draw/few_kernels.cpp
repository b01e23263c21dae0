// SPDX-License-Identifier: Apache-2.0
#include "few_kernels.h"

#include <exception>

#include "cancel_flag.h"
#include "subvol/kernel_hierarchy.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kFew = 1 << 14;

}  // namespace

FewKernels::FewKernels(const RbfVolume& all) {
    if (all.size() < 2 * kFew) return;
    thread_ = std::thread([this, &all] {
        try {
            CancelFlag quit(quit_);
            const KernelHierarchy hierarchy = build_kernel_hierarchy(all, &quit);
            few_ = kernels_of_cut(hierarchy, all, level_cut(hierarchy, kFew));
            ready_ = true;
        } catch (const std::exception&) {  // given up, or no memory: coarse pictures go on to show all kernels
            few_.reset();
        }
    });
}

FewKernels::~FewKernels() {
    quit_ = true;
    if (thread_.joinable()) thread_.join();
}

}  // namespace subvol::detail
