// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netcdf.h>
#include <netcdf_mem.h>

#include <cstdlib>
#include <stdexcept>
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
    int format = NC_64BIT_OFFSET;
    bool old_names = false;  // one variable for all coordinates and one for all values at nodes
};

/// Defines dimensions and variables of a netCDF file in memory, then writes them.
class NetcdfText {
public:
    explicit NetcdfText(int format) { check(nc_create_mem("memory", format, 0, &id_)); }

    int dimension(const std::string& name, std::size_t length) {
        int dimension = 0;
        check(nc_def_dim(id_, name.c_str(), length, &dimension));
        return dimension;
    }
    int variable(const std::string& name, nc_type type, const std::vector<int>& dimensions) {
        int variable = 0;
        check(nc_def_var(id_, name.c_str(), type, static_cast<int>(dimensions.size()), dimensions.data(), &variable));
        return variable;
    }
    void attribute(int variable, const std::string& name, const std::string& text) {
        check(nc_put_att_text(id_, variable, name.c_str(), text.size(), text.c_str()));
    }
    void end_definitions() { check(nc_enddef(id_)); }
    void put(int variable, const std::vector<std::size_t>& start, const std::vector<std::size_t>& counts,
             const std::vector<double>& values) {
        check(nc_put_vara_double(id_, variable, start.data(), counts.data(), values.data()));
    }
    void put(int variable, const std::vector<int>& values) { check(nc_put_var_int(id_, variable, values.data())); }
    void put_name(int variable, std::size_t row, const std::string& name) {
        const std::size_t start[]{row, 0}, counts[]{1, name.size() + 1};
        check(nc_put_vara_text(id_, variable, start, counts, name.c_str()));
    }
    std::string text() {
        NC_memio memory{};
        check(nc_close_memio(id_, &memory));
        std::string bytes(static_cast<const char*>(memory.memory), memory.size);
        std::free(memory.memory);
        return bytes;
    }

private:
    static void check(int status) {
        if (status != NC_NOERR) throw std::runtime_error(nc_strerror(status));
    }
    int id_ = 0;
};

inline std::vector<double> axis_of(const std::vector<Vec3>& points, int axis) {
    std::vector<double> values;
    for (const Vec3& point : points) values.push_back(point[axis]);
    return values;
}

inline std::string exodus_text(const ExodusText& file) {
    NetcdfText out(file.format);
    const std::size_t points = file.points.size();
    const int nodes = out.dimension("num_nodes", points), dim = out.dimension("num_dim", 3);
    const int steps = out.dimension("time_step", NC_UNLIMITED), length = out.dimension("len_name", 33);
    out.dimension("num_el_blk", file.blocks.size());
    out.dimension("num_node_sets", 1);
    const int node_set = out.variable("node_ns1", NC_INT, {out.dimension("num_nod_ns1", 1)});
    std::vector<int> coordinates, connect, element_dims, node_values;
    for (int a = 0; a < (file.old_names ? 1 : 3); ++a) {
        coordinates.push_back(file.old_names ? out.variable("coord", NC_DOUBLE, {dim, nodes})
                                             : out.variable(std::string("coord") + "xyz" [a], NC_DOUBLE, { nodes }));
    }
    for (std::size_t b = 0; b < file.blocks.size(); ++b) {
        const auto& [type, per_element, connectivity] = file.blocks[b];
        const std::string number = std::to_string(b + 1);
        element_dims.push_back(out.dimension("num_el_in_blk" + number, connectivity.size() / per_element));
        const int per = out.dimension("num_nod_per_el" + number, per_element);
        connect.push_back(out.variable("connect" + number, NC_INT, {element_dims.back(), per}));
        out.attribute(connect.back(), "elem_type", type);
    }
    const int time = out.variable("time_whole", NC_DOUBLE, {steps});
    int node_names = 0, element_names = 0;
    if (!file.of_nodes.empty()) {
        const int count = out.dimension("num_nod_var", file.of_nodes.size());
        node_names = out.variable("name_nod_var", NC_CHAR, {count, length});
        if (file.old_names) node_values.push_back(out.variable("vals_nod_var", NC_DOUBLE, {steps, count, nodes}));
        for (std::size_t v = 1; !file.old_names && v <= file.of_nodes.size(); ++v) {
            node_values.push_back(out.variable("vals_nod_var" + std::to_string(v), NC_DOUBLE, {steps, nodes}));
        }
    }
    std::vector<std::vector<int>> element_values;
    if (!file.of_elements.empty()) {
        const int count = out.dimension("num_elem_var", file.of_elements.size());
        element_names = out.variable("name_elem_var", NC_CHAR, {count, length});
        for (std::size_t v = 0; v < file.of_elements.size(); ++v) {
            auto& per_block = element_values.emplace_back();
            for (std::size_t b = 0; b < file.blocks.size(); ++b) {
                const std::string name = "vals_elem_var" + std::to_string(v + 1) + "eb" + std::to_string(b + 1);
                const bool has = !file.of_elements[v].second[b].empty();
                per_block.push_back(has ? out.variable(name, NC_DOUBLE, {steps, element_dims[b]}) : -1);
            }
        }
    }
    out.end_definitions();
    out.put(node_set, {1});
    for (int a = 0; a < 3; ++a) {
        const auto axis = static_cast<std::size_t>(a);
        file.old_names ? out.put(coordinates[0], {axis, 0}, {1, points}, axis_of(file.points, a))
                       : out.put(coordinates[axis], {0}, {points}, axis_of(file.points, a));
    }
    for (std::size_t b = 0; b < file.blocks.size(); ++b) out.put(connect[b], file.blocks[b].connectivity);
    if (!file.times.empty()) out.put(time, {0}, {file.times.size()}, file.times);
    for (std::size_t v = 0; v < file.of_nodes.size(); ++v) {
        const auto& [name, values] = file.of_nodes[v];
        out.put_name(node_names, v, name);
        const std::size_t count = values.size() / points;
        file.old_names ? out.put(node_values[0], {0, v, 0}, {count, 1, points}, values)
                       : out.put(node_values[v], {0, 0}, {count, points}, values);
    }
    for (std::size_t v = 0; v < file.of_elements.size(); ++v) {
        out.put_name(element_names, v, file.of_elements[v].first);
        for (std::size_t b = 0; b < file.blocks.size(); ++b) {
            const auto& values = file.of_elements[v].second[b];
            if (!values.empty())
                out.put(element_values[v][b], {0, 0}, {file.times.size(), values.size() / file.times.size()}, values);
        }
    }
    return out.text();
}

/// The cells of a mesh as a block.
inline ExodusBlock hex_block(const HexMesh& mesh) {
    ExodusBlock block{"HEX8", 8, {}};
    for (const auto& cell : mesh.cells) {
        for (const Index p : cell) block.connectivity.push_back(static_cast<int>(p) + 1);
    }
    return block;
}

}  // namespace subvol::test
