// SPDX-License-Identifier: Apache-2.0
#include "file_info.h"

#include <array>

#include "subvol/error.h"

namespace subvol::cli {
namespace {

/// What a kind of file can be asked for.
struct InfoKind {
    std::unique_ptr<FileInfo> (*make)(const InfoRequest&);
    const char* what;   ///< "grids": what the file holds
    bool is_mesh;       ///< options of reading meshes have an effect, and shares are figures of some cells
    bool in_one_piece;  ///< all of the mesh is in memory
    bool has_voxels;    ///< values are read at places
};

const InfoKind& kind_of_info(InputKind kind) {
    static constexpr InfoKind kMesh{make_mesh_info, "a mesh", true, true, false};
    static constexpr InfoKind kBricks{make_bricks_info, "bricks", true, false, false};
    static constexpr InfoKind kPoints{make_points_info, "points", false, false, false};
    static constexpr InfoKind kGrids{make_grids_info, "grids", false, false, true};
    switch (kind) {
        case InputKind::Bricks:
            return kBricks;
        case InputKind::Points:
            return kPoints;
        case InputKind::Grid:
            return kGrids;
        case InputKind::Mesh:
        case InputKind::Picture:
            break;
    }
    return kMesh;
}

}  // namespace

bool InfoRequest::shows(const std::string& name) const {
    return !common.field || *common.field == name || common.field->starts_with(name + ".");
}

std::unique_ptr<FileInfo> make_file_info(const InfoRequest& request) {
    const InfoKind& kind = kind_of_info(kind_of(request.input));
    if (request.share && (request.lists_fields || request.devices || !kind.is_mesh)) {
        throw Error(ErrorCode::InvalidInput, "only the figures of a mesh are found in shares",
                    request.ranks != nullptr ? "info in several processes" : "--part");
    }
    const bool in_one_piece = kind.in_one_piece && !request.lists_fields && !request.share;
    struct OfOnePiece {
        bool asked;
        std::string option;
    };
    for (const auto& [asked, option] : {OfOnePiece{request.tets.asked(), "--scheme"}, OfOnePiece{request.folds, "--folds"},
                                        OfOnePiece{request.limit, "--limit"}, OfOnePiece{request.ignored, "--ignored"}}) {
        if (asked && !in_one_piece)
            throw Error(ErrorCode::InvalidInput, "needs a mesh in one piece, and one process", option, "no " + option);
    }
    if (!kind.is_mesh) refuse_mesh_options(request.app, "needs a mesh; these are points or grids");
    if (!request.places.empty() && !kind.has_voxels && !request.lists_fields) {
        throw Error(ErrorCode::InvalidInput, std::string("reads values from grids in .vdb files only, not from ") + kind.what,
                    "--at");
    }
    return kind.make(request);
}

}  // namespace subvol::cli
