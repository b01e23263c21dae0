// SPDX-License-Identifier: Apache-2.0
// CalculiX's results. A line begins with its key: -1 a node, an element or the values at a node, -2 what follows of it, -3 the
// end of a list, -4 a result, -5 a component of it. Numbers have fixed widths and may touch each other.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

#include "assemble.h"
#include "mesh_file.h"
#include "solver_formats.h"
#include "text_scanner.h"

namespace subvol::detail {

namespace {

constexpr EntityNames kFrdNames{"node", "element", 1};
constexpr std::size_t kOfReal = 12;

// The nodes of each type of element, by its number; those of volumes only with names.
struct FrdType {
    std::size_t nodes;
    std::string_view name;
};
constexpr std::array<FrdType, 13> kFrdTypes{{{0, ""},
                                             {8, "he8"},
                                             {6, "pe6"},
                                             {4, "te4"},
                                             {20, "he20"},
                                             {15, "pe15"},
                                             {10, "te10"},
                                             {3, "tr3"},
                                             {6, "tr6"},
                                             {4, "qu4"},
                                             {8, "qu8"},
                                             {2, "be2"},
                                             {3, "be3"}}};

class FrdLines {
public:
    FrdLines(std::string_view text, std::string_view file) : text_(text), in_(text, file, TextScanner::Comments::None) {}

    /// Goes to the next line. returns: false at the end
    bool next() {
        if (next_ >= text_.size()) return false;
        position_ = next_;
        const std::size_t end = std::min(text_.find('\n', next_), text_.size());
        line_ = text_.substr(next_, end - next_);
        if (line_.ends_with('\r')) line_.remove_suffix(1);
        next_ = end + 1;
        return true;
    }
    void back() { next_ = position_; }

    [[nodiscard]] std::string_view line() const { return line_; }
    /// A line's key, such as "-1", "2C" or "100C"; it ends with a letter.
    [[nodiscard]] std::string_view key() const {
        const std::string_view word = trimmed(line_.substr(0, 6));
        if (word.starts_with('-')) return word.substr(0, 2);
        const std::size_t letter = word.find_first_not_of("0123456789");
        return letter == std::string_view::npos ? word : word.substr(0, letter + 1);
    }
    [[nodiscard]] std::string_view part(std::size_t first, std::size_t length) const {
        return first < line_.size() ? trimmed(line_.substr(first, length)) : std::string_view();
    }
    [[nodiscard]] bool has(std::size_t first) const { return first < line_.size() && !trimmed(line_.substr(first)).empty(); }

    [[nodiscard]] std::int64_t integer(std::size_t first, std::size_t length, std::string_view what) const {
        const std::string_view word = part(first, length);
        std::int64_t value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (word.empty() || error != std::errc() || end != word.data() + word.size()) {
            fail(std::string(what) + " is expected, not " + in_quotes(word));
        }
        return value;
    }
    [[nodiscard]] double real(std::size_t first, std::string_view what) const {
        std::string_view word = part(first, kOfReal);
        if (word.starts_with('+')) word.remove_prefix(1);
        double value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (word.empty() || error == std::errc::invalid_argument || end != word.data() + word.size()) {
            fail(std::string(what) + " is expected, not " + in_quotes(word));
        }
        return error == std::errc::result_out_of_range ? 0 : value;  // smaller than any double: exponents have two digits
    }
    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const {
        in_.fail_at(position_, message, allowed);
    }
    [[nodiscard]] std::size_t position() const { return position_; }
    [[nodiscard]] const TextScanner& in() const { return in_; }

private:
    std::string_view text_, line_;
    TextScanner in_;
    std::size_t next_ = 0, position_ = 0;
};

// The width of numbers of nodes and elements, by the number at the end of a header line.
std::size_t width_of(const FrdLines& lines) {
    const std::string_view line = trimmed(lines.line());
    const std::size_t last = line.find_last_of(' ');
    const std::string_view form = last == std::string_view::npos ? std::string_view() : line.substr(last + 1);
    if (form == "0") return 5;
    if (form == "1") return 10;
    lines.fail("the format of the list is " + in_quotes(form), "0 and 1 are supported: CalculiX's text, not its binary files");
}

// A line 100C: the results of a step begin.
struct StepLine {
    double time;
    std::int64_t number;
};

StepLine step_of(const FrdLines& lines) {
    StepLine step{lines.real(12, "the time of a step"), 0};
    if (!std::isfinite(step.time)) lines.fail("the time of the step is not finite");
    step.number = lines.integer(58, 5, "the number of a step");
    return step;
}

// Steps in the order of the file, with the times, and their order.
class StepTimes {
public:
    void add(const StepLine& line) {
        if (times_.empty() || line.number != last_.number || line.time != last_.time) times_.push_back(line.time);
        last_ = line;
    }
    [[nodiscard]] std::size_t current() const { return times_.size() - 1; }
    [[nodiscard]] std::vector<std::size_t> order() const {
        std::vector<std::size_t> order(times_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t k) { return times_[k]; });
        return order;
    }
    [[nodiscard]] std::vector<double> times() const {
        std::vector<double> sorted = times_;
        std::ranges::stable_sort(sorted);
        return sorted;
    }

private:
    std::vector<double> times_;
    StepLine last_{0, 0};
};

StepTimes steps_of(std::string_view text, std::string_view file) {
    FrdLines lines(text, file);
    StepTimes steps;
    while (lines.next()) {
        if (lines.key() == "100C") steps.add(step_of(lines));
    }
    return steps;
}

class FrdReader {
public:
    FrdReader(std::string_view text, std::string_view file, const ReadOptions& options)
        : lines_(text, file), file_(file), options_(options) {
        const StepTimes steps = steps_of(text, file);
        const auto order = steps.order();
        const std::size_t chosen = chosen_step(options, std::max<std::size_t>(1, order.size()), file, found_.warnings);
        if (!order.empty()) step_ = order[chosen];
    }

    ReadResult read() {
        StepTimes steps;
        while (lines_.next()) {
            const std::string_view key = lines_.key();
            if (key == "2C") read_nodes();
            if (key == "3C") read_elements();
            if (key == "100C") {
                steps.add(step_of(lines_));
                if (numbers_.empty()) lines_.fail("it has results, but no nodes before them");
                if (steps.current() == step_) read_result();
            }
            if (key == "9999") break;
        }
        if (numbers_.empty()) lines_.fail("not a file of CalculiX's results, or it has no nodes");
        finish();
        EntityNames names = kFrdNames;
        names.point_numbers = numbers_;
        return assemble(std::move(found_), lines_.in(), file_, names, options_);
    }

private:
    void read_nodes() {
        const std::size_t width = width_of(lines_);
        while (lines_.next() && lines_.key() == "-1") {
            const std::int64_t number = lines_.integer(3, width, "the number of a node");
            if (found_.points.size() >= kNone) lines_.fail("there are too many nodes");
            if (!places_.try_emplace(number, static_cast<Index>(found_.points.size())).second) {
                lines_.fail("there is another node " + std::to_string(number));
            }
            Vec3 x;
            for (std::size_t a = 0; a < 3; ++a) x[static_cast<int>(a)] = lines_.real(3 + width + a * kOfReal, "a coordinate");
            add_point(found_, x, lines_.position());
            numbers_.push_back(number);
        }
        if (lines_.key() != "-3") lines_.fail("the list of nodes does not end with -3");
    }

    void read_elements() {
        const std::size_t width = width_of(lines_);
        while (lines_.next() && lines_.key() == "-1") {
            const std::int64_t number = lines_.integer(3, width, "the number of an element");
            const std::int64_t type = lines_.integer(3 + width, 5, "the type of an element");
            if (type < 1 || type >= static_cast<std::int64_t>(kFrdTypes.size())) {
                lines_.fail("element " + std::to_string(number) + " is of type " + std::to_string(type), "types are 1 to 12");
            }
            const FrdType& kind = kFrdTypes[static_cast<std::size_t>(type)];
            std::vector<Index> nodes;
            while (lines_.next() && lines_.key() == "-2") {
                for (std::size_t at = 3; nodes.size() < kind.nodes && lines_.has(at); at += width) {
                    nodes.push_back(place(number, lines_.integer(at, width, "the number of a node")));
                }
            }
            lines_.back();
            if (nodes.size() != kind.nodes) {
                lines_.fail("element " + std::to_string(number) + " of type " + std::string(kind.name) + " has " +
                                counted(nodes.size(), "node", "nodes"),
                            std::to_string(kind.nodes) + " are needed");
            }
            take(kind, nodes);
            ++elements_;
        }
        if (lines_.key() != "-3") lines_.fail("the list of elements does not end with -3");
    }

    [[nodiscard]] Index place(std::int64_t element, std::int64_t node) const {
        const auto found = places_.find(node);
        if (found == places_.end()) {
            lines_.fail("element " + std::to_string(element) + ": there is no node " + std::to_string(node));
        }
        return found->second;
    }

    // The edges' nodes are those of the bottom, the upright ones and those of the top.
    void take(const FrdType& kind, const std::vector<Index>& nodes) {
        const bool others = options_.other_cells != OtherCells::Ignore;
        if (kind.name.starts_with("he")) {
            const bool whole = kind.nodes == 20 && options_.curved_tolerance;
            put(found_.hexes, nodes, whole);
            if (whole) found_.curved.add(elements_, CurvedOrder::Exodus, nodes);
        } else if (kind.name.starts_with("pe") && others) {
            put(found_.prisms, nodes, false);
        } else if (kind.name.starts_with("te") && others) {
            put(found_.tets, nodes, false);
        } else {
            ++left_out_[kind.name];
        }
    }

    template <std::size_t N>
    void put(FileCells<N>& into, const std::vector<Index>& nodes, bool whole) {
        curved_ += nodes.size() > N && !whole;
        std::copy_n(nodes.begin(), N, into.corners.emplace_back().begin());
        into.numbers.push_back(static_cast<Index>(elements_));
    }

    // The values of a result at the nodes. Components that follow from others are not in the file.
    void read_result() {
        const std::size_t width = width_of(lines_);
        if (!lines_.next() || lines_.key() != "-4") lines_.fail("the name of a result is expected, a line that begins with -4");
        FileArray array{as_utf8(lines_.part(5, 8)), 0, false, {}};
        const std::int64_t kind = lines_.part(18, 5).empty() ? 1 : lines_.integer(18, 5, "where the values are");
        while (lines_.next() && lines_.key() == "-5") {
            const bool follows = !lines_.part(33, 5).empty() && lines_.integer(33, 5, "a flag") != 0;
            array.components += !follows;
        }
        lines_.back();
        const auto components = static_cast<std::size_t>(array.components);
        if (kind != 1 || components == 0 || components > kMostComponents) {
            found_.warnings.push_back("result " + in_quotes(array.name) + " is not at the nodes: ignored");
            return;
        }
        if (found_.points.size() > lines_.in().size()) lines_.fail("there are too many nodes");
        array.values.assign(found_.points.size() * components, std::numeric_limits<double>::quiet_NaN());
        while (lines_.next() && lines_.key() == "-1") {
            const std::int64_t number = lines_.integer(3, width, "the number of a node");
            const auto node = places_.find(number);
            if (node == places_.end()) lines_.fail("there is no node " + std::to_string(number));
            for (std::size_t c = 0; c < components; ++c) {
                if (c > 0 && c % kOfLine == 0 && (!lines_.next() || lines_.key() != "-2")) {
                    lines_.fail("node " + std::to_string(number) + " has fewer values than " + std::to_string(components));
                }
                array.values[node->second * components + c] = lines_.real(3 + width + c % kOfLine * kOfReal, "a value");
            }
        }
        if (lines_.key() != "-3") lines_.fail("the result does not end with -3");
        found_.arrays.push_back(std::move(array));
    }

    void finish() {
        if (curved_ > 0) {
            found_.warnings.push_back(counted(curved_, "element has", "elements have") +
                                      " more nodes than corners: only the corners are used");
        }
        std::string list;
        for (const auto& [type, count] : left_out_) {
            list += (list.empty() ? "" : ", ") + counted(count, "element", "elements") + " of type " + std::string(type);
        }
        add_left_out_warning(found_, list, file_);
        const auto used = used_points(found_);
        std::erase_if(found_.arrays, [&](const FileArray& array) {
            const auto components = static_cast<std::size_t>(array.components);
            for (std::size_t p = 0; p < used.size(); ++p) {
                if (!used[p] || !std::isnan(array.values[p * components])) continue;
                found_.warnings.push_back("result " + in_quotes(array.name) + " is not at node " + std::to_string(numbers_[p]) +
                                          ": ignored");
                return true;
            }
            return false;
        });
    }

    static constexpr std::size_t kOfLine = 6, kMostComponents = 60;

    FrdLines lines_;
    std::string_view file_;
    ReadOptions options_;
    MeshFile found_;
    std::unordered_map<std::int64_t, Index> places_;
    std::vector<std::int64_t> numbers_;
    std::map<std::string_view, std::size_t> left_out_;
    std::size_t elements_ = 0, curved_ = 0, step_ = 0;
};

}  // namespace

ReadResult read_frd(std::string_view text, std::string_view file, const ReadOptions& options) {
    return FrdReader(text, file, options).read();
}

std::vector<double> frd_times(const std::filesystem::path& path) {
    return steps_of(read_text(path), path.string()).times();
}

}  // namespace subvol::detail
