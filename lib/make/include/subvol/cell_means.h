// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "subvol/patch_values.h"
#include "subvol/refine.h"

namespace subvol {

struct CellMeansReport {
    /// How far the means of the limit are from those wanted, in parts of each field's range; the largest of all fields
    double rms_off = 0, most_off = 0;
    double seconds = 0;
};

struct CellMeansFit {
    std::vector<Attribute> fields;  ///< values at the mesh's points, with the names of the means
    CellMeansReport report;
};

/// Finds values at the control points whose limit follows means over the cells, as finite volumes have them, without waves.
///
/// The means at points are corrected twice by what their limit lacks of the means over cells: of fourth order in even grids, of
/// second order and exact for linear functions in others, of third order on the boundary of even grids. Waves from cell to cell
/// are not amplified (by no more than a quarter, at any length), so means of rough fields are met only nearly, which the report
/// says. Values stay within the range of the means around them, on the boundary within what the cells there lead to. If 2 % of
/// the cells have a field's least mean and so do all their neighbours, as where a fraction is 0, values are not less; and so
/// for the greatest. These are the `bounds` of a field of one channel. The mean over the whole volume is that of the means, by
/// a change that is least where values are near these bounds.
///
/// means: per cell of the mesh, by field
/// parts: for each cell the number of the whole that it is a part of, whose mean is given at all its parts; none: each its own
/// throws: Error(InvalidInput) as `refine`, if a size is wrong or a mean is not finite; Error(Cancelled)
/// cost:   parallel; bitwise the same for any number of threads
[[nodiscard]] CellMeansFit fit_cell_means(const HexMesh& mesh, std::span<const Attribute> means,
                                          std::span<const Index> parts = {}, Progress* progress = nullptr);

/// The same with what is known of the fields on the boundary: means do not lead beyond faces whose values are known, or across
/// which a field does not change.
[[nodiscard]] CellMeansFit fit_cell_means(const HexMesh& mesh, std::span<const Attribute> means,
                                          const ValuesOnPatches& on_patches, std::span<const Index> parts = {},
                                          Progress* progress = nullptr);

struct ExactMeansOptions {
    SchemeOptions scheme{};
    /// How much a change of the first guess counts beside the means that are not met: it decides between the many sets of
    /// values with the same means, and keeps noise of the means from growing. Greater than 0
    double tie = 1e-4;
    double tolerance = 1e-4;  ///< the search ends when no mean is off by more than this part of the means' range
    int max_iterations = 60;  ///< the most iterations of conjugate gradients
    Progress* progress = nullptr;
};

struct ExactMeansReport {
    CellMeansReport found;
    double first_rms_off = 0;  ///< rms_off before the search
    int iterations = 0;
};

struct ExactMeansFit {
    std::vector<Attribute> fields;
    ExactMeansReport report;
};

/// Finds values at the control points whose limit has given means over the cells.
///
/// The mean of a cell is a weighted sum of control values: the integral of the product of the field and the Jacobian's
/// determinant, of the triquadratic surroundings of the 27 limit points of the first level; exact for cubic fields in straight
/// cells. The values start from a linear reconstruction: each cell has its mean and a gradient by its neighbours. Least squares
/// then change them as little as possible, by a sum of the cells' weights. Fields that are not smooth are given waves from cell
/// to cell: means lose these, so whoever meets means exactly amplifies them. Values inside the mesh stay within the range of
/// the field's means, those on the boundary as near to it as the gradient of their cells allows: where a front is thinner than
/// a cell, as that of a liquid, the means beside it are therefore not met, which the report says.
///
/// means, parts, throws: as for `fit_cell_means`
/// cost:   parallel; bitwise the same for any number of threads. About 5 kB and 40 µs of CPU time a cell
[[nodiscard]] ExactMeansFit fit_exact_cell_means(const HexMesh& mesh, std::span<const Attribute> means,
                                                 std::span<const Index> parts = {}, const ExactMeansOptions& options = {});

/// Gives fields at the points of patches the values that the file has on the faces there.
///
/// A point gets the mean over its faces, by area, each with a gradient along its patch: exact for linear fields, of second
/// order. Points inside the mesh keep their values, so no waves arise, but cells beside a wall lose their means where the layer
/// along it is thinner than they are, and the volume its whole integral. Where patches meet at a point, those that something
/// flows through (PatchRole::Open) decide; if they say nothing, the value there stays. A vector keeps the walls' component
/// along their normals, and on planes of symmetry it has none.
///
/// use: Meet or Normal
/// cost: linear in the sides on patches; the same for any number of threads
PatchValuesReport meet_patch_values(HexMesh& mesh, const ValuesOnPatches& on_patches,
                                    PatchValuesUse use = PatchValuesUse::Meet);

/// Sets what is known of gradients at points of patches: of each field that the file has at cells and on faces, as finite
/// volumes take them. Along a face it is that of the values on the patch; across, the step from the mean of the cell behind the
/// face to the face's value, by the distance of their centres. At a wall at rest that is the shear of the first cells, which
/// the limit of means over cells does not have. Exact for linear fields. A point of walls has the mean of the walls' faces
/// there, and where they meet one whose length is between that and what each wall asks for; other points that of all faces
/// whose values are known.
///
/// cell_parts: as in `ReadResult`
/// cost: linear in the sides on patches and the cells; the same for any number of threads
void set_wall_gradients(HexMesh& mesh, const ValuesOnPatches& on_patches, std::span<const Index> cell_parts = {});

}  // namespace subvol
