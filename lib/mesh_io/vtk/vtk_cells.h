// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "mesh_file.h"
#include "subvol/mesh_io.h"

namespace subvol::detail {

/// How VTK counts: from 0.
inline constexpr EntityNames kVtkNames{"point", "cell", 0};

/// Sorts the cells of VTK by what can be done with them.
class VtkCellSorter {
public:
    VtkCellSorter(const TextScanner& in, MeshFile& found, const ReadOptions& options)
        : in_(in), found_(found), options_(options) {}

    /// Takes the cell that comes next; its points are already counted through all pieces. position: its place in the text
    void take(std::int64_t type, std::span<const Index> corners, std::size_t position);

    /// Behind the last piece: tells what was left out or taken for something else.
    void report(std::string_view file);

private:
    /// As the kind of cell that `into` holds, of the first N corners. curved: more points may follow
    template <std::size_t N>
    void take_as(FileCells<N>& into, std::span<const Index> corners, std::size_t position, std::string_view kind, bool curved);

    const TextScanner& in_;
    MeshFile& found_;
    ReadOptions options_;
    std::size_t next_ = 0;  // the number of the cell that comes next
    std::size_t mislabelled_ = 0;
    std::size_t curved_ = 0;  // cells with points in the middle of their edges
    std::map<std::int64_t, std::size_t> left_out_;
};

}  // namespace subvol::detail
