// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "subvol/surface.h"

namespace subvol::detail {

class OutputFile;

/// The file for the boundary of points if their own file has no place for it: NAME.boundary.vtp for NAME.vtp.
[[nodiscard]] std::filesystem::path boundary_path(const std::filesystem::path& points);

/// The file with the boundary of points. The constructor writes it, `commit` gives it its name; without a commit it is removed.
/// A boundary without triangles gets no file.
///
/// throws: Error(Io)
class BoundaryFile {
public:
    BoundaryFile(const std::filesystem::path& points, const Surface& boundary);
    ~BoundaryFile();
    BoundaryFile(const BoundaryFile&) = delete;
    BoundaryFile& operator=(const BoundaryFile&) = delete;

    void commit();

private:
    std::unique_ptr<OutputFile> file_;
};

/// Reads the boundary of points. triangles: their number when the points were written
///
/// returns: an empty surface if the file does not exist, or if there were no triangles
/// throws:  Error(Io); Error(InvalidInput) if the file is malformed, or has another number of triangles and so belongs to other
///          points
[[nodiscard]] Surface read_boundary(const std::filesystem::path& points, std::size_t triangles);

}  // namespace subvol::detail
