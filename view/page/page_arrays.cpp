// SPDX-License-Identifier: Apache-2.0
#include "page_arrays.h"

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

}  // namespace subvol::detail
