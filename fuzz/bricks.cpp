// SPDX-License-Identifier: Apache-2.0
// The index of a folder of bricks; what was read is written as a text that is read as the same.

#include "brick_index.h"
#include "input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    const std::string text(fuzz::text_of(data, size));
    fuzz::run([&] { static_cast<void>(detail::bricks_from_json(text, "index", true)); });
    return fuzz::run([&] {
        const std::string again = detail::bricks_to_json(detail::bricks_from_json(text, "index"));
        fuzz::check(detail::bricks_to_json(detail::bricks_from_json(again, "index")) == again);
    });
}
