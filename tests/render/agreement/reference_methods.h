// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "render/hex_meshes.h"
#include "render/image_differences.h"
#include "render/voxel_box.h"
#include "subvol/render_dense.h"
#include "subvol/render_grid.h"
#include "subvol/render_projected.h"
#include "subvol/render_tets.h"

namespace subvol::test {

/// The reference renderers.
enum class Reference { Tets, Dense, Voxels, ProjectedTopological, ProjectedLists };

inline const std::vector<Reference> kReferences{Reference::Tets, Reference::Dense, Reference::Voxels,
                                                Reference::ProjectedTopological, Reference::ProjectedLists};

inline std::string name_of(Reference reference) {
    return std::vector<std::string>{"Tets", "Dense", "Voxels", "ProjectedTopological",
                                    "ProjectedLists"}[static_cast<std::size_t>(reference)];
}
inline void PrintTo(Reference reference, std::ostream* out) {
    *out << name_of(reference);
}

[[nodiscard]] inline bool needs_gl(Reference reference) {
    return reference == Reference::ProjectedTopological || reference == Reference::ProjectedLists;
}

/// Draws a field on a mesh; dense grids at `levels` of MCQ. Not for voxels, which have no mesh.
inline Image draw(Reference reference, const HexMesh& mesh, std::span<const double> values, const View& view,
                  const Optics& optics, int levels = 1) {
    switch (reference) {
        case Reference::Tets:
            return render_tets(valued(mesh, values), {}, view, optics).image;
        case Reference::Dense:
            return render_dense(valued(mesh, values), {}, view, optics, {.levels = levels}).image;
        case Reference::ProjectedTopological:
        case Reference::ProjectedLists:
            return render_projected(
                       valued(mesh, values), {}, view, optics,
                       {.order = reference == Reference::ProjectedLists ? ProjectedOrder::Lists : ProjectedOrder::Topological})
                .image;
        case Reference::Voxels:
            break;
    }
    return {};
}

/// Draws a field in a box, on `cells`³ cells with their inner points moved by up to `jitter` cell widths, or on as many voxels.
inline Image draw(Reference reference, const Box& box, int cells, double jitter,
                  const std::function<double(const Vec3&)>& field, const View& view, const Optics& optics, int levels = 1) {
    if (reference == Reference::Voxels) {
        return render_grid(VoxelBox(box, cells, field), view, optics, {.tolerance = 1e-6}).image;
    }
    HexMesh mesh = jittered_box(static_cast<Index>(cells), jitter, 5);
    for (Vec3& p : mesh.points) p = box.lower + p * box.size();
    return draw(reference, mesh, evaluate(mesh, field), view, optics, levels);
}

}  // namespace subvol::test
