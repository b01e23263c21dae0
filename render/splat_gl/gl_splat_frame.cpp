// SPDX-License-Identifier: Apache-2.0
#include "gl_splat_frame.h"

#include "eye_splats.h"

namespace subvol::detail {

namespace {

std::array<double, 4> row(const Vec3& axis, double last) {
    return {axis.x, axis.y, axis.z, last};
}

/// Factor and offset that convert values into cells of the table from `min` to `max`.
std::array<double, 2> cells_of(double min, double max, bool normalized) {
    const double scale = PreintegratedTable::kCells / (max - min);
    return {scale, normalized ? -min * scale : 0};
}

void set_light(GlSplatFrame& frame, const Shading& shading) {
    const Vec3 key = glm::normalize(shading.key);
    const auto to_float = [](double v) { return static_cast<float>(v); };
    frame.key = {to_float(key.x), to_float(key.y), to_float(key.z), 0};
    frame.material = {to_float(shading.ambient), to_float(shading.diffuse), to_float(shading.specular),
                      to_float(shading.shininess)};
}

}  // namespace

GlSplatFrame gl_splat_frame(const SplatScene& scene, const View& view, const Classification& classification,
                            const SheetStack& sheets, int tile_px, int batch) {
    GlSplatFrame frame;
    const Vec3 middle = view.to_eye(scene.middle);
    frame.right = row(view.axes()[0], middle.x);
    frame.up = row(view.axes()[1], middle.y);
    frame.forward = row(view.axes()[2], 0);
    const auto values = cells_of(classification.table.min, classification.table.max, scene.normalized);
    const auto colors = cells_of(classification.colors.min, classification.colors.max, scene.normalized);
    frame.cells = {values[0], values[1], colors[0], colors[1]};
    frame.unit = classification.table.unit;
    if (scene.shading) set_light(frame, *scene.shading);
    frame.width = view.width();
    frame.height = view.height();
    frame.tiles_x = (view.width() + tile_px - 1) / tile_px;
    frame.tiles_y = (view.height() + tile_px - 1) / tile_px;
    frame.sheets = sheets.count;
    frame.batches = (sheets.count + batch - 1) / batch;
    frame.perspective = view.perspective();
    // Slices are seen in batches whose values are not.
    frame.all_visible = static_cast<std::size_t>(classification.table.visible.back()) == classification.table.rows.size() ||
                        scene.clip.has_slices();
    frame.first_depth = sheets.first;
    frame.sheet_distance = sheets.distance;
    frame.middle_depth = sheets.middle;
    frame.near_depth = sheets.near;
    frame.pixel = static_cast<float>(view.pixel());
    frame.value_offset = value_offset(scene, classification);
    frame.color_offset = color_offset(scene, classification);
    frame.half_weight = scene.half_weight;
    frame.least_gradient = kLeastChange * PreintegratedTable::kCells / static_cast<float>(scene.diagonal);
    frame.kernel_cells = scene.kernel_table.empty() ? 0 : static_cast<float>(scene.kernel_table.size() - 1);
    return frame;
}

}  // namespace subvol::detail
