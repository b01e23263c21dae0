// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "subvol/facts.h"
#include "subvol/field.h"
#include "subvol/field_samples.h"
#include "subvol/hex_mesh.h"
#include "subvol/progress.h"
#include "subvol/scheme.h"
#include "subvol/surface.h"

namespace subvol {

/// The gradient at a place: by `gradient` if the field has one, else by differences, central where both neighbours have a
/// value, else one-sided; nothing where neither neighbour along an axis has one.
[[nodiscard]] std::optional<Vec3> gradient_at(const FieldView& field, const Vec3& x);

/// Numbers over no place at all are NaN: l1, l2 and linf of fields that have no place in common, gradient_rmse where no
/// gradients were compared.
struct FieldDifference {
    double l1 = std::numeric_limits<double>::quiet_NaN();  ///< mean absolute difference
    double l2 = l1;     ///< root mean square difference: the L² norm over the volume, divided by the root of the volume
    double linf = l1;   ///< largest absolute difference at a place
    Vec3 linf_at{0.0};  ///< that place; the first of several
    /// Root mean square of the length of the gradients' difference (world⁻¹), over `gradients` places.
    double gradient_rmse = l1;
    std::size_t samples = 0;    ///< places where both fields have a value
    std::size_t uncovered = 0;  ///< places where only the reference has a value; they do not enter the other numbers
    std::size_t gradients = 0;

    /// The share of the reference's places at which both fields have a value: what the other numbers are about.
    [[nodiscard]] double coverage() const {
        return samples == 0 ? 0.0 : static_cast<double>(samples) / static_cast<double>(samples + uncovered);
    }
};

struct FieldDifferenceOptions {
    std::size_t samples = 100'000;
    std::uint64_t seed = 0;
    bool gradients = true;
    Progress* progress = nullptr;
};

/// Compares two fields at random places, uniform over the volume of the reference's domain.
///
/// throws: Error(InvalidInput) if no place of the reference's domain is found in 1000 tries per sample
/// cost:   parallel; bitwise the same for any number of threads
[[nodiscard]] FieldDifference compare_fields(const FieldView& test, const FieldView& reference,
                                             const FieldDifferenceOptions& options = {});

/// Compares a field with known values at given places (`random_places`, `new_vertices`), with their weights. No gradients.
///
/// throws: Error(InvalidInput) if there is no place
[[nodiscard]] FieldDifference compare_field(const FieldView& test, const FieldSamples& places);

/// The integral of a field over its domain: the midpoint rule on cubes.
///
/// box:        the region of the cubes; the field outside is ignored
/// resolution: cubes along the longest side, 2 to 2000. Linear fields are exact except in cubes that the boundary cuts: those
///             count as whole if their middle is inside, else not at all
/// cost:       resolution³ evaluations at most; parallel, bitwise the same for any number of threads
[[nodiscard]] double integrate_field(const FieldView& field, const Box& box, int resolution = 128,
                                     Progress* progress = nullptr);

struct MassError {
    double test = 0, reference = 0;
    /// |∫ test − ∫ reference| / |∫ reference|, both on the same cubes; infinite if only the reference's integral is 0.
    double relative = 0;
    int resolution = 0;  ///< cubes along the longest side
};

/// resolution: as of `integrate_field`; none: from 32 on as fine as it takes, at most 128, until `relative` changes by no more
///             than 1e-4 or a twentieth of itself
[[nodiscard]] MassError mass_error(const FieldView& test, const FieldView& reference, std::optional<int> resolution = {},
                                   Progress* progress = nullptr);

/// The surface on which a field takes a value, by marching tetrahedra: cubes of a grid over `box`, six tetrahedra each.
/// Vertices lie on edges of the tetrahedra, where regula falsi finds the value; triangles between them are flat, hence off the
/// surface by up to h²/8 times its curvature. Cubes with a corner outside the domain are left out, so the surface ends up to a
/// cube before the boundary. Features smaller than a cube may be missed.
///
/// resolution: cubes along the longest side, 2 to 2000
/// throws:     Error(InvalidInput) for a resolution out of range or an empty box
[[nodiscard]] Surface isosurface(const FieldView& field, double iso, const Box& box, int resolution = 128,
                                 Progress* progress = nullptr);

/// The larger of the two one-sided distances: from all vertices of one surface to the nearest points of the other's triangles.
/// This is the Hausdorff distance of the surfaces up to the size of a triangle, because places inside triangles may be further
/// away than vertices. Infinite if one surface has no triangle; 0 if neither has.
[[nodiscard]] double hausdorff_distance(const Surface& a, const Surface& b);

struct IsosurfaceDistance {
    double distance = 0;  ///< the Hausdorff distance of both isosurfaces on the same grid; infinite if only one of them exists
    /// Side of the grid's cubes, world: the uncertainty of the distance, which is much less for smooth surfaces.
    double spacing = 0;
    std::size_t test_triangles = 0, reference_triangles = 0;  ///< 0 if the field does not take the value
};

/// throws: as `isosurface`, or Error(InvalidInput) if neither field takes the value
[[nodiscard]] IsosurfaceDistance isosurface_distance(const FieldView& test, const FieldView& reference, double iso,
                                                     int resolution = 128, Progress* progress = nullptr);

struct MeshDifferenceOptions {
    SchemeOptions scheme{};  ///< of the reference's limit
    Progress* progress = nullptr;
};

/// The largest difference of a field at a point or, of fields at cells, in a cell.
struct LargestDifference {
    std::string name;
    double max = 0;  ///< its amount, in the field's unit; of a vector or tensor the root of the sum of its channels' squares
    std::optional<Index> point{};  ///< of a field at points
    std::optional<Index> cell{};   ///< of a field whose differences are at cells
    Vec3 place{0.0};               ///< the point, or the middle of the cell
};

struct MeshDifference {
    HexMesh mesh;  ///< the first mesh with the differences as its attributes, under the names of the fields
    /// Both meshes have the same cells and points: values at points, and at cells, were subtracted one by one
    bool same_points = false;
    std::size_t outside = 0;   ///< points outside the reference's limit: they have the value of its nearest place
    double outside_world = 0;  ///< how far the farthest of them lies outside
    std::vector<LargestDifference> fields;
};

/// The report as facts: same_points, outside, outside_distance, and a group of fields with max, at, and point or cell of each.
[[nodiscard]] Facts facts_of(const MeshDifference& difference);

/// The difference of each field that two meshes have, test − reference, at the points of the first mesh: its value there minus
/// that of the reference's limit at the place. Fields with another number of channels in the reference are left out.
///
/// throws: Error(InvalidInput) as `LimitProbe`, or if the meshes have no field in common; Error(Cancelled)
/// cost:   that of one subtraction if both have the same cells and points; else as `LimitProbe`
[[nodiscard]] MeshDifference mesh_difference(const HexMesh& test, const HexMesh& reference,
                                             const MeshDifferenceOptions& options = {});

}  // namespace subvol
