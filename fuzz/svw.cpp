// SPDX-License-Identifier: Apache-2.0
// Files of steps before compression: the first byte says which part of which good file the rest is. It is packed into a file
// again, with the hashes of what is then there.

#include "input.h"
#include "io/series/series_parts.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_report.h"
#include "svw_parts.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    static const test::SeriesParts small = fuzz::good_steps(), refined = fuzz::refined_steps();
    const char letter = size == 0 ? 'i' : static_cast<char>(data[0]);
    test::SeriesParts parts = fuzz::is_of_refined(letter) ? refined : small;
    if (std::string* const part = size == 0 ? nullptr : fuzz::part_of(parts, letter)) {
        *part = fuzz::text_of(data + 1, size - 1);
    }
    const std::string packed = parts.packed();
    const auto file = fuzz::as_file(reinterpret_cast<const std::uint8_t*>(packed.data()), packed.size(), ".svw");
    for (const std::size_t step : {std::size_t{0}, parts.steps.size() - 1}) {
        fuzz::run([&] { static_cast<void>(inspect(read_mesh(file, {.step = step}).mesh)); });
    }
    return 0;
}
