// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <vector>

#include "label_readers.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/detail/vtk_xml.h"
#include "vtk/vtk_image.h"

namespace subvol::detail {

namespace {

struct LabelArray {
    pugi::xml_node node;
    std::string name;
    bool at_cells = false;
};

/// The arrays of integers with one component, but those of ghosts.
std::vector<LabelArray> integer_arrays(const VtkXml& xml, const pugi::xml_node& piece, std::vector<std::string>& others) {
    std::vector<LabelArray> found;
    for (const bool at_cells : {true, false}) {
        for (const auto& array : piece.child(at_cells ? "CellData" : "PointData").children("DataArray")) {
            const std::string name = as_utf8(array.attribute("Name").as_string());
            const bool one = number_attribute(array, "NumberOfComponents").value_or(1) == 1;
            if (name == "vtkGhostType") continue;
            if (one && xml.arrays().has_integers(array)) {
                found.push_back({array, name, at_cells});
            } else {
                others.push_back(name);
            }
        }
    }
    return found;
}

std::string list_of_names(const std::vector<std::string>& names) {
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + in_quotes(name);
    return list;
}

LabelArray chosen_array(const VtkXml& xml, const pugi::xml_node& piece, const std::optional<std::string>& wanted) {
    std::vector<std::string> others, names;
    const std::vector<LabelArray> arrays = integer_arrays(xml, piece, others);
    for (const LabelArray& array : arrays) names.push_back(array.name);
    if (wanted) {
        const auto found = std::ranges::find(arrays, *wanted, &LabelArray::name);
        if (found != arrays.end()) return *found;
        const bool real = std::ranges::find(others, *wanted) != others.end();
        xml.fail_at(piece, in_quotes(*wanted) + (real ? " is not an array of integers with one component" : " is not there"),
                    names.empty() ? "no array is one of labels" : "arrays of labels: " + list_of_names(names));
    }
    if (arrays.empty()) {
        xml.fail_at(piece, "no array has integers, which are labels",
                    others.empty() ? "there is no array" : "it has " + list_of_names(others));
    }
    if (arrays.size() > 1) xml.fail_at(piece, "several arrays could be labels", "choose one of " + list_of_names(names));
    return arrays.front();
}

}  // namespace

LabelGrid read_vti_labels(std::string_view text, std::string_view file, const std::optional<std::string>& array) {
    const VtkXml xml(text, file, "ImageData", "an image is needed");
    const pugi::xml_node piece = xml.data_set().child("Piece");
    if (!piece) xml.fail_at(xml.data_set(), "there is no Piece element");
    if (piece.next_sibling("Piece")) xml.fail_at(xml.data_set(), "has several pieces", "one piece with all voxels");
    const LabelArray labels = chosen_array(xml, piece, array);
    const VtkExtent extent = extent_of(xml, piece);
    std::array<std::size_t, 3> size = extent.grid.points;
    const std::array<double, 3> spacing = spacing_of(xml);
    Vec3 first;
    for (std::size_t a = 0; a < 3; ++a) {
        if (labels.at_cells && size[a] > 0) --size[a];
        if (size[a] == 0) xml.fail_at(piece, "has no voxels", "one or more along each axis");
        first[static_cast<int>(a)] = spacing[a] * (static_cast<double>(extent.first[a]) + (labels.at_cells ? 0.5 : 0.0));
    }
    // Never multiplied before it is known that the product has 64 bits.
    std::uint64_t voxels = 1;
    for (const std::size_t side : size) {
        if (side > LabelGrid::kMostVoxels / voxels) xml.fail_at(piece, "has more than 2^31 voxels");
        voxels *= side;
    }
    xml.expect_size(labels.node, xml.arrays().size(labels.node), voxels, "a label for each voxel");
    const ImagePlacement place = placement_of(xml);
    const Vec3 origin = place(first);
    Mat3 to_world(1);
    for (int axis = 0; axis < 3; ++axis) {
        for (int k = 0; k < 3; ++k)
            to_world[axis][k] = place.axes[static_cast<std::size_t>(3 * k + axis)] * spacing[static_cast<std::size_t>(axis)];
    }
    LabelGrid grid(to_world, origin);
    LabelRows rows(grid, size);
    xml.arrays().each_integer(labels.node, [&](std::span<const std::int64_t> some) { rows.take(some); });
    rows.finish();
    return grid;
}

}  // namespace subvol::detail
