// SPDX-License-Identifier: Apache-2.0
#include "subvol/placed_image.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <climits>
#include <filesystem>
#include <string>

#include "subvol/detail/picture_part.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/image_metrics.h"

namespace subvol {
namespace placed_image_test {

namespace fs = std::filesystem;

/// A picture of which every pixel is another.
Image numbered(int width, int height) {
    Image image(width, height);
    for (std::size_t i = 0; i < image.rgba.size(); ++i) image.rgba[i] = static_cast<float>(i);
    return image;
}

/// The part of `numbered(20, 12)` with this window, shifted to where its first pixel is at `origin`.
PlacedImage part(const PixelWindow& window, int origin_x = 0, int origin_y = 0) {
    const Image whole = numbered(20, 12);
    Image image(window.width, window.height);
    for (int y = 0; y < window.height; ++y) {
        for (int x = 0; x < window.width; ++x) {
            const auto from = whole.pixel(window.left + x, window.top + y);
            std::copy(from.begin(), from.end(), image.pixel(x, y).begin());
        }
    }
    return {std::move(image),
            {window.left + origin_x, window.top + origin_y, window.width, window.height},
            {origin_x, origin_y, 20, 12},
            "part"};
}

template <class Call>
std::string refusal(const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
        return error.what();
    }
    ADD_FAILURE() << "no error was thrown";
    return {};
}

TEST(PlacedImage, PartsAreComparedWhereTheyOverlap) {
    const CommonPixels common = common_pixels(part({0, 0, 13, 9}), part({5, 2, 15, 10}));
    EXPECT_EQ(common.window, (PixelWindow{5, 2, 8, 7}));
    EXPECT_EQ(common.a.rgba, part({5, 2, 8, 7}).image.rgba);
    EXPECT_EQ(common.b.rgba, common.a.rgba);
    EXPECT_EQ(compare_images(common.a, common.b).max, 0);
}

TEST(PlacedImage, APartAgainstItsWhole) {
    const CommonPixels common = common_pixels(whole_image(numbered(20, 12)), part({0, 6, 20, 6}));
    EXPECT_EQ(common.window, (PixelWindow{0, 6, 20, 6}));
    EXPECT_EQ(common.a.rgba, common.b.rgba);
}

TEST(PlacedImage, PartsOfOneSizeInOtherPlacesAreRefused) {
    EXPECT_NE(refusal([] {
                  (void)common_pixels(part({0, 0, 20, 6}), part({0, 6, 20, 6}));
              }).find("no pixel in common"),
              std::string::npos);
    // Side by side in rows that both have.
    EXPECT_NE(refusal([] {
                  (void)common_pixels(part({0, 0, 10, 12}), part({10, 0, 10, 12}));
              }).find("no pixel in common"),
              std::string::npos);
}

TEST(PlacedImage, OtherDisplayWindowsAreRefused) {
    EXPECT_NE(refusal([] {
                  (void)common_pixels(part({0, 0, 8, 6}), part({0, 0, 8, 6}, 3));
              }).find("display window"),
              std::string::npos);
    PlacedImage of_another = part({0, 0, 8, 6});
    of_another.display_window.height = 13;
    EXPECT_NE(refusal([&] { (void)common_pixels(part({0, 0, 8, 6}), of_another); }).find("20 x 13"), std::string::npos);
    EXPECT_NE(refusal([] {
                  (void)common_pixels(part({0, 0, 8, 6}), whole_image(numbered(8, 6)));
              }).find("display window"),
              std::string::npos);
    const std::string sizes =
        refusal([] { (void)common_pixels(whole_image(numbered(4, 3), "a"), whole_image(numbered(3, 4), "b")); });
    EXPECT_EQ(sizes, "a: has 4 x 3 pixels, b has 3 x 4 (only pictures of the same size can be compared)");
}

TEST(PlacedImage, WindowsAtTheEndsOfNumbersDoNotOverflow) {
    const auto at = [](int left, int top) {
        return PlacedImage{numbered(2, 2), {left, top, 2, 2}, {INT_MIN, INT_MIN, INT_MAX, INT_MAX}, {}};
    };
    EXPECT_NE(refusal([&] { (void)common_pixels(at(INT_MIN, INT_MIN), at(INT_MAX, INT_MAX)); }).find("no pixel"),
              std::string::npos);
    EXPECT_EQ(common_pixels(at(INT_MAX, INT_MAX), at(INT_MAX, INT_MAX)).window.width, 2);
}

class PlacedFiles : public ::testing::Test {
protected:
    PlacedFiles() : folder_(fs::temp_directory_path() / ("subvol_placed_image_" + std::to_string(::getpid()))) {
        fs::remove_all(folder_);
        fs::create_directory(folder_);
    }
    ~PlacedFiles() override { fs::remove_all(folder_); }

    fs::path folder_;
};

TEST_F(PlacedFiles, WindowsAreKept) {
    const PlacedImage written = part({5, 2, 8, 7}, -30, 40);
    write_placed_image(folder_ / "a.exr", written);
    const PlacedImage read = read_placed_image(folder_ / "a.exr");
    EXPECT_EQ(read.data_window, written.data_window);
    EXPECT_EQ(read.display_window, written.display_window);
    EXPECT_EQ(read.image.rgba, written.image.rgba);
    EXPECT_FALSE(read.whole());

    write_image(folder_ / "b.exr", numbered(20, 12));
    EXPECT_TRUE(read_placed_image(folder_ / "b.exr").whole());
    write_image(folder_ / "b.png", numbered(20, 12));
    EXPECT_EQ(read_placed_image(folder_ / "b.png").display_window, (PixelWindow{0, 0, 20, 12}));
}

TEST_F(PlacedFiles, RowsOfADrawnPartKnowTheirPlace) {
    detail::write_picture_part(folder_ / "a.exr",
                               {.rows = part({0, 6, 20, 6}).image, .first_row = 6, .whole_height = 12, .note = "note"});
    const PlacedImage read = read_placed_image(folder_ / "a.exr");
    EXPECT_EQ(read.data_window, (PixelWindow{0, 6, 20, 6}));
    EXPECT_EQ(read.display_window, (PixelWindow{0, 0, 20, 12}));
    EXPECT_EQ(detail::read_picture_part(folder_ / "a.exr").first_row, 6);
}

}  // namespace placed_image_test
}  // namespace subvol
