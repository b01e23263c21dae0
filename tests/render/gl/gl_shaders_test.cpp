// SPDX-License-Identifier: Apache-2.0
// Every assembled shader against the reference compiler of Khronos, which is stricter than most drivers.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "lib/test_meshes.h"
#include "subvol/gl_device.h"
#include "subvol/render_projected.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace subvol {
namespace gl_shaders_test {

namespace fs = std::filesystem;

/// Collects the shaders of all programs of the context that is current while a picture is drawn.
class Collector : public Progress {
public:
    void report(std::string_view, double) override {
        for (GLuint program = 1; program < 512; ++program) {
            if (glIsProgram(program)) collect(program);
        }
    }
    /// Texts, with the ending that the compiler knows the stage by.
    std::set<std::pair<std::string, std::string>> shaders{};

private:
    void collect(GLuint program) {
        std::array<GLuint, 4> attached{};
        GLsizei count = 0;
        glGetAttachedShaders(program, static_cast<GLsizei>(attached.size()), &count, attached.data());
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            GLint stage = 0, length = 0;
            glGetShaderiv(attached[i], GL_SHADER_TYPE, &stage);
            glGetShaderiv(attached[i], GL_SHADER_SOURCE_LENGTH, &length);
            std::string text(static_cast<std::size_t>(length), '\0');
            glGetShaderSource(attached[i], length, nullptr, text.data());
            text.resize(text.find('\0'));
            const char* name = stage == GL_VERTEX_SHADER ? "vert" : stage == GL_FRAGMENT_SHADER ? "frag" : "comp";
            shaders.emplace(text, name);
        }
    }
};

RbfVolume sampled(Correction correction, const Kernel& kernel, bool bounded) {
    HexMesh mesh = test::make_nested_cubes(2);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x + p.y * p.z; });
    test::add_field(mesh, "g", [](const Vec3& p) { return p.z; });
    RbfVolume volume = sample_rbf_points(mesh, {.correction = correction, .kernel = kernel}).volume;
    if (!bounded) volume.boundary = {};
    return volume;
}

void draw_splats(Collector& collector, SplatMethod method, const View& view, const Optics& optics) {
    const auto draw = [&](const RbfVolume& volume, SplatOptions options) {
        options.method = method;
        options.sheets = 4;
        options.progress = &collector;
        (void)render_splats(volume, view, optics, options);
    };
    const Clip clip{.planes = {{{0, 0, 0}, {1, 0, 0}}}};
    const RbfVolume bounded = sampled(Correction::Full, {}, true), unbounded = sampled(Correction::Second, {}, false);
    draw(bounded, {});
    draw(bounded, {.color_channel = 1, .shading = Shading{}, .clip = clip});
    draw(bounded, {.normalized = false, .shading = Shading{}});
    draw(unbounded, {.shading = Shading{}});
    draw(unbounded, {.color_channel = 1, .clip = clip});
    draw(sampled(Correction::Second, GaussianKernel{.radius = 2}, true), {});
    RbfVolume separable = sampled(Correction::Second, GaussianKernel{.radius = 2}, true);
    separable.kernel = SeparableGaussianKernel{.radius = 2};
    draw(separable, {.shading = Shading{}});
    if (method == SplatMethod::Sheets) return;
    const RbfVolume volume = sampled(Correction::Second, {}, true);
    draw(volume, {.shading = Shading{}, .shadows = true});
    draw(volume, {.shadows = true});
}

void draw_tets(Collector& collector, const View& view, const Optics& optics) {
    HexMesh mesh = test::make_nested_cubes(1);
    test::add_field(mesh, "f", [](const Vec3& p) { return p.x; });
    for (const bool clipped : {false, true}) {
        Clip clip;
        if (clipped) clip.planes = {{{0, 0, 0}, {1, 0, 0}}};
        for (const ProjectedOrder order : {ProjectedOrder::Topological, ProjectedOrder::Lists, ProjectedOrder::Havs}) {
            (void)render_projected(mesh, "f", view, optics, {.order = order, .clip = clip, .progress = &collector});
        }
    }
}

TEST(GlShaders, AreAcceptedByTheReferenceCompiler) {
    if (gl_devices().empty()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
    if (std::system("glslangValidator --version > /dev/null 2>&1") != 0)
        GTEST_SKIP() << "glslangValidator is not installed (Debian's glslang-tools)";
    Collector collector;
    const Optics optics({.color = {{-1, {1, 0, 0}}, {1, {0, 0, 1}}}, .opacity = {{-1, 0}, {1, .4}}}, .2);
    for (const double height : {0.0, 4.0}) {
        const View view({.eye = {1, -5, 2}, .target = {0, 0, 0}, .up = {0, 0, 1}, .ortho_height = height}, 12, 9);
        if (height == 0) draw_splats(collector, SplatMethod::Gl, view, optics);  // its shaders are the same for both
        draw_splats(collector, SplatMethod::Sheets, view, optics);
        draw_tets(collector, view, optics);
    }
    EXPECT_GT(collector.shaders.size(), 50u);
    const fs::path folder = fs::path(testing::TempDir()) / ("gl_shaders_test" + std::to_string(getpid()));
    fs::create_directories(folder);
    std::string files;
    int number = 0;
    for (const auto& [text, stage] : collector.shaders) {
        const fs::path file = folder / (std::to_string(number++) + "." + stage);
        std::ofstream(file) << text;
        files += " " + file.string();
    }
    const fs::path log = folder / "log";
    const int result = std::system(("glslangValidator" + files + " > " + log.string()).c_str());
    std::ifstream messages(log);
    EXPECT_EQ(result, 0) << std::string(std::istreambuf_iterator<char>(messages), {});
    fs::remove_all(folder);
}

}  // namespace gl_shaders_test
}  // namespace subvol
