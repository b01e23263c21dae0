// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/render_projected.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {

struct ProgressiveOptions {
    double seconds = 1;  ///< how long the work may take; the first picture is always finished
    /// Distances between neighbouring kernels that are tried when there is time left, in pixels, descending.
    std::vector<double> footprint_px{4, 2, 1};
    SampleOptions sample{};  ///< how the mesh is sampled; the finer steps set its footprint
    SplatOptions splat{};    ///< options of the last pictures; the first ones have fewer sheets
    /// Its `picture` gets every picture as soon as it is drawn; a request to stop ends the work as usual.
    Progress* progress = nullptr;
};

/// The last picture and its parameters.
struct ProgressiveResult {
    SplatResult splat;
    int steps = 0;            // pictures made
    int picture_scale = 1;    // width of the pixels of the result
    double footprint_px = 0;  // 0: one kernel for each control vertex
    double seconds = 0;
};

/// Draws a mesh within a time: first at a quarter and at half of the picture's size, then at its full size with one kernel for
/// each control vertex, then with the mesh sampled again for this view, ever finer. A picture that is not finished in time is
/// given up, and the last finished one is returned, always in the size of the view.
///
/// throws: as sample_rbf_points and Splatter; Error(InvalidInput) if seconds or a footprint is not positive
[[nodiscard]] ProgressiveResult render_progressively(const HexMesh& mesh, const View& view, const Optics& optics,
                                                     const ProgressiveOptions& options = {});

struct ProjectedProgressiveOptions {
    double seconds = 1;                       ///< how long the work may take; the first picture is always finished
    std::vector<double> lod{0.03, 0.1, 0.3};  ///< fractions of the inner faces that are drawn on the way, ascending, 0..1
    /// How pictures are drawn; order, lod and progress are replaced, and samples count for the last picture only.
    ProjectedOptions projected{};
    /// Its `picture` gets every picture as soon as it is drawn; a request to stop ends the work as usual.
    Progress* progress = nullptr;
};

/// The last picture and its parameters.
struct ProjectedProgressiveResult {
    ProjectedResult projected;
    int steps = 0;                                // pictures made
    ProjectedOrder order = ProjectedOrder::Havs;  // of the last
    double lod = 0;                               // of the last
    bool finished = false;                        // whether the last picture is exact
    double seconds = 0;
};

/// Draws tetrahedra within a time: first the faces of the boundary alone, then rising fractions of the inner ones up to all of
/// them (ProjectedOrder::Havs). If the k-buffer missed a face, a last picture is drawn with lists, so the last one is exact. A
/// picture that is not finished in time is given up. Each picture is drawn anew: the partial ones take about as long in total
/// as the whole one.
///
/// throws: as ProjectedRenderer::draw; Error(InvalidInput) if seconds is not positive or a fraction is out of range
/// source: cbps2006, where each picture continues the one before
[[nodiscard]] ProjectedProgressiveResult render_progressively(ProjectedRenderer& renderer, const View& view,
                                                              const Optics& optics,
                                                              const ProjectedProgressiveOptions& options = {});

}  // namespace subvol
