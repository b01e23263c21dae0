// SPDX-License-Identifier: Apache-2.0
// The reader of Abaqus and CalculiX decks.

#include "formats.h"
#include "input.h"
#include "subvol/mesh_report.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    return fuzz::run([&] {
        const ReadResult result = detail::read_inp(fuzz::as_file(data, size, ".inp"), {});
        validate(result.mesh);
        static_cast<void>(inspect(result.mesh));
    });
}
