// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/flow_surface.h"
#include "subvol/hex_mesh.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// The options of streamlines, and of the arrows beside them.
struct StreamArguments {
    FlowChoices chosen{};
    std::vector<std::string> seeds{};  ///< texts as of `parse_seeds`, or files of places; none: middles of cells

    /// Also what is only seen in pictures.
    void add_to(CLI::App& app);
    /// Those of streamlines that are written.
    void add_lines_to(CLI::App& app);

    /// The seeds in a mesh.
    ///
    /// throws: Error(InvalidInput) if a text names neither seeds nor a file of them; Error(Io)
    [[nodiscard]] std::vector<Vec3> places(const HexMesh& mesh, const LimitOptions& limit) const;

private:
    void add_seeds_to(CLI::App& app);
};

}  // namespace subvol::cli
