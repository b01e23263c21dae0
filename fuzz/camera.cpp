// SPDX-License-Identifier: Apache-2.0
// Cameras as JSON, and as ten numbers (what follows a zero byte).

#include "subvol/camera.h"
#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return subvol::fuzz::run([&] {
        const bool numbers = size > 0 && data[0] == 0;
        const std::string text = numbers ? std::string(subvol::fuzz::text_of(data + 1, size - 1))
                                         : subvol::fuzz::as_file(data, size, ".json").string();
        static_cast<void>(subvol::parse_camera(text, {{-1, -1, -1}, {1, 1, 1}}));
    });
}
