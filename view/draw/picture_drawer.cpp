// SPDX-License-Identifier: Apache-2.0
#include "subvol/picture_drawer.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <optional>
#include <thread>
#include <utility>
#include <variant>

#include "cancel_flag.h"
#include "picture_overlays.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/kernel_hierarchy.h"
#include "subvol/rbf_volume.h"
#include "subvol/shell_scene.h"
#include "surface_preview.h"

namespace subvol::detail {

namespace {

/// Few kernels that stand for very many in coarse pictures, merged on a thread of its own while all of them are drawn.
class FewKernels {
public:
    /// Begins to merge, if the kernels are many.
    ///
    /// all: stays as it is until this object's end
    explicit FewKernels(const RbfVolume& all);
    ~FewKernels();
    FewKernels(const FewKernels&) = delete;
    FewKernels& operator=(const FewKernels&) = delete;

    /// The few; null while they are being made, and where there are not many.
    [[nodiscard]] const RbfVolume* ready() const { return ready_ ? &*few_ : nullptr; }

private:
    std::optional<RbfVolume> few_{};
    std::atomic<bool> ready_ = false, quit_ = false;
    std::thread thread_{};
};

constexpr std::size_t kFew = 1 << 14;

FewKernels::FewKernels(const RbfVolume& all) {
    if (all.size() < 2 * kFew) return;
    thread_ = std::thread([this, &all] {
        try {
            CancelFlag quit(quit_);
            const KernelHierarchy hierarchy = build_kernel_hierarchy(all, &quit);
            few_ = kernels_of_cut(hierarchy, all, level_cut(hierarchy, kFew));
            ready_ = true;
        } catch (const std::exception&) {  // given up, or no memory: coarse pictures go on to show all kernels
            few_.reset();
        }
    });
}

FewKernels::~FewKernels() {
    quit_ = true;
    if (thread_.joinable()) thread_.join();
}

}  // namespace

}  // namespace subvol::detail

namespace subvol {

using namespace detail;

namespace {

PictureBody picture_body(const ViewBody& body) {
    PictureBody shown{.tets = body.tets, .shape = body.shape, .moved = body.moved};
    if (body.points.volume) {
        shown.kernels = body.points.volume.get();
        shown.voxels = body.points.voxels.get();
        shown.channels = {body.channel};
    } else {
        shown.mesh = body.mesh;
    }
    return shown;
}

double seconds_of(const Facts& facts, std::initializer_list<std::string_view> stages) {
    double sum = 0;
    const FactValue* seconds = facts.find("seconds");
    if (seconds == nullptr) return sum;
    for (const Fact& stage : std::get<Facts>(seconds->value).all()) {
        if (std::ranges::find(stages, stage.name) != stages.end()) sum += std::get<double>(stage.value.value);
    }
    return sum;
}

void add_facts(const Facts& facts, DrawnPicture& picture) {
    picture.seconds_boundary += seconds_of(facts, {"boundary"});
    picture.seconds_kernels += seconds_of(facts, {"refine", "sample", "reduce", "threshold"});
    if (const FactValue* backend = facts.find("backend")) picture.backend = std::get<std::string>(backend->value);
    for (const char* name : {"cells", "micro_cells", "tets", "points"}) {
        if (const FactValue* count = facts.find(name)) picture.points = std::get<std::uint64_t>(count->value);
    }
    picture.is_boundary = facts.find("triangles") != nullptr;
}

}  // namespace

struct PictureDrawer::State {
    MethodOptions settings;
    std::optional<int> samples{};  // of full pictures
    std::shared_ptr<const ViewBody> body{};
    std::optional<PictureMaker> maker{};
    std::unique_ptr<FewKernels> few{};  // of the kernels, for coarse pictures
    std::optional<ShellScene> flow{};   // streamlines and arrows of the body

    /// Streamlines and arrows in the colours and the cut of a picture; null: there are none.
    const ShellScene* flow_of(const ViewState& shown, const PictureStyle& style, const Optics& optics, Progress* progress) {
        if (!body->flow) return nullptr;
        Facts facts;
        if (!flow) {
            Flow traced = *body->flow;
            traced.limit.progress = progress;
            ColoredSurface drawn = flow_surface(body->mesh, traced, facts);
            flow = ShellScene{std::move(drawn), maker->skin(progress, facts).surface, {}, optics, 1, {}, true, true};
        }
        flow->optics = optics;
        flow->samples = style.sample_count();
        flow->clip = shown.clip;
        return &*flow;
    }

    void take(const std::shared_ptr<const ViewBody>& next, const PictureStyle& style) {
        if (body != next) {
            few.reset();  // it refers to the kernels
            flow.reset();
            if (maker) maker->set_body(picture_body(*next));
            body = next;
        }
        settings.style = style;
        if (maker)
            maker->set_style(style);
        else
            maker.emplace(picture_body(*body), settings);
    }

    /// Few kernels in place of very many, as soon as there are; null: all of them.
    const RbfVolume* stand_in(const Optics& optics, Progress* progress, Facts& facts) {
        if (!few && !body->moved) few = std::make_unique<FewKernels>(maker->kernels(optics, progress, facts));
        return few ? few->ready() : nullptr;  // those of a moved body soon change
    }

    /// A coarse picture of a solid, whatever the method: its boundary alone.
    void draw_preview(const View& view, const Optics& optics, DrawnPicture& picture, Progress* progress) {
        const Stopwatch watch;
        Facts facts;
        const BoundaryValues& boundary = maker->skin(progress, facts);
        add_facts(facts, picture);
        picture.seconds_build = watch.seconds();
        Preview preview = surface_preview(boundary, view, optics, picture.state.clip);
        picture.image = std::move(preview.image);
        picture.depth = std::move(preview.depth);
        picture.backend = "cpu";
        picture.points = boundary.surface.points.size();
        picture.is_boundary = true;
        picture.seconds_draw = watch.seconds() - picture.seconds_build;
    }

    void draw(const View& view, const Optics& optics, DrawnPicture& picture, Progress* progress) {
        const Stopwatch watch;
        Facts facts;
        if (!maker->keeps_kernels(optics)) few.reset();
        const bool few_suffice = picture.scale > 1 && draws_kernels(settings.style.method);
        const RbfVolume* merged = few_suffice ? stand_in(optics, progress, facts) : nullptr;
        facts.merge(maker->prepare(optics, progress, merged == nullptr));
        picture.seconds_build = watch.seconds();
        Picture drawn = maker->draw(view, optics, progress, merged);
        facts.merge(drawn.facts);
        add_facts(facts, picture);
        picture.image = std::move(drawn.image);
        picture.depth = std::move(drawn.depth);
        picture.seconds_draw = watch.seconds() - picture.seconds_build;
    }
};

PictureDrawer::PictureDrawer(const MethodOptions& settings)
    : state_(std::make_unique<State>(State{.settings = settings, .samples = settings.style.samples})) {
    state_->settings.names = OptionNames::Keywords;
}
PictureDrawer::~PictureDrawer() = default;
PictureDrawer::PictureDrawer(PictureDrawer&&) noexcept = default;
PictureDrawer& PictureDrawer::operator=(PictureDrawer&&) noexcept = default;

DrawnPicture PictureDrawer::draw(const ViewState& state, const std::shared_ptr<const ViewBody>& body, int scale,
                                 Progress* progress) {
    PictureStyle style{.method = state.method, .look = state.look, .clip = state.clip};
    style.samples = scale > 1 ? std::optional(1) : state_->samples;
    state_->take(body, style);
    const Optics optics = optics_of(state, *body);
    const int width = state.width - legend_columns(state, *body, optics);
    const View view(state.camera, std::max(1, width / scale), std::max(1, state.height / scale));
    DrawnPicture picture;
    picture.scale = scale;
    picture.state = state;
    const ShellScene* const flow = state_->flow_of(state, style, optics, progress);
    const View of_volume = flow != nullptr ? ended_at(*flow, view) : view;
    if (scale > 1 && flow == nullptr && state_->maker->paints_boundary() && state.clip.slices.empty()) {
        state_->draw_preview(view, optics, picture, progress);
    } else {
        state_->draw(of_volume, optics, picture, progress);
        if (flow != nullptr) flow->draw_into(picture.image, picture.depth, view);
    }
    if (scale > 1) {
        draw_inverted(picture, view, *body);
        return picture;
    }
    const bool edges = state.edges && body->mesh.cells.size() > 0;
    const bool within = edges && (state.look.look != Look::Solid || !state.look.opacity.empty() || picture.depth.empty());
    if (within) {
        Facts facts;
        draw_edges_within(picture, of_volume, *body, state_->maker->boundary(optics, progress, facts),
                          [&](const View& ended) { return state_->maker->draw(ended, optics, progress).image; });
    }
    draw_overlays(picture, view, *body, optics, edges && !within);
    return picture;
}

}  // namespace subvol
