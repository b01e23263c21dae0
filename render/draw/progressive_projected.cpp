// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "deadline.h"
#include "subvol/error.h"
#include "subvol/progressive.h"

namespace subvol {

using namespace detail;

namespace {

void check(const ProjectedProgressiveOptions& options) {
    if (!(options.seconds > 0)) {
        throw Error(ErrorCode::InvalidInput, "the time is " + std::to_string(options.seconds), {},
                    "a positive number of seconds");
    }
    for (const double lod : options.lod) {
        if (lod >= 0 && lod <= 1) continue;
        throw Error(ErrorCode::InvalidInput, "a fraction of the faces is " + std::to_string(lod), {}, "0..1");
    }
}

class Steps {
public:
    Steps(ProjectedRenderer& renderer, const View& view, const Optics& optics, const ProjectedProgressiveOptions& options)
        : renderer_(renderer), view_(view), optics_(optics), options_(options), deadline_(options.progress, options.seconds) {}

    ProjectedProgressiveResult run() {
        draw(ProjectedOrder::Havs, 0, 1);
        deadline_.arm();
        try {
            for (const double lod : options_.lod) draw(ProjectedOrder::Havs, lod, 1);
            draw(ProjectedOrder::Havs, 1, 1);
            const bool late = result_.projected.report.late_faces > 0;
            if (late || options_.projected.samples > 1)
                draw(late ? ProjectedOrder::Lists : ProjectedOrder::Havs, 1, options_.projected.samples);
            result_.finished = true;
        } catch (const Error& error) {
            if (error.code() != ErrorCode::Cancelled || deadline_.stopped()) throw;
        }
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

ProjectedProgressiveResult render_progressively(ProjectedRenderer& renderer, const View& view, const Optics& optics,
                                                const ProjectedProgressiveOptions& options) {
    check(options);
    return Steps(renderer, view, optics, options).run();
}

}  // namespace subvol
