// SPDX-License-Identifier: Apache-2.0
// The reader of VTKHDF on any datasets.

#include "formats.h"

#include "hdf5_lines.h"
#include "subvol/mesh_report.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    return fuzz::run([&] {
        const detail::Hdf5File file(std::make_unique<fuzz::Lines>(fuzz::text_of(data, size), "/VTKHDF/"), "file");
        static_cast<void>(detail::vtkhdf_times(file));
        ReadResult result = detail::read_vtkhdf(file, {});
        detail::check_read(result, "file");
        static_cast<void>(inspect(result.mesh));
    });
}
