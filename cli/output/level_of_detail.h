// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "report.h"
#include "subvol/camera.h"
#include "subvol/kernel_file.h"
#include "subvol/kernel_hierarchy.h"
#include "subvol/rbf_volume.h"

namespace subvol::cli {

/// The kernels of a volume or a file for each view: with --lod merged where they would be narrow, else all of them.
class LevelOfDetail {
public:
    /// volume:  referred to
    /// pixels:  of --lod; 0: all kernels
    /// channel: whose error bounds are reported
    LevelOfDetail(const RbfVolume& volume, double pixels, std::size_t channel, Report& report);

    /// file:     referred to; of it each view reads what it needs
    /// channels: of the file, that are drawn; the first is that whose error bounds are reported
    /// pixels:   of --lod, above 0
    LevelOfDetail(KernelFile& file, std::vector<std::size_t> channels, double pixels);

    /// The kernels for a view, timed and counted in the report. Valid until the next call.
    [[nodiscard]] const RbfVolume& of(const View& view, Report& report);

    /// Whether the last call returned other kernels than the one before it; than all of them, before the first.
    [[nodiscard]] bool has_changed() const { return changed_; }

    /// All kernels; null if they are in a file.
    [[nodiscard]] const RbfVolume* all() const { return volume_; }

private:
    const RbfVolume& few_of_file(const View& view, Report& report);

    const RbfVolume* volume_ = nullptr;
    KernelFile* file_ = nullptr;
    std::vector<std::size_t> channels_{};
    LevelOptions options_;
    std::optional<KernelHierarchy> hierarchy_;
    KernelCut cut_;
    RbfVolume few_;
    bool changed_ = false;
};

}  // namespace subvol::cli
