// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/hex_mesh.h"
#include "subvol/hierarchy.h"
#include "subvol/wavelet.h"

namespace subvol {

/// A fine mesh that is edited at a coarser level of itself: its finer details stay what they are, and those of the shape turn
/// with their surroundings.
class CoarseEdit {
public:
    /// Takes the mesh apart by the wavelets of a scheme.
    ///
    /// mesh:   kept: its cells, creases and sharp faces
    /// levels: how much coarser, 1 to 10; a structured grid is filled up to counts that can be halved so often
    /// throws: Error(InvalidInput) as `find_hierarchy` and `wavelet_basis`, or if there are fewer coarser levels
    /// cost:   parallel, O(points); about 500 bytes for each point
    CoarseEdit(const HexMesh& mesh, int levels, const SchemeOptions& scheme = {});

    /// The control mesh of that level, with the fields' control values. Its points are near those of the mesh, not among them:
    /// they are means of what is about them.
    [[nodiscard]] const HexMesh& coarse() const { return coarse_; }

    /// Changes control points and values. Without a change the mesh stays the same, to rounding.
    ///
    /// changed: `coarse()` with other points and values
    /// returns: the fine mesh
    /// throws:  Error(InvalidInput) if it has other counts; nothing changes then
    /// cost:    parallel, O(points)
    const HexMesh& change(HexMesh changed);

    /// Takes another shape of the same mesh apart: with the same cells, but other points and values.
    void take(const HexMesh& mesh);

private:
    MeshHierarchy hierarchy_;
    WaveletBasis basis_;
    HexMesh mesh_, coarse_;
    WaveletField shape_;  // turned to the shape
    std::vector<WaveletField> fields_;
};

}  // namespace subvol
