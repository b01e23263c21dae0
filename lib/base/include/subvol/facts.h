// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "subvol/detail/stopwatch.h"
#include "subvol/progress.h"

namespace subvol {

struct Fact;
struct FactValue;
template <class T>
struct WithFacts;

/// What a call found out beside its result: names with values, in the order in which they were set. A call returns them; its
/// caller merges them into its own, and the command makes the text and the JSON of them, Python a dictionary.
///
/// Three names have a meaning of their own: "seconds" is a group with the seconds of each stage, which add up; "warnings" and
/// "notes" are lists of sentences for users, each once. Notes are printed, but they are not part of the JSON.
class Facts {
public:
    Facts();
    Facts(const Facts&);
    Facts(Facts&&) noexcept;
    Facts& operator=(const Facts&);
    Facts& operator=(Facts&&) noexcept;
    ~Facts();

    /// The value of a name; a new name is added at the end with no value.
    FactValue& operator[](std::string_view name);
    /// The value of a name; null if there is none.
    [[nodiscard]] const FactValue* find(std::string_view name) const;
    /// The facts of a name, as which they are added if there are none.
    Facts& group(std::string_view name);

    /// A sentence for users. An empty one, and one that is there already, is left out.
    void warn(const std::string& sentence) { add_sentence("warnings", sentence); }
    /// The same for a remark that does not warn.
    void note(const std::string& sentence) { add_sentence("notes", sentence); }
    /// Adds to the seconds of a stage.
    void add_seconds(std::string_view stage, double seconds);

    /// Runs a stage of work, reports that it begins, and adds its seconds.
    ///
    /// throws: Error(Cancelled) before it if `progress` is cancelled; what the work throws
    template <class Work>
    auto timed(Progress* progress, const char* stage, Work&& work) {
        report_progress(progress, stage, 0);
        const Timer timer{*this, stage};
        return std::forward<Work>(work)();
    }

    /// Sets all facts of another call: warnings, notes and seconds are added, other names take the new value.
    void merge(const Facts& other);

    /// Merges the facts of a result, and returns its value.
    template <class T>
    T unpack(WithFacts<T> made) {
        merge(made.facts);
        return std::move(made.value);
    }

    [[nodiscard]] bool empty() const;
    [[nodiscard]] const std::vector<Fact>& all() const { return all_; }

private:
    struct Timer {
        Facts& facts;
        const char* stage;
        detail::Stopwatch watch{};
        ~Timer() { facts.add_seconds(stage, watch.seconds()); }
    };

    void add_sentence(std::string_view list, const std::string& sentence);

    std::vector<Fact> all_;
};

/// The result of a call, with what the call found out.
template <class T>
struct WithFacts {
    T value;
    Facts facts{};
};

/// Nothing, a truth, a number, a text, a list, or a group of facts.
struct FactValue {
    using List = std::vector<FactValue>;

    std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string, List, Facts> value{};

    FactValue() = default;
    FactValue(bool truth) : value(truth) {}
    template <std::signed_integral Number>
    FactValue(Number number) : value(std::int64_t{number}) {}
    template <std::unsigned_integral Number>
    requires(!std::same_as<Number, bool>) FactValue(Number number) : value(std::uint64_t{number}) {}
    template <std::floating_point Number>
    FactValue(Number number) : value(double{number}) {}
    FactValue(const char* text) : value(std::string(text)) {}
    FactValue(std::string_view text) : value(std::string(text)) {}
    FactValue(std::string text) : value(std::move(text)) {}
    FactValue(Facts facts) : value(std::move(facts)) {}
    FactValue(List list) : value(std::move(list)) {}
    /// A list of all that a container has.
    template <class Items>
    requires(!std::convertible_to<Items, std::string_view> &&
             requires(const Items& items) {
                 std::begin(items);
                 std::end(items);
             }) FactValue(const Items& items)
        : value(List(std::begin(items), std::end(items))) {}
};

struct Fact {
    std::string name;
    FactValue value;
    std::string unit{};  ///< such as "s", "B" or "px"; empty for pure numbers and texts
};

}  // namespace subvol
