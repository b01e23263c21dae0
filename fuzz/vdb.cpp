// SPDX-License-Identifier: Apache-2.0
// OpenVDB files: what the check lets pass, OpenVDB reads.

#include "input.h"
#include "subvol/vdb_contents.h"
#include "subvol/vdb_grid.h"
#include "subvol/vdb_points.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    const auto file = fuzz::as_file(data, size, ".vdb");
    fuzz::run([&] {
        for (const VdbGrid& grid : read_vdb(file)) static_cast<void>(grid.value({0, 0, 0}));
    });
    fuzz::run([&] { static_cast<void>(read_vdb_contents(file)); });
    return fuzz::run([&] { validate(read_vdb_points(file)); });
}
