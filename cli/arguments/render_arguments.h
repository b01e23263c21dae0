// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "picture_arguments.h"
#include "refine_arguments.h"
#include "sample_arguments.h"
#include "splat_arguments.h"
#include "subvol/picture_maker.h"
#include "tet_refinement.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// What `subvol render` is told about a picture: all options but the files and the shares.
struct RenderArguments {
    Method method = Method::Splat;   ///< as settled
    BodyKind body = BodyKind::Mesh;  ///< as settled
    PictureArguments picture{};
    SampleArguments sample{};
    Clip clip{};
    SplatArguments splat{};
    RefineArguments refine{};
    TetRefinement tets{};
    MethodOptions chosen{};  ///< the options of pictures that the library describes; the rest stays as it is

    void add_to(CLI::App& app);
    /// What the library and the command describe of them.
    [[nodiscard]] std::vector<Option> described();

    /// Decides what the options leave open, and refuses those that do not go together or have no effect.
    ///
    /// input:     the kind of body that the input has; a scheme of tetrahedra makes a mesh one of tetrahedra
    /// level_set: the input is a grid of distances, whose body ends at a surface
    /// throws:    Error(InvalidInput)
    void settle(BodyKind input, bool level_set, const CLI::App& app);

    /// The options of the library.
    ///
    /// box:   of the body
    /// field: the range of the field that gives the opacities
    [[nodiscard]] MethodOptions method_options(const Box& box, const Range& field, Progress* progress) const;

private:
    std::string method_name_ = "splat";
};

}  // namespace subvol::cli
