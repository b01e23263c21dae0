// SPDX-License-Identifier: Apache-2.0
#include "vtk_image.h"

#include <charconv>
#include <string>
#include <string_view>

#include "subvol/detail/printable.h"
#include "subvol/detail/text_scanner.h"

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

}  // namespace

Vec3 ImagePlacement::operator()(const Vec3& along) const {
    Vec3 point;
    for (int i = 0; i < 3; ++i) {
        const auto row = static_cast<std::size_t>(3 * i);
        point[i] = origin[row / 3] + axes[row] * along.x + axes[row + 1] * along.y + axes[row + 2] * along.z;
    }
    return point;
}

std::array<double, 3> spacing_of(const VtkXml& xml) {
    return reals_of<3>(xml, "Spacing", {1, 1, 1});
}

ImagePlacement placement_of(const VtkXml& xml) {
    return {reals_of<3>(xml, "Origin", {0, 0, 0}), reals_of<9>(xml, "Direction", {1, 0, 0, 0, 1, 0, 0, 0, 1})};
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

}  // namespace subvol::detail
