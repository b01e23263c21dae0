// SPDX-License-Identifier: Apache-2.0
// CalculiX's results. A line begins with its key: -1 a node, an element or the values at a node, -2 what follows of it, -3 the
// end of a list, -4 a result, -5 a component of it. Numbers have fixed widths and may touch each other. In binary files the
// lines with -1 and -2 are records instead, as many as the head of the list says, and there are no lines with -3.

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>

#include "assemble.h"
#include "mesh_file.h"
#include "solver_readers.h"
#include "subvol/detail/number_type.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"

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
    /// The next bytes, after the line. what: for messages
    std::string_view bytes(std::size_t count, std::string_view what) {
        position_ = std::min(next_, text_.size());
        if (count > text_.size() - position_) fail(std::string(what) + ": the file ends");
        next_ += count;
        return text_.substr(position_, count);
    }
    std::int64_t binary_integer(std::string_view what) {
        return integer_from(bytes(4, what), NumberType::Int32, std::endian::little);
    }
    std::vector<double> binary_reals(std::size_t count, NumberType type, std::string_view what) {
        if (count > text_.size()) fail(std::string(what) + ": the file ends");
        return reals_from(bytes(count * size_of(type), what), type, std::endian::little);
    }
    [[nodiscard]] std::size_t position() const { return position_; }
    [[nodiscard]] const TextScanner& in() const { return in_; }

private:
    std::string_view text_, line_;
    TextScanner in_;
    std::size_t next_ = 0, position_ = 0;
};

// The head of a list. width: of the numbers of nodes and elements in text; number: the type of reals in binary files
struct FrdHead {
    std::size_t count = 0, width = 0;
    NumberType number = NumberType::Float32;
    bool binary = false;
};

FrdHead head_of(const FrdLines& lines) {
    const std::string_view line = trimmed(lines.line());
    const std::size_t last = line.find_last_of(' ');
    const std::string_view form = last == std::string_view::npos ? std::string_view() : line.substr(last + 1);
    FrdHead head;
    if (form == "0" || form == "1") {
        head.width = form == "0" ? 5 : 10;
    } else if (form == "2" || form == "3") {
        head.binary = true;
        head.number = form == "2" ? NumberType::Float32 : NumberType::Float64;
        const std::int64_t count = lines.integer(24, 12, "the number of records");
        if (count < 0 || static_cast<std::size_t>(count) > lines.in().size()) {
            lines.fail("count out of range: " + std::to_string(count));
        }
        head.count = static_cast<std::size_t>(count);
    } else {
        lines.fail("the format of the list is " + in_quotes(form), "0 and 1 are text, 2 and 3 are binary");
    }
    return head;
}

const FrdType& type_of(const FrdLines& lines, std::int64_t element, std::int64_t type) {
    if (type < 1 || type >= static_cast<std::int64_t>(kFrdTypes.size())) {
        lines.fail("element " + std::to_string(element) + " is of type " + std::to_string(type), "types are 1 to 12");
    }
    return kFrdTypes[static_cast<std::size_t>(type)];
}

// The name of a result and its components; kind: 1 at the nodes.
struct FrdResult {
    std::string name;
    std::int64_t kind = 1;
    std::size_t components = 0;
};

// Reads the lines -4 and -5. Components that follow from others are not in the file.
FrdResult result_of(FrdLines& lines) {
    if (!lines.next() || lines.key() != "-4") lines.fail("the name of a result is expected, a line that begins with -4");
    FrdResult result{as_utf8(lines.part(5, 8)), 1, 0};
    if (!lines.part(18, 5).empty()) result.kind = lines.integer(18, 5, "where the values are");
    while (lines.next() && lines.key() == "-5") {
        const bool follows = !lines.part(33, 5).empty() && lines.integer(33, 5, "a flag") != 0;
        result.components += !follows;
    }
    lines.back();
    return result;
}

// Skips the records of a result. Those of text are lines like all others.
void skip_values(FrdLines& lines, const FrdHead& head) {
    if (!head.binary) return;
    const std::size_t components = result_of(lines).components;
    for (std::size_t k = 0; k < head.count; ++k) std::ignore = lines.bytes(4 * (components + 1), "values");
}

// The same for nodes and elements. key: "2C" or "3C"
void skip_list(FrdLines& lines, std::string_view key) {
    const FrdHead head = head_of(lines);
    if (!head.binary) return;
    for (std::size_t k = 0; k < head.count; ++k) {
        if (key == "2C") {
            std::ignore = lines.bytes(4 + 3 * size_of(head.number), "a node");
            continue;
        }
        const std::int64_t number = lines.binary_integer("the number of an element");
        const std::int64_t type = lines.binary_integer("the type of an element");
        std::ignore = lines.bytes(4 * (2 + type_of(lines, number, type).nodes), "an element");
    }
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
        const std::string_view key = lines.key();
        if (key == "2C" || key == "3C") skip_list(lines, key);
        if (key == "9999") break;
        if (key != "100C") continue;
        steps.add(step_of(lines));
        skip_values(lines, head_of(lines));
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
            if (key.starts_with("1U")) found_.ignored.push_back({"record", printable(std::string(trimmed(lines_.line())))});
            if (key == "2C") read_nodes();
            if (key == "3C") read_elements();
            if (key == "100C") {
                steps.add(step_of(lines_));
                if (numbers_.empty()) lines_.fail("it has results, but no nodes before them");
                const FrdHead head = head_of(lines_);
                if (steps.current() == step_) {
                    read_result(head);
                } else {
                    skip_values(lines_, head);
                }
            }
            if (key == "9999") break;
        }
        if (numbers_.empty()) lines_.fail("not a file of CalculiX's results, or it has no nodes");
        if (!options_.deck.empty()) take_deck();
        finish();
        EntityNames names = kFrdNames;
        names.point_numbers = numbers_;
        return assemble(std::move(found_), lines_.in(), file_, names, options_);
    }

private:
    void read_nodes() {
        const FrdHead head = head_of(lines_);
        for (std::size_t k = 0; k < head.count; ++k) {
            const std::int64_t number = lines_.binary_integer("the number of a node");
            const auto x = lines_.binary_reals(3, head.number, "a coordinate");
            add_node(number, {x[0], x[1], x[2]});
        }
        if (head.binary) return;
        while (lines_.next() && lines_.key() == "-1") {
            const std::int64_t number = lines_.integer(3, head.width, "the number of a node");
            Vec3 x;
            for (std::size_t a = 0; a < 3; ++a)
                x[static_cast<int>(a)] = lines_.real(3 + head.width + a * kOfReal, "a coordinate");
            add_node(number, x);
        }
        if (lines_.key() != "-3") lines_.fail("the list of nodes does not end with -3");
    }

    void add_node(std::int64_t number, const Vec3& x) {
        if (found_.points.size() >= kNone) lines_.fail("there are too many nodes");
        if (!places_.try_emplace(number, static_cast<Index>(found_.points.size())).second) {
            lines_.fail("there is another node " + std::to_string(number));
        }
        add_point(found_, x, lines_.position());
        numbers_.push_back(number);
    }

    void read_elements() {
        const FrdHead head = head_of(lines_);
        std::vector<Index> nodes;
        for (std::size_t k = 0; k < head.count; ++k) {
            const std::int64_t number = lines_.binary_integer("the number of an element");
            const FrdType& kind = type_of(lines_, number, lines_.binary_integer("the type of an element"));
            std::ignore = lines_.bytes(8, "the group and the material of an element");
            nodes.clear();
            while (nodes.size() < kind.nodes) nodes.push_back(place(number, lines_.binary_integer("the number of a node")));
            take(kind, nodes);
            element_numbers_.push_back(number);
            ++elements_;
        }
        if (head.binary) return;
        while (lines_.next() && lines_.key() == "-1") {
            const std::int64_t number = lines_.integer(3, head.width, "the number of an element");
            const FrdType& kind = type_of(lines_, number, lines_.integer(3 + head.width, 5, "the type of an element"));
            nodes.clear();
            while (lines_.next() && lines_.key() == "-2") {
                for (std::size_t at = 3; nodes.size() < kind.nodes && lines_.has(at); at += head.width) {
                    nodes.push_back(place(number, lines_.integer(at, head.width, "the number of a node")));
                }
            }
            lines_.back();
            if (nodes.size() != kind.nodes) {
                lines_.fail("element " + std::to_string(number) + " of type " + std::string(kind.name) + " has " +
                                counted(nodes.size(), "node", "nodes"),
                            std::to_string(kind.nodes) + " are needed");
            }
            take(kind, nodes);
            element_numbers_.push_back(number);
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

    // The values of a result at the nodes.
    void read_result(const FrdHead& head) {
        const FrdResult result = result_of(lines_);
        const std::size_t components = result.components;
        if (result.kind != 1 || components == 0 || components > kMostComponents) {
            found_.ignore({"result", result.name, 1, "it is not at the nodes"});
            for (std::size_t k = 0; k < head.count; ++k) std::ignore = lines_.bytes(4 * (components + 1), "values");
            return;
        }
        if (found_.points.size() > lines_.in().size()) lines_.fail("there are too many nodes");
        FileArray array{result.name, static_cast<int>(components), false, {}};
        array.values.assign(found_.points.size() * components, std::numeric_limits<double>::quiet_NaN());
        for (std::size_t k = 0; k < head.count; ++k) {
            double* const values = array.values.data() + node(lines_.binary_integer("the number of a node")) * components;
            std::ranges::copy(lines_.binary_reals(components, NumberType::Float32, "a value"), values);
        }
        if (!head.binary) read_values(head.width, array);
        found_.arrays.push_back(std::move(array));
    }

    void read_values(std::size_t width, FileArray& array) {
        const auto components = static_cast<std::size_t>(array.components);
        while (lines_.next() && lines_.key() == "-1") {
            const std::int64_t number = lines_.integer(3, width, "the number of a node");
            const std::size_t first = node(number) * components;
            for (std::size_t c = 0; c < components; ++c) {
                if (c > 0 && c % kOfLine == 0 && (!lines_.next() || lines_.key() != "-2")) {
                    lines_.fail("node " + std::to_string(number) + " has fewer values than " + std::to_string(components));
                }
                array.values[first + c] = lines_.real(3 + width + c % kOfLine * kOfReal, "a value");
            }
        }
        if (lines_.key() != "-3") lines_.fail("the result does not end with -3");
    }

    [[nodiscard]] std::size_t node(std::int64_t number) const {
        const auto found = places_.find(number);
        if (found == places_.end()) lines_.fail("there is no node " + std::to_string(number));
        return found->second;
    }

    // The sets and surfaces of the deck, whose elements and nodes have the numbers that they have here.
    void take_deck() {
        const auto fail = [&](const std::string& message, const std::string& allowed) {
            throw Error(ErrorCode::InvalidInput, message, options_.deck, allowed);
        };
        ReadOptions whole = options_;
        whole.blocks.clear();
        whole.deck.clear();
        const DeckContents deck = read_inp_contents(options_.deck, whole);
        const auto node_at = [&](Index point) {
            const auto at = places_.find(deck.nodes[point]);
            return at == places_.end() ? kNone : at->second;
        };
        Box box;
        for (const Vec3& x : found_.points) box.add(x);
        constexpr double kDigits = 1e-4;  // coordinates have six digits in the results
        for (Index p = 0; p < deck.nodes.size(); ++p) {
            const Index here = node_at(p);
            if (here == kNone || glm::distance(found_.points[here], deck.found.points[p]) <= kDigits * box.diagonal()) continue;
            fail("node " + std::to_string(deck.nodes[p]) + " lies elsewhere than in " + in_quotes(file_),
                 "the deck that was computed");
        }
        std::unordered_map<std::int64_t, Index> cells;  // of the results
        for (Index c = 0; c < element_numbers_.size(); ++c) cells.try_emplace(element_numbers_[c], c);
        const std::map<Index, std::vector<Index>> here = corners_of(found_), there = corners_of(deck.found);
        std::vector<Index> places(deck.elements.size(), kNone);
        std::size_t missing = 0;
        for (const auto& [cell, corners] : there) {
            const auto at = cells.find(deck.elements[cell]);
            const auto same = at == cells.end() ? here.end() : here.find(at->second);
            if (same == here.end()) {
                ++missing;
                continue;
            }
            std::vector<Index> of_deck;
            for (const Index p : corners) of_deck.push_back(node_at(p));
            std::ranges::sort(of_deck);
            if (of_deck != same->second) {
                fail("element " + std::to_string(deck.elements[cell]) + " has other nodes than in " + in_quotes(file_),
                     "the deck that was computed");
            }
            places[cell] = at->second;
        }
        if (missing == there.size()) fail("none of its elements is in " + in_quotes(file_), "the deck that was computed");
        if (missing > 0) {
            found_.warnings.push_back(std::to_string(missing) + " of " + counted(there.size(), "element", "elements") +
                                      " of the deck are not in the results");
        }
        std::map<std::string_view, std::size_t> cells_of;
        for (const FileSet& set : deck.found.sets) {
            FileSet& taken = found_.sets.emplace_back(FileSet{set.name, {}});
            for (const Index cell : set.numbers) {
                if (places[cell] != kNone) taken.numbers.push_back(places[cell]);
            }
            cells_of[set.name] = taken.numbers.size();
        }
        for (const FileSet& set : deck.found.node_sets) {
            FileSet& taken = found_.node_sets.emplace_back(FileSet{set.name, {}});
            for (const Index point : set.numbers) {
                if (node_at(point) != kNone) taken.numbers.push_back(node_at(point));
            }
        }
        for (MeshBlock block : deck.found.blocks) {
            block.cells = cells_of[block.name];
            if (block.cells > 0) found_.blocks.push_back(block);
        }
        std::vector<Index> corners;
        for (const FilePatch& patch : deck.found.patches) {
            FilePatch& taken = found_.patches.emplace_back();
            taken.name = patch.name;
            taken.role = patch.role;
            for (std::size_t f = 0; f < patch.size(); ++f) {
                corners.clear();
                for (const Index p : patch.face(f)) corners.push_back(node_at(p));
                if (std::ranges::find(corners, kNone) == corners.end()) taken.add(corners);
            }
        }
    }

    /// The corners of the cells by their numbers, ascending.
    [[nodiscard]] static std::map<Index, std::vector<Index>> corners_of(const MeshFile& file) {
        std::map<Index, std::vector<Index>> corners;
        each_kind(file, [&](const auto& kind) {
            for (std::size_t c = 0; c < kind.corners.size(); ++c) {
                auto& of_cell = corners[kind.numbers[c]];
                of_cell.assign(kind.corners[c].begin(), kind.corners[c].end());
                std::ranges::sort(of_cell);
            }
        });
        return corners;
    }

    void finish() {
        if (curved_ > 0) {
            found_.warnings.push_back(counted(curved_, "element has", "elements have") +
                                      " more nodes than corners: only the corners are used");
        }
        add_left_out_warning(found_, ignored_parts("element type", left_out_), file_);
    }

    static constexpr std::size_t kOfLine = 6, kMostComponents = 60;

    FrdLines lines_;
    std::string_view file_;
    ReadOptions options_;
    MeshFile found_;
    std::unordered_map<std::int64_t, Index> places_;
    std::vector<std::int64_t> numbers_, element_numbers_;
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
