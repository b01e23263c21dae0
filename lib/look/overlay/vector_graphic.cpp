// SPDX-License-Identifier: Apache-2.0
#include "subvol/overlay.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <pugixml.hpp>
#include <sstream>

#include "subvol/detail/printable.h"
#include "subvol/detail/text_codes.h"
#include "subvol/srgb.h"
#include "svg_parts.h"

namespace subvol {

using namespace detail;

std::string detail::svg_number(double x) {
    std::array<char, 32> digits{};
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), x, std::chars_format::fixed, 2).ptr};
}

std::string detail::svg_color(const Vec3& linear) {
    std::string text = "#";
    for (const double c : {linear.x, linear.y, linear.z}) {
        const auto byte = static_cast<std::size_t>(std::lround(255 * srgb_from_linear(std::clamp(c, 0.0, 1.0))));
        text += "0123456789abcdef"[byte / 16];
        text += "0123456789abcdef"[byte % 16];
    }
    return text;
}

pugi::xml_node detail::append_element(pugi::xml_node parent, const char* name,
                                      std::initializer_list<std::pair<const char*, std::string>> attributes) {
    pugi::xml_node node = parent.append_child(name);
    for (const auto& [key, value] : attributes) node.append_attribute(key).set_value(value.c_str());
    return node;
}

pugi::xml_node detail::append_svg(pugi::xml_document& document, int width, int height, const std::string& sheet_color,
                                  std::initializer_list<std::pair<const char*, std::string>> attributes) {
    const std::string across = std::to_string(width), down = std::to_string(height);
    pugi::xml_node svg = append_element(document, "svg",
                                        {{"xmlns", "http://www.w3.org/2000/svg"},
                                         {"width", across},
                                         {"height", down},
                                         {"viewBox", "0 0 " + across + " " + down}});
    for (const auto& [key, value] : attributes) svg.append_attribute(key).set_value(value.c_str());
    append_element(svg, "rect", {{"width", "100%"}, {"height", "100%"}, {"fill", sheet_color}});
    return svg;
}

std::string detail::svg_text(const pugi::xml_document& document) {
    std::ostringstream text;
    document.save(text, " ", pugi::format_default | pugi::format_no_declaration);
    return text.str();
}

namespace {

std::string path_of(std::span<const Vec2> places) {
    std::string path;
    for (const Vec2& place : places) path += (path.empty() ? "M" : " L") + svg_number(place.x) + " " + svg_number(place.y);
    return path;
}

/// Appends a shape to the element of the document.
class SvgShapes {
public:
    explicit SvgShapes(pugi::xml_node svg) : svg_(svg) {}

    void operator()(const LineShape& line) const {
        pugi::xml_node node = append_element(svg_, "path",
                                             {{"fill", "none"},
                                              {"stroke", svg_color(line.options.color)},
                                              {"stroke-width", svg_number(line.options.width_px)},
                                              {"stroke-linecap", "round"},
                                              {"stroke-linejoin", "round"},
                                              {"d", path_of(line.places)}});
        append_alpha(node, "stroke-opacity", line.options.alpha);
    }

    void operator()(const AreaShape& area) const {
        pugi::xml_node node =
            append_element(svg_, "path", {{"fill", svg_color(area.color)}, {"d", path_of(area.corners) + " Z"}});
        append_alpha(node, "fill-opacity", area.alpha);
    }

    void operator()(const TextShape& shape) const {
        const TextAnchor anchor = shape.options.anchor;
        append_element(svg_, "text",
                       {{"x", svg_number(shape.place.x)},
                        {"y", svg_number(shape.place.y)},
                        {"font-size", svg_number(shape.options.size_px)},
                        {"fill", svg_color(shape.options.color)},
                        {"text-anchor", anchor == TextAnchor::Start    ? "start"
                                        : anchor == TextAnchor::Middle ? "middle"
                                                                       : "end"}})
            .text()
            .set(shape.text.c_str());
    }

    void operator()(const PictureShape& picture) const {
        append_element(svg_, "image",
                       {{"x", svg_number(picture.corner.x)},
                        {"y", svg_number(picture.corner.y)},
                        {"width", svg_number(picture.size.x)},
                        {"height", svg_number(picture.size.y)},
                        {"href", "data:image/png;base64," + base64(picture.png)}});
    }

private:
    static void append_alpha(pugi::xml_node node, const char* name, double alpha) {
        if (alpha != 1) node.append_attribute(name).set_value(svg_number(alpha).c_str());
    }

    pugi::xml_node svg_;
};

}  // namespace

std::string vector_graphic_svg(const VectorGraphic& graphic, const std::string& title) {
    pugi::xml_document document;
    pugi::xml_node svg = append_svg(document, graphic.width, graphic.height, svg_color(graphic.background),
                                    {{"font-family", "'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif"}});
    if (!title.empty()) svg.prepend_child("title").text().set(printable(title).c_str());
    for (const auto& shape : graphic.shapes) std::visit(SvgShapes(svg), shape);
    return svg_text(document);
}

}  // namespace subvol
