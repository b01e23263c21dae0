// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "clip_arguments.h"
#include "picture_arguments.h"
#include "reference_arguments.h"
#include "refine_arguments.h"
#include "sample_arguments.h"
#include "splat_arguments.h"
#include "tet_refinement.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// What `subvol render` is told about a picture: all options but the files and the shares.
///
/// options: of kernels, as settled; clip: also as settled
struct RenderArguments {
    std::string method = "splat";
    std::uint64_t memory_bytes = std::uint64_t{1} << 30;
    PictureArguments picture{};
    ReferenceArguments reference{};
    SampleArguments sample{};
    ClipArguments clip{};
    SplatArguments splat{};
    RefineArguments refine{};
    TetRefinement tets{};
    SplatOptions options{};

    void add_to(CLI::App& app);

    /// Decides what the options leave open, and refuses those that do not go together.
    ///
    /// has_cells: the input has a boundary, unlike points and voxels
    /// in_bricks: the input is a folder of bricks, which schemes of tetrahedra do not refine
    /// throws:    Error(InvalidInput)
    void settle(bool has_cells, bool in_bricks);
};

}  // namespace subvol::cli
