// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <utility>

#include "subvol/model.h"
#include "subvol/view_session.h"

namespace subvol {

inline const MethodOptions kByCpu{.splat = {.method = SplatMethod::Cpu}};

/// A small ball with its field and with z.
inline HexMesh ball_with_height() {
    HexMesh mesh = make_model("ball", 3);
    Attribute height{"height", 1, {}};
    for (const Vec3& point : mesh.points) height.values.push_back(point.z);
    mesh.attributes.push_back(std::move(height));
    return mesh;
}

/// direction: in which the box is seen
inline ViewState small_state(const Box& box, const Vec3& direction, Look look = Look::Volume) {
    return {.camera = fit_camera(box, direction), .width = 48, .height = 40, .look = {.look = look}};
}

inline double rms_difference(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t k = 0; k < a.rgba.size(); ++k) {
        const double d = double{a.rgba[k]} - double{b.rgba[k]};
        sum += d * d;
    }
    return std::sqrt(sum / static_cast<double>(a.rgba.size()));
}

}  // namespace subvol
