// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::test {

/// A block of an Exodus II file. nodes: of an element; connectivity: from 1
struct ExodusBlock {
    std::string type;
    std::size_t nodes;
    std::vector<int> connectivity;
};

/// What to write.
///
/// values: of each variable, step by step; those of elements block by block, with an empty list where a block has none
struct ExodusText {
    std::vector<Vec3> points;
    std::vector<ExodusBlock> blocks;
    std::vector<double> times{};
    std::vector<std::pair<std::string, std::vector<double>>> of_nodes{};
    std::vector<std::pair<std::string, std::vector<std::vector<double>>>> of_elements{};
    int version = 2;         // of the classic format
    bool old_names = false;  // one variable for all coordinates and one for all values at nodes
};

/// A netCDF file in memory: dimensions, and variables over them with their values; all numbers are integers or doubles.
class NetcdfText {
public:
    enum class Kind : std::int32_t { Characters = 2, Integers = 4, Reals = 6 };  // as the classic format counts them
    static constexpr std::size_t kUnlimited = 0;

    struct Dimension {
        std::string name;
        std::size_t length;
    };
    /// values: those that are put, by their places among all
    struct Variable {
        std::string name;
        Kind kind;
        std::vector<std::size_t> dimensions;
        std::vector<std::pair<std::string, std::string>> texts{};
        std::vector<double> values{};
    };

    std::vector<Dimension> dimensions;
    std::vector<Variable> variables;
    std::size_t records = 0;

    std::size_t dimension(const std::string& name, std::size_t length) {
        dimensions.push_back({name, length});
        return dimensions.size() - 1;
    }
    std::size_t variable(const std::string& name, Kind kind, const std::vector<std::size_t>& over) {
        variables.push_back({name, kind, over});
        return variables.size() - 1;
    }
    void attribute(std::size_t variable, const std::string& name, const std::string& text) {
        variables[variable].texts.emplace_back(name, text);
    }
    /// Values from a row of the first dimension on.
    template <class Values>
    void put(std::size_t variable, const Values& values, std::size_t row = 0) {
        Variable& into = variables[variable];
        const std::size_t first = row * row_length(into), end = first + values.size();
        if (into.values.size() < end) into.values.resize(end);
        std::copy(values.begin(), values.end(), into.values.begin() + static_cast<std::ptrdiff_t>(first));
        if (is_record(into)) records = std::max(records, into.values.size() / row_length(into));
    }

    [[nodiscard]] bool is_record(const Variable& variable) const {
        return !variable.dimensions.empty() && dimensions[variable.dimensions[0]].length == kUnlimited;
    }
    [[nodiscard]] std::size_t row_length(const Variable& variable) const {
        std::size_t length = 1;
        for (std::size_t d = 1; d < variable.dimensions.size(); ++d) length *= dimensions[variable.dimensions[d]].length;
        return length;
    }
    [[nodiscard]] std::size_t rows(const Variable& variable) const {
        if (variable.dimensions.empty()) return 1;
        return is_record(variable) ? records : dimensions[variable.dimensions[0]].length;
    }

    /// The bytes of the classic format, of version 1, 2 or 5.
    [[nodiscard]] std::string text(int version) const {
        std::vector<std::size_t> begins(variables.size());
        const std::string header = head(version, begins);
        std::size_t end = header.size();
        for (const bool record : {false, true}) {
            for (std::size_t v = 0; v < variables.size(); ++v) {
                if (is_record(variables[v]) != record) continue;
                begins[v] = end;
                end += bytes_of_row(variables[v]) * (record ? 1 : rows(variables[v]));
                end = (end + 3) / 4 * 4;
            }
        }
        std::string bytes = head(version, begins);
        for (const Variable& variable : variables) {
            if (!is_record(variable)) add_rows(bytes, variable, 0, rows(variable));
        }
        for (std::size_t r = 0; r < records; ++r) {
            for (const Variable& variable : variables) {
                if (is_record(variable)) add_rows(bytes, variable, r, 1);
            }
        }
        return bytes;
    }

private:
    template <class T>
    static void add(std::string& bytes, T value) {
        std::string text(sizeof value, '\0');
        std::memcpy(text.data(), &value, sizeof value);
        if (std::endian::native == std::endian::little) std::reverse(text.begin(), text.end());
        bytes += text;
    }
    static void pad(std::string& bytes) { bytes.resize((bytes.size() + 3) / 4 * 4); }

    [[nodiscard]] std::size_t bytes_of_row(const Variable& variable) const {
        const std::size_t size = variable.kind == Kind::Reals ? 8 : variable.kind == Kind::Integers ? 4 : 1;
        return size * row_length(variable);
    }
    [[nodiscard]] std::string head(int version, const std::vector<std::size_t>& begins) const {
        std::string bytes = "CDF" + std::string(1, static_cast<char>(version));
        const auto count = [&](std::size_t number) {
            version == 5 ? add(bytes, static_cast<std::int64_t>(number)) : add(bytes, static_cast<std::int32_t>(number));
        };
        const auto name = [&](const std::string& text) {
            count(text.size());
            bytes += text;
            pad(bytes);
        };
        const auto list = [&](std::int32_t tag, std::size_t elements) {
            add(bytes, elements == 0 ? 0 : tag);
            count(elements);
        };
        count(records);
        list(10, dimensions.size());
        for (const Dimension& dimension : dimensions) {
            name(dimension.name);
            count(dimension.length);
        }
        list(12, 0);
        list(11, variables.size());
        for (std::size_t v = 0; v < variables.size(); ++v) {
            const Variable& variable = variables[v];
            name(variable.name);
            count(variable.dimensions.size());
            for (const std::size_t dimension : variable.dimensions) count(dimension);
            list(12, variable.texts.size());
            for (const auto& [key, text] : variable.texts) {
                name(key);
                add(bytes, static_cast<std::int32_t>(Kind::Characters));
                name(text);
            }
            add(bytes, static_cast<std::int32_t>(variable.kind));
            count((bytes_of_row(variable) * (is_record(variable) ? 1 : rows(variable)) + 3) / 4 * 4);
            version == 1 ? add(bytes, static_cast<std::int32_t>(begins[v])) : add(bytes, static_cast<std::int64_t>(begins[v]));
        }
        return bytes;
    }
    void add_rows(std::string& bytes, const Variable& variable, std::size_t first, std::size_t count) const {
        const std::size_t length = row_length(variable);
        for (std::size_t i = first * length; i < (first + count) * length; ++i) {
            const double value = i < variable.values.size() ? variable.values[i] : 0;
            if (variable.kind == Kind::Reals) add(bytes, value);
            if (variable.kind == Kind::Integers) add(bytes, static_cast<std::int32_t>(value));
            if (variable.kind == Kind::Characters) bytes += static_cast<char>(value);
        }
        pad(bytes);
    }
};

inline std::vector<double> axis_of(const std::vector<Vec3>& points, int axis) {
    std::vector<double> values;
    for (const Vec3& point : points) values.push_back(point[axis]);
    return values;
}

inline NetcdfText exodus_variables(const ExodusText& file) {
    using Kind = NetcdfText::Kind;
    NetcdfText out;
    const std::size_t points = file.points.size();
    const auto nodes = out.dimension("num_nodes", points), dim = out.dimension("num_dim", 3);
    const auto steps = out.dimension("time_step", NetcdfText::kUnlimited), length = out.dimension("len_name", 33);
    out.dimension("num_el_blk", file.blocks.size());
    out.dimension("num_node_sets", 1);
    out.put(out.variable("node_ns1", Kind::Integers, {out.dimension("num_nod_ns1", 1)}), std::vector<int>{1});
    const auto put_names = [&](const std::string& variable, std::size_t count, const auto& variables) {
        const std::size_t names = out.variable(variable, Kind::Characters, {count, length});
        for (std::size_t v = 0; v < variables.size(); ++v) out.put(names, variables[v].first, v);
    };
    if (file.old_names) {
        const std::size_t all = out.variable("coord", Kind::Reals, {dim, nodes});
        for (std::size_t a = 0; a < 3; ++a) out.put(all, axis_of(file.points, static_cast<int>(a)), a);
    }
    for (int a = 0; !file.old_names && a < 3; ++a) {
        out.put(out.variable(std::string("coord") + "xyz" [a], Kind::Reals, { nodes }), axis_of(file.points, a));
    }
    std::vector<std::size_t> elements;  // dimensions of the blocks
    for (std::size_t b = 0; b < file.blocks.size(); ++b) {
        const auto& [type, per_element, connectivity] = file.blocks[b];
        const std::string number = std::to_string(b + 1);
        elements.push_back(out.dimension("num_el_in_blk" + number, connectivity.size() / per_element));
        const std::size_t per = out.dimension("num_nod_per_el" + number, per_element);
        const std::size_t connect = out.variable("connect" + number, Kind::Integers, {elements.back(), per});
        out.attribute(connect, "elem_type", type);
        out.put(connect, connectivity);
    }
    out.put(out.variable("time_whole", Kind::Reals, {steps}), file.times);
    if (!file.of_nodes.empty()) {
        const std::size_t count = out.dimension("num_nod_var", file.of_nodes.size());
        put_names("name_nod_var", count, file.of_nodes);
        const std::size_t all = file.old_names ? out.variable("vals_nod_var", Kind::Reals, {steps, count, nodes}) : 0;
        for (std::size_t v = 0; v < file.of_nodes.size(); ++v) {
            const auto& values = file.of_nodes[v].second;
            if (!file.old_names) {
                out.put(out.variable("vals_nod_var" + std::to_string(v + 1), Kind::Reals, {steps, nodes}), values);
                continue;
            }
            auto& into = out.variables[all].values;  // for each step those of all variables
            into.resize(file.of_nodes.size() * values.size());
            for (std::size_t i = 0; i < values.size(); ++i) {
                into[(i / points * file.of_nodes.size() + v) * points + i % points] = values[i];
            }
        }
    }
    if (!file.of_elements.empty()) {
        put_names("name_elem_var", out.dimension("num_elem_var", file.of_elements.size()), file.of_elements);
        for (std::size_t v = 0; v < file.of_elements.size(); ++v) {
            for (std::size_t b = 0; b < file.blocks.size(); ++b) {
                const auto& values = file.of_elements[v].second[b];
                const std::string name = "vals_elem_var" + std::to_string(v + 1) + "eb" + std::to_string(b + 1);
                if (!values.empty()) out.put(out.variable(name, Kind::Reals, {steps, elements[b]}), values);
            }
        }
    }
    return out;
}

inline std::string exodus_text(const ExodusText& file) {
    return exodus_variables(file).text(file.version);
}

/// The cells of a mesh as a block.
inline ExodusBlock hex_block(const HexMesh& mesh) {
    ExodusBlock block{"HEX8", 8, {}};
    for (const auto& cell : mesh.cells) {
        for (const Index p : cell) block.connectivity.push_back(static_cast<int>(p) + 1);
    }
    return block;
}

inline std::vector<double> count_from(double first, std::size_t count) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(first + static_cast<double>(i));
    return values;
}

/// A box of 2 x 2 x 1 cells: three of the hexahedra, then the last one; two time steps.
inline ExodusText two_blocks(const HexMesh& box) {
    ExodusBlock first = hex_block(box), second{"hex", 8, {}};
    second.connectivity.assign(first.connectivity.begin() + 24, first.connectivity.end());
    first.connectivity.resize(24);
    ExodusText file{.points = box.points, .blocks = {first, second}, .times = {0, 0.5}};
    for (const std::string name : {"VELX", "VELY", "VELZ", "T", "D_x", "D_y"}) {
        file.of_nodes.push_back({name, count_from(static_cast<double>(file.of_nodes.size()), 2 * box.points.size())});
    }
    file.of_elements = {{"c", {{0, 0, 0, 5, 5, 5}, {0, 6}}}, {"only one", {{0, 0, 0, 5, 5, 5}, {}}}};
    return file;
}

}  // namespace subvol::test
