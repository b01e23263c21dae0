// SPDX-License-Identifier: Apache-2.0
// One of the readers of meshes; what it reads has to be valid and fit to be measured, with either set of options.

#include "formats.h"
#include "input.h"
#include "subvol/mesh_report.h"

namespace subvol::fuzz {

using namespace detail;

namespace {

int read(std::string_view text, const ReadOptions& options) {
    return run([&] {
        const ReadResult result = SUBVOL_FUZZ_READER(text, "file", options);
        validate(result.mesh);
        validate(result.sets, result.mesh);
        static_cast<void>(inspect(result.mesh));
    });
}

}  // namespace

}  // namespace subvol::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    fuzz::read(fuzz::text_of(data, size), {});
    return fuzz::read(fuzz::text_of(data, size), {.other_cells = OtherCells::Ignore, .weld = 1e-3});
}
