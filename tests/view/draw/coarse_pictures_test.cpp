// SPDX-License-Identifier: Apache-2.0
// Coarse pictures of very many kernels show few that stand for them; full pictures do not.
#include <gtest/gtest.h>

#include <thread>

#include "subvol/model.h"
#include "subvol/picture_drawer.h"
#include "view/session/small_sessions.h"

namespace subvol {
namespace coarse_pictures_test {

class CoarsePictures : public testing::Test {
protected:
    PictureDrawer drawer{kByCpu};
    std::shared_ptr<const ViewBody> body = std::make_shared<const ViewBody>(view_body(make_model("twist", 40), {}));
    ViewState state{
        .camera = fit_camera(body->box, {0.3, 1, -0.4}), .width = 256, .height = 256, .look = {.look = Look::Volume}};
};

TEST_F(CoarsePictures, ShowFewKernelsAsSoonAsThereAre) {
    const DrawnPicture full = drawer.draw(state, body);
    const DrawnPicture of_all = drawer.draw(state, body, 4);
    ASSERT_GT(of_all.points, 32768U);
    DrawnPicture of_few;
    do {
        std::this_thread::yield();
        of_few = drawer.draw(state, body, 4);
    } while (of_few.points == of_all.points);
    EXPECT_LE(of_few.points, 16384U);
    EXPECT_LT(rms_difference(of_few.image, of_all.image), 0.01);
    EXPECT_EQ(drawer.draw(state, body).image.rgba, full.image.rgba);
}

TEST_F(CoarsePictures, OfAnotherBodyShowItsOwnKernels) {
    (void)drawer.draw(state, body, 4);  // its kernels are still being merged
    const auto ball = std::make_shared<const ViewBody>(view_body(make_model("ball", 4), {}));
    const DrawnPicture coarse = drawer.draw(state, ball, 4);
    EXPECT_EQ(coarse.image.rgba, PictureDrawer(kByCpu).draw(state, ball, 4).image.rgba);
}

}  // namespace coarse_pictures_test
}  // namespace subvol
