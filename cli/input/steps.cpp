// SPDX-License-Identifier: Apache-2.0
#include "steps.h"

#include <algorithm>
#include <charconv>
#include <iterator>

#include "input.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/progress.h"
#include "subvol/warp.h"
#include "text.h"

namespace subvol::cli {
namespace {

std::optional<std::size_t> step_number(std::string_view text) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

[[noreturn]] void refuse(const std::string& text) {
    const bool time = detail::plain_number(text).has_value();
    throw Error(ErrorCode::InvalidInput, "'" + text + "' is not a step", "--step",
                "a number from 0, last, all, or A-B" + (time ? "; --time " + text + " takes the step of a time" : ""));
}

std::size_t existing(std::size_t step, const MeshSeries& series) {
    if (step < series.size()) return step;
    throw Error(ErrorCode::InvalidInput, text("there is no step ", step), series.path.string(),
                series.size() == 1 ? "it has one step, number 0" : text("steps are 0 to ", series.size() - 1));
}

}  // namespace

bool may_have_steps(const std::string& input) {
    const InputKind kind = kind_of(input);
    return !is_model(input) && (kind == InputKind::Mesh || kind == InputKind::Picture);
}

bool asks_for_steps(const CommonOptions& options) {
    return options.step && (*options.step == "all" || options.step->find('-') != std::string::npos);
}

std::optional<std::size_t> one_step(const std::string& input, const CommonOptions& options) {
    if (options.read.time) return nearest_step(open_series(input), *options.read.time);
    if (!options.step) return std::nullopt;
    if (asks_for_steps(options)) {
        throw Error(ErrorCode::InvalidInput, "only one step can be read here, not " + *options.step, "--step",
                    "a number or last; vdb, points, approximate and render write a file a step");
    }
    if (*options.step == "last") return open_series(input).size() - 1;
    const auto step = step_number(*options.step);
    if (!step) refuse(*options.step);
    return step;
}

void say_step(const ReadResult& read, Facts& facts) {
    if (read.steps < 2 || !read.mesh.time) return;
    const double time = *read.mesh.time;
    facts["step"] = read.step;
    facts["time"] = time;
    facts.note(text("step ", read.step, " of 0 to ", read.steps - 1, ", time ", time));
}

FrameRange chosen_steps(const MeshSeries& series, const CommonOptions& options) {
    const int last = static_cast<int>(series.size()) - 1;
    const std::string& text = *options.step;
    if (text == "all") return {0, last};
    const std::size_t dash = text.find('-');
    const auto first = step_number(std::string_view(text).substr(0, dash));
    const auto end = step_number(std::string_view(text).substr(dash + 1));
    if (!first || !end || *end < *first) refuse(text);
    return {static_cast<int>(existing(*first, series)), static_cast<int>(existing(*end, series))};
}

CommonOptions of_step(const CommonOptions& options, int step) {
    CommonOptions one = options;
    one.step = std::to_string(step);
    return one;
}

WithFacts<CommonOptions> for_steps(const std::string& input, const CommonOptions& options, const FrameRange& range,
                                   Progress* progress) {
    WithFacts<CommonOptions> result{options, {}};
    if (!options.warp) return result;
    const Warp warp = parse_warp(*options.warp);
    if (warp.factor) return result;
    CommonOptions at_rest = options;
    at_rest.warp.reset();
    at_rest.field.reset();
    at_rest.at_rest.clear();
    std::optional<double> least;
    for (int step = range.first; step <= range.last; ++step) {
        report_progress(progress, "factor of --warp", static_cast<std::size_t>(step - range.first),
                        static_cast<std::size_t>(range.count()));
        const auto factor = automatic_factor(read_input(input, of_step(at_rest, step), nullptr).value.mesh, warp.field);
        if (factor) least = std::min(*factor, least.value_or(*factor));
    }
    if (!least) {
        throw Error(ErrorCode::InvalidInput, "\"" + warp.field + "\" is 0 in all steps, so there is no factor to find",
                    "--warp", warp.field + "*1");
    }
    result.value.warp = warp.field + "*" + detail::exact_text(*least);
    result.facts.note(text("all steps are moved by ", *least, " × ", warp.field));
    return result;
}

void StepsWithFields::refuse_none() const {
    if (!any_ && why_) throw Error(*why_);
}

void StepsWithFields::finish(std::string_view outcome) {
    report_.end_series();
    refuse_none();
    if (lacking_.empty()) return;
    std::string list;
    for (auto step = lacking_.begin(); step != lacking_.end(); ++step) {
        const int first = *step;
        while (std::next(step) != lacking_.end() && *std::next(step) == *step + 1) ++step;
        list += text(list.empty() ? "" : ", ", first, first == *step ? "" : text(" to ", *step));
    }
    report_.warn(text(lacking_.size() == 1 ? "step " : "steps ", list, " ", outcome, ": ", why_->what()));
}

std::optional<BetweenSteps> between_steps(const std::string& input, const CommonOptions& options) {
    if (!options.interpolate_time || !options.read.time) return std::nullopt;
    const MeshSeries series = open_series(input);
    std::optional<std::size_t> before, after;
    for (std::size_t k = 0; k < series.size(); ++k) {
        const double time = series.times[k];
        if (time <= *options.read.time && (!before || time > series.times[*before])) before = k;
        if (time >= *options.read.time && (!after || time < series.times[*after])) after = k;
    }
    if (!before || !after || series.times[*before] == series.times[*after]) return std::nullopt;
    const double from = series.times[*before], to = series.times[*after];
    return BetweenSteps{*before, *after, (*options.read.time - from) / (to - from)};
}

}  // namespace subvol::cli
