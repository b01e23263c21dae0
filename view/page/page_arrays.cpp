// SPDX-License-Identifier: Apache-2.0
#include "page_arrays.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "subvol/detail/vtu_bytes.h"

namespace subvol::detail {

int PageArrays::add(std::span<double> values, std::size_t components, int bits) {
    const std::size_t count = values.size() / components;
    const double steps = std::ldexp(1.0, bits) - 1;
    PageJson low = PageJson::array(), step = PageJson::array();
    std::vector<std::uint32_t> numbers(values.size());
    for (std::size_t c = 0; c < components; ++c) {
        double least = count ? values[c] : 0, most = least;
        for (std::size_t i = 0; i < count; ++i) {
            least = std::min(least, values[i * components + c]);
            most = std::max(most, values[i * components + c]);
        }
        const double size = most > least ? (most - least) / steps : 1;
        for (std::size_t i = 0; i < count; ++i) {
            double& value = values[i * components + c];
            const double number = std::clamp(std::round((value - least) / size), 0.0, steps);
            numbers[c * count + i] = static_cast<std::uint32_t>(number);
            value = least + number * size;
        }
        low.push_back(least);
        step.push_back(size);
    }
    const int bytes_each = bits > 16 ? 3 : 2;
    directory_.push_back({{"at", bytes_.size()},
                          {"count", count},
                          {"components", components},
                          {"bytes", bytes_each},
                          {"low", low},
                          {"step", step}});
    append(numbers, bytes_each);
    return static_cast<int>(directory_.size()) - 1;
}

int PageArrays::add_integers(std::span<const std::uint32_t> values, std::size_t components) {
    const std::size_t count = values.size() / components;
    std::vector<std::uint32_t> numbers(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) numbers[i % components * count + i / components] = values[i];
    directory_.push_back({{"at", bytes_.size()}, {"count", count}, {"components", components}, {"bytes", 4}});
    append(numbers, 4);
    return static_cast<int>(directory_.size()) - 1;
}

void PageArrays::append(std::span<const std::uint32_t> numbers, int bytes_each) {
    std::vector<std::uint32_t> changes(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) changes[i] = numbers[i] - (i > 0 ? numbers[i - 1] : 0);
    for (int byte = 0; byte < bytes_each; ++byte) {
        for (const std::uint32_t change : changes) bytes_.push_back(static_cast<char>(change >> (8 * byte) & 255));
    }
}

std::string PageArrays::compressed() const {
    return deflated(bytes_);
}

std::string deflated(std::string_view bytes) {
    return zlib_compressed(bytes, 6);
}

namespace {

void put_word(std::string& to, std::uint32_t word) {
    for (int shift = 24; shift >= 0; shift -= 8) to.push_back(static_cast<char>(word >> shift & 255));
}

void put_chunk(std::string& to, const std::string& name, const std::string& content) {
    put_word(to, static_cast<std::uint32_t>(content.size()));
    const std::string checked = name + content;
    to += checked;
    const auto* bytes = reinterpret_cast<const Bytef*>(checked.data());
    put_word(to, static_cast<std::uint32_t>(crc32(0, bytes, static_cast<uInt>(checked.size()))));
}

}  // namespace

std::string png_bytes(int width, int height, std::span<const std::uint8_t> rgb) {
    const std::size_t row = 3 * static_cast<std::size_t>(width);
    std::string lines;
    for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
        lines.push_back(1);  // each byte less the one of the pixel before
        for (std::size_t x = 0; x < row; ++x) {
            const int before = x < 3 ? 0 : rgb[y * row + x - 3];
            lines.push_back(static_cast<char>(rgb[y * row + x] - before));
        }
    }
    std::string head;
    put_word(head, static_cast<std::uint32_t>(width));
    put_word(head, static_cast<std::uint32_t>(height));
    head += std::string("\x08\x02\0\0\0", 5);  // 8 bits, RGB
    std::string png = "\x89PNG\r\n\x1a\n";
    put_chunk(png, "IHDR", head);
    put_chunk(png, "IDAT", deflated(lines));
    put_chunk(png, "IEND", "");
    return png;
}

}  // namespace subvol::detail
