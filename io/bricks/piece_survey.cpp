// SPDX-License-Identifier: Apache-2.0
#include "piece_survey.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "assemble.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/error.h"

// The first look at all pieces, one at a time: which arrays all of them have, whether their numbers of points and cells are
// whole and different, how large the mesh is, and a hash of each piece, by which a later round finds that a file has changed.
// It ends at the first piece that cannot be joined by itself, and says why.

namespace subvol::detail {

namespace {

template <class T>
std::string_view bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

class Surveyor {
public:
    Surveyor(PieceStream& stream, const std::string& list, PieceSurvey& survey, std::string& why)
        : stream_(stream), list_(list), survey_(survey), why_(why) {}

    [[nodiscard]] bool run() {
        for (const std::string_view name : kPointNumberArrays) survey_.point_numbers.push_back({name, 0, true, {}});
        for (const std::string_view name : kCellNumberArrays) survey_.cell_numbers.push_back({name, 0, true, {}});
        stream_.begin(0);
        std::uint64_t points = 0;
        while (const auto piece = stream_.next()) {
            // The reasons are known from one piece alone, so the survey ends with the first of them and the files behind it are
            // not read for nothing.
            if (const std::string why = why_whole(*piece); !why.empty()) {
                why_ = why;
                return false;
            }
            survey_.hashes.push_back(hash_of(*piece));
            points += piece->points.size();
            survey_.first_cells.push_back(survey_.cells);
            survey_.cells += cell_count(*piece);
            if (points >= kNone || survey_.cells >= kNone) {
                throw Error(ErrorCode::InvalidInput, "too many points or cells", list_);
            }
            for (const Vec3& x : piece->points) survey_.box.add(x);
            survey_.largest_cell = std::max(survey_.largest_cell, largest_cell(*piece));
            const bool others =
                !piece->tets.corners.empty() || !piece->prisms.corners.empty() || !piece->pyramids.corners.empty();
            survey_.others = survey_.others || others;
            survey_.cut = survey_.cut || piece->cut;
            look_at_arrays(*piece);
            for (PieceSurvey::Numbers& numbers : survey_.point_numbers)
                look_at_numbers(*piece, false, survey_.hashes.size() - 1, numbers);
            if (cell_count(*piece) > 0) {
                for (PieceSurvey::Numbers& numbers : survey_.cell_numbers)
                    look_at_numbers(*piece, true, survey_.with_cells, numbers);
                ++survey_.with_cells;
            }
            for (const UnreadField& field : piece->unread) {
                if (said_.insert(field.name).second) {
                    survey_.warnings.push_back("array " + in_quotes(field.name) + " left out: " + field.why);
                }
            }
            for (const std::string& warning : piece->warnings) {
                // Each warning is kept once, although many pieces may give it.
                if (said_.insert(warning).second) survey_.warnings.push_back(warning);
            }
        }
        if (survey_.hashes.empty() || survey_.cells == 0) {
            throw Error(ErrorCode::InvalidInput, "no hexahedra in any of its files", list_);
        }
        choose_cell_order();
        return true;
    }

private:
    [[nodiscard]] std::string why_whole(const MeshFile& piece) const {
        // Curved cells are split by a tolerance that is a part of the diagonal of the whole mesh, which is not known yet.
        if (piece.curved.size() > 0) return "it has curved cells";
        const bool is_split =
            piece.cut || !piece.tets.corners.empty() || !piece.prisms.corners.empty() || !piece.pyramids.corners.empty();
        const ReadOptions& read = stream_.options();
        if (is_split && read.other_cells == OtherCells::Split && read.crease_angle_deg != 0)
            return "sharp edges are those of its cells before they are split (--crease-angle none: piece by piece)";
        const FileArray* ghosts = find_array(piece, kGhostArray, false, 1);
        if (ghosts && std::ranges::any_of(ghosts->values, hides_point)) return "it has hidden points";
        return {};
    }

    void look_at_arrays(const MeshFile& piece) {
        for (const FileArray& array : piece.arrays) {
            if (array.name == kNodeNumberMap) continue;
            if (known_.insert({array.name, array.at_cells}).second) {
                survey_.arrays.push_back({{array.name, array.components, array.at_cells, {}}, 0});
            }
        }
        // An array with another number of components in this piece counts as missing.
        std::set<std::tuple<std::string_view, bool, int>> there;
        for (const FileArray& array : piece.arrays) there.emplace(array.name, array.at_cells, array.components);
        for (auto& [array, parts] : survey_.arrays) parts += there.contains({array.name, array.at_cells, array.components});
    }

    // before: how many pieces there were that could have the array
    void look_at_numbers(const MeshFile& piece, bool at_cells, std::size_t before, PieceSurvey::Numbers& numbers) const {
        if (numbers.parts != before) return;  // another lacks it
        const FileArray* array = find_array(piece, numbers.name, at_cells, 1);
        if (!array) {
            // Some piece lacks the array, so its numbers are of no use: their memory is given back at once.
            numbers.ranks = {};
            return;
        }
        ++numbers.parts;
        const auto is_whole = [](double n) { return n == std::floor(n); };
        if (!at_cells) {
            numbers.whole = numbers.whole && std::ranges::all_of(array->values, is_whole);
            if (numbers.whole) numbers.ranks.add(array->values);
            return;
        }
        std::vector<double> values;
        each_cell(piece, [&](const auto&, std::size_t number, bool is_ghost) {
            numbers.whole = numbers.whole && is_whole(array->values[number]);
            if (!is_ghost) values.push_back(array->values[number]);
        });
        if (numbers.whole) numbers.ranks.add(values);
    }

    void choose_cell_order() {
        const auto found = std::ranges::find_if(survey_.cell_numbers,
                                                [&](const PieceSurvey::Numbers& c) { return c.parts == survey_.with_cells; });
        if (found == survey_.cell_numbers.end()) return;
        // The first array that all pieces have decides. If its numbers are not whole and different, the cells stay in the order
        // of the files.
        if (found->whole && found->ranks.finish()) {
            survey_.order = &*found;
        } else {
            survey_.warnings.push_back(does_not_number(found->name, "cells"));
        }
        for (PieceSurvey::Numbers& numbers : survey_.cell_numbers) {
            if (&numbers != survey_.order) numbers.ranks = {};
        }
    }

    PieceStream& stream_;
    const std::string& list_;
    PieceSurvey& survey_;
    std::string& why_;
    std::set<std::pair<std::string, bool>> known_;
    std::set<std::string> said_;
};

}  // namespace

void PieceStream::begin(double part) {
    at_ = 0;
    part_ = part;
}

std::optional<MeshFile> PieceStream::next() {
    while (at_ < files_.files.size()) {
        report_progress(progress_, "read", (part_ + static_cast<double>(at_) / static_cast<double>(files_.files.size())) / 2);
        MeshFile piece = read_part(files_.files[at_++], options_);
        if (!piece.points.empty()) return piece;
    }
    return {};
}

std::uint64_t hash_of(const MeshFile& piece) {
    ByteHash hash;
    hash.add(bytes_of(piece.points));
    each_kind(piece, [&](const auto& cells) { hash.add(bytes_of(cells.corners)); });
    for (const FileArray& array : piece.arrays) {
        hash.add_text(array.name);
        hash.add(bytes_of(array.values));
    }
    return hash.value();
}

bool PieceSurvey::is_field(const FileArray& array) const {
    return array.name != kGhostArray && !(order && array.at_cells && array.name == order->name);
}

std::optional<PieceSurvey> survey_pieces(PieceStream& stream, const std::string& list, std::string& why) {
    PieceSurvey survey;
    if (!Surveyor(stream, list, survey, why).run()) return {};
    return survey;
}

}  // namespace subvol::detail
