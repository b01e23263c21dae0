// SPDX-License-Identifier: Apache-2.0
// Files of steps before compression: the first byte says which part of a good file the rest is. It is packed into a file again.

#include "input.h"
#include "lib/wavelet/series_parts.h"
#include "subvol/mesh_report.h"
#include "svw_parts.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    static const test::SeriesParts good = fuzz::good_steps();
    test::SeriesParts parts = good;
    if (std::string* const part = size == 0 ? nullptr : fuzz::part_of(parts, static_cast<char>(data[0]))) {
        *part = fuzz::text_of(data + 1, size - 1);
    }
    const std::string packed = parts.packed();
    const auto file = fuzz::as_file(reinterpret_cast<const std::uint8_t*>(packed.data()), packed.size(), ".svw");
    for (const std::size_t step : {0u, 2u}) {
        fuzz::run([&] { static_cast<void>(inspect(detail::read_series_file(file, step).mesh)); });
    }
    return 0;
}
