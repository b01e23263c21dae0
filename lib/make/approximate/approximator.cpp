// SPDX-License-Identifier: Apache-2.0
#include "subvol/approximator.h"

#include <optional>

#include "data_field.h"
#include "fitter.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {

struct Approximator::State {
    ApproximateOptions given, options;
    HexMesh mesh;
    detail::SampleFinder finder;
    std::optional<detail::Fitter> fitter{};
    std::size_t placements = 0;

    State(HexMesh onto, const ApproximateOptions& asked)
        : given(asked), options(asked), mesh(detail::prepared(std::move(onto), options)), finder(mesh, options) {}
};

Approximator::Approximator(HexMesh onto, const ApproximateOptions& options) {
    if (options.refine > 0) {
        throw Error(ErrorCode::InvalidInput, "all steps have the same control mesh", option_name("refine", options.names),
                    "one step alone, whose control mesh then serves the series");
    }
    state_ = std::make_unique<State>(std::move(onto), options);
}

Approximator::~Approximator() = default;
Approximator::Approximator(Approximator&&) noexcept = default;
Approximator& Approximator::operator=(Approximator&&) noexcept = default;

Approximation Approximator::fit(const HexMesh& samples, Progress* progress) {
    ApproximateOptions options = state_->options;
    if (progress != nullptr) options.progress = progress;
    detail::check_samples(samples);
    if (!state_->fitter || !state_->fitter->is_for(samples)) {
        state_->fitter.reset();  // before the next one takes memory
        state_->fitter.emplace(state_->mesh, detail::DataField(samples, state_->given), options, state_->finder);
        ++state_->placements;
    }
    return state_->fitter->fit(samples.attributes, options.progress);
}

std::size_t Approximator::placements() const {
    return state_->placements;
}

std::vector<Option> options_of_series(ApproximateOptions& options) {
    std::vector<Option> kept = options_of(options);
    std::erase_if(kept, [](const Option& option) { return option.name == "refine" || option.name == "tolerance"; });
    return kept;
}

}  // namespace subvol
