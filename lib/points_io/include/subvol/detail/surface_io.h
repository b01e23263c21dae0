// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "subvol/surface.h"

namespace subvol::detail {

class OutputFile;

/// Where the boundary of points stands that their own file does not hold: NAME.boundary.vtp for NAME.vtp.
[[nodiscard]] std::filesystem::path boundary_path(const std::filesystem::path& points);

/// The boundary beside a file of points. The constructor writes it, `commit` gives it its name; without that nothing is left.
/// No triangles, no file.
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

/// Reads it. triangles: how many there were as the points were written
///
/// returns: an empty surface if the file is not there, or if there were no triangles
/// throws:  Error(Io), Error(InvalidInput) if it is malformed or has another number of triangles: it belongs to other points
[[nodiscard]] Surface read_boundary(const std::filesystem::path& points, std::size_t triangles);

}  // namespace subvol::detail
