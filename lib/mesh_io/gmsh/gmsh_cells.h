// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string_view>
#include <utility>

#include "gmsh_elements.h"
#include "gmsh_numbers.h"
#include "gmsh_values.h"
#include "mesh_file.h"
#include "subvol/mesh_io.h"

namespace subvol::detail {

/// 1 to 3; other elements than lines, triangles and quads count as solid.
[[nodiscard]] std::int64_t dimension_of(const GmshElement& element);

/// Puts the elements of a Gmsh file where they belong: cells, sheets and curves, tags of sharp groups. Counts what is left out.
class GmshCells {
public:
    /// All are referred to.
    GmshCells(TextScanner& in, GmshValues& values, const GmshNumbers& nodes, const ReadOptions& options, MeshFile& found)
        : in_(in), values_(values), nodes_(nodes), options_(options), found_(found) {}

    /// Reads the nodes of an element.
    ///
    /// number:  in the order of the file, from 0
    /// sharp:   whether it is in a group that the user wants to be sharp
    /// type:    of the nodes' numbers
    /// returns: whether it is read as a cell
    bool take(const GmshElement& element, std::size_t number, bool sharp, NumberType type, const Place& place);

    /// To be called after the last element: warnings of what is left out.
    void list_left_out(std::string_view file);

private:
    Index read_corner(const Place& place, NumberType type);
    void take_tag(const GmshElement& element, NumberType type, const Place& place);
    template <std::size_t N>
    void take_sheet(FileCells<N>& into, const GmshElement& element, std::size_t number, NumberType type, const Place& place);
    template <std::size_t N>
    bool take_as(FileCells<N>& into, const GmshElement& element, std::size_t number, NumberType type, const Place& place);
    void leave_out(const GmshElement& element, std::size_t how_many);

    TextScanner& in_;
    GmshValues& values_;
    const GmshNumbers& nodes_;
    const ReadOptions& options_;
    MeshFile& found_;
    std::size_t curved_ = 0;
    std::map<std::string_view, std::pair<std::size_t, std::string_view>> left_out_;
};

}  // namespace subvol::detail
