// SPDX-License-Identifier: Apache-2.0
// Files of points, .ply or .vtp; what is read has to be valid.

#include "input.h"
#include "subvol/points_io.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return subvol::fuzz::run([&] { validate(subvol::read_points(subvol::fuzz::as_file(data, size, SUBVOL_FUZZ_EXTENSION))); });
}
