// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "svk_file.h"

namespace subvol::detail {

/// The parts of a file's blocks that were read for this view and the ones before it, up to some bytes.
class KernelCache {
public:
    /// file: referred to
    KernelCache(const SvkFile& file, std::uint64_t most_bytes);

    void begin_view() { ++view_; }

    /// The bytes of a part, until the next `trim`. Several threads may ask for parts of different blocks.
    [[nodiscard]] const std::string& part(std::size_t block, std::size_t part);

    /// Drops parts if there are too many bytes: those that this view has not used, the longest unused first; then the last that
    /// it has read, so that the next view finds the others.
    void trim();

private:
    struct Slot {
        std::string bytes{};
        std::uint64_t view = 0, turn = 0;  // when it was last used, and read
    };

    const SvkFile& file_;
    std::uint64_t most_bytes_, view_ = 0, turn_ = 0;
    std::atomic<std::uint64_t> bytes_ = 0;
    std::vector<Slot> slots_;
};

}  // namespace subvol::detail
