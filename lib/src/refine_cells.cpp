#include "subvol/refine_cells.h"

#include "patch.h"
#include "subvol/error.h"

namespace subvol {

namespace {

void check_cells(const HexMesh& mesh, std::span<const Index> cells) {
    std::vector<std::uint8_t> named(mesh.cells.size(), 0);
    for (const Index c : cells) {
        if (c >= mesh.cells.size()) {
            throw Error(ErrorCode::InvalidInput, "there is no cell " + std::to_string(c), {},
                        "the mesh has " + std::to_string(mesh.cells.size()) + " cells");
        }
        if (named[c]) throw Error(ErrorCode::InvalidInput, "cell " + std::to_string(c) + " is named twice");
        named[c] = 1;
    }
}

}  // namespace

HexMesh refine_cells(const HexMesh& mesh, std::span<const Index> cells, const RefineOptions& options) {
    if (options.levels < 0 || options.levels > 10) {
        throw Error(ErrorCode::InvalidInput, "the number of levels is " + std::to_string(options.levels), {}, "0 to 10");
    }
    validate(mesh);
    check_cells(mesh, cells);
    if (cells.empty()) return {};
    HexMesh tagged;
    if (options.crease_angle_deg && options.levels > 0) {
        tagged = mesh;
        tag_creases(tagged, *options.crease_angle_deg);
    }
    const HexMesh& control = options.crease_angle_deg && options.levels > 0 ? tagged : mesh;
    detail::Patch patch = detail::PatchSource(control).cut(cells, std::min(options.levels, 2));
    for (int level = 1; level <= options.levels; ++level) {
        patch = detail::refine_patch(patch, options, std::min(options.levels - level, 2));
    }
    return std::move(patch.mesh);
}

}  // namespace subvol
