// SPDX-License-Identifier: Apache-2.0
// Reads Gmsh's files of the versions 1, 2 and 4, as text or binary. A first pass looks at the headers of the data sections
// only: an array that has several moments (time, step) makes the steps of the file, and one that has a single moment belongs to
// every step. The second pass reads the sections in their order:
//
//     $MeshFormat          $PhysicalNames, $Entities      $Nodes       $Elements      $NodeData, $ElementData
//     layout, byte order   groups, sharp or not           points       cells          arrays of the chosen step
//
// Data follow what they belong to, and elements follow the nodes. The file gives nodes and elements any numbers; data find them
// by these. Elements that are not read as cells are counted, too, so that data for them have a place. An array stays out, with
// a warning, if it lacks a value at a node or at an element that is read as a cell. Other sections are passed over up to their
// end; other data are warned of.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "assemble.h"
#include "formats.h"
#include "gmsh_elements.h"
#include "mesh_file.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

/// The nodes or the elements that a data section has values for.
///
/// at_cells: they are the elements
/// numbers:  the numbers that the file gives them
/// needed:   a flag for each: whether it must have a value. If one of these has none, the array is left out with a warning
struct GmshEntities {
    bool at_cells;
    const GmshNumbers& numbers;
    std::span<const std::uint8_t> needed;
};

struct DataHeader {
    std::string name = "unnamed";
    double time = 0;
    std::int64_t step = 0;
    std::size_t components = 0;
    std::size_t lines = 0;
};

// Texts (the first is the name), real numbers (times) and integers (step, components, lines), which are words even in a binary
// file.
DataHeader read_header(TextScanner& in, const std::string& section) {
    DataHeader header;
    const std::size_t texts = in.count({"texts of " + section});
    in.line();
    for (std::size_t t = 0; t < texts && !in.at_end(); ++t) {
        const std::string_view text = in.line();
        if (t == 0) header.name = unquoted(text);
    }
    const std::string reals_of = "real numbers of " + section, integers_of = "integers of " + section;
    const std::size_t reals = in.count({reals_of});
    for (std::size_t r = 0; r < reals; ++r) {
        const double real = in.real({reals_of});
        if (r == 0) header.time = real;
    }
    const std::size_t integers = in.count({integers_of});
    if (integers < 3) in.fail(section + " needs at least 3 integers");
    header.step = in.integer({integers_of});
    header.components = in.count({integers_of});
    if (header.components < 1 || header.components > 9) {
        in.fail(section + " has " + std::to_string(header.components) + " components", "1, 3 or 9");
    }
    header.lines = in.count({integers_of});
    for (std::size_t i = 3; i < integers; ++i) in.integer({integers_of});
    return header;
}

// The steps of a file, in the order of their times: those of the arrays that it has several times. Arrays that it has once
// belong to all of them.
//
// sections: for each section of data, in the order of the file, its step; -1: all
struct GmshSteps {
    std::vector<double> times;
    std::vector<int> sections;
};

// A keyword of data at the beginning of a line, from an offset on.
std::size_t next_data(std::string_view text, std::size_t from) {
    while (true) {
        const std::size_t at = text.find("Data", from);
        if (at == std::string_view::npos) return at;
        for (const std::string_view keyword : {"$NodeData", "$ElementData"}) {
            const std::size_t before = keyword.size() - 4;
            if (at < before || text.substr(at - before, keyword.size()) != keyword) continue;
            const std::size_t begin = at - before;
            const char next = at + 4 < text.size() ? text[at + 4] : ' ';
            if ((begin == 0 || text[begin - 1] == '\n') && (next == '\n' || next == '\r' || next == ' ')) return begin;
        }
        from = at + 4;
    }
}

// Headers that cannot be read have no steps: who reads the sections reports them.
GmshSteps steps_of_data(std::string_view text) {
    using Moment = std::pair<double, std::int64_t>;
    std::vector<std::pair<std::string, Moment>> sections;
    std::map<std::string, std::set<Moment>> of_arrays;
    std::string keyword;
    try {
        for (std::size_t at = next_data(text, 0); at != std::string_view::npos; at = next_data(text, at + keyword.size())) {
            TextScanner in(text.substr(at), {}, TextScanner::Comments::None);
            keyword = in.word();
            const DataHeader header = read_header(in, keyword);
            sections.emplace_back(keyword + header.name, Moment{std::isfinite(header.time) ? header.time : 0, header.step});
            of_arrays[sections.back().first].insert(sections.back().second);
        }
    } catch (const Error&) {
        return {};
    }
    std::set<Moment> moments;
    for (const auto& [array, found] : of_arrays) {
        if (found.size() > 1) moments.insert(found.begin(), found.end());
    }
    GmshSteps steps;
    for (const Moment& moment : moments) steps.times.push_back(moment.first);
    for (const auto& [array, moment] : sections) {
        const bool once = of_arrays[array].size() == 1;
        steps.sections.push_back(once ? -1 : static_cast<int>(std::distance(moments.begin(), moments.find(moment))));
    }
    return steps;
}

// Reads the section $NodeData or $ElementData, whose keyword was the last word, and appends it as an array.
void read_gmsh_data(TextScanner& in, GmshValues& values, const GmshEntities& entities, MeshFile& found) {
    const auto& [at_cells, numbers, needed] = entities;
    const std::string entity = at_cells ? "element" : "node";
    const DataHeader header = read_header(in, at_cells ? "$ElementData" : "$NodeData");
    const std::string what = "array " + in_quotes(header.name) + ": line";
    if (!std::isfinite(header.time)) in.fail("array " + in_quotes(header.name) + ": its time is not finite");
    FileArray array{header.name, static_cast<int>(header.components), at_cells, {}};
    array.values.assign(numbers.size() * header.components, std::numeric_limits<double>::quiet_NaN());
    std::vector<std::uint8_t> missing(needed.begin(), needed.end());
    values.begin();
    for (std::size_t n = 0; n < header.lines; ++n) {
        const Place place{what, static_cast<std::int64_t>(n + 1), header.lines};
        const std::int64_t number = values.integer(place);
        const Index to = numbers.find(number);
        if (to == kNone) {
            // NOLINTNEXTLINE(performance-inefficient-string-concatenation): the loop ends here
            in.fail(what + " " + std::to_string(n + 1) + ": there is no " + entity + " " + std::to_string(number));
        }
        if (!std::isnan(array.values[to * header.components])) {
            // NOLINTNEXTLINE(performance-inefficient-string-concatenation): the loop ends here
            in.fail(what + " " + std::to_string(n + 1) + ": " + entity + " " + std::to_string(number) + " has a value already");
        }
        missing[to] = 0;
        for (std::size_t k = 0; k < header.components; ++k) array.values[to * header.components + k] = values.real(place);
    }
    const auto count = static_cast<std::size_t>(std::count(missing.begin(), missing.end(), std::uint8_t{1}));
    if (count == 0) {
        found.arrays.push_back(std::move(array));
    } else {
        found.ignore({"array", header.name, 1, "it has no value at " + counted(count, entity, entity + "s")});
    }
}

// The layout of nodes and elements: versions 1 and 2 list them one by one, 4.0 and 4.1 in blocks, one for each entity of the
// geometry.
enum class Layout { V1, V2, V40, V41 };

class GmshReader {
public:
    GmshReader(std::string_view text, std::string_view file, const ReadOptions& options)
        : in_(text, file, TextScanner::Comments::None),
          file_(file),
          options_(options),
          values_(in_),
          groups_(options.sharp),
          steps_(steps_of_data(text)),
          cells_(in_, values_, nodes_, options_, found_) {
        const std::size_t count = std::max<std::size_t>(1, steps_.times.size());
        step_ = static_cast<int>(chosen_step(options, count, file, found_.warnings));
    }

    ReadResult read() {
        read_format();
        while (!in_.at_end()) {
            const std::string_view keyword = in_.word();
            if (!keyword.starts_with('$')) in_.fail_word({"section"}, "a keyword that begins with $", keyword);
            read_section(keyword);
        }
        if (found_.points.empty()) in_.fail("there is no $Nodes section, or it is empty");
        cells_.list_left_out(file_);
        groups_.check(file_);
        return assemble(std::move(found_), in_, file_, names_, options_);
    }

private:
    /// What to do with files of other programs that have the same ending.
    [[nodiscard]] std::string way_from_others(std::string_view first) const {
        if (upper_case(first) == "MESH") {
            return "meshes of GiD begin so, which neither meshio, VTK nor Gmsh reads: export another format from GiD, such as "
                   "one of docs/formats.md";
        }
        if (first.starts_with('(')) {
            const std::string name = std::filesystem::path(file_).filename().string();
            return "files of Fluent begin so: python3 -m subvol.convert " + name + " mesh.vtu --format ansys converts them";
        }
        return "$MeshFormat is missing";
    }

    void read_format() {
        if (in_.at_end()) in_.fail("the file is empty");
        // Sections before it are those of other programs.
        std::string_view first = in_.word();
        const std::string_view start = first;
        while (first.starts_with('$') && first != "$MeshFormat" && first != "$NOD" && skip_unknown(first) && !in_.at_end())
            first = in_.word();
        if (first == "$NOD") {  // version 1 begins with its nodes
            layout_ = Layout::V1;
            in_.seek(in_.position());
            return;
        }
        if (first != "$MeshFormat") first = start;
        if (first != "$MeshFormat") in_.fail("not a Gmsh file: it begins with " + in_quotes(first), way_from_others(first));
        const double version = in_.real({"version"});
        if (!(version >= 2 && version < 3) && !(version >= 4 && version < 5)) {
            in_.fail("version " + number_word() + " of Gmsh's format is not supported", "2 and 4 are: gmsh -save -format msh4");
        }
        layout_ = version < 3 ? Layout::V2 : version < 4.1 ? Layout::V40 : Layout::V41;
        const bool binary = in_.integer({"file type"}) != 0;
        const std::int64_t data_size = in_.integer({"data size"});
        if (binary) read_order(data_size);
        read_end("$MeshFormat");
    }

    // Goes behind the end of a section. returns: whether there is one
    bool skip_unknown(std::string_view keyword) {
        const std::string end = "\n$End" + std::string(keyword.substr(1));
        const std::size_t at = in_.rest().find(end);
        if (at == std::string_view::npos) return false;
        in_.seek(in_.size() - in_.bytes_left() + at + end.size());
        return true;
    }

    // A binary file has the number 1, from which the byte order follows.
    void read_order(std::int64_t data_size) {
        if (data_size != 8) in_.fail("numbers of " + std::to_string(data_size) + " bytes are not supported", "8 are");
        in_.line();
        const std::string_view one = in_.bytes(size_of(NumberType::Int32), {"byte order"});
        for (const std::endian order : {std::endian::little, std::endian::big}) {
            if (integer_from(one, NumberType::Int32, order) == 1) values_.set_binary(order);
        }
        if (!values_.binary()) in_.fail("the byte order is unknown", "the number 1 is expected after the format");
    }

    // The word that was read last, as text.
    [[nodiscard]] std::string number_word() const {
        TextScanner again = in_;
        again.seek(in_.position());
        return std::string(again.word().substr(0, 8));
    }

    void read_end(std::string_view keyword) {
        const std::string end = (layout_ == Layout::V1 ? "$END" : "$End") + std::string(keyword.substr(1));
        const std::string_view word = in_.word();
        if (word != end) in_.fail_word({shortened(keyword)}, shortened(end), word);
    }

    void read_section(std::string_view keyword) {
        const bool data = keyword == "$NodeData" || keyword == "$ElementData";
        if (data && is_of_other_step()) {
            skip_section(keyword, false);
            return;
        }
        if (keyword == "$Nodes" || (keyword == "$NOD" && layout_ == Layout::V1)) {
            read_nodes();
        } else if (keyword == "$Elements" || (keyword == "$ELM" && layout_ == Layout::V1)) {
            read_elements();
        } else if (keyword == "$NodeData") {
            if (found_.points.empty()) in_.fail("$NodeData come before $Nodes");
            const std::vector<std::uint8_t> all(nodes_.size(), 1);
            read_gmsh_data(in_, values_, {.at_cells = false, .numbers = nodes_, .needed = all}, found_);
        } else if (keyword == "$ElementData") {
            if (!has_elements_) in_.fail("$ElementData come before $Elements");
            read_gmsh_data(in_, values_, {.at_cells = true, .numbers = elements_, .needed = taken_}, found_);
        } else if (keyword == "$PhysicalNames") {
            groups_.read_names(in_);
        } else if (keyword == "$Entities" && layout_ > Layout::V2) {
            groups_.read_entities(values_, layout_ == Layout::V41);
        } else {
            skip_section(keyword, keyword.ends_with("Data"));
            return;
        }
        read_end(keyword);
    }

    // Whether the next section of data belongs to a step that is not read.
    [[nodiscard]] bool is_of_other_step() {
        const std::size_t section = sections_++;
        const int step = section < steps_.sections.size() ? steps_.sections[section] : -1;
        return step >= 0 && step != step_;
    }

    // Only data give a warning: names of physical groups, entities of the geometry and comments are not needed.
    void skip_section(std::string_view keyword, bool warn) {
        const std::string end = "$End" + std::string(keyword.substr(1));
        while (!in_.at_end()) {
            if (in_.word() != end) continue;
            IgnoredPart section{"section", std::string(keyword)};
            if (warn) return found_.ignore(std::move(section));
            found_.ignored.push_back(std::move(section));
            return;
        }
        in_.fail_word({shortened(keyword)}, shortened(end), "");
    }

    // In a binary file of version 4.1 the numbers of nodes and elements, and their counts, have 8 bytes.
    [[nodiscard]] NumberType number_type() const { return layout_ == Layout::V41 ? NumberType::UInt64 : NumberType::Int32; }

    // Reads the total count, then block by block. read_block(count): reads a block; count: the total count
    template <class ReadBlock>
    void read_blocks(const std::string& section, const GmshNumbers& numbers, const ReadBlock& read_block) {
        values_.begin();
        const std::size_t blocks = values_.count({section}, NumberType::UInt64);
        const std::size_t count = values_.count({section}, NumberType::UInt64);
        if (layout_ == Layout::V41) {
            for (const std::string_view end : {"smallest number", "largest number"}) values_.integer({end}, NumberType::UInt64);
        }
        for (std::size_t b = 0; b < blocks; ++b) read_block(count);
        if (numbers.size() == count) return;
        in_.fail(section + ": its blocks have " + std::to_string(numbers.size()) + ", but it announces " +
                 std::to_string(count));
    }

    void read_nodes() {
        if (nodes_.size() > 0) in_.fail("there is a second $Nodes section");
        if (layout_ <= Layout::V2) {
            const std::size_t count = in_.count({"$Nodes"});
            values_.begin();
            reserve_nodes(count);
            for (std::size_t n = 0; n < count; ++n) {
                read_node_number(count, NumberType::Int32);
                read_point(values_, found_, names_, count);
            }
        } else {
            read_blocks("$Nodes", nodes_, [&](std::size_t count) { read_node_block(count); });
        }
        names_.point_numbers = nodes_.all();
        if (const auto twice = nodes_.sort()) in_.fail("there are two nodes " + std::to_string(*twice));
    }

    void reserve_nodes(std::size_t count) {
        const std::size_t room = std::min(count, values_.room() / 4);
        found_.points.reserve(room);
        nodes_.reserve(room);
    }

    void read_node_number(std::size_t of, NumberType type) {
        nodes_.add(values_.integer({"number of node", static_cast<std::int64_t>(nodes_.size() + 1), of}, type));
    }

    // Version 4.1 lists all numbers, then all coordinates; 4.0 each number with its coordinates. Parameters on the curve or
    // surface of the geometry may follow the coordinates.
    void read_node_block(std::size_t of) {
        const std::int64_t first = values_.integer({"block of $Nodes"});
        const std::int64_t second = values_.integer({"block of $Nodes"});
        const std::int64_t dimension = layout_ == Layout::V41 ? first : second;
        const bool parametric = values_.integer({"block of $Nodes"}) != 0;
        if (dimension < 0 || dimension > 3) in_.fail("a block of $Nodes is of dimension " + std::to_string(dimension));
        const std::size_t count = values_.count({"block of $Nodes"}, NumberType::UInt64);
        if (count > of - nodes_.size()) in_.fail("$Nodes: its blocks have more than the " + std::to_string(of) + " announced");
        if (nodes_.size() == 0) reserve_nodes(of);
        for (std::size_t n = 0; layout_ == Layout::V41 && n < count; ++n) read_node_number(of, number_type());
        for (std::size_t n = 0; n < count; ++n) {
            if (layout_ == Layout::V40) read_node_number(of, number_type());
            read_point(values_, found_, names_, of);
            for (std::int64_t k = 0; parametric && k < dimension; ++k) values_.real({"parameter of a node"});
        }
    }

    void read_elements() {
        if (has_elements_) in_.fail("there is a second $Elements section");
        if (found_.points.empty()) in_.fail("$Elements come before $Nodes");
        has_elements_ = true;
        if (layout_ <= Layout::V2) {
            const std::size_t count = in_.count({"$Elements"});
            values_.begin();
            while (elements_.size() < count) values_.binary() ? read_element_run(count) : read_element_line(count);
        } else {
            read_blocks("$Elements", elements_, [&](std::size_t count) { read_element_block(count); });
        }
        std::ignore = elements_.sort();  // numbers that occur twice matter only to data
    }

    /// Reads the nodes of an element.
    void take(const GmshElement& element, std::int64_t number, const Place& place) {
        const std::size_t before = elements_.size();
        elements_.add(number);
        taken_.push_back(cells_.take(element, before, in_sharp_group_, number_type(), place) ? 1 : 0);
    }

    [[nodiscard]] Place next_element(std::size_t of) const {
        return {"element", static_cast<std::int64_t>(elements_.size() + 1), of};
    }

    [[nodiscard]] const GmshElement& element_of(std::int64_t type) const {
        const auto element = kGmshElements.find(type);
        if (element == kGmshElements.end()) {
            in_.fail("element " + std::to_string(elements_.size() + 1) + " is of the unknown type " + std::to_string(type));
        }
        return element->second;
    }

    // Reads an element: number, type, tags and nodes.
    void read_element_line(std::size_t of) {
        const Place place = next_element(of);
        in_sharp_group_ = false;
        const std::int64_t number = in_.integer(place);
        const GmshElement& element = element_of(in_.integer(place));
        const bool counted = layout_ == Layout::V1;  // two tags, then the number of nodes
        const std::size_t tags = counted ? 2 : in_.count(place);
        if (tags == 0) set_group(0, 0);
        for (std::size_t t = 0; t < tags; ++t) read_tag(element, t, in_.integer(place));
        if (counted && in_.count(place) != element.nodes)
            in_.fail("element " + std::to_string(number) + " has another number of nodes");
        take(element, number, place);
    }

    // Reads a run of elements of one type with the same number of tags.
    void read_element_run(std::size_t of) {
        const GmshElement& element = element_of(values_.integer(next_element(of)));
        const std::size_t count = values_.count(next_element(of));
        const std::size_t tags = values_.count(next_element(of));
        if (count == 0 || count > of - elements_.size()) in_.fail("there are not as many elements as announced");
        for (std::size_t e = 0; e < count; ++e) {
            const Place place = next_element(of);
            const std::int64_t number = values_.integer(place);
            for (std::size_t t = 0; t < tags; ++t) read_tag(element, t, values_.integer(place));
            if (tags == 0) in_sharp_group_ = false;
            if (tags == 0) set_group(0, 0);
            take(element, number, place);
        }
    }

    // The first tag of an element is its physical group.
    void read_tag(const GmshElement& element, std::size_t tag, std::int64_t value) {
        if (tag > 0) return;
        const std::int64_t dimension = dimension_of(element);
        in_sharp_group_ = groups_.is_sharp(dimension, value);
        set_group(dimension, value);
    }

    // The names of groups are looked up once for each run of elements of a group.
    void set_group(std::int64_t dimension, std::int64_t group) {
        if (group_ == std::pair(dimension, group)) return;
        group_ = {dimension, group};
        const bool one = group > 0;
        cells_.set_groups(one ? std::vector<std::string>{groups_.name_of(dimension, group)} : std::vector<std::string>{});
    }

    // Reads a block: elements of one type on one entity of the geometry.
    void read_element_block(std::size_t of) {
        const std::int64_t first = values_.integer({"block of $Elements"});
        const std::int64_t second = values_.integer({"block of $Elements"});
        const auto entity = layout_ == Layout::V41 ? std::pair(first, second) : std::pair(second, first);
        in_sharp_group_ = groups_.has_sharp(entity.first, entity.second);
        cells_.set_groups(groups_.names_of_entity(entity.first, entity.second));
        const GmshElement& element = element_of(values_.integer({"block of $Elements"}));
        const std::size_t count = values_.count({"block of $Elements"}, NumberType::UInt64);
        if (count > of - elements_.size()) {
            in_.fail("$Elements: its blocks have more than the " + std::to_string(of) + " announced");
        }
        for (std::size_t e = 0; e < count; ++e) {
            const Place place = next_element(of);
            take(element, values_.integer(place, number_type()), place);
        }
    }

    TextScanner in_;
    std::string_view file_;
    ReadOptions options_;
    GmshValues values_;
    GmshGroups groups_;
    GmshSteps steps_;
    int step_ = 0;                                       // that is read
    std::size_t sections_ = 0;                           // of data so far
    std::pair<std::int64_t, std::int64_t> group_{0, 0};  // of the element before: dimension and number
    bool in_sharp_group_ = false;                        // the element that is being read
    Layout layout_ = Layout::V2;
    MeshFile found_;
    EntityNames names_{"node", "element", 1};
    GmshNumbers nodes_;
    GmshNumbers elements_;
    std::vector<std::uint8_t> taken_;  // a flag for each element: whether it is read as a cell
    GmshCells cells_;
    bool has_elements_ = false;
};

}  // namespace

ReadResult read_gmsh(std::string_view text, std::string_view file, const ReadOptions& options) {
    return GmshReader(text, file, options).read();
}

std::vector<double> gmsh_times(const std::filesystem::path& path) {
    return steps_of_data(read_text(path)).times;
}

}  // namespace subvol::detail
