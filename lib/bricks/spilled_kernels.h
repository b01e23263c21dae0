// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "kernel_source.h"
#include "spill_file.h"

namespace subvol::detail {

/// The kernels of a whole in files, for a `.svk` file of more than fits into memory.
class SpilledKernels : public KernelSource {
public:
    /// folder: of the files. like: of the kernel and the channels of all. count: of kernels, less than 2³²
    SpilledKernels(const std::filesystem::path& folder, const RbfVolume& like, std::uint64_t count, const Surface& boundary);

    /// numbers: the places of the kernels in the whole, ascending
    void write(std::span<const std::uint64_t> numbers, const RbfVolume& kernels);

    [[nodiscard]] SvkContents contents() const override { return contents_; }
    [[nodiscard]] const Surface& boundary() const override { return boundary_; }
    [[nodiscard]] std::vector<Index> order(std::size_t leaves) const override;
    [[nodiscard]] RbfVolume kernels(std::span<const Index> numbers) const override;

    [[nodiscard]] std::uint64_t written() const { return written_; }

private:
    const Surface& boundary_;
    SvkContents contents_;
    std::uint64_t written_ = 0;
    SpillFile centers_, rest_;
};

}  // namespace subvol::detail
