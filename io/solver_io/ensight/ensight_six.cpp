// SPDX-License-Identifier: Apache-2.0
#include "ensight_six.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <tuple>

namespace subvol::detail {

namespace {

constexpr std::size_t kLine = 80;

void put_line(std::string& out, std::string_view text) {
    out += text.substr(0, kLine);
    out.append(kLine - std::min(kLine, text.size()), '\0');
}

template <class Number>
void put_number(std::string& out, Number number) {
    out.append(reinterpret_cast<const char*>(&number), sizeof number);
}

void put_part(std::string& out, std::int64_t number) {
    put_line(out, "part");
    put_number(out, static_cast<std::int32_t>(number));
}

// "part 3"
std::int64_t part_number(const EnsightData& data, std::string_view line) {
    const std::string_view word = trimmed(line.substr(4));
    std::int64_t number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || number < 0 || number > 1 << 24) {
        data.fail("a line \"part\" with a number is expected, not " + in_quotes(line));
    }
    return number;
}

// Values that follow each other with all their components become one list for each component.
void put_components(std::string& out, const std::vector<double>& values, std::size_t components) {
    for (std::size_t c = 0; c < components; ++c) {
        for (std::size_t i = c; i < values.size(); i += components) put_number(out, static_cast<float>(values[i]));
    }
}

}  // namespace

void EnsightSix::read_nodes(EnsightData& data, const std::string& ids) {
    count_ = data.count("nodes");
    const bool listed = ids == "given" || ids == "ignore";
    std::vector<std::int64_t> numbers;
    std::vector<double> values;
    if (listed && !data.binary()) {
        for (std::size_t p = 0; p < count_; ++p) {
            const auto number = data.column_integers(1, "number of a node");
            const auto point = data.column_reals(3, "coordinates");
            numbers.push_back(number[0]);
            values.insert(values.end(), point.begin(), point.end());
        }
    } else {
        if (listed) numbers = data.integers(count_, "numbers of nodes");
        if (count_ > data.in().size()) data.fail("there are too many nodes");
        values = data.column_reals(3 * count_, "coordinates");
    }
    points_.assign(values.begin(), values.end());
    numbered_ = ids == "given";
    for (std::size_t p = 0; numbered_ && p < count_; ++p) places_.emplace(numbers[p], static_cast<Index>(p));
}

void EnsightSix::read_block(EnsightData& data, Part& part, const std::string& line) {
    const auto sizes = data.column_integers(3, "sizes of a block");
    if (std::ranges::any_of(sizes, [](std::int64_t size) { return size < 1 || size > 1 << 20; })) {
        data.fail("the sizes of the block are out of range");
    }
    part.block_points = part.block_cells = 1;
    put_line(part.block, line);
    for (const std::int64_t size : sizes) {
        part.block_points *= static_cast<std::size_t>(size);
        part.block_cells *= static_cast<std::size_t>(size - 1);
        put_number(part.block, static_cast<std::int32_t>(size));
    }
    if (part.block_points > data.in().size()) data.fail("the file is too short for the block");
    for (const double value : data.column_reals(3 * part.block_points, "coordinates")) {
        put_number(part.block, static_cast<float>(value));
    }
    if (line.find("iblanked") == std::string::npos) return;
    for (const std::int64_t blank : data.column_integers(part.block_points, "blanks")) {
        put_number(part.block, static_cast<std::int32_t>(blank));
    }
}

void EnsightSix::read_elements(EnsightData& data, Part& part, const std::string& type, bool ids) const {
    const std::size_t nodes = nodes_of_ensight(type);
    if (nodes == 0) data.fail("elements of type " + in_quotes(type) + " are not known");
    Group& group = part.groups.emplace_back();
    group.type = type;
    group.count = data.count("elements");
    if (group.count > data.in().size() / nodes) data.fail("there are too many elements");
    if (ids && data.binary()) std::ignore = data.integers(group.count, "numbers of elements");
    for (std::size_t e = 0; e < group.count; ++e) {
        if (ids && !data.binary()) std::ignore = data.column_integers(1, "number of an element");
        for (const std::int64_t node : data.column_integers(nodes, "nodes of elements")) {
            const auto place = numbered_ ? places_.find(node) : places_.end();
            const bool known = numbered_ ? place != places_.end() : node >= 1 && static_cast<std::size_t>(node) <= count_;
            if (!known) data.fail(type + " " + std::to_string(e + 1) + ": there is no node " + std::to_string(node));
            group.corners.push_back(numbered_ ? place->second : static_cast<Index>(node - 1));
        }
    }
    part.nodes.insert(part.nodes.end(), group.corners.begin(), group.corners.end());
}

void EnsightSix::put(std::string& out, Part& part, const std::vector<float>& points) {
    put_part(out, part.number);
    put_line(out, part.name);
    out += part.block;
    if (!part.block.empty()) return;
    std::ranges::sort(part.nodes);
    part.nodes.erase(std::unique(part.nodes.begin(), part.nodes.end()), part.nodes.end());
    put_line(out, "coordinates");
    put_number(out, static_cast<std::int32_t>(part.nodes.size()));
    for (std::size_t k = 0; k < 3; ++k) {
        for (const Index p : part.nodes) put_number(out, points[3 * p + k]);
    }
    for (const Group& group : part.groups) {
        put_line(out, group.type);
        put_number(out, static_cast<std::int32_t>(group.count));
        for (const Index p : group.corners) {
            const auto place = std::ranges::lower_bound(part.nodes, p) - part.nodes.begin();
            put_number(out, static_cast<std::int32_t>(place + 1));
        }
    }
}

std::string EnsightSix::geometry(EnsightData& data) {
    *this = {};
    std::string out;
    put_line(out, "C Binary");
    put_line(out, data.description());
    put_line(out, data.description());
    put_line(out, "node id off");
    put_line(out, "element id off");
    const std::string node_ids = data.kind_of_ids("node"), element_ids = data.kind_of_ids("element");
    while (!data.at_end()) {
        const std::string line = data.keyword();
        if (line == "coordinates") {
            read_nodes(data, node_ids);
        } else if (line.starts_with("part")) {
            const std::int64_t number = part_number(data, line);
            parts_.push_back({.number = number, .name = data.description(), .block = {}, .groups = {}, .nodes = {}});
        } else if (parts_.empty()) {
            if (!line.empty()) data.fail("a part is expected, not " + in_quotes(line));
        } else if (line.starts_with("block")) {
            read_block(data, parts_.back(), line);
        } else {
            read_elements(data, parts_.back(), line, element_ids == "given" || element_ids == "ignore");
        }
    }
    order_ = data.order();
    for (Part& part : parts_) put(out, part, points_);
    return out;
}

const EnsightSix::Part& EnsightSix::part_of(const EnsightData& data, const std::string& line) const {
    const std::int64_t number = part_number(data, line);
    const auto part = std::ranges::find(parts_, number, &Part::number);
    if (part == parts_.end()) data.fail("there is no part " + std::to_string(number));
    return *part;
}

std::string EnsightSix::variable(EnsightData& data, std::size_t components, bool at_cells) const {
    data.set_order(order_);
    std::string out;
    put_line(out, data.description());
    if (!at_cells && count_ > 0) {
        const std::vector<double> values = data.column_reals(components * count_, "values");
        for (const Part& part : parts_) {
            if (!part.block.empty()) continue;
            put_part(out, part.number);
            put_line(out, "coordinates");
            for (std::size_t c = 0; c < components; ++c) {
                for (const Index p : part.nodes) put_number(out, static_cast<float>(values[p * components + c]));
            }
        }
    }
    const Part* part = nullptr;
    while (!data.at_end()) {
        const std::string line = data.keyword();
        if (line.starts_with("part")) {
            part = &part_of(data, line);
            put_part(out, part->number);
        } else if (part == nullptr) {
            if (!line.empty()) data.fail("a part is expected, not " + in_quotes(line));
        } else if (line.starts_with("block")) {
            const std::size_t count = at_cells ? part->block_cells : part->block_points;
            put_line(out, "block");
            // Texts list the first component of all values, then the next one; binary files list value by value.
            put_components(out, data.column_reals(components * count, "values"), data.binary() ? components : 1);
        } else {
            const auto group = std::ranges::find(part->groups, line, &Group::type);
            if (!at_cells || group == part->groups.end()) data.fail("the part has no elements of type " + in_quotes(line));
            put_line(out, line);
            put_components(out, data.column_reals(components * group->count, "values"), components);
        }
    }
    return out;
}

}  // namespace subvol::detail
