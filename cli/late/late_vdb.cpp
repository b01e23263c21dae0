// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/module.h"
#include "vdb_functions.h"

namespace subvol::cli {

const VdbFunctions& vdb() {
    using ModuleEntry = const VdbFunctions* (*)();
    static const VdbFunctions& functions = []() -> const VdbFunctions& {
        const auto& loaded =
            *reinterpret_cast<ModuleEntry>(detail::load_module("openvdb", "reading, writing or computing grids"))();
        detail::remove_unfinished_files_of(loaded.remove_unfinished_files);
        return loaded;
    }();
    return functions;
}

}  // namespace subvol::cli
