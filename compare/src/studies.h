#pragma once

#include "subvol/hex_mesh.h"
#include "subvol/study.h"

namespace subvol::detail {

[[nodiscard]] std::vector<StudyTable> study_table2(const StudyOptions& options);
[[nodiscard]] std::vector<StudyTable> study_order(const StudyOptions& options);
[[nodiscard]] std::vector<StudyTable> study_spacing(const StudyOptions& options);

/// A mesh of a study with a smooth density: of the position within its box, so that all meshes are alike in it.
struct StudyMesh {
    std::string name;
    HexMesh mesh;
};

/// The smooth density at the points of a mesh, as its one attribute "density".
void put_smooth_density(HexMesh& mesh);

/// The pawn and the ball at given resolutions, and the meshes of the options.
[[nodiscard]] std::vector<StudyMesh> smooth_meshes(int pawn, int ball, const StudyOptions& options);

/// log2 of the ratio of two errors: the order if the spacing was halved.
[[nodiscard]] double order_of(double coarse, double fine);

}  // namespace subvol::detail
