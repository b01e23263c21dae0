// SPDX-License-Identifier: Apache-2.0
#include "subvol/placed_image.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "subvol/error.h"

namespace subvol {

namespace {

std::string size_of(const PixelWindow& window) {
    return std::to_string(window.width) + " x " + std::to_string(window.height);
}

std::string first_of(const PixelWindow& window) {
    return "(" + std::to_string(window.left) + ", " + std::to_string(window.top) + ")";
}

std::string name_of(const PlacedImage& picture, const char* otherwise) {
    return picture.name.empty() ? otherwise : picture.name;
}

[[noreturn]] void refuse_other_display(const PlacedImage& a, const PlacedImage& b) {
    const std::string first = name_of(a, "the first picture"), second = name_of(b, "the second picture");
    const auto from_zero = [](const PlacedImage& picture) {
        return picture.whole() && picture.display_window.left == 0 && picture.display_window.top == 0;
    };
    if (from_zero(a) && from_zero(b)) {
        throw Error(ErrorCode::InvalidInput,
                    "has " + size_of(a.display_window) + " pixels, " + second + " has " + size_of(b.display_window), first,
                    "only pictures of the same size can be compared");
    }
    const auto described = [](const PlacedImage& picture) {
        return (picture.whole() ? "a picture of " : "part of a picture of ") + size_of(picture.display_window) +
               " pixels from " + first_of(picture.display_window);
    };
    throw Error(ErrorCode::InvalidInput, "is " + described(a) + ", " + second + " is " + described(b), first,
                "pictures with the same display window can be compared");
}

/// 64 bits: windows are from files, which may have any int.
std::int64_t end_of(int begin, int length) {
    return std::int64_t{begin} + length;
}

PixelWindow intersection(const PixelWindow& a, const PixelWindow& b) {
    const int left = std::max(a.left, b.left), top = std::max(a.top, b.top);
    const std::int64_t right = std::min(end_of(a.left, a.width), end_of(b.left, b.width));
    const std::int64_t bottom = std::min(end_of(a.top, a.height), end_of(b.top, b.height));
    if (right <= left || bottom <= top) return {};
    return {left, top, static_cast<int>(right - left), static_cast<int>(bottom - top)};
}

Image cut(PlacedImage picture, const PixelWindow& window) {
    if (picture.data_window == window) return std::move(picture.image);
    Image part(window.width, window.height);
    for (int y = 0; y < window.height; ++y) {
        const auto from = picture.image.pixel(window.left - picture.data_window.left, window.top - picture.data_window.top + y);
        std::copy_n(from.data(), 4 * static_cast<std::size_t>(window.width), part.pixel(0, y).data());
    }
    return part;
}

}  // namespace

PlacedImage whole_image(Image image, std::string name) {
    const PixelWindow window{0, 0, image.width, image.height};
    return {std::move(image), window, window, std::move(name)};
}

CommonPixels common_pixels(PlacedImage a, PlacedImage b) {
    if (a.display_window != b.display_window) refuse_other_display(a, b);
    const PixelWindow window = intersection(a.data_window, b.data_window);
    if (window.width == 0) {
        throw Error(ErrorCode::InvalidInput,
                    "its " + size_of(a.data_window) + " pixels from " + first_of(a.data_window) + " and the " +
                        size_of(b.data_window) + " from " + first_of(b.data_window) + " of " +
                        name_of(b, "the second picture") + " have no pixel in common",
                    name_of(a, "the first picture"), "parts of a picture are compared where they overlap");
    }
    return {cut(std::move(a), window), cut(std::move(b), window), window};
}

}  // namespace subvol
