// SPDX-License-Identifier: Apache-2.0
// Tables of places, and of what was measured there.

#include "input.h"
#include "places_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    const std::string file = fuzz::as_file(data, size, ".csv").string();
    fuzz::run([&] { static_cast<void>(cli::read_places(file)); });
    return fuzz::run([&] {
        const HexMesh samples = cli::read_samples(file);
        for (const Attribute& field : samples.attributes) {
            fuzz::check(field.values.size() == samples.points.size() * static_cast<std::size_t>(field.channels));
        }
    });
}
