// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "mesh_file.h"
#include "subvol/read_options.h"

namespace subvol::detail {

/// VTK counts from 0.
inline constexpr EntityNames kVtkNames{"point", "cell", 0};

/// Sorts the cells of a VTK file into the kinds of cells that are read, and those that are left out.
class VtkCellSorter {
public:
    VtkCellSorter(const TextScanner& in, MeshFile& found, const ReadOptions& options)
        : in_(in), found_(found), options_(options) {}

    /// Adds the next cell.
    ///
    /// corners:  numbered through all pieces of the file
    /// position: of the cell in the text
    void take(std::int64_t type, std::span<const Index> corners, std::size_t position);

    /// The file is of a version in which Lagrange and Bézier hexahedra have VTK 8's order of nodes.
    void set_old_order() { old_order_ = true; }

    /// To be called after the last cell: appends warnings about cells that were left out or read as another kind.
    ///
    /// file: refused if it has no cells that are taken; nothing: that is allowed, and quads and lines are left out
    void report(std::optional<std::string_view> file);

private:
    /// Counts all quads and lines as left out: parts of a mesh have no shells.
    void take_no_shells();
    /// Keeps all nodes of a curved hexahedron. returns: whether its shape is known
    bool keep_curved(std::int64_t type, std::span<const Index> nodes);
    /// Adds the cell to `into`, with its first N corners. curved: it may have more points
    template <std::size_t N>
    void take_as(FileCells<N>& into, std::span<const Index> corners, std::size_t position, std::string_view kind, bool curved);

    const TextScanner& in_;
    MeshFile& found_;
    ReadOptions options_;
    std::size_t next_ = 0;  // the number of the cell that comes next
    std::size_t mislabelled_ = 0;
    bool old_order_ = false;
    std::size_t curved_ = 0;  // cells of which only the corners are used
    std::map<std::int64_t, std::size_t> left_out_;
};

}  // namespace subvol::detail
