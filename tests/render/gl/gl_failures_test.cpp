// SPDX-License-Identifier: Apache-2.0
// Devices that fail: they refuse a shader, have no memory left, or are lost. Functions of OpenGL are replaced to simulate that.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "gl_context.h"
#include "lib/test_meshes.h"
#include "subvol/error.h"
#include "subvol/gl_device.h"
#include "subvol/render_projected.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {
namespace gl_failures_test {

/// Replaces a function of OpenGL for a scope. It must have been called before, as libepoxy looks functions up when they are
/// called first.
template <class Function>
class Replaced {
public:
    Replaced(Function& place, Function by) : place_(place), before_(place) { place = by; }
    ~Replaced() { place_ = before_; }
    Replaced(const Replaced&) = delete;
    Replaced& operator=(const Replaced&) = delete;

    [[nodiscard]] Function before() const { return before_; }

private:
    Function& place_;
    Function before_;
};

PFNGLGETSTRINGPROC real_string;
PFNGLGETSHADERIVPROC real_shader;
PFNGLGETERRORPROC real_error;
bool refuses = false, full = false, lost = false;

const GLubyte* EPOXY_CALLSPEC card_string(GLenum name) {
    return name == GL_RENDERER ? reinterpret_cast<const GLubyte*>("a card") : real_string(name);
}
void EPOXY_CALLSPEC shader_state(GLuint shader, GLenum name, GLint* value) {
    real_shader(shader, name, value);
    if (refuses && name == GL_COMPILE_STATUS) *value = GL_FALSE;
}
GLenum EPOXY_CALLSPEC error_state() {
    if (std::exchange(full, false)) return GL_OUT_OF_MEMORY;
    return real_error();
}
GLenum EPOXY_CALLSPEC reset_state() {
    return lost ? GL_GUILTY_CONTEXT_RESET : GL_NO_ERROR;
}

class GlFailures : public testing::Test {
protected:
    void SetUp() override {
        if (gl_devices().empty()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
        const detail::GlContext context;
        GLint size = 0;
        const GLuint shader = glCreateShader(GL_COMPUTE_SHADER);
        glGetShaderiv(shader, GL_COMPILE_STATUS, &size);
        glDeleteShader(shader);
        (void)glGetString(GL_RENDERER);
        (void)glGetGraphicsResetStatus();
        (void)glGetError();
        real_string = epoxy_glGetString;
        real_shader = epoxy_glGetShaderiv;
        real_error = epoxy_glGetError;
        string_.emplace(epoxy_glGetString, card_string);
        shader_.emplace(epoxy_glGetShaderiv, shader_state);
        error_.emplace(epoxy_glGetError, error_state);
        reset_.emplace(epoxy_glGetGraphicsResetStatus, reset_state);
    }
    void TearDown() override { refuses = full = lost = false; }

    static RbfVolume sampled() {
        HexMesh mesh = test::make_nested_cubes(3);
        test::add_field(mesh, "f", [](const Vec3& p) { return p.x + p.y * p.z; });
        return sample_rbf_points(mesh).volume;
    }
    static View view() { return {{.eye = {1, -5, 2}, .target = {0, 0, 0}, .up = {0, 0, 1}}, 33, 25}; }
    static Optics optics() { return Optics({.color = {{-1, {1, 0, 0}}, {1, {0, 0, 1}}}, .opacity = {{-1, 0}, {1, .4}}}, .2); }

private:
    std::optional<Replaced<PFNGLGETSTRINGPROC>> string_;
    std::optional<Replaced<PFNGLGETSHADERIVPROC>> shader_;
    std::optional<Replaced<PFNGLGETERRORPROC>> error_;
    std::optional<Replaced<PFNGLGETGRAPHICSRESETSTATUSPROC>> reset_;
};

TEST_F(GlFailures, OfShadersLeaveTheWorkToTheCpuWithOneWarning) {
    const RbfVolume volume = sampled();
    const SplatResult cpu = render_splats(volume, view(), optics(), {.method = SplatMethod::Cpu});
    EXPECT_EQ(render_splats(volume, view(), optics(), {}).report.backend, "gl") << "it works for now";
    refuses = true;
    Splatter splatter(volume, {});
    const SplatResult first = splatter.draw(view(), optics());
    EXPECT_EQ(first.report.backend, "cpu");
    EXPECT_NE(first.report.warning.find("rejects the shader"), std::string::npos) << first.report.warning;
    EXPECT_EQ(first.image.rgba, cpu.image.rgba);
    EXPECT_EQ(splatter.draw(view(), optics()).report.warning, "") << "once";
    EXPECT_THROW(Splatter(volume, {.method = SplatMethod::Gl}), Error) << "whoever wants it is told";
}

TEST_F(GlFailures, OfMemoryAndOfTheDeviceLeaveThePictureToTheCpu) {
    const RbfVolume volume = sampled();
    const SplatResult cpu = render_splats(volume, view(), optics(), {.method = SplatMethod::Cpu});
    for (bool* failure : {&full, &lost}) {
        Splatter splatter(volume, {});
        EXPECT_EQ(splatter.draw(view(), optics()).report.backend, "gl");
        *failure = true;
        const SplatResult first = splatter.draw(view(), optics());
        *failure = false;
        EXPECT_EQ(first.report.backend, "cpu");
        EXPECT_NE(first.report.warning.find(failure == &full ? "no memory" : "reset"), std::string::npos)
            << first.report.warning;
        EXPECT_EQ(first.image.rgba, cpu.image.rgba);
        const SplatResult second = splatter.draw(view(), optics());
        EXPECT_EQ(second.report.backend, "cpu");
        EXPECT_EQ(second.report.warning, "") << "once";
        *failure = true;
        splatter.set_kernels(volume);
        EXPECT_EQ(splatter.draw(view(), optics()).report.backend, "cpu") << "without the GPU";
        *failure = false;
    }
}

TEST_F(GlFailures, GetANewContextForTheNextPicture) {
    const RbfVolume volume = sampled();
    for (const SplatMethod method : {SplatMethod::Gl, SplatMethod::Sheets}) {
        Splatter splatter(volume, {.method = method});
        const auto before = splatter.draw(view(), optics()).image.rgba;
        lost = true;
        EXPECT_THROW((void)splatter.draw(view(), optics()), Error);
        EXPECT_THROW((void)splatter.draw(view(), optics()), Error) << "it is still lost";
        lost = false;
        EXPECT_EQ(splatter.draw(view(), optics()).image.rgba, before);
    }
    HexMesh mesh = test::make_nested_cubes(2);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    ProjectedRenderer renderer(mesh, "f");
    for (const ProjectedOrder order : {ProjectedOrder::Topological, ProjectedOrder::Lists, ProjectedOrder::Havs}) {
        const auto before = renderer.draw(view(), optics(), {.order = order}).image.rgba;
        lost = true;
        EXPECT_THROW((void)renderer.draw(view(), optics(), {.order = order}), Error);
        lost = false;
        EXPECT_EQ(renderer.draw(view(), optics(), {.order = order}).image.rgba, before);
    }
}

}  // namespace gl_failures_test
}  // namespace subvol
