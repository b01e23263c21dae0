// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "subvol/detail/svk_layout.h"
#include "subvol/kernel_file.h"

namespace subvol::detail {

/// What the head of a file says, for users.
[[nodiscard]] KernelFileContents kernel_file_contents(const SvkContents& contents, const SvkLayout& layout,
                                                      std::uint64_t bytes);

/// The kernels of a volume, in memory or in files, for `write_kernel_file`.
class KernelSource {
public:
    virtual ~KernelSource() = default;

    /// As `svk_contents` of the volume.
    [[nodiscard]] virtual SvkContents contents() const = 0;
    [[nodiscard]] virtual const Surface& boundary() const = 0;

    /// As `median_order` of the kernels' centres.
    [[nodiscard]] virtual std::vector<Index> order(std::size_t leaves) const = 0;

    /// The kernels with these numbers, in that order.
    [[nodiscard]] virtual RbfVolume kernels(std::span<const Index> numbers) const = 0;
};

/// The file that `write_kernel_file` makes of the volume, which has kernels.
///
/// throws: Error(InvalidInput) if there are too many; Error(Io)
KernelFileContents write_kernel_file(const std::filesystem::path& path, const KernelSource& source,
                                     Progress* progress = nullptr);

}  // namespace subvol::detail
