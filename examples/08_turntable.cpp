// SPDX-License-Identifier: Apache-2.0
// Your own transfer function, and a turn around the volume. Writes turn_0.png to turn_7.png and legend.svg.

#include <algorithm>
#include <cstdio>
#include <string>

#include "subvol/compare.h"
#include "subvol/render.h"
#include "subvol/subvol.h"

int main() try {
    const subvol::HexMesh mesh = subvol::make_model("nozzle", 24);
    const subvol::Box box = bounds(mesh);

    // Colours in linear light and opacities, each linear between its knots: two shells of equal speed, the fast one red.
    const subvol::TransferFunction shells{.color = {{-1, {.1, .2, .8}}, {0, {.8, .8, .8}}, {1, {.8, .1, .1}}},
                                          .opacity = {{-.3, 0}, {-.25, .3}, {-.2, 0}, {.5, 0}, {.55, .8}, {.6, 0}}};
    const subvol::Optics optics(shells, box.diagonal() / 100);

    subvol::write_legend("legend.svg", shells, {.title = "speed", .min = -1, .max = 1});

    // The work that all pictures share is done once.
    const subvol::RbfVolume volume = subvol::sample_rbf_points(mesh, {.per_edge = 2}).volume;
    subvol::Splatter splatter(volume);
    const subvol::Camera camera = fit_turntable(subvol::parse_camera("iso", box), box, 8);
    int frame = 0;
    bool all_show_it = true;
    for (const subvol::Camera& turned : turntable(camera, box.center(), 8)) {
        const subvol::Image picture = splatter.draw(subvol::View(turned, 160, 160), optics).image;
        subvol::write_image("turn_" + std::to_string(frame++) + ".png", picture, subvol::Vec3(1.0));
        float most = 0;
        for (std::size_t i = 3; i < picture.rgba.size(); i += 4) most = std::max(most, picture.rgba[i]);
        all_show_it = all_show_it && most > .5F;
        std::printf("frame %d: at most %.2f opaque\n", frame, static_cast<double>(most));
    }
    return all_show_it && frame == 8 ? 0 : 1;
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
