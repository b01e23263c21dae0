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
///
/// third: kNone if there is none
/// part:  the way from the first centre to the face, in parts of that to the second centre
/// face:  that of the patches, or kNone
struct MeanReach {
    Index first, second, third;
    double part;
    Index face;
};

/// The operators of `fit_cell_means` as rows, made from the straight cells of a mesh.
///
/// corners: of each cell the integrals of its corners' trilinear functions
/// volumes, centres: of the wholes
/// slopes:  of each whole: its gradient is the sum of these times (the neighbour's mean − its own)
/// around:  of each point: the wholes of the cells around it, by their parts of the volume there
/// offsets: from the mean of the wholes' centres around each point to the point
/// ends:    of each point of the boundary: what the means next to it add to a linear reconstruction; rows over wholes
/// mesh_ends: the same of the wholes' centres, which linear functions are freed of
/// reaches: of each point of the boundary, those of one whole in turn
/// faces:   of each point: those of the patches there, one for each side
/// bends:   of each point: the sum of second differences over the lines of the mesh through it; rows over points
/// mesh_bends: the bends of the mesh's own points
struct MeanStencils {
    Wholes wholes;
    std::vector<std::array<double, 8>> corners;
    std::vector<double> volumes;
    std::vector<Vec3> centres;
    SlopeTerms slopes;
    MeanTerms around, ends, bends;
    Rows<MeanReach> reaches;
    IndexRows faces;
    std::vector<Vec3> offsets, mesh_ends, mesh_bends;
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
