// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/render_projected.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {

/// seconds:      how long the work may take; the first picture is always finished
/// footprint_px: distances between neighbouring kernels that are tried when there is time left, in pixels, descending
/// sample:       how the mesh is sampled; the finer steps set its footprint
/// splat:        the last pictures are drawn so; the first ones with a part of the sheets
/// progress:     its `picture` gets every picture as soon as it is there; a wish to stop ends the work as usual
struct ProgressiveOptions {
    double seconds = 1;
    std::vector<double> footprint_px{4, 2, 1};
    SampleOptions sample{};
    SplatOptions splat{};
    Progress* progress = nullptr;
};

/// The last picture, and how it came about.
struct ProgressiveResult {
    SplatResult splat;
    int steps = 0;            // pictures made
    int picture_scale = 1;    // pixels of the result are that wide
    double footprint_px = 0;  // 0: one kernel a control vertex
    double seconds = 0;
};

/// Draws a mesh within a time: first at a quarter and at half of the picture's size, then whole with one kernel a control
/// vertex, then with the mesh sampled again for this view, ever finer. What is not finished in time is given up, and the last
/// picture returned, always of the size asked for.
///
/// throws: as sample_rbf_points and Splatter; Error(InvalidInput) if seconds or a footprint is not positive
[[nodiscard]] ProgressiveResult render_progressively(const HexMesh& mesh, const View& view, const Optics& optics,
                                                     const ProgressiveOptions& options = {});

/// seconds:  how long the work may take; the first picture is always finished
/// lod:      fractions of the inner faces that are drawn on the way, ascending, 0..1
/// projected:     how pictures are drawn; order, fraction and listener are the work's own, and samples are for the last picture
/// progress: its `picture` gets every picture as soon as it is there; a wish to stop ends the work as usual
struct ProjectedProgressiveOptions {
    double seconds = 1;
    std::vector<double> lod{0.03, 0.1, 0.3};
    ProjectedOptions projected{};
    Progress* progress = nullptr;
};

/// The last picture, and how it came about.
struct ProjectedProgressiveResult {
    ProjectedResult projected;
    int steps = 0;                                // pictures made
    ProjectedOrder order = ProjectedOrder::Havs;  // of the last
    double lod = 0;                               // of the last
    bool finished = false;                        // the last picture is exact
    double seconds = 0;
};

/// Draws tetrahedra within a time: first the faces of the boundary alone, then with rising fractions of those inside up to all
/// of them (ProjectedOrder::Havs). The picture after that is by lists if the k-buffer missed a face, so the last is exact. What
/// is not finished in time is given up. Each picture is drawn anew: those before the whole one take together about as long as
/// it.
///
/// throws: as ProjectedRenderer::draw; Error(InvalidInput) if seconds is not positive or a fraction is out of range
/// source: cbps2006, whose pictures go on from one another
[[nodiscard]] ProjectedProgressiveResult render_progressively(ProjectedRenderer& renderer, const View& view,
                                                              const Optics& optics,
                                                              const ProjectedProgressiveOptions& options = {});

}  // namespace subvol
