// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "common_options.h"
#include "subvol/brick_points.h"
#include "subvol/bricks.h"
#include "subvol/facts.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// Opens bricks; cells and bricks are facts. Refuses the common options that bricks cannot have.
[[nodiscard]] WithFacts<Bricks> open_bricks_input(const std::string& input, const CLI::App& app);

/// A field that is taken from each brick, with its range in the whole mesh.
struct StreamedField {
    std::string name;  ///< as the user says it: a field, the length of a vector, a component "V.1"; empty: density 1 everywhere
    bool vector = false;  ///< all three channels are taken
    double min = 0, max = 1;
};

/// Chooses the field as `with_selected_field` does for a mesh.
[[nodiscard]] WithFacts<StreamedField> select_brick_field(const Bricks& bricks, const CommonOptions& options);

/// A field that the user names. throws: Error(InvalidInput) if there is none; names those that exist
[[nodiscard]] StreamedField named_brick_field(const Bricks& bricks, const std::string& name, bool vector_allowed);

/// A mesh of one cell whose fields have the ranges of the whole: what chooses a field by names and values sees no difference.
[[nodiscard]] HexMesh stand_in(const Bricks& bricks);

/// The brick with these fields alone, the attributes in their order.
[[nodiscard]] HexMesh with_brick_fields(HexMesh brick, const std::vector<StreamedField>& fields);

}  // namespace subvol::cli
