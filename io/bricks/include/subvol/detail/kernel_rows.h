// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "subvol/progress.h"
#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// A file of kernels that come in any order: a binary `.ply`, or a `.svk` if its name ends so. The bytes are those that
/// `write_points` and `write_kernel_file` write for all together.
class KernelRows {
public:
    /// like:     kernels of the same kind and channels
    /// kernels:  how many there will be
    /// boundary: of all; is referred to
    /// note:     of a part, as in PlyRows; not for a `.svk`
    /// throws:   Error(Io); Error(InvalidInput) if there are too many
    KernelRows(const std::filesystem::path& path, const RbfVolume& like, std::uint64_t kernels, const Surface& boundary,
               const std::string& note = {}, Progress* progress = nullptr);
    ~KernelRows();
    KernelRows(const KernelRows&) = delete;
    KernelRows& operator=(const KernelRows&) = delete;

    /// numbers: the places of the kernels in the whole, ascending
    void write(std::span<const std::uint64_t> numbers, const RbfVolume& kernels);

    /// After the last one; then the file has its name.
    ///
    /// throws: Error(Io); Error(InvalidInput) if a kernel has not been written
    /// cost:   of a `.svk` memory: 16 bytes a kernel; on disk some 90 bytes a kernel besides the file, until it is done
    void finish();

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol::detail
