// SPDX-License-Identifier: Apache-2.0
#include "piece_tables.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <optional>

#include "assemble.h"
#include "piece_survey.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/error.h"

// Pieces become tables with one record for each point and each cell of the whole. The pieces are read in rounds:
//
//      survey     which arrays and numbers do all pieces have?  a hash of each piece, so that a change meanwhile is found
//      places     only if points have no numbers: points of different pieces at the same place are one point
//      fill       each record goes to the rank of its point or cell:
//
//          piece 0   7 3 9        rank(7) = 1 ┐      table   │ 3 │ 7 │ 9 │12 │
//          piece 1   9 12         rank(9) = 2 ┴──▶           └───┴───┴───┴───┘   a point of two pieces is written once
//
// Numbers of points that differ at one place, or agree at two places, are none; then the places decide after all. Cells that
// repeat points make the mesh one that must be held whole.

namespace subvol::detail {

namespace {

constexpr std::size_t kPointsOfChunk = std::size_t{1} << 16;  // points that are checked together

std::size_t& count_of(CellCounts& counts, std::size_t corners) {
    return corners == 8 ? counts.hexes : corners == 4 ? counts.tets : corners == 6 ? counts.prisms : counts.pyramids;
}

/// Reads the pieces, and fills the tables.
constexpr const char* kNotFinite = "it has values that are not finite";

class TableFiller {
public:
    TableFiller(const PartFiles& files, std::string list, std::filesystem::path folder, const ReadOptions& options,
                Progress* progress, std::string& why)
        : files_(files),
          list_(std::move(list)),
          folder_(std::move(folder)),
          stream_(files, options, progress),
          refuses_others_(options.other_cells == OtherCells::Refuse),
          why_(why) {}

    std::unique_ptr<PieceTables> run() {
        std::optional<PieceSurvey> survey = survey_pieces(stream_, list_, why_);
        if (!survey) return {};
        survey_ = std::move(*survey);
        if (survey_.others && refuses_others_) {
            why_ = "it has other cells than hexahedra";
            return {};
        }
        // Numbers are tried first, because points at one place may be different on purpose, as at a crack. They count only if
        // every piece has them.
        const auto everywhere = [&](const PieceSurvey::Numbers& n) { return n.parts == survey_.pieces(); };
        const auto numbers = std::ranges::find_if(survey_.point_numbers, everywhere);
        if (numbers != survey_.point_numbers.end() && !numbers->whole) {
            survey_.warnings.push_back(does_not_number(numbers->name, "points"));
        } else if (numbers != survey_.point_numbers.end()) {
            by_numbers_ = &*numbers;
            numbers->ranks.finish();
            const Filled filled = fill();
            if (filled == Filled::Done) return finished();
            // The numbers agree with each other; it is the cells that need the whole mesh, so places would not help.
            if (filled == Filled::HoldWhole) return {};
            survey_.warnings.push_back(does_not_number(numbers->name, "points"));
            by_numbers_ = nullptr;
        }
        survey_.point_numbers.clear();
        find_places();
        return fill() == Filled::Done ? finished() : nullptr;
    }

private:
    // Another round, where points have no numbers.
    void find_places() {
        places_.emplace(folder_);
        stream_.begin(0);
        while (const auto piece = stream_.next()) places_->add_piece(piece->points);
        places_->finish();
    }

    /// What comes of a round that fills the tables.
    ///
    /// NumbersContradict: the points' numbers do not say which points are the same
    /// HoldWhole:         the mesh cannot be joined piece by piece; `why_` is the reason
    enum class Filled { Done, NumbersContradict, HoldWhole };

    // The last round.
    Filled fill() {
        tables_ = std::make_unique<PieceTables>(folder_);
        for (const auto& [array, parts] : survey_.arrays) {
            if (!survey_.is_field(array)) continue;
            if (parts == survey_.pieces()) tables_->arrays.push_back(array);
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
        stream_.begin(1);
        std::size_t k = 0;
        while (const auto piece = stream_.next()) {
            // The pieces are read several times, and the simulation that writes them may still be running.
            if (k == survey_.pieces() || hash_of(*piece) != survey_.hashes[k]) {
                throw Error(ErrorCode::InvalidInput, "has changed while it was being read", stream_.file().path.string());
            }
            if (!add_points(*piece, known)) return Filled::NumbersContradict;
            if (!add_cells(*piece)) return Filled::HoldWhole;
            ++k;
        }
        return Filled::Done;
    }

    // Returns false if the numbers of points contradict each other.
    bool add_points(const MeshFile& piece, PointFlags& known) {
        // A point that several pieces have is written by the first of them, so its values are those of the first, as in memory.
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
        for (Index i = 0; i < ranks_.size(); ++i) {
            if (is_first[i]) order.push_back(i);
        }
        joined_ += ranks_.size() - order.size();
        sort_by_rank(order);
        std::vector<Index> numbers;
        std::vector<Vec3> points;
        for (const Index i : order) {
            numbers.push_back(ranks_[i]);
            points.push_back(piece.points[i]);
        }
        // Sorted by rank, so that neighbouring records are written in one go.
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
        for (Index i = 0; i < ranks_.size(); ++i) {
            if (!is_first[i]) again.push_back(i);
        }
        sort_by_rank(again);
        for (const Index i : again) numbers.push_back(ranks_[i]);
        std::vector<Vec3> there(again.size());
        tables_->coordinates.read_some(numbers, records_of(there));
        const double near = near_of_join(survey_.box, survey_.largest_cell);
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
                std::copy_n(array->values.data() + which[i] * components, components, records.data() + (i * length + column));
            }
            column += components;
        }
        return records;
    }

    // Returns false if the cells must be held whole.
    bool add_cells(const MeshFile& piece) {
        const FileArray* numbers = survey_.order ? find_array(piece, survey_.order->name, true, 1) : nullptr;
        std::vector<Index> ranks, in_file;
        std::vector<std::array<Index, 8>> cells;
        bool collapsed = false;
        each_cell(piece, [&](std::array<Index, 8> corners, std::size_t number, bool is_ghost) {
            if (is_ghost) {
                ++ghosts_;
                return;
            }
            std::size_t count = 0;
            for (; count < 8 && corners[count] != kNone; ++count) {
                corners[count] = ranks_[corners[count]];
                for (std::size_t j = 0; j < count; ++j) collapsed = collapsed || corners[count] == corners[j];
                tables_->used.set(corners[count]);
            }
            ++count_of(tables_->counts, count);
            cells.push_back(corners);
            ranks.push_back(numbers ? survey_.order->ranks.rank(numbers->values[number]) : static_cast<Index>(tables_->cells));
            in_file.push_back(static_cast<Index>(number));
            ++tables_->cells;
        });
        if (collapsed) {
            why_ = "it has cells that repeat points";
            return false;
        }
        // Cells are written at the ranks of their numbers, or in the order of the files if they have none.
        std::vector<Index> order(ranks.size());
        std::iota(order.begin(), order.end(), Index{0});
        const auto rank = [&](Index i) { return ranks[i]; };
        if (!std::ranges::is_sorted(order, {}, rank)) std::ranges::sort(order, {}, rank);
        std::vector<Index> sorted, sorted_in_file;
        std::vector<std::array<Index, 8>> corners;
        for (const Index i : order) {
            sorted.push_back(ranks[i]);
            sorted_in_file.push_back(in_file[i]);
            corners.push_back(cells[i]);
        }
        tables_->corners.write_some(sorted, records_of(corners));
        if (!tables_->cell_values) return true;
        const std::vector<double> values = values_of(piece, true, sorted_in_file);
        if (!check_cell_values(values, sorted_in_file)) {
            why_ = kNotFinite;
            return false;
        }
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

    // The whole mesh leaves out a field with a value that is not finite, which is known only when all of it has been read.
    bool check_cell_values(const std::vector<double>& records, const std::vector<Index>& in_file) {
        bool finite = true;
        const std::size_t length = tables_->components(true);
        each_column(true, [&](const FileArray& array, std::size_t column, std::size_t components) {
            keep_least(array, records, column, length, [](std::size_t) { return true; });
            for (std::size_t i = 0; i < in_file.size(); ++i) {
                for (std::size_t c = column; c < column + components; ++c) {
                    finite &= std::isfinite(records[i * length + c]);
                }
            }
        });
        return finite;
    }

    bool check_point_values() {
        bool finite = true;
        if (!tables_->point_values) return finite;
        const std::size_t length = tables_->components(false);
        std::vector<double> records;
        for (std::size_t begin = 0; begin < points_; begin += kPointsOfChunk) {
            const std::size_t count = std::min(kPointsOfChunk, points_ - begin);
            records.resize(count * length);
            tables_->point_values->read(begin, records_of(records));
            const auto used = [&](std::size_t p) { return tables_->used[static_cast<Index>(begin + p)]; };
            each_column(false, [&](const FileArray& array, std::size_t column, std::size_t components) {
                keep_least(array, records, column, length, used);
                for (std::size_t p = 0; p < count; ++p) {
                    if (!used(p)) continue;
                    for (std::size_t c = column; c < column + components; ++c) {
                        finite &= std::isfinite(records[p * length + c]);
                    }
                }
            });
        }
        return finite;
    }

    // Keeps the least finite value of the first component in the records that count.
    template <class Counts>
    void keep_least(const FileArray& array, const std::vector<double>& records, std::size_t column, std::size_t length,
                    const Counts& counts) {
        double least = HUGE_VAL;
        for (std::size_t i = 0; i * length < records.size(); ++i) {
            const double value = records[i * length + column];
            if (counts(i) && std::isfinite(value)) least = std::min(least, value);
        }
        if (least == HUGE_VAL) return;
        double& kept = least_.try_emplace({array.name, array.at_cells}, least).first->second;
        kept = std::min(kept, least);
    }

    // The warnings that arrays give rise to, whatever the cells are: those of a cube with the least value of each everywhere.
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
        tables.cut = survey_.cut;
        if (!check_point_values()) {
            why_ = kNotFinite;
            return {};
        }
        tables.used.count();
        ByteHash hash;
        for (const std::uint64_t piece_hash : survey_.hashes)
            hash.add({reinterpret_cast<const char*>(&piece_hash), sizeof piece_hash});
        const std::string by = by_numbers_ ? in_quotes(std::string(by_numbers_->name)) : "their places";
        const std::string order = survey_.order ? in_quotes(std::string(survey_.order->name)) : std::string();
        // How points and cells were joined belongs to the hash, as the same pieces give other tables if they are joined
        // otherwise.
        hash.add_text(by);
        hash.add_text(order);
        tables.hash = hash.value();
        for (const auto& [array, parts] : survey_.arrays) {
            if (parts != survey_.pieces() && survey_.is_field(array)) {
                survey_.warnings.push_back(ignored_text(not_everywhere(array.name, files_.word)));
            }
        }
        if (survey_.pieces() > 1) survey_.warnings.push_back(joining_report(survey_.pieces(), files_.word, joined_, by, order));
        if (ghosts_ > 0) survey_.warnings.push_back(ghosts_left_out(ghosts_));
        std::ranges::copy(warnings_of_arrays(), std::back_inserter(survey_.warnings));
        tables.warnings = files_.warnings;
        tables.warnings.insert(tables.warnings.end(), survey_.warnings.begin(), survey_.warnings.end());
        return std::move(tables_);
    }

    const PartFiles& files_;
    std::string list_;
    std::filesystem::path folder_;
    PieceStream stream_;
    bool refuses_others_;
    std::string& why_;

    PieceSurvey survey_;
    PieceSurvey::Numbers* by_numbers_ = nullptr;
    std::optional<RanksOfPlaces> places_;
    std::map<std::pair<std::string, bool>, double> least_;  // of the first component of each array

    std::unique_ptr<PieceTables> tables_;
    std::size_t points_ = 0, joined_ = 0, ghosts_ = 0;
    std::vector<Index> ranks_;  // of the points of the piece at work
};

}  // namespace

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
    std::unique_ptr<PieceTables> tables = TableFiller(files, list, folder, options, progress, why).run();
    const bool hexes_alone = !tables || (tables->counts.hexes == tables->cells && !tables->cut);
    // Splitting is a step of its own, from tables to tables, so that all that follows handles hexahedra alone.
    return hexes_alone ? std::move(tables) : split_tables(std::move(tables), list, folder, progress);
}

}  // namespace subvol::detail
