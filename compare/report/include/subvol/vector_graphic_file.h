// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "subvol/vector_graphic.h"

namespace subvol {

/// Writes a vector graphic as `.svg`, or as a page of `.pdf` of its size with the fonts embedded and without a date. The file
/// appears whole under its name or not at all.
///
/// title:  of the document
/// throws: Error(InvalidInput) for another extension, Error(Io), Error(MissingCapability) if a .pdf needs the module of cairo
///         and it is not installed
void write_vector_graphic(const std::filesystem::path& path, const VectorGraphic& graphic, const std::string& title = {});

}  // namespace subvol
