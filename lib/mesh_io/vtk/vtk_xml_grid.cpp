// SPDX-License-Identifier: Apache-2.0
#include "vtk_xml_grid.h"

#include <charconv>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

namespace {

template <class Number, std::size_t N>
bool parse(std::string_view text, std::array<Number, N>& numbers) {
    TextScanner words(text, {}, TextScanner::Comments::None);
    for (Number& number : numbers) {
        const std::string_view word = words.word();
        const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        if (error != std::errc() || stop != word.data() + word.size()) return false;
    }
    return words.at_end();
}

template <std::size_t N>
std::array<double, N> reals_of(const VtkXml& xml, const char* name, const std::array<double, N>& otherwise) {
    const pugi::xml_attribute attribute = xml.data_set().attribute(name);
    if (!attribute) return otherwise;
    std::array<double, N> numbers{};
    if (!parse(attribute.as_string(), numbers)) {
        xml.fail_at(xml.data_set(), std::string("its ") + name + " is " + in_quotes(attribute.as_string()),
                    std::to_string(N) + " numbers are needed");
    }
    return numbers;
}

std::array<std::vector<double>, 3> cuts(const VtkXml& xml, const pugi::xml_node& piece, const VtkExtent& extent) {
    std::array<std::vector<double>, 3> at;
    pugi::xml_node array = piece.child("Coordinates").child("DataArray");
    for (std::size_t a = 0; a < 3; ++a) {
        if (!array) xml.fail_at(piece, "the piece does not have three arrays of Coordinates");
        at[a] = xml.arrays().reals(array);
        xml.expect_size(array, at[a].size(), extent.grid.points[a], "the coordinates along an axis");
        array = array.next_sibling("DataArray");
    }
    return at;
}

// Coordinates along the axes of the image, from its origin, which belongs to the number 0.
std::array<std::vector<double>, 3> even_cuts(const VtkExtent& extent, const std::array<double, 3>& spacing) {
    std::array<std::vector<double>, 3> at;
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t i = 0; i < extent.grid.points[a]; ++i) {
            at[a].push_back(spacing[a] * static_cast<double>(extent.first[a] + static_cast<std::int64_t>(i)));
        }
    }
    return at;
}

// The position of an image in the world: its origin, and its axes as the columns of a matrix that is stored row by row.
struct Placement {
    std::array<double, 3> origin;
    std::array<double, 9> axes;

    Vec3 operator()(const Vec3& along) const {
        Vec3 point;
        for (int i = 0; i < 3; ++i) {
            const auto row = static_cast<std::size_t>(3 * i);
            point[i] = origin[row / 3] + axes[row] * along.x + axes[row + 1] * along.y + axes[row + 2] * along.z;
        }
        return point;
    }
};

Placement placement(const VtkXml& xml) {
    return {reals_of<3>(xml, "Origin", {0, 0, 0}), reals_of<9>(xml, "Direction", {1, 0, 0, 0, 1, 0, 0, 0, 1})};
}

}  // namespace

const char* name_of(VtkGrid grid) {
    constexpr std::array<const char*, 4> kNames{"UnstructuredGrid", "StructuredGrid", "RectilinearGrid", "ImageData"};
    return kNames[static_cast<std::size_t>(grid)];
}

// The attribute has the first and the last number along each of the three axes.
VtkExtent extent_of(const VtkXml& xml, const pugi::xml_node& piece) {
    constexpr std::int64_t kFar = std::int64_t{1} << 40;  // so that differences can be formed
    const std::string_view text = piece.attribute("Extent").as_string();
    std::array<std::int64_t, 6> ends{};
    bool sound = parse(text, ends);
    for (const std::int64_t end : ends) sound = sound && end >= -kFar && end <= kFar;
    if (!sound) xml.fail_at(piece, "its Extent is " + in_quotes(text), "six integers are needed");
    VtkExtent extent;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::int64_t low = ends[2 * a], high = ends[2 * a + 1];
        extent.first[a] = low;
        extent.grid.points[a] = high < low ? 0 : static_cast<std::size_t>(high - low) + 1;
    }
    return extent;
}

void add_grid_points(const VtkXml& xml, VtkGrid kind, const pugi::xml_node& piece, const VtkExtent& extent, MeshFile& into) {
    if (into.points.size() + extent.grid.point_count() > most_points(xml.most_bytes())) {  // of all pieces
        xml.fail_at(piece, size_text(extent.grid) + " are more than the file can have values for");
    }
    const auto position = xml.place(piece);
    if (kind == VtkGrid::Rectilinear) {
        add_points(into, cuts(xml, piece, extent), position);
        return;
    }
    MeshFile along;
    add_points(along, even_cuts(extent, reals_of<3>(xml, "Spacing", {1, 1, 1})), position);
    const Placement place = placement(xml);
    for (const Vec3& point : along.points) add_point(into, place(point), position);
}

}  // namespace subvol::detail
