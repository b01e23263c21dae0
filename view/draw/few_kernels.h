// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <optional>
#include <thread>

#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// Few kernels that stand for very many in coarse pictures, merged on a thread of its own while all of them are drawn.
class FewKernels {
public:
    /// Begins to merge, if the kernels are many.
    ///
    /// all: stays as it is until this object's end
    explicit FewKernels(const RbfVolume& all);
    ~FewKernels();
    FewKernels(const FewKernels&) = delete;
    FewKernels& operator=(const FewKernels&) = delete;

    /// The few; null while they are being made, and where there are not many.
    [[nodiscard]] const RbfVolume* ready() const { return ready_ ? &*few_ : nullptr; }

private:
    std::optional<RbfVolume> few_{};
    std::atomic<bool> ready_ = false, quit_ = false;
    std::thread thread_{};
};

}  // namespace subvol::detail
