// SPDX-License-Identifier: Apache-2.0
// The reader of CGNS on any nodes.

#include "formats.h"
#include "solver_readers.h"

#include "hdf5_lines.h"
#include "subvol/mesh_report.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    return fuzz::run([&] {
        const detail::Hdf5File file(std::make_unique<fuzz::Lines>(fuzz::text_of(data, size), "/", "/ data"), "file");
        ReadResult result = detail::read_cgns(file, {});
        detail::check_read(result, "file");
        static_cast<void>(inspect(result.mesh));
    });
}
