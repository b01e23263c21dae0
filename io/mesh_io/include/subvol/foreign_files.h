// SPDX-License-Identifier: Apache-2.0
// Files of other programs that the library does not read, but meshio or VTK do, Python's packages. The library knows their
// names, and takes what they are converted to; a program that wants such files read runs the converter, in a process of its
// own.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace subvol {

/// A format that meshio or VTK reads.
///
/// endings:  of file names, in lower case; one without a point is a whole name, such as "d3plot"
/// program:  whose files they are, "Nastran"
/// by:       what reads them: "meshio", "VTK" or "meshio or VTK"
/// packages: Debian's packages with it: "python3-meshio, python3-vtk9"
/// steps:    whether a file may have several steps
struct ForeignFormat {
    std::vector<std::string> endings;
    std::string program, by, packages;
    bool steps = false;
};

/// Returns all such formats.
[[nodiscard]] const std::vector<ForeignFormat>& foreign_formats();

/// Returns the format that a file's name has the ending of, in upper or lower case; null if there is none.
[[nodiscard]] const ForeignFormat* foreign_format(const std::filesystem::path& path);

/// Returns the text of the converter, a program in Python: SOURCE TARGET.vtu [--step K], or SOURCE --times. It prints an object
/// in JSON and ends with 0, with 2 if the file cannot be read, or with 3 if packages are missing.
[[nodiscard]] std::string_view foreign_program();

/// A file of another program as it was converted.
///
/// vtu:      the text of a `.vtu` file; empty if only the times were asked for
/// times:    of the steps; empty if there is one step
/// warnings: sentences: what read it, and what was left out
struct ForeignFile {
    std::string vtu;
    std::vector<double> times;
    std::vector<std::string> warnings;
};

/// What to convert of a file: one step (nothing: the last one), or none, if only the times are asked for.
struct ForeignRequest {
    std::optional<std::size_t> step{};
    bool only_times = false;
};

/// Converts a file whose name is of a `foreign_format`.
///
/// throws: Error(InvalidInput) if it cannot be read, Error(MissingCapability) if a package is missing, Error(Cancelled)
using ForeignReader = std::function<ForeignFile(const std::filesystem::path&, const ForeignRequest&)>;

/// From now on `read_mesh`, `open_series`, `is_mesh_file` and what calls them take files of other programs, too: those with
/// such a name whose first bytes are not beyond doubt of a format of the library. To be called once, before any file is read:
/// which formats can be read is one for a whole program, as the library's own table is. An empty reader ends it.
void read_foreign_files(ForeignReader reader);

}  // namespace subvol
