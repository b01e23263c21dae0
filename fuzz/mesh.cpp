// SPDX-License-Identifier: Apache-2.0
// A format of meshes, as `read_mesh` reads it, with either set of options; what it returns is fit to be measured.

#include "input.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    const auto file = fuzz::as_file(data, size, SUBVOL_FUZZ_EXTENSION);
    const auto read = [&](const ReadOptions& options) {
        return fuzz::run([&] { static_cast<void>(inspect(read_mesh(file, options).mesh)); });
    };
    read({});
    return read({.other_cells = OtherCells::Ignore, .weld = 1e-3});
}
