// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "subvol/camera.h"
#include "subvol/hex_mesh.h"
#include "subvol/names.h"
#include "subvol/option_names.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"
#include "subvol/refine.h"

namespace subvol {

/// What a kernel has of the field beside its value: nothing, the gradient, also the mean of the second derivatives, or all
/// second derivatives.
enum class Correction { None, Gradient, Second, Full };

template <>
struct NameTable<Correction> {
    static constexpr Name<Correction> rows[] = {{Correction::None, "none"},
                                                {Correction::Gradient, "gradient"},
                                                {Correction::Second, "second"},
                                                {Correction::Full, "full"}};
};

/// How the value of a sample between control points is found.
///
/// Scheme: by the subdivision scheme
/// Cubic:  Catmull-Rom in the cell's parameters over the 4×4×4 control points about it
/// Paper:  Σ w f / Σ w over the control points within a kernel's extent, in the cell's parameters [mnmq2007]
///
/// Where the surroundings are not a grid, `Cubic` extrapolates the missing points and `Paper` leaves them out.
enum class ValueRule { Scheme, Cubic, Paper };

template <>
struct NameTable<ValueRule> {
    static constexpr Name<ValueRule> rows[] = {{ValueRule::Scheme, "scheme", "exact"},
                                               {ValueRule::Cubic, "cubic", "Catmull-Rom"},
                                               {ValueRule::Paper, "paper", "weighted mean"}};
};

/// Samples for a picture: neighbours that the camera sees are at most `spacing_px` pixels apart.
struct Footprint {
    Camera camera;
    int width_px = 512;
    int height_px = 512;
    double spacing_px = 1.5;
    double least_cell_px = 1.5;  ///< cells whose projected box is smaller than this in width and height keep one interval
};

struct SampleOptions {
    SchemeOptions scheme{};
    int per_edge = 1;          ///< sample intervals per cell edge, 1 to 64; 1 is one kernel per control vertex
    double spacing_world = 0;  ///< if > 0, instead of per_edge each edge gets ⌈length / spacing⌉ intervals
    /// Instead of per_edge and spacing_world, each edge gets ⌈length in pixels / spacing⌉ intervals
    std::optional<Footprint> footprint{};
    /// If > 0, instead of all of these as many intervals as needed until the first channel's error, in its own unit, is smaller
    /// at the points of the second refinement. Where no kernel covers a point, the error is the channel's range, or the value
    /// there if that is larger
    double tolerance = 0;
    /// Also a kernel in the middle of each small cell between the samples: a body-centred lattice of twice as many kernels,
    /// with about a third of the error; the first of the steps of slow growth [pas2002]
    bool centers = false;
    Correction correction = Correction::Second;
    /// How values between control points are found; gradients and moments are those of the scheme
    ValueRule values = ValueRule::Scheme;
    Kernel kernel{};
    /// Kernel of the rule `Paper`; its weights must be positive in sum wherever there is a sample
    Kernel value_kernel = BcSplineKernel{.b = 0.039579, .c = 0.028746, .extent = 2};
    /// Refinements of the boundary surface, 0 to 6; none: as many as make its quads half a sample interval wide, at most 4 and
    /// no more than make eight million triangles; where intervals differ, that is the root of their mean square on the boundary
    std::optional<int> boundary_levels{};
    Progress* progress = nullptr;
};

[[nodiscard]] std::vector<Option> options_of(SampleOptions& options);

struct SampleReport {
    std::size_t points = 0;
    std::size_t at_vertices = 0, on_edges = 0, on_faces = 0, in_cells = 0;
    std::size_t flat_frames = 0;  // points whose Jacobian was singular and was thickened
    double largest_error = 0;     // with a tolerance: of the first channel at the points of the second refinement
};

struct SampleResult {
    RbfVolume volume;
    SampleReport report;
};

/// Samples a subdivision volume into radial basis functions: vertices, edges, faces and cells by themselves, so that shared
/// points occur once. Their number is N = V + Σ(nₑ−1) + Σ(n_u−1)(n_v−1) + Σ(n_u−1)(n_v−1)(n_w−1).
///
/// Along each direction a face has the larger count of its two opposite edges, a cell the largest of its four. Geometry and
/// values are those of the scheme: exact if all edges have the same power of two of intervals, or where the sample is a vertex
/// of the second refinement (moved to the limit); else interpolated in the cell by quartics through those vertices.
///
/// throws: Error(InvalidInput) for options out of range, and as `refine`
/// source: docs/science.md
[[nodiscard]] SampleResult sample_rbf_points(HexMesh mesh, const SampleOptions& options = {});

/// The values of a rule at the points that the first refinement adds. The error of a rule is its difference from the scheme.
///
/// field:   as in `scalar_field`
/// kernel:  of the rule `Paper`
/// returns: a value for each point that `refine` adds to those of the mesh, in its order
/// throws:  Error(InvalidInput) as `refine` and `scalar_field`
[[nodiscard]] std::vector<double> values_at_new_points(const HexMesh& mesh, std::string_view field, ValueRule rule,
                                                       const Kernel& kernel);

}  // namespace subvol
