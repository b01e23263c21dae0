// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

#include "subvol/image.h"
#include "subvol/placed_image.h"

namespace subvol::python {

/// What a renderer returns to Python: the class Image there.
struct Picture {
    Image image;
    std::vector<float> depth{};
    pybind11::dict report{};  ///< counts and seconds, under the names of the command's JSON
    std::string camera{};     ///< the camera's numbers, for the header of a file
    struct Windows {
        PixelWindow data, display;
    };
    std::optional<Windows> part{};  ///< the windows, for a file that has a part of a picture

    [[nodiscard]] Windows windows() const {
        const PixelWindow whole{0, 0, image.width, image.height};
        return part.value_or(Windows{whole, whole});
    }
};

}  // namespace subvol::python
