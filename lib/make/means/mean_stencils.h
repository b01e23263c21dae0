// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "mean_rows.h"
#include "subvol/detail/flat_array.h"
#include "subvol/patch_values.h"
#include "subvol/topology.h"

namespace subvol::detail {

/// A weight of a sum, or three for a vector of sums.
template <class Weight>
struct MeanTerm {
    Index column;
    Weight weight;
};
using MeanTerms = Rows<MeanTerm<double>>;
using SlopeTerms = Rows<MeanTerm<Vec3>>;

/// Three wholes in a row behind a face of the boundary, which decide how far a value there may lie beyond their means.
struct MeanReach {
    Index first, second;
    Index third;  ///< kNone if there is none
    double part;  ///< the way from the first centre to the face, in parts of that to the second centre
    Index face;   ///< face of the patches, or kNone
};

/// The operators of `fit_cell_means` as rows, made from the straight cells of a mesh.
struct MeanStencils {
    Wholes wholes;
    std::vector<std::array<double, 8>> corners;  ///< for each cell the integrals of its corners' trilinear functions
    std::vector<double> volumes;                 ///< volumes of the wholes
    std::vector<Vec3> centres;                   ///< centres of the wholes
    SlopeTerms slopes;  ///< for each whole: its gradient is the sum of these times (the neighbour's mean − its own)
    MeanTerms around;   ///< for each point: the wholes of the cells around it, by their parts of the volume there
    /// For each point of the boundary: what the means next to it add to a linear reconstruction; rows over wholes
    MeanTerms ends;
    MeanTerms bends;  ///< for each point: the sum of second differences over the lines of the mesh through it; rows over points
    Rows<MeanReach> reaches;       ///< for each point of the boundary, those of one whole in turn
    IndexRows faces;               ///< for each point: faces of the patches there, one for each side
    std::vector<Vec3> offsets;     ///< from the mean of the wholes' centres around each point to the point
    std::vector<Vec3> mesh_ends;   ///< the same as `ends` for the wholes' centres, which linear functions are freed of
    std::vector<Vec3> mesh_bends;  ///< the bends of the mesh's own points
};

/// Integrals over a straight cell: of its corners' trilinear functions, of 1 and of the place.
struct CellIntegrals {
    std::array<double, 8> corners{};
    double volume = 0;
    Vec3 moment{0.0};
};
[[nodiscard]] CellIntegrals integrate(const std::array<Vec3, 8>& corners);

/// parts, on_patches: as for `fit_cell_means`, or null
[[nodiscard]] MeanStencils mean_stencils(const HexMesh& mesh, const Topology& topology, std::span<const Index> parts,
                                         const ValuesOnPatches* on_patches);

}  // namespace subvol::detail
