// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <random>

#include "gl_buffer.h"
#include "gl_context.h"
#include "gl_program.h"
#include "lib/kernel_samples.h"
#include "subvol/detail/kernel_code.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;
namespace kernel_glsl_test {

using detail::GlBuffer;
using detail::GlContext;
using detail::GlProgram;

constexpr int kPlaces = 8192;

const char* const kShader = R"glsl(#version 430
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Table { float table[]; };
layout(std430, binding = 1) readonly buffer Places { vec4 places[]; };
layout(std430, binding = 2) writeonly buffer Results { vec4 results[]; };
uniform int type;
uniform vec4 parameters;
float kernel_table(int i) { return table[i]; }
void main() {
    uint id = gl_GlobalInvocationID.x;
    results[id] = vec4(kernel_value(type, parameters, places[id].xyz), kernel_gradient(type, parameters, places[id].xyz));
}
)glsl";

using Four = std::array<float, 4>;

std::vector<Four> random_places(double reach) {
    std::mt19937 random(17);
    std::uniform_real_distribution<double> anywhere(-reach, reach);
    std::vector<Four> places(kPlaces);
    for (auto& place : places) {
        for (std::size_t axis = 0; axis < 3; ++axis) place[axis] = static_cast<float>(anywhere(random));
    }
    places[0] = {};
    return places;
}

/// Value and gradient at every place, computed by the shader.
std::vector<Four> evaluate(const GlProgram& program, const Kernel& kernel, const std::vector<Four>& places) {
    const KernelCode code = kernel_code(kernel);
    const std::vector<float> table(code.table.begin(), code.table.end());
    const GlBuffer table_buffer(0, table.size() * sizeof(float), table.data());
    const GlBuffer place_buffer(1, places.size() * sizeof(Four), places.data());
    const GlBuffer result_buffer(2, places.size() * sizeof(Four), nullptr);
    glUseProgram(program.id());
    glUniform1i(program.uniform("type"), code.type);
    const auto& p = code.parameters;
    glUniform4f(program.uniform("parameters"), static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]),
                static_cast<float>(p[3]));
    glDispatchCompute(kPlaces / 64, 1, 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    std::vector<Four> results(places.size());
    result_buffer.read(results.size() * sizeof(Four), results.data());
    return results;
}

/// The largest change of the kernel and its gradient over a few float steps around x: the effect of rounding, also at kinks.
struct Spread {
    double value = 0;
    Vec3 gradient{0.0};
};

Spread spread_about(const Kernel& kernel, const Vec3& x) {
    Spread spread;
    const double value = kernel_value(kernel, x);
    const Vec3 gradient = kernel_gradient(kernel, x);
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const Vec3 near = x + 5e-7 * sign;
        spread.value = std::max(spread.value, std::abs(kernel_value(kernel, near) - value));
        spread.gradient = glm::max(spread.gradient, glm::abs(kernel_gradient(kernel, near) - gradient));
    }
    return spread;
}

TEST(KernelGlsl, EqualsCppToFloatAccuracy) {
    std::optional<GlContext> context;
    try {
        context.emplace();
    } catch (const Error& e) {
        GTEST_SKIP() << e.what();
    }
    const GlProgram program("kernel_glsl_test.comp", kShader, kernel_glsl());
    for (const auto& [name, kernel] : test::every_kernel()) {
        const auto places = random_places(1.1 * support_radius(kernel));
        const auto results = evaluate(program, kernel, places);
        int inside = 0;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Vec3 x(places[i][0], places[i][1], places[i][2]);
            const double value = kernel_value(kernel, x);
            const Vec3 gradient = kernel_gradient(kernel, x);
            const Spread spread = spread_about(kernel, x);
            // Floats round at 6e-8; the polynomials of ρ ≤ 3 have terms of up to 10, their gradients of up to 30.
            ASSERT_NEAR(results[i][0], value, 3e-6 + 2 * spread.value) << name << " at " << x.x << " " << x.y << " " << x.z;
            for (int axis = 0; axis < 3; ++axis) {
                ASSERT_NEAR(results[i][static_cast<std::size_t>(axis + 1)], gradient[axis], 2e-5 + 2 * spread.gradient[axis])
                    << name << " axis " << axis << " at " << x.x << " " << x.y << " " << x.z;
            }
            if (value != 0) ++inside;
        }
        EXPECT_GT(inside, kPlaces / 4) << name;
    }
}

}  // namespace kernel_glsl_test
}  // namespace subvol
