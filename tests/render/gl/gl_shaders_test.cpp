// SPDX-License-Identifier: Apache-2.0
// Every assembled program against the reference compiler of Khronos, which is stricter than most drivers, and as SPIR-V for
// OpenGL (-G), where everything that crosses a stage or comes from the host has a location. The rules of Vulkan (-V) are not
// ours: they have neither single uniforms nor gl_VertexID.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
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

/// The texts of a program's shaders, each with the ending that the compiler knows the stage by.
using Texts = std::map<std::string, std::string>;

/// Collects all programs of the context that is current while a picture is drawn.
class Collector : public Progress {
public:
    void report(std::string_view, double) override {
        for (GLuint program = 1; program < 512; ++program) {
            if (glIsProgram(program)) collect(program);
        }
    }
    std::set<Texts> programs{};

private:
    void collect(GLuint program) {
        std::array<GLuint, 4> attached{};
        GLsizei count = 0;
        glGetAttachedShaders(program, static_cast<GLsizei>(attached.size()), &count, attached.data());
        Texts texts;
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            GLint stage = 0, length = 0;
            glGetShaderiv(attached[i], GL_SHADER_TYPE, &stage);
            glGetShaderiv(attached[i], GL_SHADER_SOURCE_LENGTH, &length);
            std::string text(static_cast<std::size_t>(length), '\0');
            glGetShaderSource(attached[i], length, nullptr, text.data());
            text.resize(text.find('\0'));
            texts[stage == GL_VERTEX_SHADER ? "vert" : stage == GL_FRAGMENT_SHADER ? "frag" : "comp"] = text;
        }
        programs.insert(texts);
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

/// What the reference compiler says against a program.
std::string messages(const Texts& program, const fs::path& folder) {
    fs::create_directories(folder);
    for (const auto& [stage, text] : program) std::ofstream(folder / ("shader." + stage)) << text;
    const bool accepted = std::system(("cd " + folder.string() + " && glslangValidator -G shader.* > log 2>&1").c_str()) == 0;
    std::ifstream log(folder / "log");
    const std::string text(std::istreambuf_iterator<char>(log), {});
    fs::remove_all(folder);
    return accepted ? "" : "refused: " + text;
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
    EXPECT_GT(collector.programs.size(), 50u);
    const fs::path folder = fs::path(testing::TempDir()) / ("gl_shaders_test" + std::to_string(getpid()));
    for (const Texts& program : collector.programs) EXPECT_EQ(messages(program, folder), "");
}

}  // namespace gl_shaders_test
}  // namespace subvol
