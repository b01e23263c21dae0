// SPDX-License-Identifier: Apache-2.0
// The side on which a ray passes an edge, where the two products that decide are equal but for rounding.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "gl_buffer.h"
#include "gl_context.h"
#include "gl_program.h"
#include "shader_projected_crossing_glsl.h"
#include "shader_projected_frame_glsl.h"
#include "subvol/error.h"

namespace subvol {
namespace exact_sides_test {

using detail::GlBuffer;
using detail::GlContext;
using detail::GlProgram;

constexpr const char* kShader = R"glsl(#version 450
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Edges { vec4 edges[]; };
layout(std430, binding = 1) writeonly buffer Sides { uint sides[]; };
void main() {
    bool left;
    vec4 e = edges[gl_GlobalInvocationID.x];
    doubled_area(e.xy, e.zw, left);
    sides[gl_GlobalInvocationID.x] = uint(left);
}
)glsl";

using Edge = std::array<float, 4>;

/// The rule of doubled_area; products of two floats are exact in double precision.
bool passes_left(const Edge& e) {
    const double one = double{e[0]} * double{e[3]}, other = double{e[2]} * double{e[1]};
    if (one != other) return one > other;
    return e[1] != e[3] ? e[1] > e[3] : e[2] >= e[0];
}

TEST(ExactSides, AreThoseOfExactProducts) {
    std::optional<GlContext> context;
    try {
        context.emplace();
    } catch (const Error& e) {
        GTEST_SKIP() << e.what();
    }
    std::mt19937 random(11);
    std::uniform_real_distribution<float> part(-1, 1);
    std::uniform_int_distribution<int> power(-30, 30), few(-2, 2);
    std::vector<Edge> edges{{0, 0, 0, 0}, {1, 2, 2, 4}, {-1, -2, 1, 2}, {0, 1, 0, 2}, {0, 1, 1, 0}, {3, -3, -3, 3}};
    while (edges.size() < 64 * 512) {
        // Two points in line with the ray but for rounding, and a last bit or two.
        const float x = std::ldexp(part(random), power(random)), y = std::ldexp(part(random), power(random));
        const float scale = std::ldexp(part(random), power(random) / 3);
        Edge e{x, y, x * scale, y * scale};
        for (int i = few(random); i > 0; --i) e[2] = std::nextafter(e[2], 1e30f);
        for (int i = few(random); i > 0; --i) e[3] = std::nextafter(e[3], -1e30f);
        edges.push_back(e);
    }
    const GlProgram program(
        "exact_sides_test.comp", kShader, "#define PERSPECTIVE 0\n",
        {{"projected_frame.glsl", kShader_projected_frame_glsl}, {"projected_crossing.glsl", kShader_projected_crossing_glsl}});
    const GlBuffer edge_buffer(0, edges.size() * sizeof(Edge), edges.data());
    const GlBuffer side_buffer(1, edges.size() * sizeof(std::uint32_t), nullptr);
    program.use();
    glDispatchCompute(static_cast<GLuint>(edges.size() / 64), 1, 1);
    std::vector<std::uint32_t> sides(edges.size());
    side_buffer.read(sides.size() * sizeof sides[0], sides.data());
    int undecided = 0;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const Edge& e = edges[i];
        ASSERT_EQ(sides[i] != 0, passes_left(e)) << e[0] << ' ' << e[1] << ' ' << e[2] << ' ' << e[3];
        undecided += e[0] * e[3] == e[2] * e[1] ? 1 : 0;
    }
    EXPECT_GT(undecided, 1000) << "rounding makes many of the products equal";
}

}  // namespace exact_sides_test
}  // namespace subvol
