// SPDX-License-Identifier: Apache-2.0
#include "piece_tables.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <set>

#include "assemble.h"
#include "join_pieces.h"
#include "piece_numbers.h"
#include "subvol/cell.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kChunk = std::size_t{1} << 16;  // cells, or points, that are worked on together

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::uint64_t hash_of(const MeshFile& piece) {
    ByteHash hash;
    hash.add(bytes_of(piece.points));
    hash.add(bytes_of(piece.hexes.corners));
    for (const FileArray& array : piece.arrays) {
        hash.add_text(array.name);
        hash.add(bytes_of(array.values));
    }
    return hash.value();
}

// Reads the pieces, and puts them into the tables.
class Maker {
public:
    Maker(const PartFiles& files, std::string list, std::filesystem::path folder, const ReadOptions& options,
          Progress* progress, std::string& why)
        : files_(files),
          list_(std::move(list)),
          folder_(std::move(folder)),
          options_(options),
          progress_(progress),
          why_(why) {}

    std::unique_ptr<PieceTables> run() {
        if (!look()) return {};
        if (hashes_.empty() || cells_in_files_ == 0) {
            throw Error(ErrorCode::InvalidInput, "no hexahedra in any of its files", list_);
        }
        choose_cell_order();
        const auto everywhere = [&](const Candidate& c) { return c.parts == hashes_.size(); };
        const auto numbers = std::ranges::find_if(point_numbers_, everywhere);
        if (numbers != point_numbers_.end() && !numbers->whole) {
            warnings_.push_back(does_not_number(numbers->name, "points"));
        } else if (numbers != point_numbers_.end()) {
            by_numbers_ = &*numbers;
            numbers->ranks.finish();
            if (fill()) return finished();
            if (!why_.empty()) return {};
            warnings_.push_back(does_not_number(numbers->name, "points"));
            by_numbers_ = nullptr;
        }
        point_numbers_.clear();
        find_places();
        return fill() ? finished() : nullptr;
    }

private:
    // An array that may number points or cells.
    struct Candidate {
        std::string_view name;
        std::size_t parts = 0;  // that have it
        bool whole = true;
        RanksOfNumbers ranks;
    };

    // Reads the next piece that is not empty; nothing after the last one.
    std::optional<MeshFile> next() {
        while (at_ < files_.files.size()) {
            report_progress(progress_, "read",
                            (round_ + static_cast<double>(at_) / static_cast<double>(files_.files.size())) / 2);
            MeshFile piece = read_part(files_.files[at_++], options_);
            if (!piece.points.empty()) return piece;
        }
        return {};
    }
    void begin(double round) {
        at_ = 0;
        round_ = round;
    }

    // The first round: what the pieces have in common, and the numbers of points and cells. Returns whether they can be joined
    // one by one.
    bool look() {
        for (const std::string_view name : kPointNumberArrays) point_numbers_.push_back({name, 0, true, {}});
        for (const std::string_view name : kCellNumberArrays) cell_numbers_.push_back({name, 0, true, {}});
        begin(0);
        std::uint64_t points = 0;
        while (const auto piece = next()) {
            if (const std::string why = why_whole(*piece); !why.empty()) {
                why_ = why;
                return false;
            }
            hashes_.push_back(hash_of(*piece));
            points += piece->points.size();
            first_cells_.push_back(cells_in_files_);
            cells_in_files_ += cell_count(*piece);
            if (points >= kNone || cells_in_files_ >= kNone) {
                throw Error(ErrorCode::InvalidInput, "too many points or cells", list_);
            }
            for (const Vec3& x : piece->points) box_.add(x);
            look_at_arrays(*piece);
            for (Candidate& candidate : point_numbers_) look_at_numbers(*piece, false, hashes_.size() - 1, candidate);
            if (cell_count(*piece) > 0) {
                for (Candidate& candidate : cell_numbers_) look_at_numbers(*piece, true, with_cells_, candidate);
                ++with_cells_;
            }
            for (const std::string& warning : piece->warnings) {
                if (said_.insert(warning).second) warnings_.push_back(warning);
            }
        }
        return true;
    }

    [[nodiscard]] static std::string why_whole(const MeshFile& piece) {
        if (!piece.tets.corners.empty()) return "it has tetrahedra";
        if (!piece.prisms.corners.empty()) return "it has prisms";
        if (!piece.pyramids.corners.empty()) return "it has pyramids";
        if (piece.curved.size() > 0) return "it has curved cells";
        const FileArray* ghosts = find_array(piece, kGhostArray, false, 1);
        if (ghosts && std::ranges::any_of(ghosts->values, hides_point)) return "it has hidden points";
        return {};
    }

    void look_at_arrays(const MeshFile& piece) {
        for (const FileArray& array : piece.arrays) {
            if (known_.insert({array.name, array.at_cells}).second) {
                arrays_.push_back({{array.name, array.components, array.at_cells, {}}, 0});
            }
        }
        for (auto& [array, parts] : arrays_)
            parts += find_array(piece, array.name, array.at_cells, array.components) != nullptr;
    }

    // before: how many pieces there were that could have the array
    void look_at_numbers(const MeshFile& piece, bool at_cells, std::size_t before, Candidate& candidate) const {
        if (candidate.parts != before) return;  // another lacks it
        const FileArray* array = find_array(piece, candidate.name, at_cells, 1);
        if (!array) {
            candidate.ranks = {};
            return;
        }
        ++candidate.parts;
        const auto is_whole = [](double n) { return n == std::floor(n); };
        if (!at_cells) {
            candidate.whole = candidate.whole && std::ranges::all_of(array->values, is_whole);
            if (candidate.whole) candidate.ranks.add(array->values);
            return;
        }
        std::vector<double> numbers;
        each_cell(piece, [&](std::size_t, std::size_t number, bool is_ghost) {
            candidate.whole = candidate.whole && is_whole(array->values[number]);
            if (!is_ghost) numbers.push_back(array->values[number]);
        });
        if (candidate.whole) candidate.ranks.add(numbers);
    }

    // Calls call(place in the list, number in the file, whether it is a ghost) for each cell.
    template <class Call>
    static void each_cell(const MeshFile& piece, const Call& call) {
        const FileArray* ghosts = find_array(piece, kGhostArray, true, 1);
        for (std::size_t c = 0; c < piece.hexes.corners.size(); ++c) {
            const std::size_t number = piece.hexes.numbers.empty() ? c : piece.hexes.numbers[c];
            call(c, number, ghosts && leaves_out_cell(ghosts->values[number]));
        }
    }

    void choose_cell_order() {
        const auto found = std::ranges::find_if(cell_numbers_, [&](const Candidate& c) { return c.parts == with_cells_; });
        if (found == cell_numbers_.end()) return;
        if (found->whole && found->ranks.finish()) {
            order_ = &*found;
        } else {
            warnings_.push_back(does_not_number(found->name, "cells"));
        }
        for (Candidate& candidate : cell_numbers_) {
            if (&candidate != order_) candidate.ranks = {};
        }
    }

    // Not the ghosts, nor the numbers that are the order of the cells.
    [[nodiscard]] bool is_field(const FileArray& array) const {
        return array.name != kGhostArray && !(order_ && array.at_cells && array.name == order_->name);
    }

    // Another round, where points have no numbers.
    void find_places() {
        places_.emplace(folder_);
        begin(0);
        while (const auto piece = next()) places_->add_piece(piece->points);
        places_->finish();
    }

    // The last round. Returns false if the points' numbers are none, or if the cells must be held whole: then there is a
    // reason.
    bool fill() {
        tables_ = std::make_unique<PieceTables>(folder_);
        for (const auto& [array, parts] : arrays_) {
            if (!is_field(array)) continue;
            if (parts == hashes_.size()) tables_->arrays.push_back(array);
        }
        for (const bool at_cells : {false, true}) {
            const std::size_t components = tables_->components(at_cells);
            if (components == 0) continue;
            (at_cells ? tables_->cell_values : tables_->point_values) =
                std::make_unique<SpillFile>(folder_, components * sizeof(double));
        }
        joined_ = ghosts_ = 0;
        points_ = by_numbers_ ? by_numbers_->ranks.size() : 0;
        PointFlags known;
        if (by_numbers_) known.resize(points_);
        tables_->used.resize(by_numbers_ ? points_ : 0);
        begin(1);
        std::size_t k = 0;
        while (const auto piece = next()) {
            if (k == hashes_.size() || hash_of(*piece) != hashes_[k]) {
                throw Error(ErrorCode::InvalidInput, "has changed while it was being read",
                            files_.files[at_ - 1].path.string());
            }
            if (!add_points(*piece, known) || !add_cells(*piece, k)) return false;
            ++k;
        }
        return true;
    }

    bool add_points(const MeshFile& piece, PointFlags& known) {
        std::vector<std::uint8_t> is_first;
        if (by_numbers_) {
            const FileArray* numbers = find_array(piece, by_numbers_->name, false, 1);
            ranks_.clear();
            for (const double number : numbers->values) {
                ranks_.push_back(by_numbers_->ranks.rank(number));
                is_first.push_back(!known[ranks_.back()]);
            }
            if (!is_sound(piece, is_first)) return false;
            for (const Index p : ranks_) known.set(p);
        } else {
            places_->take_piece(piece.points.size(), ranks_, is_first);
            for (std::size_t i = 0; i < ranks_.size(); ++i) points_ += is_first[i];
            tables_->used.resize(points_);
        }
        std::vector<Index> order;
        for (std::size_t i = 0; i < ranks_.size(); ++i) {
            if (is_first[i]) order.push_back(static_cast<Index>(i));
        }
        joined_ += ranks_.size() - order.size();
        sort_by_rank(order);
        std::vector<Index> numbers;
        std::vector<Vec3> points;
        for (const Index i : order) {
            numbers.push_back(ranks_[i]);
            points.push_back(piece.points[i]);
        }
        tables_->coordinates.write_some(numbers, records_of(points));
        if (tables_->point_values) tables_->point_values->write_some(numbers, records_of(values_of(piece, false, order)));
        return true;
    }

    void sort_by_rank(std::vector<Index>& order) const {
        const auto rank = [&](Index i) { return ranks_[i]; };
        if (!std::ranges::is_sorted(order, {}, rank)) std::ranges::sort(order, {}, rank);
    }

    // Whether the numbers of a piece's points are all different, and at the places where the same numbers were before.
    bool is_sound(const MeshFile& piece, const std::vector<std::uint8_t>& is_first) const {
        std::vector<Index> sorted = ranks_;
        std::ranges::sort(sorted);
        if (std::ranges::adjacent_find(sorted) != sorted.end()) return false;
        std::vector<Index> again, numbers;
        for (std::size_t i = 0; i < ranks_.size(); ++i) {
            if (!is_first[i]) again.push_back(static_cast<Index>(i));
        }
        sort_by_rank(again);
        for (const Index i : again) numbers.push_back(ranks_[i]);
        std::vector<Vec3> there(again.size());
        tables_->coordinates.read_some(numbers, records_of(there));
        const double near = kNearOfDiagonal * box_.diagonal();
        for (std::size_t i = 0; i < again.size(); ++i) {
            if (!(glm::distance(there[i], piece.points[again[i]]) <= near)) return false;
        }
        return true;
    }

    // The records of some of a piece's points or cells.
    [[nodiscard]] std::vector<double> values_of(const MeshFile& piece, bool at_cells, const std::vector<Index>& which) const {
        const std::size_t length = tables_->components(at_cells);
        std::vector<double> records(which.size() * length);
        std::size_t column = 0;
        for (const FileArray& like : tables_->arrays) {
            if (like.at_cells != at_cells) continue;
            const auto components = static_cast<std::size_t>(like.components);
            const FileArray* array = find_array(piece, like.name, at_cells, like.components);
            for (std::size_t i = 0; i < which.size(); ++i) {
                std::copy_n(array->values.begin() + static_cast<std::ptrdiff_t>(which[i] * components), components,
                            records.begin() + static_cast<std::ptrdiff_t>(i * length + column));
            }
            column += components;
        }
        return records;
    }

    bool add_cells(const MeshFile& piece, std::size_t k) {
        const FileArray* numbers = order_ ? find_array(piece, order_->name, true, 1) : nullptr;
        std::vector<Index> ranks, places, in_file;
        bool collapsed = false;
        each_cell(piece, [&](std::size_t c, std::size_t number, bool is_ghost) {
            if (is_ghost) return;
            std::array<Index, 8> corners;
            for (std::size_t i = 0; i < 8; ++i) {
                corners[i] = ranks_[piece.hexes.corners[c][i]];
                for (std::size_t j = 0; j < i; ++j) collapsed = collapsed || corners[i] == corners[j];
                tables_->used.set(corners[i]);
            }
            ranks.push_back(numbers ? order_->ranks.rank(numbers->values[number]) : static_cast<Index>(tables_->cells));
            places.push_back(static_cast<Index>(c));
            in_file.push_back(static_cast<Index>(number));
            ++tables_->cells;
        });
        if (collapsed) {
            why_ = "it has cells that repeat points";
            return false;
        }
        ghosts_ += piece.hexes.corners.size() - ranks.size();
        std::vector<Index> order(ranks.size());
        std::iota(order.begin(), order.end(), Index{0});
        const auto rank = [&](Index i) { return ranks[i]; };
        if (!std::ranges::is_sorted(order, {}, rank)) std::ranges::sort(order, {}, rank);
        std::vector<Index> sorted, sorted_in_file;
        std::vector<std::array<Index, 8>> corners;
        for (const Index i : order) {
            sorted.push_back(ranks[i]);
            sorted_in_file.push_back(in_file[i]);
            corners.push_back(piece.hexes.corners[places[i]]);
            for (Index& p : corners.back()) p = ranks_[p];
        }
        tables_->corners.write_some(sorted, records_of(corners));
        if (!tables_->cell_values) return true;
        const std::vector<double> values = values_of(piece, true, sorted_in_file);
        check_cell_values(values, sorted_in_file, k);
        tables_->cell_values->write_some(sorted, records_of(values));
        return true;
    }

    // Calls call(array, first component in a record, components) for each array of points or cells.
    template <class Call>
    void each_column(bool at_cells, const Call& call) const {
        std::size_t column = 0;
        for (const FileArray& array : tables_->arrays) {
            if (array.at_cells != at_cells) continue;
            call(array, column, static_cast<std::size_t>(array.components));
            column += static_cast<std::size_t>(array.components);
        }
    }

    [[noreturn]] void refuse(const FileArray& array, const std::string& entity) const {
        throw Error(ErrorCode::InvalidInput, "the value at " + entity + " is not finite",
                    list_ + ", array " + in_quotes(array.name));
    }

    void check_cell_values(const std::vector<double>& records, const std::vector<Index>& in_file, std::size_t k) {
        const std::size_t length = tables_->components(true);
        each_column(true, [&](const FileArray& array, std::size_t column, std::size_t components) {
            keep_least(array, records, column, length);
            for (std::size_t i = 0; i < in_file.size(); ++i) {
                for (std::size_t c = column; c < column + components; ++c) {
                    if (std::isfinite(records[i * length + c])) continue;
                    refuse(array, names_in_parts().cell(first_cells_[k] + in_file[i]));
                }
            }
        });
    }

    void check_point_values() {
        if (!tables_->point_values) return;
        const std::size_t length = tables_->components(false);
        std::vector<double> records;
        for (std::size_t begin = 0; begin < points_; begin += kChunk) {
            const std::size_t count = std::min(kChunk, points_ - begin);
            records.resize(count * length);
            tables_->point_values->read(begin, records_of(records));
            each_column(false, [&](const FileArray& array, std::size_t column, std::size_t components) {
                keep_least(array, records, column, length);
                for (std::size_t p = 0; p < count; ++p) {
                    if (!tables_->used[static_cast<Index>(begin + p)]) continue;
                    for (std::size_t c = column; c < column + components; ++c) {
                        if (!std::isfinite(records[p * length + c])) refuse(array, names_in_parts().point(begin + p));
                    }
                }
            });
        }
    }

    // Of the first component, and of the values that are finite.
    void keep_least(const FileArray& array, const std::vector<double>& records, std::size_t column, std::size_t length) {
        double least = HUGE_VAL;
        for (std::size_t i = column; i < records.size(); i += length) {
            if (std::isfinite(records[i])) least = std::min(least, records[i]);
        }
        if (least == HUGE_VAL) return;
        double& kept = least_.try_emplace({array.name, array.at_cells}, least).first->second;
        kept = std::min(kept, least);
    }

    // What is said of the arrays of a mesh, whatever its cells are: of a cube that has the least value of each everywhere.
    [[nodiscard]] std::vector<std::string> warnings_of_arrays() const {
        MeshFile cube;
        for (const Vec3 x : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}) cube.points.push_back(x);
        for (std::size_t p = 0; p < 4; ++p) cube.points.push_back(cube.points[p] + Vec3(0, 0, 1));
        cube.hexes = {{{0, 1, 2, 3, 4, 5, 6, 7}}, {0}};
        for (const FileArray& array : tables_->arrays) {
            const auto count = static_cast<std::size_t>(array.components) * (array.at_cells ? 1 : cube.points.size());
            cube.arrays.push_back(array);
            const auto least = least_.find({array.name, array.at_cells});
            cube.arrays.back().values.assign(count, least == least_.end() ? 0 : least->second);
        }
        return assemble(std::move(cube), list_, names_in_parts(), {.cell_values = CellValues::Mean}).warnings;
    }

    std::unique_ptr<PieceTables> finished() {
        PieceTables& tables = *tables_;
        if (tables.cells == 0) throw Error(ErrorCode::InvalidInput, "the mesh has no hexahedra", list_);
        tables.points = points_;
        check_point_values();
        tables.used.count();
        ByteHash hash;
        for (const std::uint64_t of_piece : hashes_) hash.add({reinterpret_cast<const char*>(&of_piece), sizeof of_piece});
        const std::string by = by_numbers_ ? in_quotes(std::string(by_numbers_->name)) : "their places";
        const std::string order = order_ ? in_quotes(std::string(order_->name)) : std::string();
        hash.add_text(by);
        hash.add_text(order);
        tables.hash = hash.value();
        for (const auto& [array, parts] : arrays_) {
            if (parts != hashes_.size() && is_field(array)) {
                warnings_.push_back(not_everywhere(array.name, files_.word));
            }
        }
        warnings_.push_back(joining_report(hashes_.size(), files_.word, joined_, by, order));
        if (ghosts_ > 0) warnings_.push_back(ghosts_left_out(ghosts_));
        std::ranges::copy(warnings_of_arrays(), std::back_inserter(warnings_));
        tables.warnings = files_.warnings;
        tables.warnings.insert(tables.warnings.end(), warnings_.begin(), warnings_.end());
        return std::move(tables_);
    }

    const PartFiles& files_;
    std::string list_;
    std::filesystem::path folder_;
    const ReadOptions& options_;
    Progress* progress_;
    std::string& why_;

    std::size_t at_ = 0;  // the next file
    double round_ = 0;
    std::vector<std::uint64_t> hashes_;  // of the pieces that are not empty
    std::vector<std::size_t> first_cells_;
    std::size_t cells_in_files_ = 0, with_cells_ = 0;
    Box box_;
    std::set<std::pair<std::string, bool>> known_;
    std::vector<std::pair<FileArray, std::size_t>> arrays_;  // and how many pieces have it
    std::vector<Candidate> point_numbers_, cell_numbers_;
    Candidate *by_numbers_ = nullptr, *order_ = nullptr;
    std::optional<RanksOfPlaces> places_;
    std::map<std::pair<std::string, bool>, double> least_;  // of the first component of each array
    std::vector<std::string> warnings_;
    std::set<std::string> said_;

    std::unique_ptr<PieceTables> tables_;
    std::size_t points_ = 0, joined_ = 0, ghosts_ = 0;
    std::vector<Index> ranks_;  // of the points of the piece at work
};

// The centres lie in a file for each axis.
class SpilledCenters : public CellCenters {
public:
    SpilledCenters(std::size_t count, const std::filesystem::path& folder)
        : count_(count),
          files_{SpillFile(folder, sizeof(double)), SpillFile(folder, sizeof(double)), SpillFile(folder, sizeof(double))} {}
    [[nodiscard]] std::size_t count() const override { return count_; }
    void read(int axis, std::span<const Index> cells, std::span<double> values) const override {
        files_[static_cast<std::size_t>(axis)].read_some(cells, {reinterpret_cast<char*>(values.data()), values.size_bytes()});
    }
    void write(std::size_t axis, std::uint64_t first, const std::vector<double>& values) {
        files_[axis].write(first, records_of(values));
    }

private:
    std::size_t count_;
    std::array<SpillFile, 3> files_;
};

}  // namespace

void PointFlags::resize(std::size_t points) {
    words_.resize((points + 63) / 64);
}

std::uint64_t PointFlags::count() {
    std::uint64_t count = 0;
    before_.clear();
    for (const std::uint64_t word : words_) {
        before_.push_back(count);
        count += static_cast<std::uint64_t>(std::popcount(word));
    }
    return count;
}

std::uint64_t PointFlags::count_before(Index p) const {
    const std::uint64_t lower = (std::uint64_t{1} << p % 64) - 1;
    return before_[p / 64] + static_cast<std::uint64_t>(std::popcount(words_[p / 64] & lower));
}

CornersOfCells::CornersOfCells(std::span<const std::array<Index, 8>> cells) {
    if (cells.empty()) return;
    Index last = 0;
    first_ = kNone;
    for (const auto& cell : cells) {
        for (const Index p : cell) {
            first_ = std::min(first_, p);
            last = std::max(last, p);
        }
    }
    words_.resize((last - first_) / 64 + 1);
    for (const auto& cell : cells) {
        for (const Index p : cell) words_[(p - first_) / 64] |= std::uint64_t{1} << (p - first_) % 64;
    }
    for (std::size_t w = 0; w < words_.size(); ++w) {
        before_.push_back(static_cast<Index>(points_.size()));
        for (std::uint64_t word = words_[w]; word != 0; word &= word - 1) {
            points_.push_back(static_cast<Index>(first_ + 64 * w + static_cast<std::size_t>(std::countr_zero(word))));
        }
    }
}

Index CornersOfCells::place(Index p) const {
    const Index at = p - first_;
    const std::uint64_t lower = (std::uint64_t{1} << at % 64) - 1;
    return before_[at / 64] + static_cast<Index>(std::popcount(words_[at / 64] & lower));
}

PieceTables::PieceTables(const std::filesystem::path& folder)
    : coordinates(folder, sizeof(Vec3)), corners(folder, sizeof(std::array<Index, 8>)) {
}

std::size_t PieceTables::components(bool at_cells) const {
    std::size_t count = 0;
    for (const FileArray& array : arrays) count += array.at_cells == at_cells ? static_cast<std::size_t>(array.components) : 0;
    return count;
}

std::unique_ptr<PieceTables> tables_of_pieces(const PartFiles& files, const std::string& list,
                                              const std::filesystem::path& folder, const ReadOptions& options,
                                              Progress* progress, std::string& why) {
    why.clear();
    return Maker(files, list, folder, options, progress, why).run();
}

std::unique_ptr<CellCenters> centers_of(PieceTables& tables, const std::filesystem::path& folder, Progress* progress) {
    auto centers = std::make_unique<SpilledCenters>(tables.cells, folder);
    std::atomic<std::size_t> turned = 0, folded = 0;
    std::vector<std::array<Index, 8>> cells;
    std::vector<Vec3> points;
    std::array<std::vector<double>, 3> of_axis;
    for (std::uint64_t begin = 0; begin < tables.cells; begin += kChunk) {
        report_progress(progress, "measure", static_cast<double>(begin) / static_cast<double>(tables.cells));
        cells.resize(std::min<std::uint64_t>(kChunk, tables.cells - begin));
        tables.corners.read(begin, records_of(cells));
        const CornersOfCells corners(cells);
        points.resize(corners.points().size());
        tables.coordinates.read_some(corners.points(), records_of(points));
        for (auto& values : of_axis) values.resize(cells.size());
        parallel_each(cells.size(), [&](std::size_t c) {
            std::array<Vec3, 8> x;
            for (std::size_t k = 0; k < 8; ++k) x[k] = points[corners.place(cells[c][k])];
            if (cell_volume(x) < 0) {
                std::swap_ranges(x.begin(), x.begin() + 4, x.begin() + 4);
                ++turned;
            }
            if (is_folded(x)) ++folded;
            Vec3 sum(0.0);
            for (const Vec3& corner : x) sum += corner;
            for (int axis = 0; axis < 3; ++axis) of_axis[static_cast<std::size_t>(axis)][c] = sum[axis] / 8.0;
        });
        for (std::size_t axis = 0; axis < 3; ++axis) centers->write(axis, begin, of_axis[axis]);
    }
    if (turned > 0) tables.warnings.push_back(cells_turned(turned, tables.cells));
    if (folded > 0) tables.warnings.push_back(cells_folded(folded, tables.cells));
    return centers;
}

}  // namespace subvol::detail
