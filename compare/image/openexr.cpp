// SPDX-License-Identifier: Apache-2.0
#include "openexr.h"

#include "subvol/detail/module.h"

namespace subvol {

const detail::OpenExr& detail::openexr() {
    using Entry = const OpenExr* (*)();
    static const OpenExr& functions = *reinterpret_cast<Entry>(load_module("openexr", "reading or writing .exr pictures"))();
    return functions;
}

}  // namespace subvol
