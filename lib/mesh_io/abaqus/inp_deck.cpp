// SPDX-License-Identifier: Apache-2.0
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

#include "named_files.h"
#include "subvol/error.h"
#include "text_scanner.h"

namespace subvol::detail {

using namespace std::string_view_literals;

namespace {

// A line could ask for any number of nodes, elements and members of sets. What is made is in proportion to the deck's bytes.
constexpr std::size_t kFewMade = std::size_t{1} << 20, kFewMembers = std::size_t{1} << 22;
constexpr std::size_t kMadeOfByte = 16;
constexpr std::size_t kMostIncluded = 10000;

std::vector<std::string_view> fields_of(std::string_view line) {
    std::vector<std::string_view> fields;
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.find(',', begin), line.size());
        fields.push_back(trimmed(line.substr(begin, end - begin)));
        begin = end + 1;
    }
    if (fields.back().empty()) fields.pop_back();  // after a comma at the end
    return fields;
}

// Shells, membranes and surfaces of four nodes, with or without a suffix for the integration; not those of axisymmetric parts.
constexpr std::array kQuads{"S4"sv, "DS4"sv, "M3D4"sv, "SFM3D4"sv, "R3D4"sv};
// Beams, trusses and rigid links of two nodes, in space.
constexpr std::array kLines{"B31"sv, "B33"sv, "T3D2"sv, "DC1D2"sv, "RB3D2"sv, "PIPE31"sv};

bool is_one_of(std::string_view type, std::span<const std::string_view> kinds) {
    return std::ranges::any_of(kinds, [&](std::string_view kind) {
        // A digit behind it is another type: S4R5 is an S4, S43 is not.
        return type.starts_with(kind) && (type.size() == kind.size() || type[kind.size()] < '0' || type[kind.size()] > '9');
    });
}

// The nodes of an element of a volume, a shell or a beam; 0 for any other type.
std::size_t nodes_of(std::string_view type) {
    if (is_one_of(type, kQuads)) return 4;
    if (is_one_of(type, kLines)) return 2;
    if (!type.starts_with("C3D") && !type.starts_with("DC3D")) return 0;
    const std::size_t digits = type.find("3D") + 2;
    std::size_t nodes = 0;
    std::from_chars(type.data() + digits, type.data() + type.size(), nodes);
    return nodes;
}

// The number of nodes is in the names of types; of others a line is an element.
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
            const std::string_view line = trimmed(std::string_view(text).substr(position, end - position));
            position_ = position;
            line_ = number;
            position = end + 1;
            if (line.empty() || line.starts_with("**")) continue;
            if (line.front() != '*') {
                take_data(line);
                continue;
            }
            finish_element();
            if (const auto included = take_keyword(line)) {
                const NamedFiles::Place keyword = [&in, at = position_] { return in.place_of(at); };
                read(named_file(path.parent_path(), *included, keyword), keyword);
            }
        }
        finish_element();
        in_ = outer;
        file_ = outer_file;
    }

    // Each instance of a part is another copy of its nodes and elements, and of the members of its sets.
    void count_instances() {
        std::set<std::string_view> met;
        std::map<std::string_view, std::size_t> members;
        for (const auto& [name, part] : deck_.parts) {
            for (const auto& [set, numbers] : part.sets) members[name] += 1 + numbers.size();
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

private:
    enum class Section { Other, Node, Element, ElementSet, Instance, NodesBetween, ElementsLike };

    struct Places {
        std::unordered_map<std::int64_t, std::size_t> at;
        std::size_t known = 0;
    };

    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const {
        in_->fail_at(position_, message, allowed);
    }

    // Returns the file that *INCLUDE names.
    std::optional<std::string> take_keyword(std::string_view line) {
        const auto fields = fields_of(line);
        const std::string keyword = upper_case(fields.front());
        values_.clear();
        for (std::size_t i = 1; i < fields.size(); ++i) {
            const std::size_t equals = fields[i].find('=');
            const auto value = equals == std::string_view::npos ? std::string_view() : trimmed(fields[i].substr(equals + 1));
            values_[upper_case(trimmed(fields[i].substr(0, equals)))] = std::string(value);
        }
        section_ = Section::Other;
        if (keyword == "*INCLUDE") return values_["INPUT"];
        if (keyword == "*PART") {
            part_ = upper_case(values_["NAME"]);
        } else if (keyword == "*END PART" || keyword == "*END INSTANCE") {
            part_.clear();
        } else if (keyword == "*INSTANCE") {
            section_ = Section::Instance;
            InpInstance& instance = deck_.instances.emplace_back();
            instance.part = upper_case(values_["PART"]);
            instance.place = {file_, line_};
            lines_ = 0;
        } else if (keyword == "*NODE") {
            section_ = Section::Node;
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
        }
        return std::nullopt;
    }

    void start_elements() {
        section_ = Section::Element;
        const std::string type = upper_case(values_["TYPE"]);
        if (type.empty()) fail("the *ELEMENT has no TYPE");
        type_ = deck_.types.try_emplace(type, type).first->second;
        nodes_ = nodes_of(type_);
    }

    void take_data(std::string_view line) {
        if (section_ == Section::Node) take_node(fields_of(line));
        if (section_ == Section::Element) take_element(line);
        if (section_ == Section::NodesBetween) generate_nodes(fields_of(line));
        if (section_ == Section::ElementsLike) generate_elements(fields_of(line));
        if (section_ == Section::ElementSet) take_set(fields_of(line));
        if (section_ == Section::Instance) take_place(fields_of(line));
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
        part.points.push_back(x);
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
        for (std::int64_t k = 1; k < count; ++k) {
            const double t = static_cast<double>(k) / static_cast<double>(count);
            part.numbers.push_back(first + (last > first ? k : -k) * step);
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
                    if (!values_["ELSET"].empty()) part.sets[values_["ELSET"]].push_back(copy.number);
                    part.elements.push_back(std::move(copy));
                }
            }
        }
        if (!values_["ELSET"].empty()) part.sets[values_["ELSET"]].push_back(master.number);
    }

    // An element goes on in the next line until it has all its nodes.
    void take_element(std::string_view line) {
        for (const std::string_view field : fields_of(line)) numbers_.push_back(integer(field));
        if (numbers_.size() > nodes_) finish_element();
    }

    void finish_element() {
        if (numbers_.empty()) return;
        if (nodes_ > 0 && numbers_.size() != nodes_ + 1) {
            fail("element " + std::to_string(numbers_[0]) + " of type " + std::string(type_) + " has " +
                 counted(numbers_.size() - 1, "node", "nodes"));
        }
        InpPart& part = deck_.parts[part_];
        if (!values_["ELSET"].empty()) part.sets[values_["ELSET"]].push_back(numbers_[0]);
        part.elements.push_back({numbers_[0], type_, {numbers_.begin() + 1, numbers_.end()}, file_});
        numbers_.clear();
    }

    void take_set(const std::vector<std::string_view>& fields) {
        InpPart& part = deck_.parts[part_];
        std::vector<std::int64_t>& set = part.sets[values_["ELSET"]];
        if (values_.contains("GENERATE")) {
            if (fields.size() < 2) fail("GENERATE needs a first and a last number");
            const std::int64_t first = integer(fields[0]), last = integer(fields[1]);
            const std::int64_t step = fields.size() > 2 ? integer(fields[2]) : 1;
            if (step < 1 || last < first || first < 0 ||
                (last - first) / step > static_cast<std::int64_t>(part.elements.size())) {
                fail("the numbers " + std::to_string(first) + " to " + std::to_string(last) + " are not those of elements");
            }
            count_members(static_cast<std::size_t>((last - first) / step) + 1);
            for (std::int64_t k = 0; k <= (last - first) / step; ++k) set.push_back(first + k * step);
            return;
        }
        for (const std::string_view field : fields) {
            std::int64_t number = 0;
            const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), number);
            if (error == std::errc() && end == field.data() + field.size()) {
                set.push_back(number);
                continue;
            }
            const auto other = part.sets.find(std::string(field));
            if (other == part.sets.end()) continue;
            count_members(other->second.size());
            const std::vector<std::int64_t> copy = other->second;
            set.insert(set.end(), copy.begin(), copy.end());
        }
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
    std::map<std::string, std::string> values_;  // of the keyword
    std::string part_;
    std::string_view type_;
    std::size_t nodes_ = 0;
    std::vector<std::int64_t> numbers_;  // of the element so far
    int lines_ = 0;
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

bool is_shell(std::string_view type) {
    return is_one_of(type, kQuads) || is_one_of(type, kLines);
}

InpDeck read_inp_deck(const std::filesystem::path& path) {
    InpDeck deck;
    DeckReader reader(deck);
    reader.read(path, [&] { return path.string(); });
    reader.count_instances();
    if (deck.instances.empty()) deck.instances.emplace_back();
    return deck;
}

}  // namespace subvol::detail
