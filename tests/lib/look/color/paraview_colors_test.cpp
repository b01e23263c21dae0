// SPDX-License-Identifier: Apache-2.0
// Colour maps in ParaView's form are compared with VTK's curves: the expected numbers are those that VTK 9.1 returned for the
// same knots (vtkColorTransferFunction::GetColor, vtkPiecewiseFunction::GetValue), to six digits.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "lib/temp_folder.h"
#include "subvol/optics.h"
#include "subvol/transfer_function.h"

namespace subvol {
namespace paraview_colors_test {

constexpr double kPromised = 1.0 / 512;

double encoded(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

class ParaViewColors : public test::TempFolder {
protected:
    [[nodiscard]] Optics read(const std::string& content) const {
        return {read_transfer_function(write("colors.json", "[{" + content + "}]")), 1};
    }

    void expect(const std::string& space, const std::string& points, const std::vector<Vec3>& colors) const {
        const Optics optics = read(R"("ColorSpace": ")" + space + R"(", "RGBPoints": [)" + points + "]");
        const std::vector<double> values{0, 0.25, 0.5, 0.75, 0.9, 1};
        for (std::size_t i = 0; i < values.size(); ++i) {
            const Vec3 c = optics.color(values[i]);
            const std::string where = space + " at " + std::to_string(values[i]);
            EXPECT_NEAR(encoded(c.x), colors[i].x, kPromised) << where;
            EXPECT_NEAR(encoded(c.y), colors[i].y, kPromised) << where;
            EXPECT_NEAR(encoded(c.z), colors[i].z, kPromised) << where;
        }
    }
};

constexpr const char* kBlueToRed = "0, 0.2314, 0.298, 0.753, 1, 0.706, 0.0157, 0.149";
constexpr const char* kRedToGreen = "0, 1, 0, 0.1, 1, 0, 1, 0.3";

TEST_F(ParaViewColors, AreMixedInTheirSpace) {
    const Vec3 blue{.2314, .298, .753}, red{.706, .0157, .149};
    expect("RGB", kBlueToRed,
           {blue, {.35005, .227425, .602}, {.4687, .15685, .451}, {.58735, .086275, .3}, {.65854, .04393, .2094}, red});
    expect("HSV", kBlueToRed,
           {blue,
            {.376539, .174963, .74125},
            {.631772, .1202, .7295},
            {.71775, .067113, .507431},
            {.7107, .036064, .296853},
            red});
    for (const char* name : {"Lab", "CIELAB", "Lab/CIELAB"}) {
        expect(name, kBlueToRed,
               {blue,
                {.466876, .253043, .595201},
                {.580746, .202475, .443066},
                {.653984, .138586, .296025},
                {.687036, .082288, .208754},
                red});
    }
    expect("Diverging", kBlueToRed,
           {blue,
            {.553493, .688634, .995255},
            {.865395, .86541, .865396},
            {.958528, .603154, .481768},
            {.842378, .32666, .266652},
            red});
    expect("Step", kBlueToRed, {blue, red, red, red, red, red});
}

TEST_F(ParaViewColors, OfFullSaturationStayOnTheScreen) {
    const Vec3 red{1, 0, .1}, green{0, 1, .3};
    expect("HSV", kRedToGreen, {red, {1, .5, 0}, {.9, 1, 0}, {.3, 1, 0}, {0, 1, .06}, green});
    expect("Lab", kRedToGreen,
           {red,
            {.912903, .463169, .130862},
            {.790242, .669299, .179027},
            {.59948, .8416, .236757},
            {.40061, .937742, .274204},
            green});
    expect("Diverging", kRedToGreen,
           {red, {1, .686874, .452055}, {.999983, 1, .999983}, {.729251, 1, .709581}, {.490268, 1, .502417}, green});
}

TEST_F(ParaViewColors, HueTakesTheShortWayAndGreyHasNone) {
    expect("HSV", "0, 1, 0, 0.1, 1, 1, 0.5, 0", {{1, 0, .1}, {1, .05, 0}, {1, .2, 0}, {1, .35, 0}, {1, .44, 0}, {1, .5, 0}});
    expect("Diverging", "0, 0.2, 0.3, 0.8, 1, 0.865, 0.865, 0.865",
           {{.2, .3, .8},
            {.451171, .512393, .95615},
            {.627733, .675829, 1},
            {.784259, .814915, .992519},
            {.840749, .854394, .926854},
            {.865, .865, .865}});
}

TEST_F(ParaViewColors, MayJump) {
    const Optics optics = read(R"("RGBPoints": [0, 0, 0, 0, 0.5, 0.2, 0.2, 0.2, 0.5, 0.9, 0.9, 0.9, 1, 1, 1, 1])");
    EXPECT_NEAR(encoded(optics.color(0.49).x), 0.196, kPromised);
    EXPECT_NEAR(encoded(optics.color(0.5).x), 0.2, 1e-9);
    EXPECT_NEAR(encoded(optics.color(0.5000001).x), 0.9, 1e-6);
    EXPECT_NEAR(encoded(optics.color(0.51).x), 0.902, kPromised);
}

TEST_F(ParaViewColors, OpacitiesFollowMidpointAndSharpness) {
    const std::vector<double> values{.1, .2, .3, .5, .7, .9};
    const auto expect_curve = [&](const std::string& shape, const std::vector<double>& alphas) {
        const Optics optics =
            read(R"("RGBPoints": [0, 0, 0, 0, 1, 1, 1, 1], "Points": [0, 0.1, )" + shape + ", 1, 0.9, 0.5, 0]");
        for (std::size_t i = 0; i < values.size(); ++i) {
            EXPECT_NEAR(-std::expm1(-optics.extinction(values[i])), alphas[i], kPromised) << shape << " at " << values[i];
        }
    };
    expect_curve("0.5, 0", {.18, .26, .34, .5, .66, .82});
    expect_curve("0.3, 0", {.2333333, .3666667, .5, .6142857, .7285714, .8428571});
    expect_curve("0.3, 0.5", {.1002749, .1198028, .5, .8683806, .8987492, .8999983});
    expect_curve("0.6, 1", {.1, .1, .1, .1, .9, .9});
    expect_curve("0.25, 0.2", {.120961, .2899286, .5820023, .7956907, .879039, .8992408});
    expect_curve("0, 0.5", {.7239786, .8287515, .8724788, .8968019, .899854, .8999998});
    expect_curve("1, 0", {.1400004, .1800008, .2200012, .300002, .3800028, .4600036});
}

}  // namespace paraview_colors_test
}  // namespace subvol
