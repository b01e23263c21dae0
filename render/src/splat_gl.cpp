#include <algorithm>

#include "gl_buffer.h"
#include "gl_context.h"
#include "gl_program.h"
#include "shader_splat_comp.h"
#include "splat_backend.h"

namespace subvol::detail {

namespace {

constexpr int kMostGroups = 4096;  // work groups in a dispatch: they fill a device, and between dispatches one can stop

std::string defines() {
    return "#define SPLAT_BATCH " + std::to_string(SplatFrame::kBatch) + "\n#define SPLAT_LEAST_WEIGHT " +
           std::to_string(kLeastWeight) + "\n#define SPLAT_LEAST_DIFFERENCE " + std::to_string(kLeastDifference) +
           "\n#define SPLAT_OPAQUE " + std::to_string(kOpaque) + "\n";
}

template <class T>
std::size_t bytes(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

void set_uniforms(const GlProgram& program, const SplatFrame& frame, const View& view, const PreintegratedTable& table) {
    glUseProgram(program.id());
    glUniform2i(program.uniform("size"), view.width(), view.height());
    glUniform2i(program.uniform("tiles"), frame.tiles_x, frame.tiles_y);
    glUniform1i(program.uniform("sheets"), frame.sheets);
    glUniform1i(program.uniform("batches"), frame.batches);
    glUniform1f(program.uniform("first_depth"), frame.first_depth);
    glUniform1f(program.uniform("sheet_distance"), frame.sheet_distance);
    glUniform1f(program.uniform("pixel"), static_cast<float>(view.pixel()));
    glUniform1i(program.uniform("perspective"), view.perspective());
    glUniform2f(program.uniform("table_range"), static_cast<float>(table.min), static_cast<float>(table.max));
}

}  // namespace

Image draw_splats_gl(const SplatFrame& frame, const View& view, const PreintegratedTable& table, Progress* progress) {
    const GlContext context;
    const GlProgram program("splat.comp", kShader_splat_comp, defines());
    Image image(view.width(), view.height());
    const GlBuffer splats(0, bytes(frame.splats), frame.splats.data());
    const GlBuffer bin_offsets(1, bytes(frame.bin_offsets), frame.bin_offsets.data());
    const GlBuffer bin_splats(2, bytes(frame.bin_splats), frame.bin_splats.data());
    const GlBuffer interval_offsets(3, bytes(frame.intervals.offsets), frame.intervals.offsets.data());
    const GlBuffer interval_depths(4, bytes(frame.intervals.depths), frame.intervals.depths.data());
    const GlBuffer prefixes(5, bytes(table.prefixes), table.prefixes.data());
    const GlBuffer points(6, bytes(table.points), table.points.data());
    const GlBuffer picture(7, bytes(image.rgba), nullptr);

    set_uniforms(program, frame, view, table);
    const int tiles = frame.tiles_x * frame.tiles_y;
    for (int first = 0; first < tiles; first += kMostGroups) {
        if (first > 0) glFinish();
        report_progress(progress, "splat", static_cast<double>(first) / tiles);
        glUniform1i(program.uniform("first_tile"), first);
        glDispatchCompute(static_cast<GLuint>(std::min(kMostGroups, tiles - first)), 1, 1);
    }
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    picture.read(bytes(image.rgba), image.rgba.data());
    report_progress(progress, "splat", 1);
    check_gl(context.renderer());
    return image;
}

}  // namespace subvol::detail
