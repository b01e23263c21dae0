// SPDX-License-Identifier: Apache-2.0
#include "subvol/raster.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "subvol/image.h"

namespace subvol {
namespace raster_test {

TEST(Raster, RowsFollowEachOtherFromTheTop) {
    Raster<int> raster(3, 2, 7);
    raster.at(1, 0) = 1;
    raster.at(2, 1) = 5;
    EXPECT_EQ(raster.values, (std::vector<int>{7, 1, 7, 7, 7, 5}));
    std::ranges::fill(raster.row(1), 0);
    EXPECT_EQ(raster.values, (std::vector<int>{7, 1, 7, 0, 0, 0}));
    EXPECT_EQ(pixel_count(raster.width, raster.height), 6u);
    EXPECT_TRUE(Raster<int>(0, 4).values.empty());
}

TEST(Raster, CountsBeyond32Bits) {
    EXPECT_EQ(pixel_index(65536, 65535, 65535), (std::size_t{1} << 32) - 1);
    EXPECT_EQ(pixel_count(1 << 20, 1 << 20), std::size_t{1} << 40);
}

TEST(Raster, PicturesHaveTheSamePlaces) {
    Image image(3, 2);
    image.pixel(2, 1)[3] = 1;
    EXPECT_EQ(image.rgba[4 * pixel_index(image.width, 2, 1) + 3], 1.0f);
}

}  // namespace raster_test
}  // namespace subvol
