// SPDX-License-Identifier: Apache-2.0
#include "subvol/overlay.h"

#include <gtest/gtest.h>

#include <array>
#include <pugixml.hpp>
#include <string>

namespace subvol {
namespace {

class VectorGraphics : public ::testing::Test {
protected:
    pugi::xml_node svg(const VectorGraphic& graphic, const std::string& title = {}) {
        EXPECT_TRUE(document_.load_string(vector_graphic_svg(graphic, title).c_str()));
        return document_.child("svg");
    }

    pugi::xml_document document_;
};

TEST_F(VectorGraphics, KeepLinesAreasAndTextsAsShapesInTheirOrder) {
    VectorGraphic graphic{.width = 200, .height = 100};
    const DrawTarget target(graphic);
    draw_polyline(target, std::array{Vec2(1, 2), Vec2(3.125, 4), Vec2(5, 6)},
                  {.width_px = 2, .color = Vec3(1, 0, 0), .alpha = .5});
    draw_area(target, std::array{Vec2(0, 0), Vec2(8, 0), Vec2(8, 8)}, Vec3(0, 1, 0));
    draw_text(target, {50, 60}, "a < b & \x01", {.size_px = 12, .color = Vec3(0.0), .anchor = TextAnchor::End});
    graphic.shapes.emplace_back(PictureShape{Vec2(10, 20), Vec2(30, 40), "png"});
    const pugi::xml_node svg = this->svg(graphic, "T & t");
    EXPECT_STREQ(svg.attribute("viewBox").value(), "0 0 200 100");
    EXPECT_STREQ(svg.child_value("title"), "T & t");
    const pugi::xml_node line = svg.child("path"), area = line.next_sibling(), text = area.next_sibling(),
                         picture = text.next_sibling();
    EXPECT_STREQ(line.attribute("d").value(), "M1.00 2.00 L3.12 4.00 L5.00 6.00");
    EXPECT_STREQ(line.attribute("fill").value(), "none");
    EXPECT_STREQ(line.attribute("stroke").value(), "#ff0000");
    EXPECT_STREQ(line.attribute("stroke-width").value(), "2.00");
    EXPECT_STREQ(line.attribute("stroke-opacity").value(), "0.50");
    EXPECT_STREQ(area.attribute("d").value(), "M0.00 0.00 L8.00 0.00 L8.00 8.00 Z");
    EXPECT_STREQ(area.attribute("fill").value(), "#00ff00");
    EXPECT_STREQ(text.attribute("text-anchor").value(), "end");
    EXPECT_EQ(std::string(text.text().get()).substr(0, 8), "a < b & ");
    EXPECT_EQ(std::string(text.text().get()).find('\x01'), std::string::npos);  // not a character of XML
    EXPECT_STREQ(picture.attribute("href").value(), "data:image/png;base64,cG5n");
    EXPECT_STREQ(picture.attribute("height").value(), "40.00");
}

// What is drawn over a picture is the same thing over a graphic: as many lines and texts as a scale has ticks, at their places.
TEST_F(VectorGraphics, ScalesHaveATickAndALabelAtEachRoundValue) {
    VectorGraphic graphic{.width = 400, .height = 300};
    draw_scales(DrawTarget(graphic), {.left = 50, .top = 20, .width = 300, .height = 200}, {"x", 0, 3}, {"y", 0, 1}, Vec3(0.0));
    const pugi::xml_node svg = this->svg(graphic);
    std::size_t lines = 0;
    for ([[maybe_unused]] const pugi::xml_node line : svg.children("path")) ++lines;
    std::vector<std::string> labels;
    for (const pugi::xml_node text : svg.children("text")) {
        const std::string label = text.text().get();
        labels.push_back(label);
        if (label == "2") {
            EXPECT_NEAR(text.attribute("x").as_double(), 50 + 300 * 2 / 3.0, .01);
        }
        if (label == "0.4") {  // its base line is below the middle
            EXPECT_NEAR(text.attribute("y").as_double(), 220 - .4 * 200, 5);
        }
    }
    EXPECT_EQ(lines, 4 + labels.size() - 2);  // a frame, and a tick for each label but the titles
    EXPECT_EQ(labels.back(), "y");
}

TEST_F(VectorGraphics, BoxesOfPicturesAreWholePixels) {
    Image image(4, 3);
    draw_box(DrawTarget(image), {1.5, -2}, {3.9, 2}, Vec3(1, .5, 0), .5);
    double sum = 0;
    for (int y = 0; y < 3; ++y) {
        for (int x = 0; x < 4; ++x) {
            const bool in = x >= 1 && x < 3 && y < 2;
            EXPECT_FLOAT_EQ(image.pixel(x, y)[3], in ? .5F : 0.F) << x << " " << y;
            sum += static_cast<double>(image.pixel(x, y)[1]);
        }
    }
    EXPECT_DOUBLE_EQ(sum, 4 * .25);
}

}  // namespace
}  // namespace subvol
