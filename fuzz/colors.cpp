// SPDX-License-Identifier: Apache-2.0
// Colour maps in ParaView's JSON, and opacities in a line (what follows a zero byte).

#include "input.h"
#include "subvol/transfer_function.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return subvol::fuzz::run([&] {
        if (size > 0 && data[0] == 0) {
            static_cast<void>(subvol::parse_opacity(std::string(subvol::fuzz::text_of(data + 1, size - 1)), 0, 1));
        } else {
            static_cast<void>(subvol::read_transfer_function(subvol::fuzz::as_file(data, size, ".json")));
        }
    });
}
