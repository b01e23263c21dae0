// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "subvol/camera.h"
#include "subvol/facts.h"
#include "subvol/kernel_file.h"
#include "subvol/kernel_hierarchy.h"
#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// The kernels of a volume or a file for each view: merged where they would be narrow, or all of them.
class KernelLevels {
public:
    /// volume:  referred to
    /// pixels:  kernels are merged as long as they are narrower; 0: never
    /// channel: whose error bounds are reported
    KernelLevels(const RbfVolume& volume, double pixels, std::size_t channel, Progress* progress, Facts& facts);

    /// file:     referred to; each view reads what it needs
    /// channels: of the file, that are drawn; the first is that whose error bounds are reported
    /// pixels:   above 0
    KernelLevels(KernelFile& file, std::vector<std::size_t> channels, double pixels);

    /// The kernels for a view. Valid until the next call.
    [[nodiscard]] const RbfVolume& kernels(const View& view, Progress* progress, Facts& facts);

    /// Changes with the kernels that `kernels` returns; 0 before the first that were merged or read.
    [[nodiscard]] std::size_t version() const { return version_; }

    /// All kernels; null if they are in a file.
    [[nodiscard]] const RbfVolume* all() const { return volume_; }

private:
    const RbfVolume& read_kernels(const View& view, Progress* progress, Facts& facts);

    const RbfVolume* volume_ = nullptr;
    KernelFile* file_ = nullptr;
    std::vector<std::size_t> channels_{};
    LevelOptions options_;
    std::optional<KernelHierarchy> hierarchy_{};
    KernelCut cut_{};
    RbfVolume few_{};
    std::size_t version_ = 0;
};

}  // namespace subvol::detail
