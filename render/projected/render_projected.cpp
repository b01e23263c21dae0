// SPDX-License-Identifier: Apache-2.0
// Draws tetrahedra, or their faces, over each other by OpenGL. The tetrahedra are built once and stay on the device. Each
// picture goes through these steps:
//
//     prepare   points in eye space in parts of the volume's diagonal, depths relative to that of its middle; values in parts
//               of the range of the knots; faces of the cut, slices and ends of rays likewise
//     order     by centroids, by shared faces, or of faces for a k-buffer
//     draw      from back to front; or into lists that each pixel sorts, in parts if memory is short
//
// With n × n samples the mean of n² pictures is taken, each moved by a part of a pixel. If asked for, lists are drawn once more
// to count the pixels whose order is wrong. Numbers of tetrahedra, faces and knots are checked against what 32-bit indices and
// shaders hold. After an error of the device its context is given up, and the next picture makes another one.
#include "subvol/render_projected.h"

#include <algorithm>
#include <cmath>

#include "gl_context.h"
#include "gl_tet_lists.h"
#include "gl_tets.h"
#include "pixel_tiles.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/ray_clip.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/optics.h"
#include "subvol/option.h"
#include "tet_faces.h"
#include "tet_mesh.h"
#include "tet_order.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kMostUnits = 1e30;       // fits into a float, with room
constexpr double kFarValue = 1e12;        // values further out are taken as this one
constexpr std::size_t kMostKnots = 2048;  // that a fragment goes through

/// The range of the knots, in parts of which values are counted.
struct Values {
    double first, range;

    [[nodiscard]] float parts(double value) const {
        return static_cast<float>(std::clamp((value - first) / range, -kFarValue, kFarValue));
    }
};

Values set_knots(GlTetFrame& frame, const Optics& optics) {
    const auto knots = optics.knots();
    if (knots.size() > kMostKnots) {
        throw Error(ErrorCode::MissingCapability,
                    std::to_string(knots.size()) + " values of colours and opacities are too many", {},
                    "at most " + std::to_string(kMostKnots) + " for projected tetrahedra, or the method tets");
    }
    const double range = knots.back() - knots.front();
    const Values values{knots.front(), range > 0 ? range : 1};
    frame.opacity_units = frame.scale / optics.opacity_unit();
    if (!(frame.opacity_units < kMostUnits)) {
        throw Error(ErrorCode::InvalidInput, "the opacity unit is " + number_text(optics.opacity_unit()), {},
                    "more than 1e-30 of the volume");
    }
    for (const double knot : knots) {
        const Vec3 color = optics.color(knot);
        const double opacity = -std::expm1(-optics.extinction(knot) * optics.opacity_unit());
        const auto to_float = [](double v) { return static_cast<float>(v); };
        frame.knots.push_back({{to_float(color.x), to_float(color.y), to_float(color.z), to_float(opacity)},
                               {to_float((knot - values.first) / values.range), 0, 0, 0}});
    }
    return values;
}

void set_points(GlTetFrame& frame, const TetMesh& mesh, const View& view, double middle_depth, const Values& values) {
    frame.points.resize(mesh.points.size());
    parallel_each(mesh.points.size(), [&](std::size_t p) {
        const Vec3 eye = (view.to_eye(mesh.points[p].position) - Vec3(0, 0, middle_depth)) / frame.scale;
        frame.points[p] = {static_cast<float>(eye.x), static_cast<float>(eye.y), static_cast<float>(eye.z),
                           values.parts(mesh.points[p].value)};
    });
}

void set_cuts(GlTetFrame& frame, const View& view, double middle_depth, const RayClip& clip) {
    const auto add = [&](const CutPlane& plane) {
        const Vec3 place = (view.to_eye(plane.point) - Vec3(0, 0, middle_depth)) / frame.scale;
        Vec3 normal;
        for (int k = 0; k < 3; ++k) normal[k] = glm::dot(view.axes()[static_cast<std::size_t>(k)], plane.normal);
        frame.cuts.push_back({static_cast<float>(normal.x), static_cast<float>(normal.y), static_cast<float>(normal.z),
                              static_cast<float>(-glm::dot(normal, place))});
    };
    for (const CutPlane& face : clip.faces()) add(face);
    for (const CutPlane& slice : clip.slices()) add(slice);
    frame.faces = clip.faces().size();
    frame.slices = clip.slices().size();
    frame.slices_alone = clip.slices_alone();
    frame.ends_rays = view.ends_rays();
    if (!frame.ends_rays) return;
    for (int i = 0; i < view.width() * view.height(); ++i) {  // they may have been given for another number of pixels
        if (i % 4 == 0) frame.cuts.emplace_back();
        const double end = view.ray_end(i % view.width() + 0.5, i / view.width() + 0.5);
        frame.cuts.back()[i % 4] = static_cast<float>((end - middle_depth) / frame.scale);
    }
}

bool contains(const Box& box, const Vec3& p) {
    return glm::all(glm::lessThanEqual(box.lower, p)) && glm::all(glm::lessThanEqual(p, box.upper));
}

/// The data of a picture for the device, without the order.
///
/// clip:      how the volume is cut open
/// eye_value: whether the value at the eye is needed
/// throws:    Error(InvalidInput) if extinctions are beyond 32-bit floats
GlTetFrame make_tet_frame(const TetMesh& mesh, const Box& box, const View& view, const Optics& optics, const RayClip& clip,
                          bool eye_value) {
    GlTetFrame frame;
    const double diagonal = glm::length(box.upper - box.lower);
    if (diagonal > 0) frame.scale = diagonal;
    const double middle_depth = view.to_eye(0.5 * (box.lower + box.upper)).z;
    frame.middle_depth = middle_depth / frame.scale;
    const Values values = set_knots(frame, optics);
    set_points(frame, mesh, view, middle_depth, values);
    set_cuts(frame, view, middle_depth, clip);
    if (eye_value && view.perspective() && contains(box, view.eye()))
        frame.eye_value = values.parts(value_at(mesh, view.eye()));
    return frame;
}

// OpenGL numbers vertices with signed 32-bit integers; a tetrahedron has 6, a face 3. The mark of a face needs 3 bits beside
// its rank (projected_face.frag).
constexpr std::size_t kMostTets = std::size_t{0x7fffffff} / 6, kMostFaces = std::size_t{1} << 29;
constexpr int kMostEntries = 65536;

const std::optional<int>& checked_device(const std::optional<int>& device) {
    if (find_gl_device(device)) return device;
    throw Error(ErrorCode::MissingCapability, "projected tetrahedra need OpenGL 4.5, and none was found through EGL", {},
                "the method tets");
}

void check_count(const char* what, std::size_t count, std::size_t most) {
    if (count <= most) return;
    throw Error(ErrorCode::MissingCapability, std::to_string(count) + " " + what + " are too many for OpenGL", {},
                "at most " + std::to_string(most) + ", or the method tets");
}

void check_options(const ProjectedOptions& options) {
    check_samples(options.samples);
    if (options.kbuffer < 1 || options.kbuffer > kMostEntries) {
        throw Error(ErrorCode::InvalidInput, "the k-buffer has " + std::to_string(options.kbuffer) + " entries", {},
                    "1.." + std::to_string(kMostEntries));
    }
    if (!(options.lod >= 0 && options.lod <= 1)) {
        throw Error(ErrorCode::InvalidInput, "the fraction of the faces is " + number_text(options.lod), {}, "0..1");
    }
    if (options.lod != 1 && options.order != ProjectedOrder::Havs)
        throw Error(ErrorCode::InvalidInput, "only faces can be left out", {}, "the order havs");
}

std::size_t most_fragments(std::size_t list_bytes, const GlDevice& device, GlTets::Items items) {
    const bool tets = items == GlTets::Items::Tets;
    const std::size_t fragment_bytes = tets ? 20 : 12, entry_bytes = tets ? 16 : 8;  // in both buffers, in the larger one
    constexpr std::size_t kMost = std::size_t{1} << 31;                              // fits into 32 bits, with room
    return std::min({list_bytes / fragment_bytes, device.max_ssbo_bytes / entry_bytes, kMost});
}

}  // namespace

struct ProjectedRenderer::State {
    /// What draws, in a context of its own, which is current where it is made.
    struct Device {
        explicit Device(const std::optional<int>& number)
            : context(checked_device(number)),
              drawer(std::make_unique<GlTets>()),
              lists(std::make_unique<detail::GlTetLists>(*drawer)) {}
        ~Device() {
            free_in(context, lists);
            free_in(context, drawer);
        }
        Device(const Device&) = delete;
        Device& operator=(const Device&) = delete;

        detail::GlContext context;
        std::unique_ptr<GlTets> drawer;
        std::unique_ptr<detail::GlTetLists> lists;
    };

    /// build: gives the tetrahedra
    template <class Build>
    State(const std::optional<int>& number, Progress* progress, const Build& build);
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    [[nodiscard]] ProjectedResult draw(const View& view, const Optics& optics, const ProjectedOptions& options);
    void upload(GlTets::Items items);
    void order(detail::GlTetFrame& frame, const View& view, const ProjectedOptions& options, ProjectedReport& report);
    [[nodiscard]] Image draw_sample(const ProjectedOptions& options, ProjectedReport& report, const DrawStage& stage);
    [[nodiscard]] Image draw_lists(const ProjectedOptions& options, ProjectedReport& report, const DrawStage& stage);
    [[nodiscard]] Image draw_samples(const ProjectedOptions& options, ProjectedReport& report);

    Stopwatch build_watch;
    TetMesh tets;
    std::optional<TetFaces> faces;  // found when they are drawn for the first time
    Box box;
    ProjectedReport built;
    std::optional<int> device_number;
    std::unique_ptr<Device> device;  // null after it has failed: the next picture makes another one
};

template <class Build>
ProjectedRenderer::State::State(const std::optional<int>& number, Progress* progress, const Build& build)
    : device_number(number), device(std::make_unique<Device>(number)) {
    report_progress(progress, "build", 0);
    tets = build();
    check_count("tetrahedra", tets.tets.size(), kMostTets);
    box = bounds_of(tets);
    device->context.release();
    built.device = device->context.renderer();
    built.tets = tets.tets.size();
    built.degenerate_tets = tets.shapes.degenerate;
    built.inverted_tets = tets.shapes.inverted;
    report_progress(progress, "build", 1);
    built.seconds_build = build_watch.seconds();
}

void ProjectedRenderer::State::upload(GlTets::Items items) {
    if (items == GlTets::Items::Faces && !faces) {
        faces = find_faces(tets);
        check_count("faces", faces->faces.size(), kMostFaces);
    }
    if (device->drawer->has(items)) return;
    if (items == GlTets::Items::Faces) return device->drawer->set_faces(faces->faces);
    std::vector<std::array<std::uint32_t, 4>> corners;
    corners.reserve(tets.tets.size());
    for (const auto& tet : tets.tets) {
        corners.push_back(tet.corner);
        std::sort(corners.back().begin(), corners.back().end());
    }
    device->drawer->set_tets(corners);
}

void ProjectedRenderer::State::order(detail::GlTetFrame& frame, const View& view, const ProjectedOptions& options,
                                     ProjectedReport& report) {
    if (options.order == ProjectedOrder::Havs) {
        report.faces = faces->faces.size();
        report.faces_drawn = faces->count(options.lod);
        frame.order = order_faces(tets, *faces, report.faces_drawn, view);
        return;
    }
    TetOrder found =
        options.order == ProjectedOrder::Topological ? order_topologically(tets, view) : order_by_centroid(tets, view);
    frame.order = std::move(found.tets);
    report.cycles = found.cycles;
}

Image ProjectedRenderer::State::draw_lists(const ProjectedOptions& options, ProjectedReport& report, const DrawStage& stage) {
    const auto items = options.order == ProjectedOrder::Havs ? GlTets::Items::Faces : GlTets::Items::Tets;
    const std::size_t most = most_fragments(options.list_bytes, device->context.device(), items);
    detail::GlTetLists& lists = *device->lists;
    auto drawn = items == GlTets::Items::Faces ? lists.draw_faces(static_cast<std::size_t>(options.kbuffer), most, stage)
                                               : lists.draw_tets(most, stage);
    report.fragments += drawn.fragments;
    report.parts += drawn.parts;
    report.late_faces += drawn.late_faces;
    report.violations = report.violations.value_or(0) + drawn.wrong_pixels;
    return std::move(drawn.image);
}

Image ProjectedRenderer::State::draw_sample(const ProjectedOptions& options, ProjectedReport& report, const DrawStage& stage) {
    const bool in_order = options.order == ProjectedOrder::Centroid || options.order == ProjectedOrder::Topological;
    return in_order ? device->drawer->draw_in_order(stage) : draw_lists(options, report, stage);
}

/// The same grid of rays as in trace_pixel, with one picture for each place of the grid.
Image ProjectedRenderer::State::draw_samples(const ProjectedOptions& options, ProjectedReport& report) {
    const int n = options.samples;
    const DrawStage whole{options.progress};
    if (n == 1) return draw_sample(options, report, whole);
    const double pictures = static_cast<double>(n) * n;
    std::vector<double> sums;
    Image image;
    for (int k = 0; k < n * n; ++k) {
        const int column = k % n, row = k / n;
        device->drawer->set_offset({(column + 0.5) / n - 0.5, (row + 0.5) / n - 0.5});
        image = draw_sample(options, report, whole.part(k / pictures, 1 / pictures));
        sums.resize(image.rgba.size());
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += double{image.rgba[i]};
    }
    device->drawer->set_offset(Vec2(0.0));
    for (std::size_t i = 0; i < sums.size(); ++i) image.rgba[i] = static_cast<float>(sums[i] / pictures);
    return image;
}

ProjectedRenderer::ProjectedRenderer(const HexMesh& mesh, std::string_view field, std::optional<int> device,
                                     Progress* progress) {
    const KeepCurrent keep;
    state_ = std::make_unique<State>(device, progress, [&] {
        validate(mesh);
        return build_tet_mesh(mesh, scalar_field(mesh, field).values);
    });
}

ProjectedRenderer::ProjectedRenderer(const MixedMesh& mesh, std::string_view field, std::optional<int> device,
                                     Progress* progress) {
    const KeepCurrent keep;
    state_ = std::make_unique<State>(device, progress, [&] { return build_tet_mesh(mesh, field); });
}

ProjectedRenderer::~ProjectedRenderer() = default;
ProjectedRenderer::ProjectedRenderer(ProjectedRenderer&&) noexcept = default;
ProjectedRenderer& ProjectedRenderer::operator=(ProjectedRenderer&&) noexcept = default;

double ProjectedRenderer::seconds_build() const {
    return state_->built.seconds_build;
}

ProjectedResult ProjectedRenderer::draw(const View& view, const Optics& optics, const ProjectedOptions& options) {
    check_options(options);
    State& state = *state_;
    const detail::KeepCurrent keep;
    if (!state.device) state.device = std::make_unique<State::Device>(state.device_number);
    const detail::GlScope scope(state.device->context);
    try {
        return state.draw(view, optics, options);
    } catch (const Error& error) {
        if (error.code() == ErrorCode::MissingCapability) state.device.reset();
        throw;
    }
}

ProjectedResult ProjectedRenderer::State::draw(const View& view, const Optics& optics, const ProjectedOptions& options) {
    ProjectedResult result{{}, built};
    ProjectedReport& report = result.report;
    const bool with_faces = options.order == ProjectedOrder::Havs;

    Stopwatch watch;
    upload(with_faces ? GlTets::Items::Faces : GlTets::Items::Tets);
    detail::GlTetFrame frame =
        make_tet_frame(tets, box, view, optics, RayClip(without_far_faces(options.clip, box), box.diagonal()), with_faces);
    report.seconds_prepare = watch.restart();

    order(frame, view, options, report);
    report.seconds_sort = watch.restart();

    device->drawer->set_frame(frame, view);
    result.image = draw_samples(options, report);
    report.seconds_draw = watch.seconds();
    if (options.count_violations && !report.violations) (void)draw_lists(options, report, {options.progress});
    return result;
}

ProjectedResult render_projected(const HexMesh& mesh, std::string_view field, const View& view, const Optics& optics,
                                 const ProjectedOptions& options) {
    check_options(options);
    return ProjectedRenderer(mesh, field, options.device, options.progress).draw(view, optics, options);
}

}  // namespace subvol
