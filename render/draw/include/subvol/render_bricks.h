// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "subvol/detail/reach_counts.h"
#include "subvol/pixel_rows.h"
#include "subvol/sample_pieces.h"
#include "subvol/splat.h"

namespace subvol {

struct BrickSplatOptions {
    SampleOptions sample{};
    SplatOptions splat{};
    /// The rows of the picture that are drawn, whole rows of tiles; the others stay empty, or have some kernels only.
    PixelRows rows{};
    /// About the most that kernels take while some regions are drawn; besides there are the boundary and a brick.
    std::uint64_t memory_bytes = std::uint64_t{1} << 30;
    /// Folder for kernels that wait for their region of the picture, some 90 bytes each; empty: the folder for temporary files.
    std::filesystem::path scratch{};
};

/// Draws a mesh in pieces as kernels at its points: the picture has the bits of `render_splats` of the whole mesh. Each piece
/// is sampled once; its kernels wait in files, one for each region of the picture that they touch, and are drawn region by
/// region in the order of the whole mesh.
///
/// source:   with one field of one channel
/// boundary: as `sample_boundary` makes it
/// throws:   as `sample_piece` and `BrickPicture`
[[nodiscard]] SplatResult render_bricks(const MeshSource& source, Surface boundary, const View& view, const Optics& optics,
                                        const BrickSplatOptions& options = {});

/// The picture that `render_bricks` draws, while its kernels come from elsewhere: from other processes, for example. They wait
/// in files until they are drawn.
class BrickPicture {
public:
    /// throws: as `render_splats`; Error(InvalidInput) without a boundary, for shadows, ambient occlusion, a colour channel and
    ///         other methods than the CPU's; Error(Io) if `scratch` is full
    BrickPicture(Surface boundary, const View& view, const Optics& optics, const BrickSplatOptions& options);
    ~BrickPicture();
    BrickPicture(const BrickPicture&) = delete;
    BrickPicture& operator=(const BrickPicture&) = delete;

    /// The rows that each kernel may touch.
    [[nodiscard]] std::vector<PixelRows> rows_of(const RbfVolume& kernels) const;

    /// Counts kernels of the picture, each once in all processes: they decide the number of sheets.
    void count(const RbfVolume& kernels);

    /// Adds kernels of one channel, in any order of calls. numbers: in the whole mesh, ascending
    void add(const RbfVolume& kernels, std::span<const std::uint64_t> numbers);

    /// Draws all kernels that were added; to be called once.
    ///
    /// sum: adds counts up over all processes that draw the picture; empty: this one is alone
    [[nodiscard]] SplatResult draw(const detail::SumCounts& sum = {});

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace subvol
