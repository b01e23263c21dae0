// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "common_options.h"
#include "field_gaps.h"
#include "mesh_frames.h"
#include "report.h"
#include "subvol/facts.h"
#include "subvol/mesh_series.h"

namespace subvol::cli {

/// Whether an input may be a series of steps: a file of a mesh.
[[nodiscard]] bool may_have_steps(const std::string& input);

/// Whether --step asks for more than one step: a verb then writes a file for each.
[[nodiscard]] bool asks_for_steps(const CommonOptions& options);

/// The one step that --step and --time choose; nothing: the last one, as none is chosen.
///
/// throws: Error(InvalidInput) if there is no such step, or more than one is asked for
[[nodiscard]] std::optional<std::size_t> one_step(const std::string& input, const CommonOptions& options);

/// The step that was read, and its time, if there are several.
void say_step(const ReadResult& read, Facts& facts);

/// The first and the last step that --step asks for.
///
/// throws: Error(InvalidInput) if there are no such steps
[[nodiscard]] FrameRange chosen_steps(const MeshSeries& series, const CommonOptions& options);

/// The same options with one step.
[[nodiscard]] CommonOptions of_step(const CommonOptions& options, int step);

/// The options for several steps: --warp FIELD*auto gets one factor for all of them, with which the longest displacement of
/// the step that moves most is a tenth of the box's diagonal. Each step is read for that.
///
/// throws: Error(InvalidInput) if nothing moves in any step
[[nodiscard]] WithFacts<CommonOptions> for_steps(const std::string& input, const CommonOptions& options,
                                                 const FrameRange& range, Progress* progress);

/// What is done for one step after the other. Steps that lack a field that is asked for are left out, and what is said of each
/// step is printed once.
class StepsWithFields {
public:
    explicit StepsWithFields(Report& report) : report_(report) { report.begin_series(); }

    /// Calls call() for a step. Returns whether the step has the fields.
    template <class Call>
    bool take(int step, const Call& call) {
        try {
            call();
        } catch (const NoSuchField& error) {
            if (lacking_.empty()) why_ = error;
            lacking_.insert(step);
            return false;
        }
        any_ = true;
        return true;
    }
    /// After the last step: warns of those that lack the fields. outcome: what became of them
    ///
    /// throws: as `refuse_none`
    void finish(std::string_view outcome = "left out");
    /// throws: Error(InvalidInput) as the first step, if all steps so far lack the fields
    void refuse_none() const;

private:
    Report& report_;
    std::set<int> lacking_;
    std::optional<Error> why_;  // of the first of them
    bool any_ = false;
};

/// The steps before and after --time, and how far it lies between them, from 0 to 1. Nothing without --interpolate-time, and
/// at a step or beyond the first and the last one.
struct BetweenSteps {
    std::size_t before = 0, after = 0;
    double part = 0;
};
[[nodiscard]] std::optional<BetweenSteps> between_steps(const std::string& input, const CommonOptions& options);

}  // namespace subvol::cli
