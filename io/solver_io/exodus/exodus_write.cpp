// SPDX-License-Identifier: Apache-2.0
// Writes Exodus II as a file of netCDF's classic format. Each element is in one block, and blocks follow each other, so cells
// are sorted: sets that have no cell in common with those before become blocks, the others sets of elements. What the file has
// is named first, with functions that give the values, and then written at once.
#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>

#include "classic_netcdf.h"
#include "exodus_sides.h"
#include "mesh_arrays.h"
#include "sharp_groups.h"
#include "solver_readers.h"
#include "subvol/cell.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/output_file.h"
#include "subvol/error.h"

namespace subvol::detail {
namespace {

using Kind = ClassicNetcdfFile::Kind;

constexpr std::size_t kMostNumbered = std::numeric_limits<std::int32_t>::max();
constexpr std::size_t kUsualNameLength = 32;
constexpr float kExodusVersion = 5.1F;

std::int32_t exodus_number(std::size_t counted_from_0) {
    return static_cast<std::int32_t>(counted_from_0 + 1);
}

// The number from 1 that a side of a hexahedron has, given that in `kCellFaces`.
std::int32_t exodus_side(std::size_t side) {
    const CornersOfSides& sides = exodus_sides("HEX8");
    const auto same = [&](const std::vector<std::size_t>& corners) {
        return std::is_permutation(corners.begin(), corners.end(), kCellFaces[side].begin());
    };
    return exodus_number(static_cast<std::size_t>(std::ranges::find_if(sides, same) - sides.begin()));
}

// What programs know as components of vectors and tensors, in the order of channels; numbers for other fields.
std::vector<std::string> endings_of(int channels) {
    if (channels == 2) return {"_x", "_y"};
    if (channels == 3) return {"_x", "_y", "_z"};
    if (channels == 6) return {"_xx", "_yy", "_zz", "_xy", "_yz", "_xz"};
    if (channels == 9) return {"_xx", "_xy", "_xz", "_yx", "_yy", "_yz", "_zx", "_zy", "_zz"};
    if (channels == 1) return {""};
    std::vector<std::string> endings;
    for (int c = 1; c <= channels; ++c) endings.push_back("_" + std::to_string(c));
    return endings;
}

/// A scalar of the file: a component of a field.
struct ExodusScalar {
    std::string name;
    const std::vector<double>* values;
    std::size_t channel, channels;
};

class ExodusWriter {
public:
    ExodusWriter(const std::filesystem::path& path, const WrittenMesh& written)
        : out_(path), mesh_(written.mesh), sets_(written.sets) {
        if (std::max(mesh_.points.size(), mesh_.cells.size()) > kMostNumbered) {
            throw Error(ErrorCode::InvalidInput, "such files number at most 2,147,483,647 nodes and elements", path.string(),
                        ".vtu or .vtkhdf");
        }
    }

    std::vector<std::string> run() {
        sort_cells();
        find_scalars();
        add_general();
        add_blocks();
        add_side_sets();
        add_sets("node", "ns", "num_nod_ns", "node_ns", node_sets());
        add_sets("elem", "els", "num_ele_els", "elem_els", element_sets());
        add_scalars();
        file_.write(out_);
        out_.commit();
        warn_of_lost_creases(".e", mesh_, warnings_);
        return std::move(warnings_);
    }

private:
    /// Numbers with a name.
    struct Numbers {
        std::string name;
        std::vector<std::int32_t> numbers;
    };
    struct BlockOfCells {
        std::string name;
        std::size_t first, size;  // in `cells_`
    };

    void sort_cells() {
        std::vector<std::uint8_t> taken(mesh_.cells.size());
        const auto is_taken = [&](Index c) { return taken[c] != 0; };
        const auto add = [&](const std::string& name, const auto& cells) {
            blocks_.push_back({name, cells_.size(), cells.size()});
            for (const Index c : cells) {
                taken[c] = 1;
                cells_.push_back(c);
            }
        };
        for (const CellSet& set : sets_.sets) {
            if (set.cells.empty()) continue;
            if (std::ranges::any_of(set.cells, is_taken)) {
                others_.push_back(&set);
            } else {
                add(set.name, set.cells);
            }
        }
        std::vector<Index> rest;
        for (Index c = 0; c < mesh_.cells.size(); ++c) {
            if (!is_taken(c)) rest.push_back(c);
        }
        if (!rest.empty()) {
            std::string name = "cells";
            while (std::ranges::find(sets_.sets, name, &CellSet::name) != sets_.sets.end()) name += '_';
            add(name, rest);
        }
        numbers_.resize(cells_.size());
        for (std::size_t k = 0; k < cells_.size(); ++k) numbers_[cells_[k]] = exodus_number(k);
    }

    // The file has scalars alone: programs join those whose names end with components.
    void find_scalars() {
        std::set<std::string> at_points, at_cells;
        for (const Attribute& field : mesh_.attributes) {
            const bool of_cells = is_at_cells(mesh_, field);
            const std::vector<std::string> endings = endings_of(field.channels);
            for (std::size_t k = 0; k < endings.size(); ++k) {
                const std::string wanted = field.name + endings[k];
                std::string name = wanted;
                while (!(of_cells ? at_cells : at_points).insert(name).second) name += '_';
                if (name != wanted) warnings_.push_back(in_quotes(wanted) + " is called " + in_quotes(name));
                (of_cells ? of_elements_ : of_nodes_)
                    .push_back({name, of_cells ? &field.cells : &field.values, k, endings.size()});
            }
        }
    }

    // What all files have, and the nodes. Names may be longer than in the first versions.
    void add_general() {
        std::size_t longest = 0;
        const auto see = [&](const std::string& name) { longest = std::max(longest, name.size()); };
        for (const BlockOfCells& block : blocks_) see(block.name);
        for (const Patch& patch : sets_.patches) see(patch.name);
        for (const CellSet& set : sets_.sets) see(set.name);
        for (const NodeSet& set : sets_.nodes) see(set.name);
        for (const auto* scalars : {&of_nodes_, &of_elements_}) {
            for (const ExodusScalar& scalar : *scalars) see(scalar.name);
        }
        file_.attribute("api_version", kExodusVersion);
        file_.attribute("version", kExodusVersion);
        file_.attribute("floating_point_word_size", static_cast<std::int32_t>(sizeof(double)));
        file_.attribute("file_size", 1);  // variables may be long
        file_.attribute("maximum_name_length", static_cast<std::int32_t>(longest));
        file_.attribute("int64_status", 0);
        file_.attribute("title", "Written by subvol");
        name_length_ = std::max(longest, kUsualNameLength) + 1;
        file_.dimension("len_string", kUsualNameLength + 1);
        file_.dimension("len_line", 81);
        file_.dimension("four", 4);
        length_dimension_ = file_.dimension("len_name", name_length_);
        time_dimension_ = file_.dimension("time_step", 0);
        const std::size_t axes = file_.dimension("num_dim", 3), nodes = file_.dimension("num_nodes", mesh_.points.size());
        nodes_dimension_ = nodes;
        const std::size_t elements = file_.dimension("num_elem", mesh_.cells.size());
        file_.variable("time_whole", Kind::Reals, {time_dimension_},
                       [this](NetcdfValues& to) { to.put(mesh_.time.value_or(0)); });
        add_names("coor_names", axes, {"x", "y", "z"});
        for (int axis = 0; axis < 3; ++axis) {
            file_.variable(
                std::string("coord") + "xyz" [axis], Kind::Reals, { nodes },
                [this, axis](NetcdfValues& to) {
                    for (const Vec3& x : mesh_.points) to.put(x[axis]);
                });
        }
        // Other programs show elements by their numbers in the mesh.
        if (!std::ranges::is_sorted(cells_)) {
            file_.variable("elem_num_map", Kind::Integers, {elements}, [this](NetcdfValues& to) {
                for (const Index c : cells_) to.put(exodus_number(c));
            });
        }
    }

    void add_names(const std::string& variable, std::size_t dimension, std::vector<std::string> names) {
        file_.variable(variable, Kind::Characters, {dimension, length_dimension_},
                       [this, names = std::move(names)](NetcdfValues& to) {
                           for (const std::string& name : names) to.put(name, name_length_);
                       });
    }

    // Names, numbers and flags of parts of one kind. returns: the dimension of their number
    std::size_t add_parts(const std::string& dimension, const std::string& of, std::vector<std::string> names) {
        const std::size_t count = names.size(), parts = file_.dimension(dimension, count);
        file_.variable(of + "_status", Kind::Integers, {parts}, [count](NetcdfValues& to) {
            for (std::size_t k = 0; k < count; ++k) to.put(std::int32_t{1});
        });
        file_.variable(of + "_prop1", Kind::Integers, {parts},
                       [count](NetcdfValues& to) {
                           for (std::size_t k = 0; k < count; ++k) to.put(exodus_number(k));
                       },
                       {{"name", "ID"}});
        add_names(of + "_names", parts, std::move(names));
        return parts;
    }

    void add_blocks() {
        std::vector<std::string> names;
        for (const BlockOfCells& block : blocks_) names.push_back(block.name);
        blocks_dimension_ = add_parts("num_el_blk", "eb", std::move(names));
        for (std::size_t b = 0; b < blocks_.size(); ++b) {
            const std::string number = std::to_string(b + 1);
            const std::size_t size = file_.dimension("num_el_in_blk" + number, blocks_[b].size);
            const std::size_t corners = file_.dimension("num_nod_per_el" + number, 8);
            sizes_.push_back(size);
            file_.variable("connect" + number, Kind::Integers, {size, corners},
                           [this, b](NetcdfValues& to) {
                               for (const Index c : cells_of(blocks_[b])) {
                                   for (const Index p : mesh_.cells[c]) to.put(exodus_number(p));
                               }
                           },
                           {{"elem_type", "HEX8"}});
        }
    }

    [[nodiscard]] std::span<const Index> cells_of(const BlockOfCells& block) const {
        return std::span(cells_).subspan(block.first, block.size);
    }

    void add_side_sets() {
        std::vector<const Patch*> patches;
        std::vector<std::string> names;
        for (const Patch& patch : sets_.patches) {
            if (patch.sides.empty()) continue;
            patches.push_back(&patch);
            names.push_back(patch.name);
        }
        if (patches.empty()) return;
        add_parts("num_side_sets", "ss", std::move(names));
        for (std::size_t k = 0; k < patches.size(); ++k) {
            const std::string number = std::to_string(k + 1);
            const std::vector<CellSide>& sides = patches[k]->sides;
            const std::size_t size = file_.dimension("num_side_ss" + number, sides.size());
            file_.variable("elem_ss" + number, Kind::Integers, {size}, [this, &sides](NetcdfValues& to) {
                for (const CellSide& side : sides) to.put(numbers_[side.cell]);
            });
            file_.variable("side_ss" + number, Kind::Integers, {size}, [&sides](NetcdfValues& to) {
                for (const CellSide& side : sides) to.put(exodus_side(side.side));
            });
        }
    }

    [[nodiscard]] std::vector<Numbers> node_sets() const {
        std::vector<Numbers> sets;
        for (const NodeSet& set : sets_.nodes) {
            if (set.cells.empty()) continue;
            Numbers& numbers = sets.emplace_back(Numbers{set.name, {}});
            for (const Index p : points_of(mesh_, set)) numbers.numbers.push_back(exodus_number(p));
        }
        return sets;
    }

    [[nodiscard]] std::vector<Numbers> element_sets() const {
        std::vector<Numbers> sets;
        for (const CellSet* set : others_) {
            Numbers& numbers = sets.emplace_back(Numbers{set->name, {}});
            for (const Index c : set->cells) numbers.numbers.push_back(numbers_[c]);
        }
        return sets;
    }

    void add_sets(const std::string& kind, const std::string& of, const std::string& dimension, const std::string& variable,
                  std::vector<Numbers> sets) {
        if (sets.empty()) return;
        std::vector<std::string> names;
        for (const Numbers& set : sets) names.push_back(set.name);
        add_parts("num_" + kind + "_sets", of, std::move(names));
        for (std::size_t k = 0; k < sets.size(); ++k) {
            const std::string number = std::to_string(k + 1);
            const std::size_t size = file_.dimension(dimension + number, sets[k].numbers.size());
            file_.variable(variable + number, Kind::Integers, {size}, [numbers = std::move(sets[k].numbers)](NetcdfValues& to) {
                for (const std::int32_t value : numbers) to.put(value);
            });
        }
    }

    [[nodiscard]] std::size_t add_scalar_names(const std::string& kind, const std::vector<ExodusScalar>& scalars) {
        std::vector<std::string> names;
        for (const ExodusScalar& scalar : scalars) names.push_back(scalar.name);
        const std::size_t count = file_.dimension("num_" + kind + "_var", names.size());
        add_names("name_" + kind + "_var", count, std::move(names));
        return count;
    }

    void add_scalars() {
        if (!of_nodes_.empty()) (void)add_scalar_names("nod", of_nodes_);
        for (std::size_t v = 0; v < of_nodes_.size(); ++v) {
            file_.variable("vals_nod_var" + std::to_string(v + 1), Kind::Reals, {time_dimension_, nodes_dimension_},
                           [this, v](NetcdfValues& to) {
                               const auto& [name, values, channel, channels] = of_nodes_[v];
                               for (std::size_t p = 0; p < mesh_.points.size(); ++p) to.put((*values)[p * channels + channel]);
                           });
        }
        if (of_elements_.empty()) return;
        const std::size_t count = add_scalar_names("elem", of_elements_);
        file_.variable("elem_var_tab", Kind::Integers, {blocks_dimension_, count}, [this](NetcdfValues& to) {
            for (std::size_t k = 0; k < blocks_.size() * of_elements_.size(); ++k) to.put(std::int32_t{1});
        });
        for (std::size_t v = 0; v < of_elements_.size(); ++v) {
            for (std::size_t b = 0; b < blocks_.size(); ++b) {
                file_.variable("vals_elem_var" + std::to_string(v + 1) + "eb" + std::to_string(b + 1), Kind::Reals,
                               {time_dimension_, sizes_[b]}, [this, v, b](NetcdfValues& to) {
                                   const auto& [name, values, channel, channels] = of_elements_[v];
                                   for (const Index c : cells_of(blocks_[b])) to.put((*values)[c * channels + channel]);
                               });
            }
        }
    }

    OutputFile out_;
    const HexMesh& mesh_;
    const MeshSets& sets_;
    ClassicNetcdfFile file_;
    std::vector<Index> cells_;           // in the order of the file
    std::vector<std::int32_t> numbers_;  // in the file, of each cell
    std::vector<BlockOfCells> blocks_;
    std::vector<const CellSet*> others_;  // sets that are no blocks
    std::vector<ExodusScalar> of_nodes_, of_elements_;
    std::vector<std::size_t> sizes_;  // the dimension of each block
    std::size_t name_length_ = 0, length_dimension_ = 0, time_dimension_ = 0, nodes_dimension_ = 0, blocks_dimension_ = 0;
    std::vector<std::string> warnings_;
};

}  // namespace

std::vector<std::string> write_exodus(const std::filesystem::path& path, const WrittenMesh& written) {
    return ExodusWriter(path, written).run();
}

}  // namespace subvol::detail
