// SPDX-License-Identifier: Apache-2.0
// From a mesh to kernels, and from kernels to a picture. Writes points.ply and splat.png.

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "subvol/compare.h"
#include "subvol/render.h"
#include "subvol/subvol.h"

int main() try {
    const subvol::HexMesh mesh = subvol::make_model("twist", 16);

    // One kernel per control point: centre, frame, value, gradient and second moment. `per_edge = 2` makes eight times as many.
    const subvol::RbfVolume volume = subvol::sample_rbf_points(mesh).volume;
    subvol::write_points("points.ply", volume);

    // Between the points the kernels define a field that is close to that of the mesh.
    const subvol::RbfField field(volume);
    double largest = 0;
    for (std::size_t p = 0; p < mesh.points.size(); ++p)
        largest = std::max(largest, std::abs(field.value(mesh.points[p]).value() - mesh.attributes[0].values[p]));
    std::printf("%zu kernels, at the control points at most %.4f off\n", volume.size(), largest);

    // The picture: a camera with a size, and colours and opacities over values.
    const subvol::View view(subvol::parse_camera("iso", volume.bounds), 256, 256);
    const subvol::Optics optics(subvol::transfer_function_preset("coolwarm", -1, 1), volume.bounds.diagonal() / 100);
    const subvol::SplatResult drawn = subvol::render_splats(volume, view, optics);
    subvol::write_image("splat.png", drawn.image);

    // The points in the file are the same, bit for bit.
    const bool same = subvol::read_points("points.ply").centers == volume.centers;
    return largest < .05 && same ? 0 : 1;  // of a field from -1 to 1
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
