// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "curves.h"
#include "subvol/color_map_file.h"
#include "subvol/detail/json_depth.h"
#include "subvol/detail/knot_values.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"
#include "subvol/srgb.h"
#include "subvol/transfer_function.h"

namespace subvol {

using namespace detail;
namespace {

using nlohmann::json;
using ColorKnots = std::vector<TransferFunction::ColorKnot>;
using OpacityKnots = std::vector<TransferFunction::OpacityKnot>;

[[noreturn]] void refuse(const std::string& file, const std::string& message, const std::string& allowed = {}) {
    throw Error(ErrorCode::InvalidInput, printable(message), file, printable(allowed));
}

std::string name_of(const json& map) {
    const auto found = map.is_object() ? map.find("Name") : map.end();
    return map.is_object() && found != map.end() && found->is_string() ? found->get<std::string>() : std::string();
}

json map_named(const json& maps, const std::string& name, const std::string& file) {
    constexpr std::size_t kShown = 8;
    std::string names;
    std::size_t others = 0;
    for (const json& map : maps) {
        if (name_of(map) == name) return map;
        if (++others <= kShown) names += (names.empty() ? "" : ", ") + shortened(name_of(map));
    }
    refuse(file, "has no colour map '" + name + "'", names + (others > kShown ? ", …" : ""));
}

json read_color_map(const std::string& file, const std::string& name) {
    json document;
    try {
        document = json::parse(of_limited_depth(read_text(file), file));
    } catch (const json::exception& e) {
        refuse(file, "is not JSON: " + parser_message(e.what()));
    }
    // ParaView writes an array of colour maps; a single map without the array is accepted too.
    if (document.is_object()) document = json::array({std::move(document)});
    if (!document.is_array() || document.empty() || !document.front().is_object()) {
        refuse(file, "has no colour map", "an array with one object that has RGBPoints");
    }
    return name.empty() ? json(document.front()) : map_named(document, name, file);
}

/// The numbers at a key, four for each knot.
std::vector<double> read_quadruples(const json& map, const std::string& file, const std::string& key) {
    const auto found = map.find(key);
    if (found == map.end()) refuse(file, "key '" + key + "' is missing");
    if (!found->is_array() || found->empty() || found->size() % 4 != 0) {
        refuse(file, "key '" + key + "' is not an array of four numbers for each knot");
    }
    std::vector<double> numbers;
    numbers.reserve(found->size());
    for (const json& item : *found) {
        if (!item.is_number()) refuse(file, "key '" + key + "', entry " + std::to_string(numbers.size()) + " is not a number");
        numbers.push_back(item.get<double>());
    }
    return numbers;
}

ColorSpace read_color_space(const json& map, const std::string& file) {
    const auto found = map.find("ColorSpace");
    if (found == map.end()) return ColorSpace::Rgb;
    const auto space = found->is_string() ? color_space_named(found->get<std::string>()) : std::nullopt;
    if (!space) refuse(file, "key 'ColorSpace' is " + shortened(found->dump()), "RGB, HSV, Lab, Lab/CIELAB, Diverging or Step");
    return *space;
}

/// The knots as in the file: in sRGB, and values may repeat.
ColorKnots read_colors(const json& map, const std::string& file) {
    const std::vector<double> n = read_quadruples(map, file, "RGBPoints");
    ColorKnots knots;
    for (std::size_t i = 0; i < n.size(); i += 4) knots.push_back({n[i], {n[i + 1], n[i + 2], n[i + 3]}});
    return knots;
}

std::vector<SharpKnot> read_opacities(const json& map, const std::string& file) {
    const std::vector<double> n = read_quadruples(map, file, "Points");
    std::vector<SharpKnot> knots;
    for (std::size_t i = 0; i < n.size(); i += 4) {
        for (std::size_t k : {i + 2, i + 3}) {
            if (n[k] >= 0 && n[k] <= 1) continue;
            refuse(file, "key 'Points', knot " + std::to_string(i / 4) + ": the midpoint or the sharpness is out of range",
                   "[0,1]");
        }
        knots.push_back({n[i], n[i + 1], n[i + 2], n[i + 3]});
    }
    return knots;
}

OpacityKnots default_opacity(const ColorKnots& colors) {
    const double first = colors.front().value, last = colors.back().value;
    if (first < last) return {{first, 0}, {last, 0.5}};
    return {{first, 0.5}};
}

/// Validates the knots; errors name their numbers in the file.
void check(const ColorKnots& colors, const OpacityKnots& opacities, const std::string& file) {
    TransferFunction function{colors, opacities};
    part_equal_values(function.color);
    part_equal_values(function.opacity);
    try {
        validate(function);
    } catch (const Error& e) {
        refuse(file, e.what());
    }
}

}  // namespace

TransferFunction read_transfer_function(const std::filesystem::path& path, const std::string& name) {
    const std::string file = path.string();
    const json map = read_color_map(file, name);
    const ColorKnots colors = read_colors(map, file);
    const ColorSpace space = read_color_space(map, file);
    if (const auto points = map.find("Points"); points == map.end() || points->is_null()) {
        const OpacityKnots ramp = default_opacity(colors);
        check(colors, ramp, file);
        return {straight_pieces(colors, space), ramp};
    }
    const std::vector<SharpKnot> points = read_opacities(map, file);
    OpacityKnots corners;
    for (const SharpKnot& p : points) corners.push_back({p.value, p.alpha});
    check(colors, corners, file);
    return {straight_pieces(colors, space), straight_pieces(points)};
}

namespace {

constexpr double kColorError = 1.0 / 1024;  // of sRGB between points

Vec3 srgb_of(const Vec3& linear) {
    return {srgb_from_linear(linear.x), srgb_from_linear(linear.y), srgb_from_linear(linear.z)};
}

/// Adds the points after `a` up to `b`: halves of the way, until straight lines in sRGB are those in linear light.
void add_points(const TransferFunction::ColorKnot& a, const TransferFunction::ColorKnot& b, int depth, json& points) {
    const TransferFunction::ColorKnot middle{0.5 * (a.value + b.value), 0.5 * (a.rgb + b.rgb)};
    const Vec3 off = glm::abs(srgb_of(middle.rgb) - 0.5 * (srgb_of(a.rgb) + srgb_of(b.rgb)));
    const bool between = middle.value > a.value && middle.value < b.value;
    if (depth > 0 && between && std::max({off.x, off.y, off.z}) > kColorError) {
        add_points(a, middle, depth - 1, points);
        add_points(middle, b, depth - 1, points);
        return;
    }
    const Vec3 rgb = srgb_of(b.rgb);
    for (const double number : {b.value, rgb.x, rgb.y, rgb.z}) points.push_back(number);
}

}  // namespace

std::string color_map_json(const TransferFunction& function, const std::string& name) {
    validate(function);
    json colors = json::array(), opacities = json::array();
    const auto& first = function.color.front();
    const Vec3 rgb = srgb_of(first.rgb);
    for (const double number : {first.value, rgb.x, rgb.y, rgb.z}) colors.push_back(number);
    for (std::size_t k = 0; k + 1 < function.color.size(); ++k) add_points(function.color[k], function.color[k + 1], 8, colors);
    for (const auto& knot : function.opacity) {
        for (const double number : {knot.value, knot.alpha, 0.5, 0.0}) opacities.push_back(number);
    }
    nlohmann::ordered_json map;
    map["Name"] = name;
    map["ColorSpace"] = "RGB";
    map["RGBPoints"] = std::move(colors);
    map["Points"] = std::move(opacities);
    nlohmann::ordered_json maps = nlohmann::ordered_json::array();
    maps.push_back(std::move(map));
    return maps.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace subvol
