// SPDX-License-Identifier: Apache-2.0
// Writes Gmsh's version 4.1 as text. The format lists groups of entities of a geometry, not of elements: points, sides and
// cells that are in the same patches and sets become one entity, which is in their groups. All nodes belong to the first
// volume.
#include <algorithm>
#include <charconv>
#include <map>
#include <numeric>

#include "formats.h"
#include "mesh_arrays.h"
#include "sharp_groups.h"
#include "subvol/cell.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/output_file.h"

namespace subvol::detail {
namespace {

constexpr int kPoint = 0, kSurface = 2, kVolume = 3;  // dimensions of entities
constexpr int kPointType = 15, kQuadType = 3, kHexahedronType = 5;

/// Elements of one dimension that are in the same groups.
struct GmshEntity {
    int dimension;
    std::vector<int> groups;           // their numbers, ascending
    std::vector<std::size_t> members;  // points, places in a list of sides, or cells
};

// Puts members of groups together that are in the same ones.
//
// groups: for each member the groups that it is in
// all:    whether members of no group make an entity, too
void add_entities(int dimension, const std::vector<std::vector<int>>& groups, bool all, std::vector<GmshEntity>& entities) {
    std::map<std::vector<int>, std::size_t> places;
    for (std::size_t k = 0; k < groups.size(); ++k) {
        if (groups[k].empty() && !all) continue;
        const auto [at, is_new] = places.try_emplace(groups[k], entities.size());
        if (is_new) entities.push_back({dimension, groups[k], {}});
        entities[at->second].members.push_back(k);
    }
}

// What can stand between quotes on a line of the file, which has at most 128 characters.
std::string name_between_quotes(std::string name) {
    constexpr std::size_t kLongest = 127;
    constexpr unsigned char kFirstPrintable = ' ';
    for (char& c : name) {
        if (c == '"') c = '\'';
        if (static_cast<unsigned char>(c) < kFirstPrintable) c = '_';
    }
    name.resize(std::min(name.size(), kLongest));
    return name;
}

class GmshWriter {
public:
    GmshWriter(const std::filesystem::path& path, const WrittenMesh& written)
        : out_(path), mesh_(written.mesh), sets_(written.sets) {}

    std::vector<std::string> run() {
        out_.write("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n");
        collect();
        write_names();
        write_entities();
        write_nodes();
        write_elements();
        std::vector<Attribute> lost;
        for (const Attribute& attribute : mesh_.attributes) {
            if (!write_field(attribute)) lost.push_back(attribute);
        }
        out_.commit();
        warn_of_lost_fields(".msh", lost, warnings_);
        warn_of_lost_creases(".msh", mesh_, warnings_);
        return std::move(warnings_);
    }

private:
    void collect() {
        std::vector<std::vector<int>> of_points(mesh_.points.size()), of_cells(mesh_.cells.size()), of_sides;
        for (const NodeSet& set : sets_.nodes) {
            if (set.cells.empty()) continue;
            const int number = name(kPoint, set.name);
            for (const Index p : points_of(mesh_, set)) of_points[p].push_back(number);
        }
        std::map<std::pair<Index, std::uint8_t>, std::size_t> places;
        for (const Patch& patch : sets_.patches) {
            if (patch.sides.empty()) continue;
            const int number = name(kSurface, patch.name);
            for (const CellSide& side : patch.sides) {
                const auto [at, is_new] = places.try_emplace({side.cell, side.side}, sides_.size());
                if (is_new) {
                    sides_.push_back(side);
                    of_sides.emplace_back();
                }
                of_sides[at->second].push_back(number);
            }
        }
        for (const CellSet& set : sets_.sets) {
            if (set.cells.empty()) continue;
            const int number = name(kVolume, set.name);
            for (const Index c : set.cells) of_cells[c].push_back(number);
        }
        // Gmsh saves, and meshio reads, all elements of a mesh if all are in groups.
        if (!names_.empty() && std::ranges::any_of(of_cells, &std::vector<int>::empty)) {
            std::string rest = "cells";
            while (std::ranges::find(sets_.sets, rest, &CellSet::name) != sets_.sets.end()) rest += '_';
            const int number = name(kVolume, rest);
            for (std::vector<int>& groups : of_cells) {
                if (groups.empty()) groups.push_back(number);
            }
        }
        add_entities(kPoint, of_points, false, entities_);
        add_entities(kSurface, of_sides, false, entities_);
        add_entities(kVolume, of_cells, true, entities_);
    }

    int name(int dimension, const std::string& given) {
        const std::string text = name_between_quotes(given);
        if (text != given) warnings_.push_back("group " + in_quotes(given) + " is called " + in_quotes(text));
        names_.emplace_back(dimension, text);
        return static_cast<int>(names_.size());
    }

    void write_names() {
        if (names_.empty()) return;
        out_.write("$PhysicalNames\n" + std::to_string(names_.size()) + "\n");
        for (std::size_t k = 0; k < names_.size(); ++k) {
            const auto& [dimension, text] = names_[k];
            out_.write(std::to_string(dimension) + " " + std::to_string(k + 1) + " \"" + text + "\"\n");
        }
        out_.write("$EndPhysicalNames\n");
    }

    // Entities are numbered from 1 in each dimension; `tag` is called in their order.
    void write_entities() {
        const Box box = bounds(mesh_);
        const auto count = [&](int dimension) {
            return static_cast<std::size_t>(std::ranges::count(entities_, dimension, &GmshEntity::dimension));
        };
        NumberWriter numbers(out_, true);
        out_.write("$Entities\n");
        numbers.put_all(std::array{count(kPoint), std::size_t{0}, count(kSurface), count(kVolume)});
        numbers.end_row();
        for (std::size_t k = 0; k < entities_.size(); ++k) {
            const GmshEntity& entity = entities_[k];
            numbers.put(tag(k));
            if (entity.dimension == kPoint) {
                numbers.put_point<double>(mesh_.points[entity.members.front()]);
            } else {
                numbers.put_point<double>(box.lower);
                numbers.put_point<double>(box.upper);
            }
            numbers.put(entity.groups.size());
            numbers.put_all(entity.groups);
            if (entity.dimension != kPoint) numbers.put(0);  // entities that bound it
            numbers.end_row();
        }
        numbers.flush();
        out_.write("$EndEntities\n");
    }

    [[nodiscard]] std::size_t tag(std::size_t entity) const {
        std::size_t first = entity;
        while (first > 0 && entities_[first - 1].dimension == entities_[entity].dimension) --first;
        return entity - first + 1;
    }

    void write_nodes() {
        const std::size_t count = mesh_.points.size();
        out_.write("$Nodes\n");
        NumberWriter numbers(out_, true);
        numbers.put_all(std::array{std::size_t{1}, count, std::size_t{1}, count});
        numbers.end_row();
        numbers.put_all(std::array{std::size_t{kVolume}, std::size_t{1}, std::size_t{0}, count});
        numbers.end_row();
        for (std::size_t p = 1; p <= count; ++p) {
            numbers.put(p);
            numbers.end_row();
        }
        for (const Vec3& x : mesh_.points) {
            numbers.put_point<double>(x);
            numbers.end_row();
        }
        numbers.flush();
        out_.write("$EndNodes\n");
    }

    void write_elements() {
        std::size_t count = 0;
        for (const GmshEntity& entity : entities_) count += entity.members.size();
        out_.write("$Elements\n");
        NumberWriter numbers(out_, true);
        numbers.put_all(std::array{entities_.size(), count, std::size_t{1}, count});
        numbers.end_row();
        std::size_t next = mesh_.cells.size() + 1;  // cells keep their numbers
        for (std::size_t k = 0; k < entities_.size(); ++k) {
            const auto& [dimension, groups, members] = entities_[k];
            numbers.put(dimension);
            numbers.put(tag(k));
            numbers.put(dimension == kPoint ? kPointType : dimension == kSurface ? kQuadType : kHexahedronType);
            numbers.put(members.size());
            numbers.end_row();
            for (const std::size_t member : members) {
                numbers.put(dimension == kVolume ? member + 1 : next++);
                if (dimension == kPoint) {
                    numbers.put(member + 1);
                } else if (dimension == kSurface) {
                    const CellSide& side = sides_[member];
                    for (const std::size_t c : kCellFaces[side.side]) numbers.put(std::size_t{mesh_.cells[side.cell][c]} + 1);
                } else {
                    for (const Index p : mesh_.cells[member]) numbers.put(std::size_t{p} + 1);
                }
                numbers.end_row();
            }
        }
        numbers.flush();
        out_.write("$EndElements\n");
    }

    // Gmsh has scalars, vectors and tensors of nine components. returns: whether the field is one of them
    bool write_field(const Attribute& attribute) {
        static const std::map<int, std::vector<std::size_t>> kComponents{
            {1, {0}}, {3, {0, 1, 2}}, {6, {0, 3, 5, 3, 1, 4, 5, 4, 2}}, {9, {0, 1, 2, 3, 4, 5, 6, 7, 8}}};
        const auto components = kComponents.find(attribute.channels);
        if (components == kComponents.end()) return false;
        const bool at_cells = is_at_cells(mesh_, attribute);
        const std::vector<double>& values = at_cells ? attribute.cells : attribute.values;
        const std::size_t count = at_cells ? mesh_.cells.size() : mesh_.points.size();
        const auto channels = static_cast<std::size_t>(attribute.channels);
        const std::string section = at_cells ? "ElementData\n" : "NodeData\n";
        out_.write("$" + section + "1\n\"" + name_between_quotes(attribute.name) + "\"\n1\n");
        NumberWriter numbers(out_, true);
        numbers.put(mesh_.time.value_or(0));
        numbers.end_row();
        for (const std::size_t number : {std::size_t{3}, std::size_t{0}, components->second.size(), count}) {
            numbers.put(number);
            numbers.end_row();
        }
        for (std::size_t k = 0; k < count; ++k) {
            numbers.put(k + 1);
            for (const std::size_t c : components->second) numbers.put(values[k * channels + c]);
            numbers.end_row();
        }
        numbers.flush();
        out_.write("$End" + section);
        return true;
    }

    OutputFile out_;
    const HexMesh& mesh_;
    const MeshSets& sets_;
    std::vector<std::pair<int, std::string>> names_;  // of groups: dimension and name
    std::vector<CellSide> sides_;                     // that are in patches
    std::vector<GmshEntity> entities_;                // by dimension
    std::vector<std::string> warnings_;
};

}  // namespace

std::vector<std::string> write_gmsh(const std::filesystem::path& path, const WrittenMesh& written) {
    return GmshWriter(path, written).run();
}

}  // namespace subvol::detail
