// SPDX-License-Identifier: Apache-2.0
// Expressions in x, y, z.

#include <array>

#include "input.h"
#include "subvol/expression.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr std::array<subvol::Vec3, 2> kPoints{{{0, 0, 0}, {1, -2, 3.5}}};
    return subvol::fuzz::run(
        [&] { static_cast<void>(subvol::evaluate_expression(std::string(subvol::fuzz::text_of(data, size)), kPoints)); });
}
