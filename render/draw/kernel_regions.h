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
#include "subvol/render_bricks.h"

namespace subvol::detail {

/// Square regions of a picture, and for each a file with the kernels that may touch it. The files have no names: they vanish
/// with the program.
class KernelRegions {
public:
    /// rows:     of pixels that are drawn: what touches no region with one of them is not kept
    /// nearest:  the least eye depth that a perspective camera sees; kernels that come nearer are in all regions
    /// widening: of the frames: the part of space where a kernel is not 0
    KernelRegions(const View& view, const PixelRows& rows, double nearest, double widening, std::filesystem::path scratch);

    /// Adds kernels of one channel. numbers: in the whole mesh, ascending within a call
    void add(const RbfVolume& kernels, std::span<const std::uint64_t> numbers);

    struct Region {
        int x0, y0, x1, y1;  // pixels, from x0 to before x1
    };
    [[nodiscard]] std::size_t size() const { return files_.size(); }
    [[nodiscard]] Region region(std::size_t k) const;
    [[nodiscard]] std::uint64_t kernels_in(std::size_t k) const { return counts_[k]; }

    /// Whether a region has rows that are drawn.
    [[nodiscard]] bool is_drawn(std::size_t k) const;

    /// The rows of pixels that each kernel may touch.
    [[nodiscard]] std::vector<PixelRows> rows_of(const RbfVolume& kernels) const;

    /// Takes the kernels of some regions out of their files: each once, in the order of the whole mesh.
    ///
    /// into: gets them in place of those that it has
    void take(std::span<const std::size_t> regions, RbfVolume& into);

private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    using File = std::unique_ptr<std::FILE, Close>;

    struct PixelBox {
        double left, top, right, bottom;
    };
    [[nodiscard]] PixelBox pixels_of(const RbfVolume& kernels, std::size_t i) const;
    [[nodiscard]] Region regions_of(const RbfVolume& kernels, std::size_t i) const;
    void flush(std::size_t k);
    [[noreturn]] void fail() const;

    View view_;
    PixelRows rows_;
    double nearest_, widening_;
    std::filesystem::path scratch_;
    int side_ = 64, across_ = 1, down_ = 1;
    bool bent_ = false;
    std::vector<File> files_;
    std::vector<std::vector<char>> waiting_;
    std::vector<std::uint64_t> counts_;
};

}  // namespace subvol::detail
