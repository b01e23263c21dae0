// SPDX-License-Identifier: Apache-2.0
// Surfaces of triangles, .stl, .obj, .ply or .glb: all corners of what is read are points of it.

#include "input.h"
#include "subvol/read_surface.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return subvol::fuzz::run([&] {
        const subvol::Surface surface = subvol::read_surface(subvol::fuzz::as_file(data, size, SUBVOL_FUZZ_EXTENSION));
        subvol::fuzz::check(!surface.triangles.empty());
        for (const auto& triangle : surface.triangles) {
            for (const subvol::Index corner : triangle) subvol::fuzz::check(corner < surface.points.size());
        }
    });
}
