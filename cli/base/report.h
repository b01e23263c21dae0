// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>

#include "common_options.h"
#include "subvol/facts.h"
#include "terminal_progress.h"

namespace subvol::cli {

using Json = nlohmann::ordered_json;

/// The facts as an object.
[[nodiscard]] Json json_of(const Facts& facts);

/// The most memory that this process has held so far.
[[nodiscard]] std::int64_t peak_memory_bytes();

/// The output of a verb: collected as one JSON object, and printed at the end as such or as a table for people.
class Report {
public:
    explicit Report(const CommonOptions& options);

    Json& operator[](const char* key) { return json_[key]; }
    [[nodiscard]] const Json& json() const { return json_; }
    [[nodiscard]] Progress* progress() { return &progress_; }

    /// Adds what a call found out: warnings and seconds to those that are there.
    void merge(const Facts& facts);

    /// Merges the facts of a result, and returns its value.
    template <class T>
    T unpack(WithFacts<T> made) {
        merge(made.facts);
        return std::move(made.value);
    }

    /// Puts a finished object in place of all that has been collected.
    void take(Json json) { json_ = std::move(json); }

    /// For people on standard error, and under "warnings". An empty text is ignored.
    void warn(const std::string& warning);

    /// For people on standard error; not printed with --json or --quiet. An empty text is ignored.
    void note(const std::string& note);
    /// Until `end_series`, sentences that differ from earlier ones in numbers alone are not printed again, as those of the
    /// steps of a series; the JSON has all warnings.
    void begin_series() { series_ = true; }
    /// Prints how many warnings were not printed.
    void end_series();

    /// A line for people; not printed with --json or --quiet.
    void say(const std::string& line);

    /// A line that the command was asked for, such as a value; not printed with --json.
    void answer(const std::string& line);

    /// Stages are from now on those of "frame 3 of 8"; an empty name: no longer.
    void begin_part(const std::string& name, std::size_t index, std::size_t count) { progress_.begin_part(name, index, count); }

    /// What makes the work quicker, for people who would have to wait: said once, if a stage turns out to take more than ten
    /// seconds.
    void if_long(const std::string& quicker);

    /// Runs a stage of the work and adds its seconds, which go under "seconds". Throws Error(Cancelled) before it if the user
    /// has asked to stop.
    template <class Work>
    auto timed(const char* stage, Work&& work) {
        Timed timed{*this};
        return timed.facts.timed(&progress_, stage, std::forward<Work>(work));
    }

    /// `say` has printed everything: no table at the end.
    void all_said() { all_said_ = true; }

    /// Prints; to be called once, when the verb is done.
    ///
    /// throws: Error(Io) if standard output cannot be written to
    void finish();

private:
    /// Takes the seconds of a stage when it ends, whatever it returns.
    struct Timed {
        Report& report;
        Facts facts{};
        ~Timed() { report.merge(facts); }
    };

    void add_seconds(const std::string& stage, double seconds);

    bool print_json_;
    bool quiet_;
    bool all_said_ = false;
    bool series_ = false;
    std::size_t repeated_ = 0;    // warnings that were not printed
    std::set<std::string> said_;  // sentences without their numbers
    Json json_ = Json::object();
    TerminalProgress progress_;
};

}  // namespace subvol::cli
