#include "subvol/render_pt.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "gl_context.h"
#include "gl_tets.h"
#include "subvol/error.h"
#include "subvol/gl_device.h"
#include "tet_mesh.h"
#include "tet_order.h"

namespace subvol {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostTets = std::size_t{0x7fffffff} / 6;  // OpenGL numbers vertices by signed integers

constexpr double kMostUnits = 1e30;  // that a float holds, with room
constexpr double kFarValue = 1e12;   // values further out look like this one

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The context that was current is so again.
struct KeepCurrent {
    detail::EglContext before = detail::EglContext::current();
    ~KeepCurrent() { (void)before.make_current(); }
};

void check_device(const std::optional<int>& device) {
    if (find_gl_device(device)) return;
    throw Error(ErrorCode::MissingCapability, "projected tetrahedra need OpenGL 4.5, and none was found through EGL", {},
                "the method tets");
}

std::size_t most_fragments(const PtOptions& options, const GlDevice& device) {
    constexpr std::size_t kFragment_bytes = 32, kHalf_bytes = 16;  // two buffers
    constexpr std::size_t kMost = std::size_t{1} << 31;            // that 32 bits number, with room
    return std::min({options.list_bytes / kFragment_bytes, device.max_ssbo_bytes / kHalf_bytes, kMost});
}

/// Of the values of the knots: they are counted in parts of it.
struct Values {
    double first, range;
};

Values set_knots(detail::GlTetScene& scene, const Optics& optics) {
    const auto knots = optics.knots();
    const double range = knots.back() - knots.front();
    const Values values{knots.front(), range > 0 ? range : 1};
    scene.opacity_units = scene.scale / optics.opacity_unit();
    if (!(scene.opacity_units < kMostUnits)) {
        throw Error(ErrorCode::InvalidInput, "the opacity unit is " + std::to_string(optics.opacity_unit()), {},
                    "more than 1e-30 of the volume");
    }
    for (const double knot : knots) {
        const Vec3 color = optics.color(knot);
        const double opacity = -std::expm1(-optics.extinction(knot) * optics.opacity_unit());
        const auto to_float = [](double v) { return static_cast<float>(v); };
        scene.knots.push_back({{to_float(color.x), to_float(color.y), to_float(color.z), to_float(opacity)},
                               {to_float((knot - values.first) / values.range), 0, 0, 0}});
    }
    return values;
}

void set_points(detail::GlTetScene& scene, const TetMesh& mesh, const View& view, double middle_depth, const Values& values) {
    scene.points.resize(mesh.points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.points.size(), 4096), [&](const auto& range) {
        for (std::size_t p = range.begin(); p < range.end(); ++p) {
            const Vec3 eye = (view.to_eye(mesh.points[p].position) - Vec3(0, 0, middle_depth)) / scene.scale;
            const double value = std::clamp((mesh.points[p].value - values.first) / values.range, -kFarValue, kFarValue);
            scene.points[p] = {static_cast<float>(eye.x), static_cast<float>(eye.y), static_cast<float>(eye.z),
                               static_cast<float>(value)};
        }
    });
}

detail::GlTetScene make_scene(const TetMesh& mesh, const Box& box, const View& view, const Optics& optics) {
    detail::GlTetScene scene;
    const double diagonal = glm::length(box.upper - box.lower);
    if (diagonal > 0) scene.scale = diagonal;
    const double middle_depth = view.to_eye(0.5 * (box.lower + box.upper)).z;
    scene.middle_depth = middle_depth / scene.scale;
    set_points(scene, mesh, view, middle_depth, set_knots(scene, optics));
    scene.tets.reserve(mesh.tets.size());
    for (const auto& tet : mesh.tets) {
        scene.tets.push_back(tet.corner);
        std::sort(scene.tets.back().begin(), scene.tets.back().end());
    }
    return scene;
}

}  // namespace

PtResult render_projected_tets(const HexMesh& mesh, std::span<const double> scalar, const View& view, const Optics& optics,
                               const PtOptions& options) {
    check_tet_input(mesh, scalar);
    check_device(options.device);
    PtResult result;
    PtReport& report = result.report;

    auto start = Clock::now();
    report_progress(options.progress, "build", 0);
    const TetMesh tets = build_tet_mesh(mesh, scalar);
    if (tets.tets.size() > kMostTets) {
        throw Error(ErrorCode::MissingCapability, std::to_string(tets.tets.size()) + " tetrahedra are too many for OpenGL", {},
                    "at most " + std::to_string(kMostTets) + ", or the method tets");
    }
    detail::GlTetScene scene = make_scene(tets, bounds(mesh), view, optics);
    report.tets = tets.tets.size();
    report.degenerate_tets = tets.degenerate_tets;
    report.inverted_tets = tets.inverted_tets;
    report_progress(options.progress, "build", 1);
    report.seconds_build = seconds_since(start);

    start = Clock::now();
    TetOrder order = options.order == PtOrder::Topological ? order_topologically(tets, view) : order_by_centroid(tets, view);
    scene.order = std::move(order.tets);
    report.cycles = order.cycles;
    report.seconds_sort = seconds_since(start);

    start = Clock::now();
    const KeepCurrent keep;
    const detail::GlContext context(options.device);
    report.device = context.renderer();
    detail::GlTets drawer(scene, view);
    if (options.order != PtOrder::Lists) result.image = drawer.draw_in_order(options.progress);
    report.seconds_draw = seconds_since(start);
    if (options.order != PtOrder::Lists && !options.count_violations) return result;

    auto lists = drawer.draw_in_lists(most_fragments(options, context.device()), options.progress);
    report.fragments = lists.fragments;
    report.parts = lists.parts;
    report.violations = lists.violations;
    if (options.order == PtOrder::Lists) {
        result.image = std::move(lists.image);
        report.seconds_draw = seconds_since(start);
    }
    return result;
}

}  // namespace subvol
