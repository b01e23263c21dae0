// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace subvol::cli {

/// From now on files of other programs (Nastran, MED, LS-DYNA, Fluent, Tecplot and others) are read wherever meshes are:
/// python3 converts them by meshio or VTK, in a child process, and a warning says so. The first python3 of the path is taken,
/// and Debian's where that one lacks a package.
void read_foreign_inputs();

}  // namespace subvol::cli
