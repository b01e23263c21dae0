// SPDX-License-Identifier: Apache-2.0
// Reads an input deck of Abaqus or CalculiX into parts, instances, sets and surfaces. A deck consists of keyword lines (*NODE)
// and of data lines that belong to the last keyword; included files are read where they are named. A keyword sets the section
// and its options, and each data line adds to the part or instance that is open:
//
//     *NODE, *NGEN      points, from local and cylindrical or spherical systems turned into rectangular ones
//     *ELEMENT, *ELGEN  elements, over several lines if needed, and copies of them
//     *ELSET, *NSET     sets of elements and of nodes by numbers, ranges and other sets
//     *SURFACE          sides of elements
//
// After the last line ranges are replaced by the elements and nodes that are there. Names are compared in capitals. Few lines
// may ask for many nodes, elements and members of sets: they are counted, and limited in proportion to the bytes of the deck.
// Keywords that would make or move nodes in other ways are refused, as the mesh would be another one.
#include "inp_deck.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <unordered_map>
#include <unordered_set>

#include "local_system.h"
#include "subvol/detail/named_files.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"

namespace subvol::detail {

using namespace std::string_view_literals;

namespace {

// A line could ask for any number of nodes, elements and members of sets. What is made is in proportion to the deck's bytes.
constexpr std::size_t kFewMade = std::size_t{1} << 20, kFewMembers = std::size_t{1} << 22;
constexpr std::size_t kMadeOfByte = 16;
constexpr std::size_t kMostIncluded = 10000;
// Begins the names of what instances add to their parts.
constexpr const char* kInside = "\n";

// Commas between quotation marks belong to a name.
std::vector<std::string_view> fields_of(std::string_view line) {
    std::vector<std::string_view> fields;
    for (std::size_t begin = 0; begin <= line.size();) {
        std::size_t end = begin;
        for (bool quoted = false; end < line.size() && (quoted || line[end] != ','); ++end) quoted ^= line[end] == '"';
        fields.push_back(trimmed(line.substr(begin, end - begin)));
        begin = end + 1;
    }
    if (fields.back().empty()) fields.pop_back();  // after a comma at the end
    return fields;
}

std::string_view name_of(std::string_view text) {
    const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    return quoted ? text.substr(1, text.size() - 2) : text;
}

// Options that make or move nodes and elements: without them the mesh would be another one.
constexpr std::array kChangesTheMesh{"*NMAP"sv,   "*NCOPY"sv,        "*NFILL"sv,
                                     "*ELCOPY"sv, "*IMPERFECTION"sv, "*SYMMETRICMODELGENERATION"sv};

// Keywords without data that are taken.
const std::set<std::string_view> kStructure{"*ASSEMBLY",    "*ENDASSEMBLY", "*PART", "*ENDPART",
                                            "*ENDINSTANCE", "*ELSET",       "*NSET", "*SURFACE"};

class DeckReader {
public:
    explicit DeckReader(InpDeck& deck) : deck_(deck) {}

    // place: where the file is named, for messages
    void read(const std::filesystem::path& path, const NamedFiles::Place& place) {
        named_.count(place);
        const auto open = named_.open(path, place);
        named_.take_file(path, place);
        const std::string text = read_text(path);
        bytes_ += text.size();
        const std::string& file = *deck_.files.insert(path.string()).first;
        TextScanner in(text, file, TextScanner::Comments::None);
        const auto* const outer = std::exchange(in_, &in);
        const std::string_view outer_file = std::exchange(file_, file);
        std::size_t position = 0;
        for (std::size_t number = 1; position < text.size(); ++number) {
            const std::size_t end = std::min(text.find('\n', position), text.size());
            std::string_view line = trimmed(std::string_view(text).substr(position, end - position));
            position_ = position;
            line_ = number;
            position = end + 1;
            if (line.empty() || line.starts_with("**")) continue;
            if (line.front() != '*') {
                take_data(line);
                continue;
            }
            finish_element();
            // A comma at the end of the line goes on in the next one.
            std::string keyword(line);
            while (line.ends_with(',') && position < text.size() && text[position] != '*') {
                const std::size_t next = std::min(text.find('\n', position), text.size());
                line = trimmed(std::string_view(text).substr(position, next - position));
                keyword += line;
                position = next + 1;
                ++number;
            }
            if (const auto included = take_keyword(keyword)) {
                const NamedFiles::Place named = [&in, at = position_] { return in.place_of(at); };
                read(named_file(path.parent_path(), *included, named), named);
            }
        }
        finish_element();
        in_ = outer;
        file_ = outer_file;
    }

    // After the last line: the numbers of all sets, and what the instances make of them.
    void finish() {
        for (auto& part : deck_.parts) {
            expand_ranges(part.second.sets, [&] { return elements_of(part.first); });
            expand_ranges(part.second.node_sets, [&] { return nodes_of(part.first); });
            for (auto* sets : {&part.second.sets, &part.second.node_sets})
                std::erase_if(*sets, [](const auto& set) { return set.second.left_out; });
        }
        count_instances();
    }

private:
    enum class Section { Other, Node, Element, ElementSet, NodeSet, Instance, System, NodesBetween, ElementsLike, Surface };

    struct Places {
        std::unordered_map<std::int64_t, std::size_t> at;
        std::size_t known = 0;
    };

    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const {
        in_->fail_at(position_, message, allowed);
    }

    // Ranges name all numbers between two: those that are elements or nodes stay. there: returns the numbers of these
    template <class There>
    void expand_ranges(std::map<std::string, InpSet>& sets, const There& there) {
        if (std::ranges::all_of(sets, [](const auto& set) { return set.second.ranges.empty(); })) return;
        std::vector<std::int64_t> numbers = there();
        std::ranges::sort(numbers);
        for (auto& [name, set] : sets) {
            for (const auto& [first, last, step] : set.ranges) {
                const auto from = std::ranges::lower_bound(numbers, first), to = std::ranges::upper_bound(numbers, last);
                if (from < to) count_members(static_cast<std::size_t>(to - from));
                for (auto number = from; number < to; ++number) {
                    if ((*number - first) % step == 0) set.numbers.push_back(*number);
                }
            }
            set.ranges.clear();
        }
    }

    // The elements that the numbers in sets of a part mean: those of an instance may be in its part.
    [[nodiscard]] std::vector<std::int64_t> elements_of(const std::string& name) const {
        return numbers_in(name, [](const InpPart& part, std::vector<std::int64_t>& numbers) {
            for (const InpElement& element : part.elements) numbers.push_back(element.number);
        });
    }
    [[nodiscard]] std::vector<std::int64_t> nodes_of(const std::string& name) const {
        return numbers_in(name, [](const InpPart& part, std::vector<std::int64_t>& numbers) {
            numbers.insert(numbers.end(), part.numbers.begin(), part.numbers.end());
        });
    }

    template <class Add>
    [[nodiscard]] std::vector<std::int64_t> numbers_in(const std::string& name, const Add& add) const {
        std::vector<std::int64_t> numbers;
        const auto add_part = [&](const std::string& part) {
            const auto found = deck_.parts.find(part);
            if (found != deck_.parts.end()) add(found->second, numbers);
        };
        add_part(name);
        if (numbers.empty() && name.starts_with(kInside)) {
            for (const InpInstance& instance : deck_.instances) {
                if (instance.inside == name) add_part(instance.part);
            }
        }
        return numbers;
    }

    // Each instance of a part is another copy of its nodes and elements, and of the members of its sets.
    void count_instances() {
        std::set<std::string_view> met;
        std::map<std::string_view, std::size_t> members;
        for (const auto& [name, part] : deck_.parts) {
            for (const auto* sets : {&part.sets, &part.node_sets}) {
                for (const auto& [key, set] : *sets) members[name] += 1 + set.numbers.size();
            }
        }
        for (const InpInstance& instance : deck_.instances) {
            const auto part = deck_.parts.find(instance.part);
            if (part == deck_.parts.end()) continue;
            if (!met.insert(part->first).second) deck_.made += part->second.points.size() + part->second.elements.size();
            members_ += members[part->first];
            if (deck_.made <= most_made() && members_ <= std::max(kFewMembers, kMadeOfByte * bytes_)) continue;
            throw Error(ErrorCode::InvalidInput, "its instances have too many nodes, elements and members of sets",
                        std::string(instance.place.file) + ", line " + std::to_string(instance.place.line),
                        "at most " + std::to_string(most_made()) + " for files of this size");
        }
    }

    // Returns the file that *INCLUDE or INPUT names.
    std::optional<std::string> take_keyword(std::string_view line) {
        const auto fields = fields_of(line);
        std::string keyword = upper_case(fields.front());
        std::erase_if(keyword, [](char c) { return c == ' ' || c == '\t'; });
        values_.clear();
        for (std::size_t i = 1; i < fields.size(); ++i) {
            const std::size_t equals = fields[i].find('=');
            const auto value = equals == std::string_view::npos ? std::string_view() : trimmed(fields[i].substr(equals + 1));
            values_[upper_case(trimmed(fields[i].substr(0, equals)))] = std::string(name_of(value));
        }
        section_ = Section::Other;
        scope_ = part_;
        kind_ = &InpPart::sets;
        lines_ = 0;
        if (keyword == "*INCLUDE") return values_["INPUT"];
        if (std::ranges::find(kChangesTheMesh, keyword) != kChangesTheMesh.end()) {
            fail(in_quotes(std::string(fields.front())) + ", which makes or moves nodes and elements, is not supported",
                 "write the mesh as nodes and elements");
        }
        if (keyword == "*PART" || keyword == "*ENDPART" || keyword == "*ENDINSTANCE" || keyword == "*ASSEMBLY") {
            system_ = {};
            part_ = keyword == "*PART" ? upper_case(values_["NAME"]) : std::string();
            if (keyword == "*PART") deck_.parts[part_];
        } else if (keyword == "*INSTANCE") {
            start_instance();
        } else if (keyword == "*SYSTEM") {
            section_ = Section::System;
            system_ = {};
        } else if (keyword == "*NODE") {
            section_ = Section::Node;
            coordinates_ = read_coordinates();
        } else if (keyword == "*ELEMENT") {
            start_elements();
        } else if (keyword == "*NGEN") {
            section_ = Section::NodesBetween;
            if (!values_["LINE"].empty())
                fail("nodes on curves (*NGEN, LINE) are not supported", "nodes on straight lines are");
        } else if (keyword == "*ELGEN") {
            section_ = Section::ElementsLike;
        } else if (keyword == "*ELSET") {
            section_ = Section::ElementSet;
            if (values_["ELSET"].empty()) fail("the *ELSET has no name");
            if (values_.contains("INSTANCE")) scope_ = kInside + upper_case(values_["INSTANCE"]);
            set_of(values_["ELSET"]);
        } else if (keyword == "*NSET") {
            section_ = Section::NodeSet;
            kind_ = &InpPart::node_sets;
            if (values_.contains("INSTANCE")) scope_ = kInside + upper_case(values_["INSTANCE"]);
            if (values_["NSET"].empty()) {
                leave_out_set("it has no name");
            } else if (values_.contains("ELSET")) {
                take_nodes_of_elements();
            } else {
                set_of(values_["NSET"]);
            }
        }
        if (keyword == "*SURFACE") start_surface();
        if (section_ == Section::Other && !kStructure.contains(keyword)) ++deck_.other_keywords[upper_case(fields.front())];
        const bool has_data = section_ == Section::Node || section_ == Section::Element;
        return has_data && values_.contains("INPUT") ? std::optional(values_["INPUT"]) : std::nullopt;
    }

    // *NSET, ELSET: the nodes of the elements that are in the set so far.
    void take_nodes_of_elements() {
        const std::string name = values_["ELSET"];
        const std::string scope = scope_;
        bool found = add_nodes_of(name);
        // A set of the assembly may have members in every instance, and those of one may be meant.
        for (const InpInstance& instance : deck_.instances) {
            if (!scope.empty() || instance.inside.empty()) break;
            count_members(1);
            scope_ = instance.inside;
            const std::string prefix = instance.inside.substr(1) + ".";
            const bool of_this = upper_case(name).starts_with(prefix);
            found |= add_nodes_of(of_this ? std::string_view(name).substr(prefix.size()) : std::string_view(name));
        }
        scope_ = scope;
        if (!found) return leave_out_set("there is no set of elements " + in_quotes(name));
        section_ = Section::Other;  // it has no data
    }

    // Returns whether the part or instance that the line is about has that set of elements.
    bool add_nodes_of(std::string_view name) {
        kind_ = &InpPart::sets;
        const InpSet* const of_elements = set_named(name);
        kind_ = &InpPart::node_sets;
        if (of_elements == nullptr) return false;
        const std::unordered_set<std::int64_t> numbers(of_elements->numbers.begin(), of_elements->numbers.end());
        const auto has = [&](std::int64_t number) {
            return numbers.contains(number) || std::ranges::any_of(of_elements->ranges, [&](const auto& range) {
                       return number >= range[0] && number <= range[1] && (number - range[0]) % range[2] == 0;
                   });
        };
        std::vector<std::int64_t> nodes = numbers_in(scope_, [&](const InpPart& part, std::vector<std::int64_t>& into) {
            count_members(part.elements.size() * (1 + of_elements->ranges.size()));
            for (const InpElement& element : part.elements) {
                if (has(element.number)) into.insert(into.end(), element.nodes.begin(), element.nodes.end());
            }
        });
        std::ranges::sort(nodes);
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        count_members(nodes.size());
        InpSet& set = set_of(values_["NSET"]);
        set.numbers.insert(set.numbers.end(), nodes.begin(), nodes.end());
        return true;
    }

    void start_surface() {
        const std::string type = upper_case(values_["TYPE"]);
        if ((!type.empty() && type != "ELEMENT") || values_.contains("COMBINE")) {
            const std::string why = values_.contains("COMBINE") ? "it combines others" : "it is of type " + type;
            deck_.surfaces_left_out.add(values_["NAME"], in_->place_of(position_) + ": " + why);
            return;
        }
        if (values_["NAME"].empty()) {
            deck_.surfaces_left_out.add({}, in_->place_of(position_) + ": it has no name");
            return;
        }
        section_ = Section::Surface;
        deck_.surfaces.push_back({values_["NAME"], part_, {}});
    }

    // A set or an element, and "S1" to "S6"; without it the free sides are meant.
    void take_side(const std::vector<std::string_view>& fields) {
        if (fields.empty() || fields[0].empty()) return;
        InpSide side;
        const auto number = number_in(fields[0]);
        if (number) side.number = *number;
        if (!number) side.set = upper_case(name_of(fields[0]));
        if (fields.size() > 1) {
            const auto label = fields[1].size() == 2 && (fields[1][0] == 'S' || fields[1][0] == 's') ? fields[1][1] : '0';
            if (label < '1' || label > '6') return;  // SPOS, EDGE1, …: of shells
            side.side = static_cast<std::size_t>(label - '0');
        }
        deck_.surfaces.back().sides.push_back(std::move(side));
    }

    void start_instance() {
        section_ = Section::Instance;
        system_ = {};
        if (values_.contains("LIBRARY")) fail("instances of other analyses (LIBRARY) are not supported");
        InpInstance& instance = deck_.instances.emplace_back();
        instance.part = upper_case(values_["PART"]);
        instance.inside = part_ = kInside + upper_case(values_["NAME"]);
        instance.place = {file_, line_};
    }

    // What *NODE, SYSTEM says: rectangular unless it is C or S.
    [[nodiscard]] Coordinates read_coordinates() {
        const std::string kind = upper_case(values_["SYSTEM"]);
        if (kind.empty() || kind.starts_with('R')) return Coordinates::Rectangular;
        if (kind.starts_with('C')) return Coordinates::Cylindrical;
        if (!kind.starts_with('S')) fail("nodes in the system " + in_quotes(kind) + " are not supported", "R, C and S are");
        return Coordinates::Spherical;
    }

    // The set of a name in the part or instance that the line is about.
    InpSet& set_of(const std::string& name) {
        InpSet& set = (deck_.parts[scope_].*kind_)[upper_case(name)];
        if (set.name.empty()) set.name = name;
        return set;
    }

    // *NODE and *NGEN put their nodes into a set.
    void add_to_node_set(std::int64_t number) {
        const std::string& name = values_["NSET"];
        if (name.empty()) return;
        kind_ = &InpPart::node_sets;
        set_of(name).numbers.push_back(number);
        kind_ = &InpPart::sets;
    }

    void add_to_set(const std::string& name, std::int64_t number) {
        if (!name.empty()) set_of(name).numbers.push_back(number);
    }

    void start_elements() {
        section_ = Section::Element;
        const std::string type = upper_case(values_["TYPE"]);
        if (type.empty()) fail("the *ELEMENT has no TYPE");
        type_ = &deck_.types.try_emplace(type, inp_type(type)).first->second;
    }

    void take_data(std::string_view line) {
        if (section_ == Section::Node) take_node(fields_of(line));
        if (section_ == Section::Element) take_element(line);
        if (section_ == Section::NodesBetween) generate_nodes(fields_of(line));
        if (section_ == Section::ElementsLike) generate_elements(fields_of(line));
        if (section_ == Section::ElementSet) take_set(values_["ELSET"], fields_of(line));
        if (section_ == Section::NodeSet) take_set(values_["NSET"], fields_of(line));
        if (section_ == Section::Surface) take_side(fields_of(line));
        if (section_ == Section::Instance) take_place(fields_of(line));
        if (section_ == Section::System) take_system(fields_of(line));
    }

    [[nodiscard]] std::int64_t integer(std::string_view word) const {
        std::int64_t value = 0;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
        if (word.empty() || error != std::errc() || end != word.data() + word.size()) {
            fail("an integer is expected, not " + in_quotes(std::string(word)));
        }
        return value;
    }

    [[nodiscard]] double real(std::string_view word) const {
        if (word.empty()) return 0;  // as Abaqus takes it
        std::string text(word.front() == '+' ? word.substr(1) : word);
        std::ranges::replace_if(
            text, [](char c) { return c == 'd' || c == 'D'; }, 'e');
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error == std::errc::invalid_argument || end != text.data() + text.size() || !std::isfinite(value)) {
            fail("a number is expected, not " + in_quotes(std::string(word)));
        }
        return value;
    }

    void take_node(const std::vector<std::string_view>& fields) {
        InpPart& part = deck_.parts[part_];
        part.numbers.push_back(integer(fields.empty() ? std::string_view() : fields[0]));
        Vec3 x(0.0);
        for (std::size_t a = 0; a < 3 && a + 1 < fields.size(); ++a) x[static_cast<int>(a)] = real(fields[a + 1]);
        constexpr double kRadians = std::numbers::pi / 180;
        if (coordinates_ != Coordinates::Rectangular) x.y *= kRadians;
        if (coordinates_ == Coordinates::Spherical) x.z *= kRadians;
        part.points.push_back(system_(rectangular(coordinates_, x)));
        add_to_node_set(part.numbers.back());
    }

    // The origin, a point on the first axis, and in the next line one on the side of the second axis. Without the latter the
    // axes are turned about z only.
    void take_system(const std::vector<std::string_view>& fields) {
        const auto at = [&](std::size_t i) { return i < fields.size() ? real(fields[i]) : 0; };
        if (++lines_ == 1) {
            system_.origin = {at(0), at(1), at(2)};
            if (fields.size() <= 3) return;
            along_ = Vec3(at(3), at(4), at(5)) - system_.origin;
            system_.axes = axes_along({along_.x, along_.y, 0}, {-along_.y, along_.x, 0});
        } else if (lines_ == 2) {
            system_.axes = axes_along(along_, Vec3(at(0), at(1), at(2)) - system_.origin);
        }
        if (lines_ <= 2 && !std::isfinite(system_.axes[2].x + system_.axes[1].x)) {
            if (lines_ == 1) system_.axes[2] = Vec3(0);  // the next line may say more
            if (lines_ == 2) fail("the points of the *SYSTEM lie on one line");
        }
    }

    // Where things of the part are, by their numbers; the last one if a number is repeated.
    template <class Things, class NumberOf>
    std::size_t find(std::map<std::string, Places>& all, const Things& things, const NumberOf& number_of, std::int64_t number,
                     std::string_view word) {
        Places& places = all[part_];
        for (; places.known < things.size(); ++places.known) places.at[number_of(things[places.known])] = places.known;
        const auto found = places.at.find(number);
        if (found == places.at.end()) fail("there is no " + std::string(word) + " " + std::to_string(number));
        return found->second;
    }

    void count_generated(std::size_t more) {
        if (more > most_made() - std::min(most_made(), deck_.made)) {
            fail("too many nodes or elements are generated", "at most " + std::to_string(most_made()));
        }
        deck_.made += more;
    }

    void count_members(std::size_t more) {
        const std::size_t most = std::max(kFewMembers, kMadeOfByte * bytes_);
        if (more > most - std::min(most, members_)) fail("its sets have too many members", "at most " + std::to_string(most));
        members_ += more;
    }

    // Nodes on the straight line from one node to another, with numbers between theirs.
    void generate_nodes(const std::vector<std::string_view>& fields) {
        if (fields.size() < 2) fail("*NGEN needs a first and a last node");
        const std::int64_t first = integer(fields[0]), last = integer(fields[1]);
        const std::int64_t step = fields.size() > 2 && !fields[2].empty() ? integer(fields[2]) : 1;
        InpPart& part = deck_.parts[part_];
        const auto itself = [](std::int64_t number) { return number; };
        const Vec3 from = part.points[find(nodes_at_, part.numbers, itself, first, "node")];
        const Vec3 to = part.points[find(nodes_at_, part.numbers, itself, last, "node")];
        constexpr std::int64_t kLargest = std::int64_t{1} << 40;
        const bool sound =
            first >= 0 && last >= 0 && first < kLargest && last < kLargest && step >= 1 && (last - first) % step == 0;
        if (!sound)
            fail("the numbers from " + std::to_string(first) + " to " + std::to_string(last) + " are not in steps of " +
                 std::to_string(step));
        const std::int64_t count = std::abs(last - first) / step;
        count_generated(static_cast<std::size_t>(count));
        add_to_node_set(first);
        add_to_node_set(last);
        for (std::int64_t k = 1; k < count; ++k) {
            const double t = static_cast<double>(k) / static_cast<double>(count);
            part.numbers.push_back(first + (last > first ? k : -k) * step);
            add_to_node_set(part.numbers.back());
            part.points.push_back((1 - t) * from + t * to);
        }
    }

    // Copies of an element in up to three directions: how many, and what is added to the numbers of its nodes and its own.
    void generate_elements(const std::vector<std::string_view>& fields) {
        InpPart& part = deck_.parts[part_];
        const auto number_of = [](const InpElement& element) { return element.number; };
        if (fields.size() < 2) fail("*ELGEN needs an element and how many are made of it");
        const InpElement master = part.elements[find(elements_at_, part.elements, number_of, integer(fields[0]), "element")];
        constexpr std::int64_t kLargest = std::int64_t{1} << 40;
        const auto large = [](std::int64_t number) { return number > kLargest || number < -kLargest; };
        if (large(master.number) || std::ranges::any_of(master.nodes, large))
            fail("its element has a number that is out of range");
        std::array<std::array<std::int64_t, 3>, 3> along{{{1, 1, 1}, {1, 0, 0}, {1, 0, 0}}};
        for (std::size_t i = 1; i < std::min<std::size_t>(fields.size(), 10); ++i) {
            if (fields[i].empty()) continue;
            auto& value = along[(i - 1) / 3][(i - 1) % 3];
            value = integer(fields[i]);
            if (value > kLargest || value < -kLargest || ((i - 1) % 3 == 0 && value < 1))
                fail("its number " + std::to_string(i) + " is out of range");
        }
        constexpr std::size_t kMost = std::numeric_limits<std::size_t>::max();
        std::size_t count = 1;
        for (const auto& of : along) {
            const auto copies = static_cast<std::size_t>(of[0]);
            const std::int64_t step = std::max({std::int64_t{1}, std::abs(of[1]), std::abs(of[2])});
            if (of[0] > kLargest / step) fail("the numbers of its elements or nodes are out of range");
            count = copies > kMost / count ? kMost : count * copies;
        }
        count_generated(count);
        if (count > part.elements.size()) part.elements.reserve(part.elements.size() + count);
        for (std::int64_t k = 0; k < along[2][0]; ++k) {
            for (std::int64_t j = 0; j < along[1][0]; ++j) {
                for (std::int64_t i = 0; i < along[0][0]; ++i) {
                    if (i == 0 && j == 0 && k == 0) continue;
                    InpElement copy = master;
                    for (std::int64_t& node : copy.nodes) node += i * along[0][1] + j * along[1][1] + k * along[2][1];
                    copy.number += i * along[0][2] + j * along[1][2] + k * along[2][2];
                    copy.place = file_;
                    add_to_set(values_["ELSET"], copy.number);
                    part.elements.push_back(std::move(copy));
                }
            }
        }
        add_to_set(values_["ELSET"], master.number);
    }

    // An element goes on in the next line until it has all its nodes. Of a type that is not read, a line that ends with a comma
    // goes on.
    void take_element(std::string_view line) {
        const auto fields = fields_of(line);
        if (type_->shape == InpShape::Other) {
            if (!open_) take_unread(fields);
            open_ = line.ends_with(',') && fields.size() > 2;
            return;
        }
        for (const std::string_view field : fields) numbers_.push_back(integer(field));
        if (numbers_.size() > type_->nodes) finish_element();
    }

    void take_unread(const std::vector<std::string_view>& fields) {
        std::int64_t number = 0;
        if (!fields.empty()) std::from_chars(fields[0].data(), fields[0].data() + fields[0].size(), number);
        add_to_set(values_["ELSET"], number);
        deck_.parts[part_].elements.push_back({number, type_, {}, file_});
    }

    void finish_element() {
        open_ = false;
        if (numbers_.empty()) return;
        // C3D27 may lack the nodes in the middle of faces.
        constexpr std::size_t kCurvedNodes = 20;
        const std::size_t needed = type_->nodes > kCurvedNodes ? kCurvedNodes : type_->nodes;
        if (numbers_.size() < needed + 1) {
            fail("element " + std::to_string(numbers_[0]) + " of type " + type_->name + " has " +
                 counted(numbers_.size() - 1, "node", "nodes"));
        }
        if (numbers_.size() > type_->nodes + 1) {
            ++deck_.longer;
            numbers_.resize(type_->nodes + 1);
        }
        add_to_set(values_["ELSET"], numbers_[0]);
        deck_.parts[part_].elements.push_back({numbers_[0], type_, {numbers_.begin() + 1, numbers_.end()}, file_});
        numbers_.clear();
    }

    void leave_out_set(const std::string& why) {
        const bool of_nodes = kind_ == &InpPart::node_sets;
        const std::string& name = values_[of_nodes ? "NSET" : "ELSET"];
        (of_nodes ? deck_.node_sets_left_out : deck_.sets_left_out).add(name, in_->place_of(position_) + ": " + why);
        if (!name.empty()) set_of(name).left_out = true;
        section_ = Section::Other;
    }

    // A set that cannot be read stops nothing but itself.
    void take_set(const std::string& name, const std::vector<std::string_view>& fields) {
        if (values_.contains("GENERATE")) {
            std::array<std::int64_t, 3> range{0, 0, 1};
            for (std::size_t i = 0; i < std::min<std::size_t>(3, fields.size()); ++i) {
                const auto number = number_in(fields[i]);
                if (!number && !(i == 2 && fields[i].empty())) return leave_out_set("it is not a range of numbers");
                range[i] = number.value_or(1);
            }
            if (fields.size() == 1) range[1] = range[0];
            constexpr std::int64_t kLargest = std::int64_t{1} << 40;
            if (fields.empty() || range[2] < 1 || range[1] < range[0] || range[0] < 0 || range[1] > kLargest)
                return leave_out_set("it is not a range of numbers");
            count_members(1);
            set_of(name).ranges.push_back(range);
            return;
        }
        for (const std::string_view field : fields) {
            if (const auto number = number_in(field)) {
                set_of(name).numbers.push_back(*number);
            } else if (!add_set(name, name_of(field))) {
                return leave_out_set("there is no set " + in_quotes(std::string(field)));
            }
        }
    }

    static std::optional<std::int64_t> number_in(std::string_view field) {
        std::int64_t number = 0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), number);
        return error == std::errc() && end == field.data() + field.size() ? std::optional(number) : std::nullopt;
    }

    // Adds another set, or what "instance.set" and "instance.number" name. returns: whether there is one
    bool add_set(const std::string& name, std::string_view member) {
        if (!scope_.empty()) return copy_set(name, member);
        const std::size_t dot = member.rfind('.');
        bool found = false;
        if (dot != std::string_view::npos) {
            scope_ = kInside + upper_case(name_of(member.substr(0, dot)));
            const auto number = number_in(member.substr(dot + 1));
            if (number) set_of(name).numbers.push_back(*number);
            found = number || copy_set(name, name_of(member.substr(dot + 1)));
        } else {
            found = copy_set(name, member);
            // A set of the assembly may have members in every instance.
            for (const InpInstance& instance : deck_.instances) {
                count_members(1);
                scope_ = instance.inside;
                found |= copy_set(name, member);
            }
        }
        scope_.clear();
        return found;
    }

    // The set of that name in the part or instance that the line is about, or in the part of the instance.
    [[nodiscard]] const InpSet* set_named(std::string_view name) const {
        const auto in = [&](const std::string& part) -> const InpSet* {
            const auto sets = deck_.parts.find(part);
            if (sets == deck_.parts.end()) return nullptr;
            const auto& all = sets->second.*kind_;
            const auto found = all.find(upper_case(name));
            return found == all.end() || found->second.left_out ? nullptr : &found->second;
        };
        const InpSet* set = in(scope_);
        for (const InpInstance& instance : deck_.instances) {
            if (set != nullptr || !scope_.starts_with(kInside)) break;
            if (instance.inside == scope_) set = in(instance.part);
        }
        return set;
    }

    bool copy_set(const std::string& name, std::string_view member) {
        const InpSet* const other = set_named(member);
        if (other == nullptr) return false;
        count_members(1 + other->numbers.size() + other->ranges.size());
        const InpSet copy = *other;
        InpSet& set = set_of(name);
        set.numbers.insert(set.numbers.end(), copy.numbers.begin(), copy.numbers.end());
        set.ranges.insert(set.ranges.end(), copy.ranges.begin(), copy.ranges.end());
        return true;
    }

    void take_place(const std::vector<std::string_view>& fields) {
        InpInstance& instance = deck_.instances.back();
        const auto at = [&](std::size_t i) { return i < fields.size() ? real(fields[i]) : 0; };
        if (++lines_ == 1) {
            instance.move = {at(0), at(1), at(2)};
        } else if (lines_ == 2) {
            instance.axis = {Vec3(at(0), at(1), at(2)), Vec3(at(3), at(4), at(5))};
            instance.angle_deg = at(6);
        }
    }

    [[nodiscard]] std::size_t most_made() const { return std::max(kFewMade, kMadeOfByte * bytes_); }

    InpDeck& deck_;
    NamedFiles named_{kMostIncluded};
    std::size_t bytes_ = 0, members_ = 0;
    const TextScanner* in_ = nullptr;
    std::string_view file_;
    std::size_t position_ = 0, line_ = 0;  // of the line, and its number
    Section section_ = Section::Other;
    std::map<std::string, std::string> values_;                      // of the keyword
    std::string part_, scope_;                                       // that nodes and elements belong to, and those of a set
    std::map<std::string, InpSet> InpPart::*kind_ = &InpPart::sets;  // of sets that lines are about
    const InpType* type_ = nullptr;
    std::vector<std::int64_t> numbers_;  // of the element so far
    bool open_ = false;                  // whether the next line goes on with an element that is not read
    Coordinates coordinates_ = Coordinates::Rectangular;
    LocalSystem system_;
    Vec3 along_{0.0};
    int lines_ = 0;                                         // of a keyword so far
    std::map<std::string, Places> nodes_at_, elements_at_;  // by parts
};

}  // namespace

Vec3 InpInstance::operator()(const Vec3& x) const {
    const Vec3 moved = x + move, along = axis[1] - axis[0];
    const double length = glm::length(along);
    if (angle_deg == 0 || length == 0) return moved;
    const Vec3 u = along / length, v = moved - axis[0];
    const double angle = angle_deg * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    return axis[0] + c * v + s * glm::cross(u, v) + (1 - c) * glm::dot(u, v) * u;
}

InpDeck read_inp_deck(const std::filesystem::path& path) {
    InpDeck deck;
    DeckReader reader(deck);
    reader.read(path, [&] { return path.string(); });
    reader.finish();
    // Some programs write parts alone.
    const auto has_nodes = [](const auto& part) { return !part.second.points.empty(); };
    if (deck.instances.empty() && !deck.parts.contains("") && std::ranges::any_of(deck.parts, has_nodes)) {
        for (const auto& [name, part] : deck.parts) deck.instances.emplace_back().part = name;
        deck.parts_alone = deck.parts.size();
    }
    const auto outside = deck.parts.find("");
    if (deck.instances.empty() || (outside != deck.parts.end() && !outside->second.elements.empty())) {
        deck.instances.emplace_back();
    }
    return deck;
}

}  // namespace subvol::detail
