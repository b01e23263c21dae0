// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common_options.h"
#include "subvol/error.h"
#include "subvol/facts.h"
#include "subvol/mesh_io.h"

namespace subvol::cli {

/// A field that is asked for is not in a file, or not in this step of it.
struct NoSuchField : Error {
    explicit NoSuchField(const Error& error) : Error(error) {}
};

/// throws: NoSuchField with the reason, if a field is asked for that could not be read
void refuse_unread(const ReadResult& read, const std::string& input, const CommonOptions& options);

/// Gives the mesh the fields with gaps that are asked for, and leaves the cells that have them.
///
/// throws: Error(InvalidInput) if no cell has all of them
[[nodiscard]] Facts take_incomplete(ReadResult& read, const std::string& input, const CommonOptions& options);

}  // namespace subvol::cli
