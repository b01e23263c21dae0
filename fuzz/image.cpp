// SPDX-License-Identifier: Apache-2.0
// Pictures, as `compare` reads them: what is read has all of its pixels.

#include "input.h"
#include "subvol/placed_image.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return subvol::fuzz::run([&] {
        const auto read = subvol::read_placed_image(subvol::fuzz::as_file(data, size, SUBVOL_FUZZ_EXTENSION));
        const auto width = static_cast<std::size_t>(read.image.width), height = static_cast<std::size_t>(read.image.height);
        subvol::fuzz::check(width > 0 && height > 0 && read.image.rgba.size() == 4 * width * height);
    });
}
