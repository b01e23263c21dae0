// SPDX-License-Identifier: Apache-2.0
// Puts the pieces of a mesh together to one.
//
//     points   by their global numbers, if all pieces have them, each whole, once in a piece and at one place; else by their
//              exact places. The first of those that are joined is kept, with its values. Numbers also give the order
//     cells    one piece after the other, with the new numbers of points; then in the order of their global numbers, if these
//              are whole and different for all cells but ghosts
//     rest     patches and sets of the same name become one; arrays that a piece lacks have gaps there, but for ghost flags,
//              which are 0; values on patches go to their faces in the whole
//
// The order by numbers does not depend on how the mesh was cut, so that what follows is as it would be for the whole mesh.
#include "join_pieces.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_map>

#include "assemble.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/detail/tolerance_length.h"
#include "subvol/detail/word_hash.h"
#include "subvol/error.h"

namespace subvol::detail {

std::size_t cell_count(const MeshFile& part) {
    std::size_t count = 0;
    for (const FileArray& array : part.arrays) {
        if (array.at_cells) count = std::max(count, array.values.size() / static_cast<std::size_t>(array.components));
    }
    each_kind(part, [&](const auto& cells) {
        for (const Index number : cells.numbers) count = std::max(count, std::size_t{number} + 1);
    });
    return count;
}

double near_of_join(const Box& all, double largest) {
    return 1e-6 * tolerance_length(all, largest);
}

double largest_cell(const MeshFile& part) {
    double largest = 0;
    each_kind(part, [&](const auto& cells) {
        for (const auto& corners : cells.corners) {
            Box box;
            for (const Index p : corners) box.add(part.points[p]);
            largest = std::max(largest, box.diagonal());
        }
    });
    return largest;
}

std::string joining_report(std::size_t parts, std::string_view word, std::size_t joined, const std::string& by,
                           const std::string& order_by) {
    return counted(parts, word, std::string(word) + "s") + " put together; " + counted(joined, "point", "points") +
           " joined with those of another, by " + by + (order_by.empty() ? "" : "; cells in the order of " + order_by);
}

GapLimit::GapLimit(std::size_t values) {
    constexpr std::size_t kFewGaps = 1 << 20,
                          kGapsOfValue = 8;  // many parts with an array each would be many arrays of the whole
    room_ = kFewGaps + kGapsOfValue * values;
}

bool GapLimit::allows(std::string_view name, std::size_t values) {
    if (std::ranges::find(kPointNumberArrays, name) != kPointNumberArrays.end() ||
        std::ranges::find(kCellNumberArrays, name) != kCellNumberArrays.end() || values > room_)
        return false;
    room_ -= values;
    return true;
}

IgnoredPart not_everywhere(const std::string& name, std::string_view word) {
    return {"array", name, 1, "it is not in every " + std::string(word)};
}

IgnoredPart other_components(const std::string& name, std::size_t arrays, std::string_view word) {
    return {"array", name, arrays,
            "it has other numbers of components than in the first " + std::string(word) + " that has it"};
}

std::string does_not_number(std::string_view name, std::string_view things) {
    return "array " + in_quotes(std::string(name)) + " does not number the " + std::string(things) + ": not used";
}

namespace {

struct PointHash {
    std::size_t operator()(const Vec3& x) const { return static_cast<std::size_t>(hash_of_place(x)); }
};

class Joiner {
public:
    Joiner(std::vector<MeshFile>&& pieces, std::string_view word, std::string_view file)
        : pieces_(std::move(pieces)), word_(word), file_(file) {}

    MeshFile run() {
        set_empty_aside();
        std::size_t points = 0, cells = 0;
        for (const MeshFile& piece : pieces_) {
            points += piece.points.size();
            cells += cell_count(piece);
        }
        if (points >= kNone || cells >= kNone) {
            throw Error(ErrorCode::InvalidInput, "too many points or cells", std::string(file_));
        }
        all_.points.reserve(points);
        if (!join_by_numbers()) join_by_places();
        for (MeshFile& piece : pieces_) add_cells(piece);
        order_cells();
        add_arrays();
        for (const auto* pieces : {&pieces_, &empty_}) {
            for (const MeshFile& piece : *pieces) add_remarks(piece);
        }
        if (pieces_.size() > 1) all_.warnings.push_back(joining_report(pieces_.size(), word_, joined_, by_, order_by_));
        return std::move(all_);
    }

private:
    // A piece of which no cell is read, such as a block of surfaces, has no say in which arrays all pieces have, or in how
    // points are joined. All stay if none has cells.
    void set_empty_aside() {
        const auto has_cells = [](const MeshFile& piece) {
            bool some = piece.curved.size() > 0 || !piece.patches.empty();
            each_kind(piece, [&](const auto& cells) { some = some || !cells.corners.empty(); });
            return some;
        };
        if (std::ranges::none_of(pieces_, has_cells)) return;
        const auto rest = std::stable_partition(pieces_.begin(), pieces_.end(), has_cells);
        empty_.assign(std::move_iterator(rest), std::move_iterator(pieces_.end()));
        pieces_.erase(rest, pieces_.end());
    }

    void add_remarks(const MeshFile& piece) {
        for (const UnreadField& field : piece.unread) {
            const auto same = [&](const UnreadField& other) { return other.name == field.name; };
            if (std::ranges::none_of(all_.unread, same)) all_.unread.push_back(field);
        }
        for (const std::string& warning : piece.warnings) {
            if (said_.insert(warning).second) all_.warnings.push_back(warning);
        }
        for (const IgnoredPart& part : piece.ignored) {
            const auto [at, is_new] = ignored_.try_emplace({part.kind, part.name, part.reason}, all_.ignored.size());
            if (is_new) all_.ignored.push_back(part);
            if (!is_new) all_.ignored[at->second].count += part.count;
        }
        if (all_.time && piece.time && *all_.time != *piece.time && said_.insert("times").second)
            all_.warnings.push_back("not every " + std::string(word_) + " is of the same time: that of the first is taken");
        if (!all_.time) all_.time = piece.time;
        all_.cut = all_.cut || piece.cut;
        all_.blocks.insert(all_.blocks.end(), piece.blocks.begin(), piece.blocks.end());
    }

    // Adds the points of a piece; find(point of the piece) is the place in the whole of one to join it with, or kNone.
    template <class Find>
    void add_points(const MeshFile& piece, const Find& find) {
        auto& points = places_.emplace_back();
        points.reserve(piece.points.size());
        for (std::size_t p = 0; p < piece.points.size(); ++p) {
            const Index same = find(p);
            if (same != kNone) {
                ++joined_;
                points.push_back(same);
                continue;
            }
            points.push_back(static_cast<Index>(all_.points.size()));
            sources_.push_back({places_.size() - 1, p});
            all_.points.push_back(piece.points[p]);
        }
    }

    // Returns whether that is possible: numbers that are whole and not repeated in a piece, each at one place.
    bool join_by_numbers() {
        std::vector<const FileArray*> numbers;
        for (const std::string_view name : kPointNumberArrays) {
            numbers.clear();
            for (const MeshFile& piece : pieces_) {
                if (const FileArray* array = find_array(piece, name, false, 1)) numbers.push_back(array);
            }
            if (numbers.size() == pieces_.size()) break;
        }
        if (pieces_.empty() || numbers.size() != pieces_.size()) return false;
        std::unordered_map<double, Index> known;
        Box box;
        double largest = 0;
        for (const MeshFile& piece : pieces_) {
            for (const Vec3& x : piece.points) box.add(x);
            largest = std::max(largest, largest_cell(piece));
        }
        const double near = near_of_join(box, largest);
        for (std::size_t k = 0; k < pieces_.size(); ++k) {
            const auto& of_piece = numbers[k]->values;
            bool sound = true;
            const std::size_t before = all_.points.size();
            add_points(pieces_[k], [&](std::size_t p) {
                const double number = of_piece[p];
                sound = sound && number == std::floor(number);
                const auto [at, is_new] = known.try_emplace(number, static_cast<Index>(all_.points.size()));
                if (is_new) return kNone;
                sound = sound && at->second < before && glm::distance(all_.points[at->second], pieces_[k].points[p]) <= near;
                return at->second;
            });
            if (sound) continue;
            all_.warnings.push_back(does_not_number(numbers[k]->name, "points"));
            all_.points.clear();
            places_.clear();
            sources_.clear();
            joined_ = 0;
            return false;
        }
        by_ = in_quotes(numbers[0]->name);
        sort_by(numbers);
        return true;
    }

    // Puts the points in the order of their numbers, so that cells are cut as they would be in the whole mesh.
    void sort_by(const std::vector<const FileArray*>& numbers) {
        std::vector<Index> order(all_.points.size()), place(order.size());
        std::iota(order.begin(), order.end(), Index{0});
        const auto number = [&](Index p) { return numbers[sources_[p].first]->values[sources_[p].second]; };
        std::ranges::sort(order, [&](Index a, Index b) { return number(a) < number(b); });
        std::vector<Vec3> points;
        std::vector<std::pair<std::size_t, std::size_t>> sources;
        for (const Index p : order) {
            place[p] = static_cast<Index>(points.size());
            points.push_back(all_.points[p]);
            sources.push_back(sources_[p]);
        }
        all_.points = std::move(points);
        sources_ = std::move(sources);
        for (auto& of_piece : places_) {
            for (Index& p : of_piece) p = place[p];
        }
    }

    void join_by_places() {
        std::unordered_map<Vec3, Index, PointHash> known;
        for (const MeshFile& piece : pieces_) {
            const std::size_t before = all_.points.size();
            add_points(piece, [&](std::size_t p) {
                const auto at = known.find(piece.points[p]);
                return at == known.end() ? kNone : at->second;
            });
            for (std::size_t p = before; p < all_.points.size(); ++p) known.try_emplace(all_.points[p], static_cast<Index>(p));
        }
        by_ = "their places";
    }

    void add_cells(MeshFile& piece) {
        const std::vector<Index>& points = places_[first_cells_.size()];
        const auto first = static_cast<Index>(cells_);
        first_cells_.push_back(cells_);
        cells_ += cell_count(piece);
        const auto append = [&](auto& to, auto& from) {
            for (auto& corners : from.corners) {
                for (Index& p : corners) p = points[p];
                to.corners.push_back(corners);
            }
            for (const Index number : from.numbers) to.numbers.push_back(first + number);
        };
        append(all_.hexes, piece.hexes);
        append(all_.tets, piece.tets);
        append(all_.prisms, piece.prisms);
        append(all_.pyramids, piece.pyramids);
        auto& places = patch_places_.emplace_back();
        for (FilePatch& patch : piece.patches) {
            for (Index& p : patch.corners) p = points[p];
            FilePatch& whole = patches_[patch.name];
            whole.role = patch.role;
            places.push_back({static_cast<std::size_t>(&whole - all_.patches.data()), whole.size()});
            for (std::size_t f = 0; f < patch.size(); ++f) whole.add(patch.face(f));
        }
        for (const FileSet& set : piece.sets) {
            FileSet& whole = sets_[set.name];
            for (const Index number : set.numbers) whole.numbers.push_back(first + number);
        }
        for (const FileSet& set : piece.node_sets) {
            FileSet& whole = node_sets_[set.name];
            for (const Index p : set.numbers) whole.numbers.push_back(points[p]);
        }
        // A block is a set of cells, too, by which parts are chosen; the readers of some formats have made these sets.
        if (piece.blocks.size() == 1 &&
            std::ranges::find(piece.sets, piece.blocks[0].name, &FileSet::name) == piece.sets.end()) {
            FileSet& whole = sets_[piece.blocks[0].name];
            for (std::size_t number = first; number < cells_; ++number) whole.numbers.push_back(static_cast<Index>(number));
        }
        std::vector<Index> nodes;
        for (std::size_t k = 0; k < piece.curved.size(); ++k) {
            nodes.clear();
            for (const Index p : piece.curved.nodes_of(k)) nodes.push_back(points[p]);
            all_.curved.add(first + piece.curved.numbers[k], piece.curved.orders[k], nodes);
        }
    }

    // Puts the cells in the order of their numbers, so that it does not depend on how the mesh was cut. Ghosts have the numbers
    // of other cells and go beside them; they are left out later.
    void order_cells() {
        for (const std::string_view name : kCellNumberArrays) {
            std::vector<double> numbers(cells_);
            std::vector<std::uint8_t> counts(cells_, 1);  // the cell is not a ghost
            bool everywhere = cells_ > 0;
            for (std::size_t k = 0; k < pieces_.size() && everywhere; ++k) {
                const std::size_t end = k + 1 < pieces_.size() ? first_cells_[k + 1] : cells_;
                if (end == first_cells_[k]) continue;
                const FileArray* array = find_array(pieces_[k], name, true, 1);
                everywhere = array != nullptr;
                if (!everywhere) break;
                const FileArray* ghosts = find_array(pieces_[k], kGhostArray, true, 1);
                for (std::size_t c = first_cells_[k]; c < end; ++c) {
                    numbers[c] = array->values[c - first_cells_[k]];
                    if (ghosts) counts[c] = !leaves_out_cell(ghosts->values[c - first_cells_[k]]);
                }
            }
            if (!everywhere) continue;
            if (order_by(numbers, counts)) {
                order_by_ = in_quotes(std::string(name));
                for (MeshFile& piece : pieces_) {  // their means at points would mean nothing
                    std::erase_if(piece.arrays, [&](const FileArray& array) { return array.at_cells && array.name == name; });
                }
            } else {
                all_.warnings.push_back(does_not_number(name, "cells"));
            }
            return;
        }
    }

    // Returns whether the numbers are those of the cells: whole, and different for cells that count.
    bool order_by(const std::vector<double>& numbers, const std::vector<std::uint8_t>& counts) {
        std::vector<double> sorted;
        bool whole = true;
        each_kind(all_, [&](const auto& cells) {
            for (const Index c : cells.numbers) {
                whole = whole && numbers[c] == std::floor(numbers[c]);
                if (counts[c]) sorted.push_back(numbers[c]);
            }
        });
        if (!whole) return false;
        std::ranges::sort(sorted);
        if (std::ranges::adjacent_find(sorted) != sorted.end()) return false;
        each_kind(all_, [&](auto& cells) {
            const auto before = [&](Index a, Index b) { return numbers[a] != numbers[b] ? numbers[a] < numbers[b] : a < b; };
            if (std::ranges::is_sorted(cells.numbers, before)) return;
            std::vector<std::size_t> order(cells.numbers.size());
            std::iota(order.begin(), order.end(), std::size_t{0});
            std::ranges::sort(order, [&](std::size_t a, std::size_t b) { return before(cells.numbers[a], cells.numbers[b]); });
            std::remove_reference_t<decltype(cells)> ordered;
            ordered.corners.reserve(order.size());
            ordered.numbers.reserve(order.size());
            for (const std::size_t place : order) {
                ordered.corners.push_back(cells.corners[place]);
                ordered.numbers.push_back(cells.numbers[place]);
            }
            cells = std::move(ordered);
        });
        return true;
    }

    void add_arrays() {
        // The first of each name, and which arrays of all pieces have its name and components; of a piece the first one.
        struct Named {
            const FileArray* first;
            std::vector<std::pair<std::size_t, const FileArray*>> of_pieces;
            std::size_t others = 0;  // arrays with other components
        };
        std::vector<Named> named;
        std::map<std::pair<std::string_view, bool>, std::size_t> places;
        for (const MeshFile& piece : pieces_) {
            for (const FileArray& array : piece.arrays) {
                if (places.try_emplace({array.name, array.at_cells}, named.size()).second) named.push_back({&array, {}, 0});
            }
        }
        for (std::size_t k = 0; k < pieces_.size(); ++k) {
            for (const FileArray& array : pieces_[k].arrays) {
                Named& of_name = named[places.at({array.name, array.at_cells})];
                const bool has_one = !of_name.of_pieces.empty() && of_name.of_pieces.back().first == k;
                of_name.others += array.components == of_name.first->components ? 0 : 1;
                if (!has_one && array.components == of_name.first->components) of_name.of_pieces.emplace_back(k, &array);
            }
        }
        std::size_t values = 0;
        for (const MeshFile& piece : pieces_) {
            for (const FileArray& array : piece.arrays) values += array.values.size();
        }
        GapLimit gaps(values);
        for (const auto& [first, of_pieces, others] : named) {
            if (others > 0) all_.ignore(other_components(first->name, others, word_));
            std::vector<const FileArray*> parts(pieces_.size(), nullptr);
            for (const auto& [piece, array] : of_pieces) parts[piece] = array;
            if (first->name == kGhostArray) {  // where there are no ghosts, it may lack
                all_.arrays.push_back(joined(*first, parts, 0));
                continue;
            }
            const std::size_t with_gaps =
                (first->at_cells ? cells_ : all_.points.size()) * static_cast<std::size_t>(first->components);
            if (of_pieces.size() == pieces_.size() || gaps.allows(first->name, with_gaps)) {
                add_with_gaps(*first, parts);
            } else {
                all_.ignore(not_everywhere(first->name, word_));
            }
        }
    }

    // An array that some pieces lack, or have in parts, has no value there. At points where pieces touch it has that of the
    // piece that has one, so a cell without it may not have such points alone as its corners: it would seem to have it.
    void add_with_gaps(const FileArray& like, const std::vector<const FileArray*>& parts) {
        const auto components = static_cast<std::size_t>(like.components);
        FileArray array = joined(like, parts, std::numeric_limits<double>::quiet_NaN());
        const bool may_lack = std::ranges::find(parts, nullptr) != parts.end() ||
                              std::ranges::any_of(array.values, [](double v) { return !std::isfinite(v); });
        bool between = false;
        if (!like.at_cells && may_lack) {
            const auto is_there = [&](const std::vector<double>& values, std::size_t p) {
                return std::ranges::all_of(std::span(values).subspan(p * components, components),
                                           [](double value) { return std::isfinite(value); });
            };
            std::vector<std::uint8_t> has_value(all_.points.size(), 0);
            for (std::size_t k = 0; k < parts.size(); ++k) {
                if (parts[k] == nullptr) continue;
                for (std::size_t p = 0; p < places_[k].size(); ++p) {
                    if (!is_there(parts[k]->values, p)) continue;
                    if (std::exchange(has_value[places_[k][p]], std::uint8_t{1}) != 0) continue;
                    std::copy_n(&parts[k]->values[p * components], components, &array.values[places_[k][p] * components]);
                }
            }
            for (std::size_t k = 0; k < parts.size(); ++k)
                between = between || has_cell_between(k, parts[k], has_value, is_there);
        }
        if (!between) return all_.arrays.push_back(std::move(array));
        IgnoredPart part = not_everywhere(like.name, word_);
        part.reason += ", and cells without it lie between those that have it";
        all_.ignore(std::move(part));
    }

    // Whether a cell of a piece lacks the array, and all its corners have got it of other pieces.
    template <class IsThere>
    [[nodiscard]] bool has_cell_between(std::size_t piece, const FileArray* array, const std::vector<std::uint8_t>& has_value,
                                        const IsThere& is_there) const {
        std::vector<std::uint8_t> own(all_.points.size(), 0);  // of the piece itself
        for (std::size_t p = 0; array != nullptr && p < places_[piece].size(); ++p) {
            if (is_there(array->values, p)) own[places_[piece][p]] = 1;
        }
        const FileArray* const ghosts = find_array(pieces_[piece], kGhostArray, true, 1);
        bool between = false;
        each_kind(pieces_[piece], [&](const auto& cells) {
            for (std::size_t c = 0; c < cells.corners.size(); ++c) {
                if (ghosts != nullptr && !cells.numbers.empty() && leaves_out_cell(ghosts->values[cells.numbers[c]])) continue;
                const auto all_have = [&](const std::vector<std::uint8_t>& flags) {
                    return std::ranges::all_of(cells.corners[c], [&](Index p) { return flags[p] != 0; });
                };
                between = between || (all_have(has_value) && !all_have(own));
            }
        });
        return between;
    }

    // missing: the values of pieces that do not have the array
    [[nodiscard]] FileArray joined(const FileArray& like, const std::vector<const FileArray*>& parts, double missing) const {
        const auto components = static_cast<std::size_t>(like.components);
        FileArray array{like.name, like.components, like.at_cells, {}, like.unit, {}, like.integers};
        if (!like.at_cells) {
            array.values.reserve(all_.points.size() * components);
            for (const auto& [piece, p] : sources_) {
                for (std::size_t c = 0; c < components; ++c) {
                    array.values.push_back(parts[piece] ? parts[piece]->values[p * components + c] : missing);
                }
            }
            return array;
        }
        array.values.resize(cells_ * components, missing);
        for (std::size_t k = 0; k < parts.size(); ++k) {
            if (parts[k] == nullptr) continue;
            std::ranges::copy(parts[k]->values, array.values.data() + first_cells_[k] * components);
        }
        add_patch_values(array, parts);
        return array;
    }

    void add_patch_values(FileArray& array, const std::vector<const FileArray*>& parts) const {
        const auto components = static_cast<std::size_t>(array.components);
        std::map<std::size_t, FileOnPatch> whole;
        for (std::size_t k = 0; k < parts.size(); ++k) {
            if (parts[k] == nullptr) continue;
            for (const FileOnPatch& part : parts[k]->on_patches) {
                const auto [patch, first] = patch_places_[k][part.patch];
                FileOnPatch& values = whole[patch];
                values.patch = patch;
                values.along = values.along || part.along;
                values.level = values.level || part.level;
                values.values.resize(all_.patches[patch].size() * components, std::nan(""));
                std::ranges::copy(part.values, values.values.data() + first * components);
            }
        }
        for (auto& [patch, values] : whole) array.on_patches.push_back(std::move(values));
    }

    std::vector<MeshFile> pieces_;
    std::vector<MeshFile> empty_;                                // those of which no cell is read
    std::set<std::string> said_;                                 // warnings
    std::map<std::array<std::string, 3>, std::size_t> ignored_;  // kinds, names, reasons: where they are in the list of all
    std::string_view word_, file_;
    MeshFile all_;
    ByName<FilePatch> patches_{all_.patches};
    ByName<FileSet> sets_{all_.sets};
    ByName<FileSet> node_sets_{all_.node_sets};
    /// The number of a piece's patch in the whole, and that of its first face there.
    struct PatchPlace {
        std::size_t patch, first;
    };
    std::vector<std::vector<PatchPlace>> patch_places_;         // of each piece
    std::vector<std::vector<Index>> places_;                    // of each piece's points in the whole
    std::vector<std::pair<std::size_t, std::size_t>> sources_;  // of each point of the whole: piece and point
    std::vector<std::size_t> first_cells_;
    std::size_t cells_ = 0, joined_ = 0;
    std::string by_, order_by_;
};

}  // namespace

MeshFile join_pieces(std::vector<MeshFile>&& pieces, std::string_view word, std::string_view file) {
    return Joiner(std::move(pieces), word, file).run();
}

}  // namespace subvol::detail
