// SPDX-License-Identifier: Apache-2.0
// From a control mesh to a picture: once as splats of the control points, once as rays through the refined cells.
//
// Writes splat.png and rays.png into the current folder and prints how much they differ.

#include <cstdio>

#include "subvol/compare.h"
#include "subvol/render.h"
#include "subvol/subvol.h"

int main() try {
    // A mesh: any hexahedra with a density at the points. `read_mesh("part.vtk").mesh` would do as well.
    const subvol::HexMesh mesh = subvol::make_model("ball", 8);

    // What to look at, and how values become colour and opacity.
    const subvol::Box box = bounds(mesh);
    const subvol::View view(subvol::parse_camera("iso", box), 256, 256);
    const subvol::Optics optics(subvol::transfer_function_preset("coolwarm", -1, 1), box.diagonal() / 100);

    // The limit of subdivision as radial basis functions, one per control point, and their picture.
    const subvol::SampleResult points = subvol::sample_rbf_points(mesh);
    const subvol::Image splat = subvol::render_splats(points.volume, view, optics).image;
    subvol::write_image("splat.png", splat);

    // The same volume refined twice, every cell split into tetrahedra: slower, but only the limit is approximated.
    const subvol::HexMesh fine = subvol::refine(mesh, {.levels = 2});
    const subvol::Image rays = subvol::render_tets(fine, {}, view, optics).image;
    subvol::write_image("rays.png", rays);

    const double psnr = subvol::compare_images(splat, rays).psnr;
    std::printf("%zu kernels against %zu cells: %.1f dB\n", points.volume.size(), fine.cells.size(), psnr);
    return psnr > 40 ? 0 : 1;  // a hundredth of the full scale
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
