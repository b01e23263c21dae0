// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/glb_file.h"

#include <cstdint>
#include <cstring>

namespace subvol::detail {

std::string glb_head(std::string json, std::size_t bytes) {
    json.append((4 - json.size() % 4) % 4, ' ');
    std::string head;
    const auto put = [&](std::size_t number) {
        for (int byte = 0; byte < 4; ++byte) head += static_cast<char>(number >> (8 * byte) & 0xFF);
    };
    constexpr std::uint32_t kGltf = 0x46546C67, kVersion = 2, kJson = 0x4E4F534A, kBin = 0x004E4942;  // "glTF", "JSON", "BIN"
    put(kGltf);
    put(kVersion);
    put(12 + 8 + json.size() + 8 + bytes);
    put(json.size());
    put(kJson);
    head += json;
    put(bytes);
    put(kBin);
    return head;
}

}  // namespace subvol::detail
