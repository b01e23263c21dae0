// SPDX-License-Identifier: Apache-2.0
// The library as a guest in a program that draws with EGL itself.
#include <epoxy/egl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <optional>
#include <thread>

#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/gl_device.h"
#include "subvol/render_projected.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {
namespace gl_guest_test {

HexMesh small_box() {
    HexMesh mesh = test::make_box(2, 2, 2);
    test::add_field(mesh, "f", [](const Vec3& p) { return .2 * p.x + .1 * p.y; });
    return mesh;
}

const View kView({.eye = {4, -5, 3}, .target = {1, 1, 1}, .up = {0, 0, 1}}, 16, 12);
const Optics kOptics({.color = {{0, {1, 1, 1}}}, .opacity = {{0, .5}}}, 1);

/// What the thread has current.
struct Current {
    EGLenum api;
    EGLDisplay display;
    EGLContext context;
    EGLSurface draw, read;

    static Current now() {
        return {eglQueryAPI(), eglGetCurrentDisplay(), eglGetCurrentContext(), eglGetCurrentSurface(EGL_DRAW),
                eglGetCurrentSurface(EGL_READ)};
    }
    bool operator==(const Current&) const = default;
};

/// A program with a context of OpenGL ES, and two surfaces.
class Hosts : public testing::Test {
protected:
    void SetUp() override {
        if (gl_devices().empty()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
        display_ = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
        if (display_ == EGL_NO_DISPLAY || !eglInitialize(display_, nullptr, nullptr)) GTEST_SKIP() << "no display of Mesa";
        eglBindAPI(EGL_OPENGL_ES_API);
        const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_ES2_BIT,
                                           EGL_NONE};
        const std::array<EGLint, 3> version{EGL_CONTEXT_CLIENT_VERSION, 2, EGL_NONE};
        const std::array<EGLint, 5> size{EGL_WIDTH, 8, EGL_HEIGHT, 8, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        if (!eglChooseConfig(display_, wanted.data(), &config, 1, &count) || count == 0) GTEST_SKIP() << "no surfaces";
        context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, version.data());
        for (EGLSurface& surface : surfaces_) surface = eglCreatePbufferSurface(display_, config, size.data());
        ASSERT_TRUE(eglMakeCurrent(display_, surfaces_[0], surfaces_[1], context_));
    }
    void TearDown() override {
        if (context_ == EGL_NO_CONTEXT) return;
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        for (const EGLSurface surface : surfaces_) eglDestroySurface(display_, surface);
        eglDestroyContext(display_, context_);
        eglBindAPI(EGL_OPENGL_ES_API);
    }

    void expect_as_before(const char* what) const {
        EXPECT_EQ(Current::now(), (Current{EGL_OPENGL_ES_API, display_, context_, surfaces_[0], surfaces_[1]})) << what;
    }

    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
    std::array<EGLSurface, 2> surfaces_{};
};

TEST_F(Hosts, KeepTheirSurfacesWhenDevicesAreListed) {
    (void)gl_devices();
    expect_as_before("a list");
    EXPECT_TRUE(find_gl_device());
    expect_as_before("the first device");
    EXPECT_THROW((void)find_gl_device(99), Error);
    expect_as_before("no device");
}

TEST_F(Hosts, KeepTheirSurfacesWhenPicturesAreDrawn) {
    const HexMesh mesh = small_box();
    const RbfVolume volume = sample_rbf_points(mesh).volume;
    for (const SplatMethod method : {SplatMethod::Auto, SplatMethod::Gl, SplatMethod::Sheets}) {
        std::optional<Splatter> splatter(std::in_place, volume, SplatOptions{.method = method});
        expect_as_before("a splatter");
        (void)splatter->draw(kView, kOptics);
        expect_as_before("its picture");
        splatter->set_kernels(volume);
        expect_as_before("other kernels");
        splatter.reset();
        expect_as_before("its end");
        EXPECT_THROW(Splatter(volume, {.method = method, .device = 99}), Error);
        expect_as_before("no device");
    }
    for (const ProjectedOrder order : {ProjectedOrder::Topological, ProjectedOrder::Lists, ProjectedOrder::Havs}) {
        (void)render_projected(mesh, "f", kView, kOptics, {.order = order});
        expect_as_before("projected tetrahedra");
    }
}

TEST_F(Hosts, KeepWhateverTheyBind) {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    for (const EGLenum api : {EGL_OPENGL_ES_API, EGL_OPENGL_API}) {
        eglBindAPI(api);
        (void)gl_devices();
        (void)render_projected(small_box(), "f", kView, kOptics);
        EXPECT_EQ(Current::now(), (Current{api, EGL_NO_DISPLAY, EGL_NO_CONTEXT, EGL_NO_SURFACE, EGL_NO_SURFACE}));
    }
    // The bound API is not that of the context.
    eglBindAPI(EGL_OPENGL_ES_API);
    ASSERT_TRUE(eglMakeCurrent(display_, surfaces_[0], surfaces_[1], context_));
    eglBindAPI(EGL_OPENGL_API);
    const Current before = Current::now();
    (void)gl_devices();
    EXPECT_EQ(Current::now(), before);
    eglBindAPI(EGL_OPENGL_ES_API);
    expect_as_before("another API is bound");
}

}  // namespace gl_guest_test
}  // namespace subvol
