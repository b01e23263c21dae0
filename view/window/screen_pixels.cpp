// SPDX-License-Identifier: Apache-2.0
#include "screen_pixels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "subvol/srgb.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kFine = 4096;

/// For each interval of square roots of linear light the byte at its lower end; from there a byte or two up are left to try.
struct Encoder {
    std::array<double, 256> first{};  // the least linear light that becomes the byte
    std::array<std::uint8_t, kFine + 1> near{};

    Encoder() {
        for (std::size_t k = 1; k < 256; ++k) first[k] = linear_from_srgb((static_cast<double>(k) - 0.5) / 255);
        for (std::size_t k = 0; k <= kFine; ++k) {
            const double root = static_cast<double>(k) / kFine;
            near[k] =
                static_cast<std::uint8_t>(std::upper_bound(first.begin() + 1, first.end(), root * root) - first.begin() - 1);
        }
    }

    [[nodiscard]] std::uint8_t operator()(double linear) const {
        if (!(linear > 0)) return 0;
        if (linear >= 1) return 255;
        std::size_t byte = near[static_cast<std::size_t>(std::sqrt(linear) * kFine)];
        while (byte < 255 && linear >= first[byte + 1]) ++byte;
        return static_cast<std::uint8_t>(byte);
    }
};

}  // namespace

std::vector<std::uint8_t> screen_pixels(const Image& image, const Vec3& background) {
    static const Encoder encode;
    std::vector<std::uint8_t> bytes(image.rgba.size());
    tbb::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x) {
            const auto pixel = image.pixel(x, y);
            std::uint8_t* const byte = bytes.data() + (pixel.data() - image.rgba.data());
            const double through = 1.0 - static_cast<double>(pixel[3]);
            for (std::size_t c = 0; c < 3; ++c)
                byte[c] = encode(static_cast<double>(pixel[c]) + through * background[static_cast<int>(c)]);
            byte[3] = 255;
        }
    });
    return bytes;
}

}  // namespace subvol::detail
