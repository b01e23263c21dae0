// SPDX-License-Identifier: Apache-2.0
// The contents of a .svw file as they are before compression; what is read has to be valid and fit to be measured.

#include "formats.h"
#include "input.h"
#include "subvol/mesh_report.h"
#include "wavelet_format.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    return fuzz::run([&] {
        ReadResult result;
        result.mesh = detail::mesh_of_wavelets(fuzz::text_of(data, size), "file");
        detail::check_read(result, "file");
        static_cast<void>(inspect(result.mesh));
    });
}
