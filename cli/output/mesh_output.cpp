// SPDX-License-Identifier: Apache-2.0
#include "mesh_output.h"

#include "subvol/mesh_io.h"

namespace subvol::cli {

Facts write_reported(const std::string& path, const HexMesh& mesh, const Shells& shells, const MeshSets& sets,
                     Progress* progress) {
    Facts facts;
    for (const std::string& warning : facts.timed(progress, "write", [&] { return write_mesh(path, mesh, shells, sets); }))
        facts.warn(warning);
    return facts;
}

Facts write_reported(const std::string& path, const HexMesh& mesh, Progress* progress) {
    return write_reported(path, mesh, {}, {}, progress);
}

}  // namespace subvol::cli
