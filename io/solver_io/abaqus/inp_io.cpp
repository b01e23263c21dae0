// SPDX-License-Identifier: Apache-2.0
// Makes one mesh of a deck's parts. Each instance is a copy of its part, moved and turned; its points and cells follow those of
// the instances before.
//
//     instance → points, moved → elements of chosen sets → cells by shape → sets by numbers of elements → surfaces by sides
//
// The file's numbers of nodes and elements are unique in an instance only, so they are looked up in it; all elements that are
// counted keep a place, also those of types that are not read. Sides become lists of corners in the order of the shape's own
// table; a surface without a side means all sides, of which those inside the mesh fall away later. Shells that are faces or
// edges of cells are dropped. Warnings list what is left out, and the numbers and sets that are named but are not there.
#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "assemble.h"
#include "inp_deck.h"
#include "mesh_file.h"
#include "solver_readers.h"
#include "subvol/detail/error_text.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr EntityNames kAbaqusNames{"node", "element", 1};

// Lines of a small deck may name any number of sides, each the members of a set.
constexpr std::size_t kMostSides = std::size_t{1} << 22, kSidesOfElement = 64;

class DeckAssembly {
public:
    DeckAssembly(const InpDeck& deck, std::string file, const ReadOptions& options)
        : deck_(deck), file_(std::move(file)), options_(options) {}

    ReadResult run() {
        collect();
        EntityNames names = kAbaqusNames;
        names.point_numbers = numbers_;
        return assemble(std::move(found_), file_, names, options_);
    }

    DeckContents contents() {
        const bool numbered =
            deck_.instances.size() == 1 && deck_.instances[0].part.empty() && deck_.instances[0].inside.empty();
        if (!numbered) fail("it has parts and instances, whose elements have other numbers than in the results");
        collect();
        return {std::move(found_), std::move(numbers_), std::move(elements_)};
    }

private:
    void collect() {
        const BlockChoice choice(options_.blocks, set_names(), file_);
        for (const InpInstance& instance : deck_.instances) {
            const auto part = deck_.parts.find(instance.part), inside = deck_.parts.find(instance.inside);
            const bool has_mesh = inside != deck_.parts.end() && !inside->second.points.empty();
            if (part == deck_.parts.end() && !has_mesh) {
                if (!instance.part.empty()) fail("there is no part " + in_quotes(instance.part));
                throw Error(ErrorCode::InvalidInput, "it has no nodes", file_,
                            "*NODE is needed; AVS UCD files have this ending, too: with the ending .ucd they are read");
            }
            std::vector<const std::map<std::string, InpSet>*> sets;
            if (part != deck_.parts.end()) sets.push_back(&part->second.sets);
            if (inside != deck_.parts.end() && inside != part) sets.push_back(&inside->second.sets);
            add(has_mesh ? inside->second : part->second, instance, sets, choice);
            if (part != deck_.parts.end()) add_node_sets(part->second.node_sets);
            if (inside != deck_.parts.end() && inside != part) add_node_sets(inside->second.node_sets);
        }
        if (deck_.parts_alone > 0) {
            found_.warnings.push_back(counted(deck_.parts_alone, "part has", "parts have") +
                                      " no *INSTANCE: taken where the nodes are");
        }
        if (deck_.longer > 0) {
            found_.warnings.push_back(counted(deck_.longer, "element has", "elements have") +
                                      " more numbers than nodes: those after the last node are ignored");
        }
        deck_.sets_left_out.report("set of elements", "sets of elements", found_.warnings, found_.ignored);
        deck_.node_sets_left_out.report("set of nodes", "sets of nodes", found_.warnings, found_.ignored);
        deck_.surfaces_left_out.report("surface", "surfaces", found_.warnings, found_.ignored);
        if (unknown_nodes_ > 0) {
            found_.warnings.push_back(counted(unknown_nodes_, "number", "numbers") + " in sets of nodes that no node has");
        }
        if (moved_ > 0) {
            found_.warnings.push_back(counted(moved_, "node is", "nodes are") +
                                      " listed again with other coordinates: the last ones are taken");
        }
        warn_of_unknown_names();
        if (curved_ > 0) {
            found_.warnings.push_back(counted(curved_, "element has", "elements have") +
                                      " more nodes than corners: only the corners are used");
        }
        if (sides_ > kMostSides + kSidesOfElement * next_)
            found_.warnings.emplace_back("its surfaces have too many sides: some are left out");
        drop_parts();
        add_left_out_warning(found_, ignored_parts("element type", left_out_), file_);
        for (IgnoredPart& keyword : ignored_parts("keyword", deck_.other_keywords))
            found_.ignored.push_back(std::move(keyword));
        for (const auto& [key, block] : blocks_) {
            if (block.cells > 0) found_.blocks.push_back(block);
        }
    }

    void warn_of_unknown_names() {
        std::vector<std::string> of_nothing, not_there;
        for (const auto& [name, count] : unknown_) {
            if (count > 0) of_nothing.push_back(in_quotes(name) + " (" + std::to_string(count) + ")");
        }
        for (const auto& [name, is_there] : sets_of_surfaces_) {
            if (!is_there) not_there.push_back(in_quotes(name));
        }
        if (!of_nothing.empty())
            found_.warnings.push_back("numbers in sets of elements that no element has: " + listed(of_nothing));
        if (!not_there.empty()) found_.warnings.push_back("its surfaces name sets that it does not have: " + listed(not_there));
    }

    [[nodiscard]] std::unordered_set<std::int64_t> elements_of(const InpInstance& instance) const {
        std::unordered_set<std::int64_t> numbers;
        for (const std::string& name : {instance.part, instance.inside}) {
            const auto part = deck_.parts.find(name);
            if (part == deck_.parts.end()) continue;
            for (const InpElement& element : part->second.elements) numbers.insert(element.number);
        }
        return numbers;
    }

    [[noreturn]] void fail(const std::string& message) const { throw Error(ErrorCode::InvalidInput, message, file_); }

    // Sets of several parts whose names differ in the case of letters are one.
    [[nodiscard]] std::vector<std::string> set_names() {
        for (const auto& [part, contents] : deck_.parts) {
            for (const auto& [key, set] : contents.sets) blocks_.try_emplace(key, MeshBlock{set.name, 0});
        }
        std::vector<std::string> names;
        for (const auto& [key, block] : blocks_) names.push_back(block.name);
        return names;
    }

    using Sets = std::map<std::string, InpSet>;

    void add(const InpPart& part, const InpInstance& instance, const std::vector<const Sets*>& all_sets,
             const BlockChoice& choice) {
        places_ = {};  // not cleared, which takes as long as the largest part did
        if (found_.points.size() + part.points.size() >= kNone) fail("there are too many nodes");
        const std::size_t first = found_.points.size();
        for (std::size_t p = 0; p < part.points.size(); ++p) {
            const auto [place, is_new] = places_.try_emplace(part.numbers[p], static_cast<Index>(first + p));
            moved_ += !is_new && part.points[place->second - first] != part.points[p];
            place->second = static_cast<Index>(first + p);
            found_.points.push_back(instance(part.points[p]));
            numbers_.push_back(part.numbers[p]);
        }
        std::unordered_set<std::int64_t> chosen;
        for (const Sets* sets : all_sets) {
            for (const auto& [key, set] : *sets) {
                if (choice.takes(blocks_.at(key).name)) chosen.insert(set.numbers.begin(), set.numbers.end());
            }
        }
        std::unordered_map<std::int64_t, std::pair<Index, const InpElement*>> cells;
        for (const InpElement& element : part.elements) {
            if (!options_.blocks.empty() && !chosen.contains(element.number)) continue;
            if (take(element)) cells[element.number] = {static_cast<Index>(next_), &element};
            elements_.push_back(element.number);
            ++next_;
        }
        const std::unordered_set<std::int64_t> elements = elements_of(instance);
        for (const Sets* sets : all_sets) {
            for (const auto& [key, set] : *sets) {
                MeshBlock& block = blocks_.at(key);
                if (!choice.takes(block.name)) continue;
                const std::unordered_set<std::int64_t> of_set(set.numbers.begin(), set.numbers.end());
                FileSet& cells_of_set = sets_[block.name];
                for (const std::int64_t number : of_set) {
                    unknown_[block.name] += elements.contains(number) ? 0 : 1;
                    const auto cell = cells.find(number);
                    if (cell != cells.end()) cells_of_set.numbers.push_back(cell->second.first);
                }
                block.cells += static_cast<std::size_t>(
                    std::ranges::count_if(of_set, [&](std::int64_t number) { return cells.contains(number); }));
            }
        }
        for (const InpSurface& surface : deck_.surfaces) {
            const bool of_all = surface.scope.empty();
            if (!of_all && surface.scope != instance.part && surface.scope != instance.inside) continue;
            FilePatch& patch = patches_[surface.name];
            const auto add_sides = [&](std::int64_t number, std::size_t side) {
                const auto cell = cells.find(number);
                if (cell == cells.end() || ++sides_ > kMostSides + kSidesOfElement * next_) return;
                add_side(*cell->second.second, side, patch);
            };
            for (const InpSide& side : surface.sides) {
                if (side.set.empty()) add_sides(side.number, side.side);
                const std::string prefix = instance.inside.empty() ? "" : instance.inside.substr(1) + ".";
                const bool of_instance = !prefix.empty() && side.set.starts_with(prefix);
                for (const Sets* sets : all_sets) {
                    if (side.set.empty()) continue;
                    const auto set = sets->find(of_instance ? side.set.substr(prefix.size()) : side.set);
                    bool& is_there = sets_of_surfaces_[side.set];
                    is_there |= set != sets->end();
                    if (set == sets->end()) continue;
                    for (const std::int64_t number : set->second.numbers) add_sides(number, side.side);
                }
            }
        }
    }

    /// After `add`: the nodes of the instance that it added. Sets of several parts whose names differ in the case of letters
    /// are one.
    void add_node_sets(const Sets& sets) {
        for (const auto& [key, set] : sets) {
            FileSet& nodes = node_sets_[node_set_names_.try_emplace(key, set.name).first->second];
            for (const std::int64_t number : set.numbers) {
                const auto place = places_.find(number);
                if (place == places_.end()) {
                    ++unknown_nodes_;
                } else {
                    nodes.numbers.push_back(place->second);
                }
            }
        }
    }

    // side: from 1, or 0 for all of them, of which those inside the mesh fall away later
    void add_side(const InpElement& element, std::size_t side, FilePatch& patch) const {
        const auto& sides = inp_sides(element.type->shape);
        std::vector<Index> corners;
        for (std::size_t s = 0; s < sides.size(); ++s) {
            if (side != 0 && side != s + 1) continue;
            corners.clear();
            for (const std::size_t k : sides[s]) corners.push_back(place(element, element.nodes[k]));
            patch.add(corners);
        }
    }

    // Abaqus' C3D20 has VTK's order of nodes.
    bool take(const InpElement& element) {
        const InpShape shape = element.type->shape;
        const bool others = options_.other_cells != OtherCells::Ignore;
        if (is_shell(shape)) {
            take_shell(element);
            return false;
        }
        if (shape == InpShape::Hex) {
            const bool whole = element.nodes.size() == 20 && options_.curved_tolerance.has_value();
            put(found_.hexes, element, whole);
            if (whole) found_.curved.add(next_, CurvedOrder::Vtk, all_of(element));
        } else if (shape == InpShape::Prism && others) {
            put(found_.prisms, element, false);
        } else if (shape == InpShape::Tet && others) {
            put(found_.tets, element, false);
        } else if (shape == InpShape::Pyramid && others) {
            put(found_.pyramids, element, false);
        } else {
            ++left_out_[printable(element.type->name)];
            return false;
        }
        return true;
    }

    void take_shell(const InpElement& element) {
        if (element.type->shape == InpShape::Quad) put(found_.quads, element, false);
        if (element.type->shape == InpShape::Line) put(found_.lines, element, false);
        shells_.emplace_back(static_cast<Index>(next_), element.type->name);
    }

    // Counts the faces and edges of cells among the shells by their types.
    void drop_parts() {
        std::ignore = drop_parts_of_cells(found_, options_.shells_alone);
        std::unordered_set<Index> kept(found_.quads.numbers.begin(), found_.quads.numbers.end());
        kept.insert(found_.lines.numbers.begin(), found_.lines.numbers.end());
        for (const auto& [number, type] : shells_) {
            if (!kept.contains(number)) ++left_out_[printable(std::string(type))];
        }
    }

    [[nodiscard]] Index place(const InpElement& element, std::int64_t node) const {
        const auto found = places_.find(node);
        if (found == places_.end()) {
            throw Error(ErrorCode::InvalidInput,
                        "element " + std::to_string(element.number) + ": there is no node " + std::to_string(node),
                        std::string(element.place));
        }
        return found->second;
    }

    [[nodiscard]] std::vector<Index> all_of(const InpElement& element) const {
        std::vector<Index> nodes;
        for (const std::int64_t node : element.nodes) nodes.push_back(place(element, node));
        return nodes;
    }

    template <std::size_t N>
    void put(FileCells<N>& into, const InpElement& element, bool whole) {
        curved_ += element.nodes.size() > N && !whole;
        auto& corners = into.corners.emplace_back();
        for (std::size_t k = 0; k < N; ++k) corners[k] = place(element, element.nodes[k]);
        into.numbers.push_back(static_cast<Index>(next_));
    }

    const InpDeck& deck_;
    std::string file_;
    ReadOptions options_;
    MeshFile found_;
    std::unordered_map<std::int64_t, Index> places_;
    std::vector<std::int64_t> numbers_, elements_;  // of the points, and of all elements that were counted
    std::map<std::string, MeshBlock> blocks_;       // by names in capitals
    std::map<std::string, std::size_t> left_out_;
    std::vector<std::pair<Index, std::string_view>> shells_;  // numbers and types
    std::map<std::string, std::size_t> unknown_;              // numbers of a set that no element has
    std::map<std::string, bool> sets_of_surfaces_;            // whether they are there
    std::size_t next_ = 0, curved_ = 0, sides_ = 0, moved_ = 0;
    ByName<FilePatch> patches_{found_.patches};
    std::size_t unknown_nodes_ = 0;                      // numbers of sets of nodes that are no nodes
    std::map<std::string, std::string> node_set_names_;  // by names in capitals
    ByName<FileSet> sets_{found_.sets}, node_sets_{found_.node_sets};
};

}  // namespace

ReadResult read_inp(const std::filesystem::path& path, const ReadOptions& options) {
    const InpDeck deck = read_inp_deck(path);
    return DeckAssembly(deck, path.string(), options).run();
}

DeckContents read_inp_contents(const std::filesystem::path& path, const ReadOptions& options) {
    const InpDeck deck = read_inp_deck(path);
    return DeckAssembly(deck, path.string(), options).contents();
}

}  // namespace subvol::detail
