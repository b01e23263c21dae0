// SPDX-License-Identifier: Apache-2.0
#include "surface_preview.h"

#include <algorithm>

#include "subvol/detail/parallel_each.h"
#include "subvol/detail/triangle_raster.h"
#include "subvol/shading.h"

namespace subvol::detail {

Preview surface_preview(const BoundaryValues& boundary, const View& view, const Optics& optics, const Clip& clip) {
    const Surface& surface = boundary.surface;
    const std::vector<double>& values = boundary.values.back();
    TriangleRaster hits(surface, view, clip);
    const Shading shading = shading_for(optics.function());
    std::vector<std::array<float, 4>> colors(surface.triangles.size());
    parallel_each(colors.size(), [&](std::size_t t) {
        const auto& [i, j, k] = surface.triangles[t];
        const Vec3 &a = hits.eye[i], &b = hits.eye[j], &c = hits.eye[k];
        // Eye space (right, up, away from the eye) is left-handed: outward normals turn round.
        const Vec3 flat = glm::cross(c - a, b - a);
        const double length = glm::length(flat);
        const Vec3 to_eye = view.perspective() ? -glm::normalize(a) : Vec3(0, 0, -1);
        const double light = length > 0 ? double{surface_light(shading, flat / length, to_eye).diffuse} : 0;
        const glm::vec3 color(light * optics.color(values[i] / 3 + values[j] / 3 + values[k] / 3));
        colors[t] = {color.x, color.y, color.z, 1};
    });
    Preview preview{Image(view.width(), view.height()), std::move(hits.depth.values)};
    parallel_each(hits.triangle.values.size(), [&](std::size_t pixel) {
        const std::uint32_t t = hits.triangle.values[pixel];
        if (t != TriangleRaster::kNothing) std::ranges::copy(colors[t], preview.image.rgba.begin() + std::ptrdiff_t(4 * pixel));
    });
    return preview;
}

}  // namespace subvol::detail
