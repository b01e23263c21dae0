// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

#include "subvol/image.h"
#include "subvol/placed_image.h"

namespace subvol::python {

/// What a renderer returns to Python: the class Image there. report: counts and seconds, under the names of the command's JSON;
/// camera: its numbers, for the header of a file; part: the windows of a file that has a part of a picture
struct Picture {
    Image image;
    std::vector<float> depth{};
    pybind11::dict report{};
    std::string camera{};
    struct Windows {
        PixelWindow data, display;
    };
    std::optional<Windows> part{};

    [[nodiscard]] Windows windows() const {
        const PixelWindow whole{0, 0, image.width, image.height};
        return part.value_or(Windows{whole, whole});
    }
};

}  // namespace subvol::python
