#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "mesh_file.h"

namespace subvol {

/// The cells of a VTK file or of a piece of one.
///
/// offsets:   corners of cell c: connectivity[offsets[c] .. offsets[c + 1])
/// positions: of each cell in the text; the last one stands for all that follow
struct VtkCells {
    std::vector<std::size_t> offsets{0};
    std::vector<Index> connectivity;
    std::vector<std::int64_t> types;
    std::vector<std::size_t> positions;

    [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
};

/// How VTK counts: from 0.
inline constexpr Wording kVtkWording{"point", "cell", 0};

/// Sorts the cells of VTK by what can be done with them.
class VtkCellSorter {
public:
    VtkCellSorter(const TextScanner& in, MeshFile& found, const ReadOptions& options)
        : in_(in), found_(found), options_(options) {}

    /// Takes the cells of one piece; their points are already counted through all pieces.
    void take(const VtkCells& cells);

    /// Behind the last piece: tells what was left out or taken for something else.
    void report(std::string_view file);

private:
    void take_cell(const VtkCells& cells, std::size_t cell);
    /// As the kind of cell that `into` holds, of the cell's first N corners. curved: more points may follow
    template <std::size_t N>
    void take_as(FileCells<N>& into, const VtkCells& cells, std::size_t cell, std::string_view kind, bool curved);

    const TextScanner& in_;
    MeshFile& found_;
    ReadOptions options_;
    std::size_t taken_ = 0;  // cells of the pieces before
    std::size_t mislabelled_ = 0;
    std::size_t curved_ = 0;  // cells with points in the middle of their edges
    std::map<std::int64_t, std::size_t> left_out_;
};

}  // namespace subvol
