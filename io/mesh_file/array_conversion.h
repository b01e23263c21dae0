// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mesh_arrays.h"
#include "mesh_file.h"
#include "subvol/read_options.h"

namespace subvol::detail {

/// How the mesh's points and cells relate to the file's.
///
/// used:         a flag for each point of the file
/// cell_numbers: the number in the file of each cell of the mesh; empty if it is the same
/// shell_numbers: those of the shells and beams that are read beside cells
/// sources:      the points of the file whose mean each point of the mesh is; nothing if they are the same
struct MeshOrigin {
    std::vector<std::uint8_t> used;
    std::vector<Index> cell_numbers;
    std::optional<IndexRows> sources;
    std::vector<Index> shell_numbers{};
};

/// The arrays of a file as fields of the mesh: at points as they are, or means over the points that a new one lies between; at
/// cells kept for a fit, constant in each cell if they are labels, else means over the cells at a point by volume.
class ArrayConversion {
public:
    ArrayConversion(ReadResult& result, const MeshOrigin& origin, const EntityNames& names, CellValues cell_values)
        : result_(result), origin_(origin), names_(names), cell_values_(cell_values) {}

    /// Returns whether the mesh has got the array as its next attribute.
    bool take(FileArray&& array);

    /// After the last array: one warning for all fields that are left out, one for those that have gaps, one for all arrays of
    /// cells, and one for each name that several arrays have. unread: by the reader
    void finish(std::vector<UnreadField>&& unread);

private:
    /// The first few of some names.
    [[nodiscard]] static std::string listed(const std::vector<std::string>& all);

    /// Whether an array numbers materials, blocks or cells: no mean of such numbers means anything. Some formats have nothing
    /// but reals; there the name has to say so, too.
    [[nodiscard]] static bool is_label(const FileArray& array, const std::vector<double>& of_hexes);

    /// The same at points, where many integers are measured, as grey values are: the name has to say so. What numbers the
    /// points themselves, as "GlobalNodeId", is no label of cells.
    [[nodiscard]] static bool is_label_at_points(const FileArray& array);

    [[nodiscard]] static bool names_label(const std::string& given);

    /// Gives each cell the label that most of its points have, of as many the least. Points that splitting has made have none
    /// of their own, and in `values` that of the first point that they lie between.
    void take_labels(const FileArray& array, Attribute& attribute);

    /// Keeps a field with gaps, unless it has no value at all.
    bool take_incomplete(const FileArray& array);

    [[nodiscard]] static bool has_all(const std::vector<double>& values, std::size_t tuple, std::size_t components);

    /// Makes values at points of those at cells.
    void take_cells(const FileArray& array, Attribute& attribute);

    // The first point that a cell uses, or the first cell, with a value that is not finite; empty if there is none.
    [[nodiscard]] std::string gap_at_points(const FileArray& array) const;

    [[nodiscard]] std::string gap_at_cells(const FileArray& array) const;

    std::vector<double> from_points(FileArray&& array) const;

    std::vector<double> of_cells(const FileArray& array) const;

    void take_on_patches(const std::string& name, const FileArray& array);

    ReadResult& result_;
    const MeshOrigin& origin_;
    const EntityNames& names_;
    CellValues cell_values_;
    NamesApart distinct_{"array"};
    std::vector<std::string> averaged_, labels_, point_labels_, incomplete_, unfitted_;
    std::string gaps_;  // of the first of these
    std::vector<UnreadField> unread_;
};

}  // namespace subvol::detail
