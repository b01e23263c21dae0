// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace subvol::detail {

/// Loads the module subvol_NAME.so: the part of this library that uses a large library of others, in a file of its own, so that
/// a program only loads that library when it needs it. The module stays loaded.
///
/// purpose: what the module is for: the beginning of the message, "reading and writing pictures"
/// returns: the address of the module's function `subvol_NAME`; the caller knows its type
/// throws:  Error(MissingCapability) if the module is not in the folders where the program or library that contains this code
///          looks for libraries (RUNPATH, LD_LIBRARY_PATH, the system's), if it cannot be loaded, or if it is of another
///          version
[[nodiscard]] void* load_module(const std::string& name, const std::string& purpose);

}  // namespace subvol::detail
