// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "subvol/field.h"
#include "subvol/progress.h"
#include "subvol/reduce.h"
#include "subvol/surface.h"

namespace subvol {

/// The gradient at a place: `gradient` if there is one, else differences: central ones where both neighbours have a value, else
/// one-sided ones; nothing where an axis has no neighbour.
[[nodiscard]] std::optional<Vec3> gradient_at(const FieldView& field, const Vec3& x);

/// l1:            mean of the absolute difference
/// l2:            root of the mean of its square: the L² norm over the volume, divided by the root of the volume
/// linf:          the largest at a place
/// gradient_rmse: root of the mean of the squared length of the gradients' difference (world⁻¹), over `gradients` places
/// samples:       places where both fields have a value
/// uncovered:     places where the reference has one and the other has none; they count for nothing else
struct FieldErrors {
    double l1 = 0, l2 = 0, linf = 0;
    double gradient_rmse = 0;
    std::size_t samples = 0;
    std::size_t uncovered = 0;
    std::size_t gradients = 0;
};

struct FieldErrorOptions {
    std::size_t samples = 100'000;
    std::uint64_t seed = 0;
    bool gradients = true;
    Progress* progress = nullptr;
};

/// Two fields at random places, spread evenly over the volume of the reference's domain.
///
/// throws: Error(InvalidInput) if no place of the reference's domain is found: 1000 tries a sample at most
/// cost:   parallel; bitwise the same for any number of threads
[[nodiscard]] FieldErrors compare_fields(const FieldView& test, const FieldView& reference,
                                         const FieldErrorOptions& options = {});

/// A field at given places with known values, weighted by the places' weights (`random_places`, `new_vertices`). No gradients.
///
/// throws: Error(InvalidInput) if there is no place
[[nodiscard]] FieldErrors compare_field(const FieldView& test, const FieldSamples& places);

/// The integral of a field over its domain: the midpoint rule on cubes.
///
/// box:        the cubes' region; what is outside does not count
/// resolution: cubes along the longest side, 2 to 2000. Linear fields are exact but for the cubes that the boundary cuts: of
///             those the ones count whole whose middle is inside
/// cost:       resolution³ evaluations at most; parallel, bitwise the same for any number of threads
[[nodiscard]] double integrate_field(const FieldView& field, const Box& box, int resolution = 128,
                                     Progress* progress = nullptr);

/// |∫ test − ∫ reference| / |∫ reference|, both on the same cubes; infinite where only the reference's is 0.
struct MassError {
    double test = 0, reference = 0, relative = 0;
};

[[nodiscard]] MassError mass_error(const FieldView& test, const FieldView& reference, int resolution = 128,
                                   Progress* progress = nullptr);

/// Where a field takes a value, by marching tetrahedra: cubes of a grid over `box`, six tetrahedra each. Vertices lie on grid
/// lines, where bisection finds the value; triangles between them are flat, hence off the surface by up to h²/8 times its
/// curvature. Cubes with a corner outside the domain have none: the surface ends up to a cube before the boundary. What
/// is smaller than a cube may be missed.
///
/// resolution: cubes along the longest side, 2 to 2000
/// throws:     Error(InvalidInput) for a resolution out of range or an empty box
[[nodiscard]] Surface isosurface(const FieldView& field, double iso, const Box& box, int resolution = 128,
                                 Progress* progress = nullptr);

/// The larger of the two one-sided distances: from all vertices of the one to the nearest points of the other's triangles. It
/// is the Hausdorff distance of the surfaces but for places inside triangles, which may be further away by a triangle's size at
/// most. Infinite if one of them has no triangle; 0 if none has.
[[nodiscard]] double hausdorff_distance(const Surface& a, const Surface& b);

/// distance:     the Hausdorff distance of both isosurfaces on the same grid; infinite if only one of them is there
/// spacing:      side of the grid's cubes, world: the distance is known to about that, much better where surfaces are smooth
/// test_triangles, reference_triangles: 0: the field does not take the value there
struct IsosurfaceDistance {
    double distance = 0;
    double spacing = 0;
    std::size_t test_triangles = 0, reference_triangles = 0;
};

/// throws: as `isosurface`; Error(InvalidInput) too if neither field takes the value
[[nodiscard]] IsosurfaceDistance isosurface_distance(const FieldView& test, const FieldView& reference, double iso,
                                                     int resolution = 128, Progress* progress = nullptr);

}  // namespace subvol
