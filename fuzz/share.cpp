// SPDX-License-Identifier: Apache-2.0
// Shares of a surface: a file of one (what follows the letter f), else the bytes that are in it, joined alone and after a good
// one.

#include <array>

#include "input.h"
#include "subvol/detail/surface_share.h"
#include "subvol/model.h"

namespace subvol::fuzz {

namespace {

std::string first_share() {
    const HexMesh mesh = make_model("ball", 2);
    return detail::share_of_surface(mesh, "density", {.isos = {.5}}, {.number = 1, .count = 2}).bytes;
}

}  // namespace

}  // namespace subvol::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    if (size > 0 && data[0] == 'f') {
        return fuzz::run([&] {
            static_cast<void>(detail::read_surface_share(fuzz::as_file(data + 1, size - 1, detail::kSurfaceShareExtension)));
        });
    }
    static const std::string first = fuzz::first_share();
    const std::array<std::string, 2> names{"a", "b"};
    const std::string bytes(fuzz::text_of(data, size));
    fuzz::run([&] { static_cast<void>(detail::join_surface({bytes}, std::span(names).first(1))); });
    return fuzz::run([&] { static_cast<void>(detail::join_surface({first, bytes}, names)); });
}
