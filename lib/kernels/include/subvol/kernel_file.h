// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "subvol/camera.h"
#include "subvol/kernel_hierarchy.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"

namespace subvol {

/// What a file of kernels with levels of detail holds.
struct KernelFileContents {
    struct Channel {
        std::string name;
        float min = 0, max = 0;
    };
    Kernel kernel;
    std::size_t kernels = 0;
    std::vector<Channel> channels{};
    Box bounds;
    std::size_t boundary_triangles = 0;
    int levels = 0;           ///< levels of the tree, with the root and the leaves
    std::size_t blocks = 0;   ///< blocks of some 1000 kernels each; what lies below one node of the tree
    std::uint64_t bytes = 0;  ///< bytes of the file
};

/// Writes kernels and their hierarchy (`build_kernel_hierarchy`) as `.svk`, from which `KernelFile` reads what a view needs,
/// and `read_points` all kernels with the same bits and in the same order. The tree is made block by block and never held as a
/// whole.
///
/// throws: Error(InvalidInput) as `build_kernel_hierarchy`, or if there are no kernels; Error(Io)
/// cost:   as `build_kernel_hierarchy`, with 4 bytes per kernel and some blocks of memory; the same bytes for any number of
///         threads
KernelFileContents write_kernel_file(const std::filesystem::path& path, const RbfVolume& volume, Progress* progress = nullptr);

/// The kernels for a view, with the boundary: those of `choose_level`, in the same order.
struct StreamedKernels {
    RbfVolume volume;
    KernelCut cut;
    std::uint64_t bytes_read = 0;  ///< bytes of the file that were read for this view
};

/// A file of `write_kernel_file`, of which the parts of blocks are read that a view needs: a few levels of nodes where kernels
/// are merged, and the kernels themselves where they are not. What is read is checked against hashes.
///
/// Not for several threads at once.
class KernelFile {
public:
    /// Reads the head only.
    ///
    /// cache_bytes: about the most that is kept from view to view; it is read again beyond that
    /// throws:      Error(Io); Error(InvalidInput) if the file is malformed
    explicit KernelFile(const std::filesystem::path& path, std::uint64_t cache_bytes = std::uint64_t{1} << 30);
    ~KernelFile();
    KernelFile(KernelFile&&) noexcept;
    KernelFile& operator=(KernelFile&&) noexcept;

    [[nodiscard]] const KernelFileContents& contents() const;

    /// The surface of the solid; it is read once.
    [[nodiscard]] const Surface& boundary();

    /// The cut that `choose_cut` finds in the hierarchy of the same volume, and its kernels.
    ///
    /// options:  channel is one of the file's
    /// channels: those that the result has, in that order; none: all
    /// throws:   as `choose_cut`; Error(Io); Error(InvalidInput) if what is read is damaged, or there is no such channel
    [[nodiscard]] StreamedKernels choose_level(const View& view, const LevelOptions& options = {},
                                               const std::vector<std::size_t>& channels = {}, Progress* progress = nullptr);

    /// Returns the number of bytes read so far, for the head and all views.
    [[nodiscard]] std::uint64_t bytes_read() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol
