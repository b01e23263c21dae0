// SPDX-License-Identifier: Apache-2.0
#include "subvol/progressive.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "subvol/detail/number_text.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

/// Passes reports on to a listener, and asks to stop when the time is up.
class Deadline : public Progress {
public:
    Deadline(Progress* listener, double seconds) : listener_(listener), seconds_(seconds) {}

    void report(std::string_view stage, double fraction) override {
        if (listener_) listener_->report(stage, fraction);
    }
    void picture(const Image& image) override {
        if (listener_) listener_->picture(image);
    }
    [[nodiscard]] bool cancelled() const override { return stopped() || (armed_ && elapsed() > seconds_); }
    [[nodiscard]] double elapsed() const { return watch_.seconds(); }

    /// Does the work that may be given up. Before the first call the time does not end anything, as there is no picture yet.
    ///
    /// returns: whether the work was finished in time
    /// throws:  what the work throws, Error(Cancelled) only if the listener wants to stop
    template <class Work>
    bool finish_in_time(const Work& work) {
        armed_ = true;
        try {
            work();
            return true;
        } catch (const Error& error) {
            if (error.code() != ErrorCode::Cancelled || stopped()) throw;
            return false;
        }
    }

private:
    [[nodiscard]] bool stopped() const { return listener_ && listener_->cancelled(); }

    Progress* listener_;
    Stopwatch watch_;
    double seconds_;
    bool armed_ = false;
};

void check_seconds(double seconds) {
    if (seconds > 0 && std::isfinite(seconds)) return;
    throw Error(ErrorCode::InvalidInput, "the time is " + number_text(seconds), {}, "a positive number of seconds");
}

/// Repeats each pixel as a square of scale² pixels.
template <class T>
std::vector<T> enlarge(const std::vector<T>& small, std::size_t channels, int small_width, int scale, int width, int height) {
    std::vector<T> large;
    large.reserve(channels * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto at = static_cast<std::size_t>(y / scale) * static_cast<std::size_t>(small_width) +
                            static_cast<std::size_t>(x / scale);
            large.insert(large.end(), small.begin() + static_cast<std::ptrdiff_t>(channels * at),
                         small.begin() + static_cast<std::ptrdiff_t>(channels * (at + 1)));
        }
    }
    return large;
}

void check(const ProgressiveOptions& options) {
    check_seconds(options.seconds);
    for (const double px : options.footprint_px) {
        if (!(px > 0))
            throw Error(ErrorCode::InvalidInput, "a footprint is " + number_text(px), {}, "a positive number of pixels");
    }
}

class Progressive {
public:
    Progressive(const HexMesh& mesh, const View& view, const Optics& optics, const ProgressiveOptions& options)
        : mesh_(mesh), view_(view), optics_(optics), options_(options), deadline_(options.progress, options.seconds) {}

    ProgressiveResult run() {
        RbfVolume volume = sample({});
        draw_at(volume, 4, 0);
        (void)deadline_.finish_in_time([&] {
            draw_at(volume, 2, 0);
            draw_at(volume, 1, 0);
            for (const double px : options_.footprint_px) {
                RbfVolume finer = sample(px);
                if (finer.size() <= volume.size()) continue;
                volume = std::move(finer);
                draw_at(volume, 1, px);
            }
        });
        result_.seconds = deadline_.elapsed();
        return std::move(result_);
    }

private:
    [[nodiscard]] RbfVolume sample(std::optional<double> footprint_px) {
        SampleOptions options = options_.sample;
        options.progress = &deadline_;
        if (footprint_px) {
            options.footprint = Footprint{.camera = view_.camera(),
                                          .width_px = view_.width(),
                                          .height_px = view_.height(),
                                          .spacing_px = *footprint_px,
                                          .least_cell_px = *footprint_px};
        }
        return sample_rbf_points(mesh_, options).volume;
    }

    [[nodiscard]] SplatOptions splat_options(int scale) {
        SplatOptions options = options_.splat;
        if (options.sheets > 0) options.sheets = std::max(2, options.sheets / scale);
        if (scale > 1) options.samples = 1;
        options.progress = &deadline_;
        return options;
    }

    void draw_at(const RbfVolume& volume, int scale, double footprint_px) {
        const int width = (view_.width() + scale - 1) / scale, height = (view_.height() + scale - 1) / scale;
        SplatResult drawn = render_splats(volume, view_.resized(width, height), optics_, splat_options(scale));
        if (scale > 1) {
            drawn.image.rgba = enlarge(drawn.image.rgba, 4, width, scale, view_.width(), view_.height());
            drawn.depth = enlarge(drawn.depth, 1, width, scale, view_.width(), view_.height());
            drawn.image.width = view_.width();
            drawn.image.height = view_.height();
        }
        result_.splat = std::move(drawn);
        result_.picture_scale = scale;
        result_.footprint_px = footprint_px;
        ++result_.steps;
        deadline_.picture(result_.splat.image);
    }

    const HexMesh& mesh_;
    const View& view_;
    const Optics& optics_;
    const ProgressiveOptions& options_;
    Deadline deadline_;
    ProgressiveResult result_;
};

void check(const ProjectedProgressiveOptions& options) {
    check_seconds(options.seconds);
    for (const double lod : options.lod) {
        if (lod >= 0 && lod <= 1) continue;
        throw Error(ErrorCode::InvalidInput, "a fraction of the faces is " + number_text(lod), {}, "0..1");
    }
}

class ProjectedSteps {
public:
    ProjectedSteps(ProjectedRenderer& renderer, const View& view, const Optics& optics,
                   const ProjectedProgressiveOptions& options)
        : renderer_(renderer), view_(view), optics_(optics), options_(options), deadline_(options.progress, options.seconds) {}

    ProjectedProgressiveResult run() {
        draw(ProjectedOrder::Havs, 0, 1);
        result_.finished = deadline_.finish_in_time([&] {
            for (const double lod : options_.lod) draw(ProjectedOrder::Havs, lod, 1);
            draw(ProjectedOrder::Havs, 1, 1);
            const bool late = result_.projected.report.late_faces > 0;
            if (late || options_.projected.samples > 1)
                draw(late ? ProjectedOrder::Lists : ProjectedOrder::Havs, 1, options_.projected.samples);
        });
        result_.seconds = deadline_.elapsed();
        return std::move(result_);
    }

private:
    void draw(ProjectedOrder order, double lod, int samples) {
        ProjectedOptions options = options_.projected;
        options.order = order;
        options.lod = lod;
        options.samples = samples;
        options.progress = &deadline_;
        result_.projected = renderer_.draw(view_, optics_, options);
        result_.order = order;
        result_.lod = lod;
        ++result_.steps;
        deadline_.picture(result_.projected.image);
    }

    ProjectedRenderer& renderer_;
    const View& view_;
    const Optics& optics_;
    const ProjectedProgressiveOptions& options_;
    Deadline deadline_;
    ProjectedProgressiveResult result_;
};

}  // namespace

ProgressiveResult render_progressively(const HexMesh& mesh, const View& view, const Optics& optics,
                                       const ProgressiveOptions& options) {
    check(options);
    return Progressive(mesh, view, optics, options).run();
}

ProjectedProgressiveResult render_progressively(ProjectedRenderer& renderer, const View& view, const Optics& optics,
                                                const ProjectedProgressiveOptions& options) {
    check(options);
    return ProjectedSteps(renderer, view, optics, options).run();
}

}  // namespace subvol
