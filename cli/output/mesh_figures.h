// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "report.h"
#include "subvol/certificate.h"
#include "subvol/detail/mesh_share.h"
#include "subvol/hex_mesh.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"
#include "transport.h"

namespace subvol {
struct LimitExtreme;
}

namespace subvol::cli {

/// [x, y, z]
[[nodiscard]] Json json_of(const Vec3& point);
/// Where an extreme is; null if there is none.
[[nodiscard]] Json place_of(const LimitExtreme& extreme);

/// [lower corner, upper corner]
[[nodiscard]] Json json_of(const Box& box);

/// The figures of a share, for `join`.
[[nodiscard]] Json json_of(const detail::MeshShare& share);

/// What `json_of` made of a share. file: named in the error
///
/// throws: Error(InvalidInput)
[[nodiscard]] detail::MeshShare mesh_share_from(const Json& json, const std::string& file);

/// An object of JSON in a file.
///
/// throws: Error(Io), Error(InvalidInput)
[[nodiscard]] Json object_in(const std::string& file);

/// The figures of some cells as parts; transport.h says what each kind has. Those of --part are in the output of `info --json`.
struct FigureParts {
    using Made = detail::MeshShare;
    using Whole = detail::MeshShare;

    [[nodiscard]] static detail::MeshShare join(const std::vector<detail::MeshShare>& parts,
                                                std::span<const std::string> names);
    [[nodiscard]] static std::string pack(const detail::MeshShare& part) { return json_of(part).dump(); }
    [[nodiscard]] static detail::MeshShare unpack(const std::string& bytes);
    [[nodiscard]] static OpenedPart<detail::MeshShare> open(const std::string& file);
};

/// What `info` says to people about a mesh: a line for each figure, with units, and at the end whether the mesh is sound.
///
/// joined:  all shares
/// seconds: of each stage, as in the report
/// steps:   a line about the steps of the file, if it has several
[[nodiscard]] std::string mesh_lines(const ReadResult& read, const detail::MeshShare& joined, const Json& seconds,
                                     const std::string& steps);

/// The volume of a set's cells as they are, trilinear, as of the whole in `inspect`.
[[nodiscard]] double volume_of(const HexMesh& mesh, const CellSet& set);

/// The number of inverted cells that a verdict names.
inline constexpr std::size_t kCellsNamed = 8;

/// "sound", or what is wrong, as "51 cells inverted: 3, 17, 20, …".
///
/// inverted: the first inverted cells
[[nodiscard]] std::string verdict(const MeshReport& report, std::span<const std::size_t> inverted);

/// Whether the limit folds, in words. cells: of the mesh
[[nodiscard]] std::string fold_text(const FoldReport& folds, std::size_t cells);

/// At how many places undecided cells were sampled, and what the least determinant is.
[[nodiscard]] std::string sample_text(const FoldReport& folds);

/// A line about the mesh that a scheme of tetrahedra makes, from `TetRefinement::figures`.
[[nodiscard]] std::string refined_lines(const Json& figures);

}  // namespace subvol::cli
