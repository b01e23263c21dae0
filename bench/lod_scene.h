// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <string>

#include "subvol/camera.h"
#include "subvol/mesh_io.h"
#include "subvol/model.h"
#include "subvol/optics.h"
#include "subvol/quantity.h"

namespace subvol::bench {

/// The least of several runs.
template <class Work>
double cpu_seconds_of(const Work& work, int repeats) {
    double best = 1e30;
    for (int i = 0; i < repeats; ++i) {
        const std::clock_t begin = std::clock();
        work();
        best = std::min(best, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    }
    return best;
}

/// A model, NAME or NAME:RESOLUTION, or a file's mesh with a field of waves, in a box of diagonal 2.
inline HexMesh mesh_named(const std::string& name) {
    const std::size_t colon = name.find(':');
    const std::string model = name.substr(0, colon);
    for (const auto& known : list_models()) {
        if (known.name == model) return make_model(model, colon == std::string::npos ? 0 : std::atoi(name.c_str() + colon + 1));
    }
    HexMesh mesh = read_mesh(name).mesh;
    const Vec3 scale = Vec3(2 / bounds(mesh).diagonal()), middle = bounds(mesh).center();
    for (Vec3& p : mesh.points) p = scale * (p - middle);
    mesh.attributes = {field_of(mesh, "f", "sin(9*x)+cos(11*y)*z")};
    return mesh;
}

/// distance: 1 where the box fills the picture
inline View view_at(const Box& box, double distance, int size) {
    Camera camera = fit_camera(box, Vec3(-1, 1, -.6));
    camera.eye = camera.target + distance * (camera.eye - camera.target);
    return {camera, size, size};
}

/// Colours and opacities with a narrow peak in the middle of the range.
inline Optics optics_with_peak(double low, double high, const Box& box) {
    const double mid = 0.5 * (low + high), peak = 0.05 * (high - low);
    return Optics({.color = {{low, {.1, .2, .9}}, {mid, {.9, .9, .9}}, {high, {.9, .2, .1}}},
                   .opacity = {{low, 0}, {mid - peak, 0.01}, {mid, .8}, {mid + peak, .02}, {high, .1}}},
                  box.diagonal() / 100);
}

inline Optics optics_with_peak(const HexMesh& mesh) {
    const auto [low, high] = std::ranges::minmax(mesh.attributes[0].values);
    return optics_with_peak(low, high, bounds(mesh));
}

}  // namespace subvol::bench
