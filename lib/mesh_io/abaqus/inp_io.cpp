// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "assemble.h"
#include "formats.h"
#include "inp_deck.h"
#include "mesh_file.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr EntityNames kAbaqusNames{"node", "element", 1};

class DeckAssembly {
public:
    DeckAssembly(const InpDeck& deck, std::string file, const ReadOptions& options)
        : deck_(deck), file_(std::move(file)), options_(options) {}

    ReadResult run() {
        const BlockChoice choice(options_.blocks, set_names(), file_);
        for (const InpInstance& instance : deck_.instances) {
            const auto part = deck_.parts.find(instance.part);
            if (part == deck_.parts.end()) {
                fail(instance.part.empty() ? "it has no nodes" : "there is no part " + in_quotes(instance.part));
            }
            add(part->second, instance, choice);
        }
        if (curved_ > 0) {
            found_.warnings.push_back(counted(curved_, "element has", "elements have") +
                                      " more nodes than corners: only the corners are used");
        }
        drop_parts();
        std::string list;
        for (const auto& [type, count] : left_out_) {
            list += (list.empty() ? "" : ", ") + counted(count, "element", "elements") + " of type " + type;
        }
        add_left_out_warning(found_, list, file_);
        for (const auto& [name, cells] : blocks_) {
            if (cells > 0) found_.blocks.push_back({name, cells});
        }
        EntityNames names = kAbaqusNames;
        names.point_numbers = numbers_;
        return assemble(std::move(found_), file_, names, options_);
    }

private:
    [[noreturn]] void fail(const std::string& message) const { throw Error(ErrorCode::InvalidInput, message, file_); }

    [[nodiscard]] std::vector<std::string> set_names() const {
        std::vector<std::string> names;
        for (const auto& [part, contents] : deck_.parts) {
            for (const auto& [name, elements] : contents.sets) names.push_back(name);
        }
        return names;
    }

    void add(const InpPart& part, const InpInstance& instance, const BlockChoice& choice) {
        places_ = {};  // not cleared, which takes as long as the largest part did
        if (found_.points.size() + part.points.size() >= kNone) fail("there are too many nodes");
        for (std::size_t p = 0; p < part.points.size(); ++p) {
            places_[part.numbers[p]] = static_cast<Index>(found_.points.size());
            found_.points.push_back(instance(part.points[p]));
            numbers_.push_back(part.numbers[p]);
        }
        std::unordered_set<std::int64_t> chosen;
        for (const auto& [name, elements] : part.sets) {
            if (choice.takes(name)) chosen.insert(elements.begin(), elements.end());
        }
        std::unordered_set<std::int64_t> cells;
        for (const InpElement& element : part.elements) {
            if (!options_.blocks.empty() && !chosen.contains(element.number)) continue;
            if (take(element)) cells.insert(element.number);
            ++next_;
        }
        for (const auto& [name, elements] : part.sets) {
            if (!choice.takes(name)) continue;
            const std::unordered_set<std::int64_t> of_set(elements.begin(), elements.end());
            blocks_[name] += static_cast<std::size_t>(
                std::ranges::count_if(of_set, [&](std::int64_t number) { return cells.contains(number); }));
        }
    }

    // Abaqus' C3D20 has VTK's order of nodes.
    bool take(const InpElement& element) {
        const bool volume = element.type.starts_with("C3D") || element.type.starts_with("DC3D");
        const bool others = options_.other_cells != OtherCells::Ignore;
        const std::size_t nodes = volume ? element.nodes.size() : 0;
        if (is_shell(element.type)) {
            take_shell(element);
            return false;
        }
        if (nodes == 8 || nodes == 20 || nodes == 27) {
            const bool whole = nodes == 20 && options_.curved_tolerance.has_value();
            put(found_.hexes, element, whole);
            if (whole) found_.curved.add(next_, CurvedOrder::Vtk, all_of(element));
        } else if ((nodes == 6 || nodes == 15) && others) {
            put(found_.prisms, element, false);
        } else if ((nodes == 4 || nodes == 10) && others) {
            put(found_.tets, element, false);
        } else if ((nodes == 5 || nodes == 13) && others) {
            put(found_.pyramids, element, false);
        } else {
            ++left_out_[printable(std::string(element.type))];
            return false;
        }
        return true;
    }

    void take_shell(const InpElement& element) {
        if (element.nodes.size() == 4) put(found_.quads, element, false);
        if (element.nodes.size() == 2) put(found_.lines, element, false);
        shells_.emplace_back(static_cast<Index>(next_), element.type);
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
    std::vector<std::int64_t> numbers_;
    std::map<std::string, std::size_t> blocks_, left_out_;
    std::vector<std::pair<Index, std::string_view>> shells_;  // numbers and types
    std::size_t next_ = 0, curved_ = 0;
};

}  // namespace

ReadResult read_inp(const std::filesystem::path& path, const ReadOptions& options) {
    const InpDeck deck = read_inp_deck(path);
    return DeckAssembly(deck, path.string(), options).run();
}

}  // namespace subvol::detail
