// SPDX-License-Identifier: Apache-2.0
// Kernels as JSON; one that is taken has to be written and read back.

#include "subvol/kernel.h"
#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return subvol::fuzz::run([&] {
        const subvol::Kernel kernel = subvol::kernel_from_json(subvol::fuzz::text_of(data, size));
        static_cast<void>(subvol::kernel_from_json(subvol::to_json(kernel)));
    });
}
