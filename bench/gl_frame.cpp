// SPDX-License-Identifier: Apache-2.0
// A model of a frame of the splatter on a GPU, beside what the device counts and measures.
//
//   gl_frame [MODEL[:N]=pawn] [SIZE=512] [SHEETS=200]    SHEETS 0: as many as the kernels need
//   gl_frame MODEL[:N] SIZE counts                       a table for 200 sheets and for as many as needed; nothing is drawn
//
// The model has for each stage the bytes that it reads and writes, its floating-point operations, and the threads that it
// starts. With entries E (kernel, tile, batch of sheets) of N kernels, P pixels and F fragments (pixels of a kernel's section
// with a sheet):
//
//     kernels  N · 156 bytes, N · 250 operations        draw  E · 68 + P · 28 bytes, F · 22 + E · batch · 40 operations
//     bins     N · 32 + E · 8 bytes                     read  P · 20 bytes to the host
//     sort     E · 20 bytes for each digit of 8 bits
//
// The counters are those of GL_ARB_pipeline_statistics_query: threads of compute shaders, and for the method `sheets` vertices
// and fragments, of which Mesa's software counts whole blocks. They count a volume without a boundary, as only the device knows
// how many threads find its hits. For the table the device only converts kernels and counts their entries, which takes seconds
// for ten million kernels by Mesa's software, too; the entries of the model come from the host's kernels.
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "gl_context.h"
#include "gl_dispatch.h"
#include "gl_sheets.h"
#include "gl_splat_bins.h"
#include "gl_splatter.h"
#include "measure.h"
#include "splat_cpu.h"
#include "subvol/error.h"
#include "subvol/model.h"
#include "subvol/sample.h"
#include "subvol/splat.h"

namespace {

using namespace subvol;
using namespace subvol::detail;

/// Counts on the context that is current while a picture is drawn, from the first report of its progress to the last.
class Counter : public Progress {
public:
    explicit Counter(GLenum target) : target_(target) {}
    void report(std::string_view, double fraction) override {
        if (fraction == 0 && query_ == 0) {
            glGenQueries(1, &query_);
            glBeginQuery(target_, query_);
        }
        if (fraction == 1 && query_ != 0) {
            glEndQuery(target_);
            glGetQueryObjectui64v(query_, GL_QUERY_RESULT, &count_);
            glDeleteQueries(1, &query_);
            query_ = 0;
        }
    }
    [[nodiscard]] double count() const { return static_cast<double>(count_); }

private:
    GLenum target_;
    GLuint query_ = 0;
    GLuint64 count_ = 0;
};

struct Scene {
    SplatScene splats;
    Classification classification;
    Camera camera;
    Vec3 center;
    int size, sheets;  // 0 sheets: as many as the kernels need

    /// From another side for each frame.
    [[nodiscard]] View view(int frame) const {
        Camera turned = camera;
        const double a = 0.02 * frame;
        const Vec3 d = camera.eye - center;
        turned.eye = center + Vec3(std::cos(a) * d.x - std::sin(a) * d.y, std::sin(a) * d.x + std::cos(a) * d.y, d.z);
        return View(turned, size, size);
    }
    /// The number of sheets from that side.
    [[nodiscard]] int stack(int frame) const { return make_sheets(splats, view(frame), sheets).count; }
    [[nodiscard]] SplatFrame frame(const View& from) const {
        SplatFrame made;
        prepare_frame(made, splats, from, classification, sheets, nullptr);
        find_interval_ends(made);
        return made;
    }
};

/// The division of the work that a device gets by default.
struct Division {
    int tile_px, batch;

    [[nodiscard]] double bins(int size, int sheets) const {
        return std::pow(std::ceil(double{1} * size / tile_px), 2) * std::ceil(double{1} * sheets / batch);
    }
};

// The bytes of a frame's stages.
double kernel_bytes(double kernels) {
    return 156 * kernels;
}
double bin_bytes(double kernels, double entries) {
    return 32 * kernels + 8 * entries;
}
double sort_bytes(double entries, double bins) {
    return 20 * entries * std::ceil(std::log2(bins) / 8);
}
double draw_bytes(double entries, double pixels) {
    return 68 * entries + 28 * pixels;
}
double read_bytes(double pixels) {
    return 20 * pixels;
}

double groups(double items, double each) {
    constexpr double kMostInRow = 1024;  // as dispatch() divides them
    const double all = std::ceil(items / each), rows = std::ceil(all / kMostInRow);
    return rows > 0 ? std::ceil(all / rows) * rows : 0;
}

/// The threads of a scan of items and their total.
double scan_threads(double items) {
    double threads = 1, level = items + 1;
    for (; level > kGlBlock; level = std::ceil(level / kGlBlock)) threads += 2 * 256 * groups(level, kGlBlock);
    return threads + 256 * groups(level, kGlBlock);
}

double sort_threads(double entries, double bins) {
    const int bits = std::max(1, static_cast<int>(std::bit_width(static_cast<std::uint32_t>(bins) - 1)));
    double threads = 256 * groups(bins + 1, 256), planned = 0;
    for (int shift = 0; shift < bits; shift += 8) {
        const int digit = std::min(8, bits - shift);
        const double scan = scan_threads(std::ldexp(std::ceil(entries / kGlBlock), digit));
        threads += 2 * 256 * groups(entries, kGlBlock) + scan - 1;
        if (digit != planned) threads += 2;  // the plans of the pass and of its scan
        planned = digit;
    }
    return threads;
}

double seconds_of_stage(const GlSplatReport& report, const char* name) {
    for (const StageTime& stage : report.stages)
        if (stage.stage == name) return stage.seconds;
    return 0;
}

void print_stage(const char* name, double seconds, double bytes, double operations) {
    std::printf("  %-8s %8.2f ms %9.1f MB %8.0f GB/s %9.2f G operations %8.0f G/s\n", name, 1e3 * seconds, 1e-6 * bytes,
                seconds > 0 ? 1e-9 * bytes / seconds : 0, 1e-9 * operations, seconds > 0 ? 1e-9 * operations / seconds : 0);
}

/// The best of some frames. moving: each from another side, so that kernels are listed again
double best_frame(GlSplatter& splatter, const Scene& scene, bool moving, GlSplatReport& report) {
    double best = 1e30;
    const int frames = find_gl_device()->hardware ? 12 : 2;
    for (int i = 0; i < frames; ++i) {
        const View view = scene.view(moving ? i + 1 : 0);
        const double wall =
            bench::seconds_of([&] { (void)splatter.draw(view, scene.classification, scene.sheets, nullptr); }, 1);
        if (wall < best) report = splatter.report();
        best = std::min(best, wall);
    }
    return best;
}

double fragments_of(const SheetLists& lists) {
    double sum = 0;
    for (const std::size_t count : lists.fragments) sum += static_cast<double>(count);
    return sum;
}

void print_stages(const Scene& scene, const Division& division) {
    GlSplatter splatter(scene.splats, {});
    GlSplatReport report;
    const double kernels = static_cast<double>(scene.splats.volume->size()), pixels = double{1} * scene.size * scene.size;
    (void)best_frame(splatter, scene, false, report);  // finds the pace of dispatches
    const double still = best_frame(splatter, scene, false, report);
    const double wall = best_frame(splatter, scene, true, report);
    const SplatFrame frame = scene.frame(scene.view(0));
    const double fragments = fragments_of(list_sheets(frame, seen_pixels(frame), 0, frame.sheets.count));
    const double entries = static_cast<double>(report.bin_entries);
    std::printf("%.0f kernels, %.1f M entries, %.1f M fragments, %zu dispatches that draw\n", kernels, 1e-6 * entries,
                1e-6 * fragments, report.dispatches);
    double device = 0;
    for (const StageTime& stage : report.stages) device += stage.seconds;
    std::printf("  %-8s %8.2f ms\n", "boundary", 1e3 * seconds_of_stage(report, "boundary"));
    print_stage("kernels", seconds_of_stage(report, "kernels"), kernel_bytes(kernels), 250 * kernels);
    print_stage("bins", seconds_of_stage(report, "bins"), bin_bytes(kernels, entries), 0);
    print_stage("sort", seconds_of_stage(report, "sort"), sort_bytes(entries, division.bins(scene.size, report.sheets)), 0);
    print_stage("draw", seconds_of_stage(report, "draw"), draw_bytes(entries, pixels),
                22 * fragments + 40 * division.batch * entries);
    print_stage("the rest", wall - device, read_bytes(pixels), 0);
    std::printf("  frame    %8.2f ms; %.2f ms from the same side as before\n", 1e3 * wall, 1e3 * still);
}

void print_count(const char* what, double model, double counted) {
    std::printf("  %-44s model %14.0f  counted %14.0f  %s\n", what, model, counted, model == counted ? "equal" : "");
}

void print_threads(const Scene& scene, const Division& division) {
    GlSplatter splatter(scene.splats, {});
    const double kernels = static_cast<double>(scene.splats.volume->size());
    Counter counter(GL_COMPUTE_SHADER_INVOCATIONS_ARB);
    const auto counted = [&](int side) {
        (void)splatter.draw(scene.view(side), scene.classification, scene.sheets, &counter);
        return counter.count();
    };
    counted(0);
    const double entries = static_cast<double>(splatter.report().bin_entries);
    const double room = entries + std::floor(entries / 8) + 1;  // of the first picture, as long as it is enough
    const auto drawing = [&] {
        return 256 * groups(kernels, 256) + static_cast<double>(splatter.report().tiles) * division.tile_px * division.tile_px;
    };
    const double again = counted(0);
    print_count("threads, from the same side", drawing(), again);
    counted(1);
    const double other = counter.count(), listed = static_cast<double>(splatter.report().bin_entries);
    print_count("threads, from another side",
                drawing() + scan_threads(kernels) + 256 * groups(room, 256) +
                    sort_threads(listed, division.bins(scene.size, scene.stack(1))),
                other);
}

void print_sheets(const Scene& scene) {
    const View view = scene.view(0);
    const SplatFrame frame = scene.frame(view);
    const SheetLists lists = list_sheets(frame, seen_pixels(frame), 0, frame.sheets.count);
    const GlContext context;
    GlSheets sheets;
    const auto counted = [&](GLenum target) {
        GLuint query = 0;
        GLuint64 count = 0;
        glGenQueries(1, &query);
        glBeginQuery(target, query);
        (void)sheets.draw(frame, nullptr);
        glEndQuery(target);
        glGetQueryObjectui64v(query, GL_QUERY_RESULT, &count);
        glDeleteQueries(1, &query);
        return static_cast<double>(count);
    };
    print_count("vertices of the method sheets", 6 * static_cast<double>(lists.splats.size()),
                counted(GL_VERTICES_SUBMITTED_ARB));
    print_count("fragments of the method sheets (about)", fragments_of(lists), counted(GL_FRAGMENT_SHADER_INVOCATIONS_ARB));
}

bool has_counters() {
    const GlContext context;
    return epoxy_has_gl_extension("GL_ARB_pipeline_statistics_query");
}

Scene make(const RbfVolume& volume, const Optics& optics, int size, int sheets) {
    SplatScene splats = make_scene(volume, {});
    Classification classification = classify(splats, optics);
    const Box box = box_of(volume);
    return {std::move(splats), std::move(classification), fit_camera(box, Vec3(-1, 1, -1)), box.center(), size, sheets};
}

/// The entries of a kernel: the rule of shaders/splat_eye.comp.
class EntryCounter {
public:
    EntryCounter(const View& view, const SheetStack& sheets, const Division& division)
        : view_(view), sheets_(sheets), division_(division), per_pixel_(static_cast<float>(1 / view.pixel())) {}

    [[nodiscard]] double of(const EyeSplat& s) const {
        const float reach = 1 / std::sqrt(s.inv_szz);
        const float front = std::max(s.depth - reach, sheets_.first);
        const float back = std::min(s.depth + reach, sheets_.depth(sheets_.count - 1));
        if (!(front <= back + 1e-3f * sheets_.distance)) return 0;
        const auto half = [&](float extent, float shear) { return std::sqrt(extent * extent + shear * reach * shear * reach); };
        const float hx = half(s.extent_x, s.shear_x), hy = half(s.extent_y, s.shear_y);
        const double x = tiles(pixels(s.center_x - hx, s.center_x + hx, front, back), view_.width());
        const double y = tiles(pixels(-s.center_y - hy, -s.center_y + hy, front, back), view_.height());
        return x * y * batches(s.depth, reach);
    }

private:
    using Ends = std::array<float, 2>;

    [[nodiscard]] Ends pixels(float low, float high, float front, float back) const {
        if (!view_.perspective()) return {low * per_pixel_, high * per_pixel_};
        const float a = per_pixel_ / (sheets_.middle + front), b = per_pixel_ / (sheets_.middle + back);
        return {std::min(low * a, low * b), std::max(high * a, high * b)};
    }
    /// ends: from the middle of the picture, which has `size` pixels in this direction
    [[nodiscard]] double tiles(const Ends& ends, int size) const {
        const float middle = 0.5f * static_cast<float>(size), low = middle + ends[0], high = middle + ends[1];
        if (!(high > -1) || !(low < static_cast<float>(size) + 1)) return 0;
        const auto tile = [&](float px) {
            const auto most = static_cast<float>((size + division_.tile_px - 1) / division_.tile_px - 1);
            return std::floor(std::clamp(px / static_cast<float>(division_.tile_px), 0.0f, most));
        };
        return std::max(0.0, static_cast<double>(tile(high + 1) - tile(low - 1) + 1));
    }
    [[nodiscard]] double batches(float depth, float reach) const {
        const auto sheet = [&](float z) {
            return std::clamp((z - sheets_.first) / sheets_.distance, -1.0f, static_cast<float>(sheets_.count));
        };
        const int first = std::max(static_cast<int>(sheet(depth - reach) - 0.5f), 0);
        const int last = std::min(static_cast<int>(sheet(depth + reach) + 0.5f), sheets_.count - 1);
        return std::max(0, last / division_.batch - first / division_.batch + 1);
    }

    const View& view_;
    SheetStack sheets_;
    Division division_;
    float per_pixel_;
};

/// Entries as the device counts them; nothing is drawn. Kernels come to it in parts that any device has room for.
double counted_entries(const SplatFrame& frame, const Division& division) {
    constexpr std::uint32_t kPart = 1U << 20;
    const SplatScene& scene = *frame.scene;
    const std::string defines = gl_scene_defines(scene) + "#define kTile " + std::to_string(division.tile_px) +
                                "\n#define kBatch " + std::to_string(division.batch) + "\n";
    GlSplatBins bins(defines, GlExtras(scene).count);
    GlSplatFrame uniforms =
        gl_splat_frame(scene, *frame.view, *frame.classification, frame.sheets, division.tile_px, division.batch);
    uniforms.end_batch = uniforms.batches;
    GlBuffer buffer(sizeof uniforms);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, buffer.id());
    GlStages stages;
    std::vector<std::uint32_t> ids(scene.volume->size());
    std::iota(ids.begin(), ids.end(), 0U);
    double entries = 0;
    for (std::size_t first = 0; first < ids.size(); first += kPart) {
        const std::size_t count = std::min<std::size_t>(kPart, ids.size() - first);
        bins.upload(pack_kernels(scene, std::span<const std::uint32_t>(ids).subspan(first, count)));
        uniforms.kernels = bins.kernels();
        buffer.upload(sizeof uniforms, &uniforms);
        bins.count(stages);
        entries += static_cast<double>(bins.entries());
    }
    return entries;
}

/// A line for each division of a picture's work, by the numbers of sheets.
void print_table(const Scene& scene) {
    const View view = scene.view(0);
    const GlContext context;
    SplatFrame frame;
    frame.scene = &scene.splats;
    frame.view = &view;
    frame.classification = &scene.classification;
    eye_splats(frame.kernels, scene.splats, view, scene.classification);
    const double kernels = static_cast<double>(scene.splats.volume->size()), pixels = double{1} * scene.size * scene.size;
    std::printf("%.0f kernels; MB: kernels %.0f, read %.0f\n", kernels, 1e-6 * kernel_bytes(kernels),
                1e-6 * read_bytes(pixels));
    std::printf(
        "  sheets  M fragments  tile², batch    bins  M entries: model  counted  differ by  MB: bins    sort    draw\n");
    for (const int wanted : {200, 0}) {
        frame.sheets = make_sheets(scene.splats, view, wanted);
        const double fragments = fragments_of(list_sheets(frame, {0, 0, scene.size, scene.size}, 0, frame.sheets.count));
        for (const Division division : {Division{8, 4}, Division{16, 8}, Division{32, 32}}) {
            const EntryCounter counter(view, frame.sheets, division);
            double entries = 0;
            for (const EyeSplat& s : frame.kernels.splats) entries += counter.of(s);
            const double counted = counted_entries(frame, division);
            const double bins = division.bins(scene.size, frame.sheets.count);
            std::printf("  %6d %12.1f  %8d, %2d %8.0f %17.2f %8.2f %10.0f %9.0f %7.0f %7.0f\n", frame.sheets.count,
                        1e-6 * fragments, division.tile_px, division.batch, bins, 1e-6 * entries, 1e-6 * counted,
                        counted - entries, 1e-6 * bin_bytes(kernels, entries), 1e-6 * sort_bytes(entries, bins),
                        1e-6 * draw_bytes(entries, pixels));
            std::fflush(stdout);
        }
    }
}

void run(const std::string& name, int size, const std::string& what) {
    const std::size_t colon = name.find(':');
    const int n = colon == std::string::npos ? 0 : std::atoi(name.c_str() + colon + 1), sheets = std::atoi(what.c_str());
    RbfVolume volume = sample_rbf_points(make_model(name.substr(0, colon), n)).volume;
    const Optics optics(
        {.color = {{-1, {.1, .2, .9}}, {0, {.9, .9, .9}}, {1, {.9, .2, .1}}}, .opacity = {{-1, .05}, {0, .02}, {1, .3}}},
        box_of(volume).diagonal() / 100);
    const auto device = find_gl_device();
    if (!device) throw Error(ErrorCode::MissingCapability, "no OpenGL 4.5 was found through EGL");
    const Division division = device->hardware ? Division{8, 4} : Division{16, kBatch};
    std::printf("%s at %d², sheets: %s, %s\n", name.c_str(), size, what.c_str(), device->renderer.c_str());
    if (what == "counts") return print_table(make(volume, optics, size, 0));
    print_stages(make(volume, optics, size, sheets), division);
    if (!has_counters()) return;
    volume.boundary = {};
    const Scene unbounded = make(volume, optics, size, sheets);
    print_threads(unbounded, division);
    print_sheets(unbounded);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        run(argc > 1 ? argv[1] : "pawn", argc > 2 ? std::atoi(argv[2]) : 512, argc > 3 ? argv[3] : "200");
    } catch (const Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 3;
    }
}
