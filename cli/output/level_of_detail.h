// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "report.h"
#include "subvol/camera.h"
#include "subvol/kernel_hierarchy.h"
#include "subvol/rbf_volume.h"

namespace subvol::cli {

/// The kernels of a volume for each view: with --lod merged where they would be narrow, else all of them.
class LevelOfDetail {
public:
    /// volume:  referred to
    /// pixels:  of --lod; 0: all kernels
    /// channel: whose error bounds are reported
    LevelOfDetail(const RbfVolume& volume, double pixels, std::size_t channel, Report& report);

    /// The kernels for a view, timed and counted in the report. Valid until the next call.
    [[nodiscard]] const RbfVolume& of(const View& view, Report& report);

    /// Whether the last call returned other kernels than the one before it; than all of them, before the first.
    [[nodiscard]] bool has_changed() const { return changed_; }

private:
    const RbfVolume& volume_;
    LevelOptions options_;
    std::optional<KernelHierarchy> hierarchy_;
    KernelCut cut_;
    RbfVolume few_;
    bool changed_ = false;
};

}  // namespace subvol::cli
