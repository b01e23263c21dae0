// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "subvol/camera.h"
#include "subvol/rbf_volume.h"

namespace subvol::detail {

/// Square regions of a picture, and for each a file with the kernels that may touch it. The files have no names: they vanish
/// with the program.
class KernelRegions {
public:
    /// nearest:  the least eye depth that a perspective camera sees; kernels that come nearer are in all regions
    /// widening: of the frames: the part of space where a kernel is not 0
    KernelRegions(const View& view, double nearest, double widening, std::filesystem::path scratch);

    /// Adds kernels of one channel. numbers: in the whole mesh, ascending within a call
    void add(const RbfVolume& kernels, std::span<const std::uint64_t> numbers);

    struct Region {
        int x0, y0, x1, y1;  // pixels, from x0 to before x1
    };
    [[nodiscard]] std::size_t size() const { return files_.size(); }
    [[nodiscard]] Region region(std::size_t k) const;
    [[nodiscard]] std::uint64_t kernels_in(std::size_t k) const { return counts_[k]; }

    /// Takes the kernels of some regions out of their files: each once, in the order of the whole mesh.
    ///
    /// into: gets them in place of those that it has
    void take(std::span<const std::size_t> regions, RbfVolume& into);

private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    using File = std::unique_ptr<std::FILE, Close>;

    [[nodiscard]] Region rows_of(const RbfVolume& kernels, std::size_t i) const;
    void flush(std::size_t k);
    [[noreturn]] void fail() const;

    View view_;
    double nearest_, widening_;
    std::filesystem::path scratch_;
    int side_ = 64, across_ = 1, down_ = 1;
    bool bent_ = false;
    std::vector<File> files_;
    std::vector<std::vector<char>> waiting_;
    std::vector<std::uint64_t> counts_;
};

}  // namespace subvol::detail
