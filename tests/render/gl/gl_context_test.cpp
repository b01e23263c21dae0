// SPDX-License-Identifier: Apache-2.0
#include "gl_context.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <thread>
#include <vector>

#include "gl_buffer.h"
#include "gl_pace.h"
#include "gl_program.h"
#include "subvol/error.h"

namespace subvol {
namespace gl_context_test {

using detail::check_gl;
using detail::check_storage;
using detail::GlBuffer;
using detail::GlContext;
using detail::GlProgram;
using detail::GlScope;
using detail::GlStorage;

class Gl : public testing::Test {
protected:
    void SetUp() override {
        if (gl_devices().empty()) GTEST_SKIP() << "no OpenGL 4.5 through EGL";
    }
};

using GlContexts = Gl;
using GlBuffers = Gl;
using GlPrograms = Gl;

std::string message_of(const auto& work) {
    try {
        work();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::MissingCapability) << error.what();
        return error.what();
    }
    ADD_FAILURE() << "no error was thrown";
    return {};
}

/// Doubles the numbers of a buffer on the current context.
std::vector<std::uint32_t> doubled(std::vector<std::uint32_t> numbers) {
    const GlProgram program("double.comp", R"glsl(#version 450
layout(local_size_x = 1) in;
layout(std430, binding = 0) buffer Numbers { uint numbers[]; };
void main() { numbers[gl_WorkGroupID.x] *= 2; }
)glsl",
                            "");
    GlBuffer buffer(0, 4 * numbers.size(), numbers.data());
    program.use();
    glDispatchCompute(static_cast<GLuint>(numbers.size()), 1, 1);
    buffer.read(4 * numbers.size(), numbers.data());
    return numbers;
}

TEST_F(GlContexts, AreThoseOfTheList) {
    const auto devices = gl_devices();
    for (std::size_t i = 0; i < devices.size(); ++i) {
        EXPECT_EQ(devices[i].index, static_cast<int>(i));
        const GlContext context(static_cast<int>(i));
        EXPECT_EQ(context.renderer(), devices[i].renderer);
        EXPECT_EQ(context.hardware(), devices[i].hardware);
        EXPECT_EQ(find_gl_device(static_cast<int>(i))->version, devices[i].version);
        if (i > 0) {
            EXPECT_GE(devices[i - 1].hardware, devices[i].hardware) << "hardware first";
        }
    }
    EXPECT_EQ(find_gl_device()->index, 0);
}

TEST_F(GlContexts, AreThoseOfTheDriverThatIsAskedFor) {
    const char* driver = std::getenv("GALLIUM_DRIVER");
    if (driver == nullptr) GTEST_SKIP() << "no driver is asked for: GALLIUM_DRIVER is not set (render.zink sets it)";
    EXPECT_NE(GlContext(0).renderer().find(driver), std::string::npos) << GlContext(0).renderer();
}

TEST_F(GlContexts, OfAnUnknownNumberAreRefusedWithAList) {
    for (const int index : {-1, static_cast<int>(gl_devices().size())}) {
        const std::string message = message_of([&] { const GlContext context(index); });
        EXPECT_NE(message.find(std::to_string(index)), std::string::npos) << message;
        EXPECT_NE(message.find(gl_devices().front().renderer), std::string::npos) << message;
        EXPECT_EQ(message_of([&] { (void)find_gl_device(index); }), message);
    }
}

TEST_F(GlContexts, LiveSideBySide) {
    const GlContext first;
    const GLuint made = glCreateShader(GL_COMPUTE_SHADER);
    {
        const GlContext second;
        EXPECT_FALSE(glIsShader(made)) << "contexts share nothing";
        {
            const GlScope scope(first);
            EXPECT_TRUE(glIsShader(made));
            EXPECT_EQ(gl_devices().front().index, 0);
            EXPECT_TRUE(glIsShader(made)) << "listing devices does not change the current context";
        }
        EXPECT_FALSE(glIsShader(made)) << "after the scope the second one is current again";
        EXPECT_EQ(doubled({1, 2, 3}), (std::vector<std::uint32_t>{2, 4, 6}));
    }
    const GlScope scope(first);
    EXPECT_TRUE(glIsShader(made));
    EXPECT_EQ(doubled({4, 5}), (std::vector<std::uint32_t>{8, 10}));
}

TEST_F(GlContexts, GoFromThreadToThread) {
    const GlContext context;
    std::string refused;
    std::thread([&] { refused = message_of([&] { const GlScope scope(context); }); }).join();
    EXPECT_NE(refused.find("another thread"), std::string::npos) << refused;
    context.release();
    std::vector<std::uint32_t> result;
    for (int i = 0; i < 2; ++i) {
        std::thread([&] {
            const GlScope scope(context);
            result = doubled({7});
        }).join();
        EXPECT_EQ(result, std::vector<std::uint32_t>{14});
    }
    const GlScope scope(context);
    EXPECT_EQ(doubled({8}), std::vector<std::uint32_t>{16});
}

TEST_F(GlContexts, AreNotTakenFromAnotherThreadByADestructor) {
    struct Inhabitant {
        ~Inhabitant() { ++*freed; }
        int* freed;
    };
    int freed = 0;
    const GlContext context;
    std::unique_ptr<Inhabitant> first(new Inhabitant{&freed}), second(new Inhabitant{&freed});
    Inhabitant* const given_up = first.get();
    std::thread([&] { detail::free_in(context, first); }).join();
    EXPECT_EQ(freed, 0) << "the context is current here";
    EXPECT_EQ(first, nullptr);
    context.release();
    std::thread([&] { detail::free_in(context, second); }).join();
    EXPECT_EQ(freed, 1);
    delete given_up;
}

TEST_F(GlContexts, WorkOnSeveralThreadsAtOnce) {
    std::array<std::vector<std::uint32_t>, 3> results;
    std::vector<std::thread> threads;
    for (auto& result : results) {
        threads.emplace_back([&result] {
            const GlContext context;
            for (int i = 0; i < 5; ++i) result = doubled({1, 10, 100});
        });
    }
    for (auto& thread : threads) thread.join();
    for (const auto& result : results) EXPECT_EQ(result, (std::vector<std::uint32_t>{2, 20, 200}));
}

TEST_F(GlContexts, ReportEachErrorOnce) {
    const GlContext context;
    EXPECT_NO_THROW(check_gl("nothing"));
    glEnable(0xffff);
    glDispatchCompute(1, 1, 1);  // without a program
    const std::string message = message_of([] { check_gl("the test"); });
    EXPECT_EQ(message.find("the test: "), 0U) << message;
    EXPECT_NE(message.find("invalid enumerant"), std::string::npos) << "the first error is reported: " << message;
    EXPECT_NO_THROW(check_gl("nothing"));
}

TEST_F(GlBuffers, GrowAreFilledReadAndCleared) {
    const GlContext context;
    GlBuffer buffer;
    EXPECT_EQ(buffer.bytes(), 0U);
    buffer.read(0, nullptr);
    buffer.grow(40);
    const GLuint id = buffer.id();
    buffer.grow(20);
    EXPECT_EQ(buffer.id(), id) << "the buffer is used again";
    std::array<std::uint32_t, 10> numbers;
    std::iota(numbers.begin(), numbers.end(), 1U);
    buffer.upload(40, numbers.data());
    const std::uint32_t changed = 77;
    buffer.upload(4, &changed, 12);
    std::array<std::uint32_t, 3> some{};
    buffer.read(12, some.data(), 8);
    EXPECT_EQ(some, (std::array<std::uint32_t, 3>{3, 77, 5}));
    GlBuffer moved = std::move(buffer);
    moved.clear();
    moved.read(40, numbers.data());
    EXPECT_EQ(numbers, (std::array<std::uint32_t, 10>{}));
    moved.grow(4000);
    EXPECT_GE(moved.bytes(), 4000U);
}

TEST_F(GlBuffers, ThatDoNotFitAreRefused) {
    const GlContext context;
    EXPECT_TRUE(GlBuffer::fits(context.device().max_ssbo_bytes));
    EXPECT_FALSE(GlBuffer::fits(context.device().max_ssbo_bytes + 1));
    GlBuffer buffer(16);
    const std::string message = message_of([&] { buffer.grow(context.device().max_ssbo_bytes + 1); });
    EXPECT_NE(message.find(std::to_string(context.device().max_ssbo_bytes)), std::string::npos) << message;
    EXPECT_EQ(buffer.bytes(), 16U) << "the buffer has not changed";
}

TEST_F(GlContexts, SayWhichStorageBuffersAreMissing) {
    const GlContext context;
    const GlStorage available = GlStorage::available(), least{.compute = 8, .bindings = 8};  // that the standard guarantees
    EXPECT_GE(available.compute, least.compute);
    EXPECT_GE(available.bindings, least.bindings);
    EXPECT_NO_THROW(check_storage(available, available, ""));
    const std::string compute = message_of([&] { check_storage({.compute = 16, .bindings = 16}, least, "the CPU"); });
    EXPECT_NE(compute.find("8 storage buffers for compute shaders; this work needs 16 (the CPU)"), std::string::npos)
        << compute;
    const std::string vertex = message_of([&] { check_storage({.vertex = 1}, least, "the CPU"); });
    EXPECT_NE(vertex.find("0 storage buffers for vertex shaders"), std::string::npos) << vertex;
}

TEST(GlPaces, GiveTheDeviceLessIfItTakesLongAndMoreIfItDoesNot) {
    detail::GlPace pace(64, 16, 256);
    EXPECT_EQ(pace.amount(), 64u);
    pace.took(.2);
    EXPECT_EQ(pace.amount(), 32u);
    pace.took(.03);
    EXPECT_EQ(pace.amount(), 32u) << "as it should be";
    for (int i = 0; i < 9; ++i) pace.took(1);
    EXPECT_EQ(pace.amount(), 16u);
    for (int i = 0; i < 9; ++i) pace.took(.001);
    EXPECT_EQ(pace.amount(), 256u);
}

TEST_F(GlPrograms, NameFileAndLineOfAnError) {
    const GlContext context;
    const std::vector<detail::ShaderText> common{{"good.glsl", "const uint kTwo = 2u;\n"},
                                                 {"bad.glsl", "uint twice(uint i) { return kTwo * i; }\nuint broken(;\n"}};
    const std::string main = "#version 450\nlayout(local_size_x = 1) in;\nvoid main() {\n    undeclared = 1;\n}\n";
    const std::string in_common = message_of([&] { const GlProgram program("main.comp", main, "#define X\n", common); });
    EXPECT_NE(in_common.find("bad.glsl:2"), std::string::npos) << in_common;
    const std::string in_main = message_of([&] { const GlProgram program("main.comp", main, "#define X\n", {common[0]}); });
    EXPECT_NE(in_main.find("main.comp:4"), std::string::npos) << in_main;
}

}  // namespace gl_context_test
}  // namespace subvol
