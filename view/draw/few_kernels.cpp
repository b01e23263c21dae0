// SPDX-License-Identifier: Apache-2.0
#include "few_kernels.h"

#include <exception>
#include <string_view>

#include "subvol/kernel_hierarchy.h"
#include "subvol/progress.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kFew = 1 << 14;

class Quit : public Progress {
public:
    explicit Quit(const std::atomic<bool>& wanted) : wanted_(wanted) {}
    void report(std::string_view, double) override {}
    [[nodiscard]] bool cancelled() const override { return wanted_; }

private:
    const std::atomic<bool>& wanted_;
};

}  // namespace

FewKernels::FewKernels(const RbfVolume& all) {
    if (all.size() < 2 * kFew) return;
    thread_ = std::thread([this, &all] {
        try {
            Quit quit(quit_);
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
