// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "assemble.h"
#include "join_pieces.h"
#include "piece_numbers.h"
#include "subvol/progress.h"
#include "subvol/vec.h"
#include "vtk/collection.h"

namespace subvol::detail {

/// Reads the pieces of a mesh one after the other, as often as they are needed.
class PieceStream {
public:
    /// All are kept by reference.
    PieceStream(const PartFiles& files, const ReadOptions& options, Progress* progress)
        : files_(files), options_(options), progress_(progress) {}

    /// part: of the progress that is done before, in halves
    void begin(double part);
    [[nodiscard]] const ReadOptions& options() const { return options_; }
    /// The next piece that is not empty; nothing after the last one.
    [[nodiscard]] std::optional<MeshFile> next();
    /// The file of the last piece.
    [[nodiscard]] const ListedFile& file() const { return files_.files[at_ - 1]; }

private:
    const PartFiles& files_;
    const ReadOptions& options_;
    Progress* progress_;
    std::size_t at_ = 0;  // the next file
    double part_ = 0;
};

/// Calls call(corners, number in the file, whether it is a ghost) for each cell of a piece. The corners of other cells than
/// hexahedra end in kNone.
template <class Call>
void each_cell(const MeshFile& piece, const Call& call) {
    const FileArray* ghosts = find_array(piece, kGhostArray, true, 1);
    each_kind(piece, [&](const auto& cells) {
        for (std::size_t c = 0; c < cells.corners.size(); ++c) {
            std::array<Index, 8> corners;
            std::ranges::fill(std::ranges::copy(cells.corners[c], corners.begin()).out, corners.end(), kNone);
            const std::size_t number = cells.numbers.empty() ? c : cells.numbers[c];
            call(corners, number, ghosts && leaves_out_cell(ghosts->values[number]));
        }
    });
}

/// Returns a hash of all that was read of a piece.
[[nodiscard]] std::uint64_t hash_of(const MeshFile& piece);

/// What the pieces of a mesh have in common, and the numbers of their points and cells.
struct PieceSurvey {
    /// An array that may number points or cells.
    struct Numbers {
        std::string_view name;
        std::size_t parts = 0;  ///< how many pieces have it
        bool whole = true;      ///< whether its numbers are whole
        RanksOfNumbers ranks;
    };

    std::vector<std::uint64_t> hashes;     ///< hashes of the pieces that are not empty
    std::vector<std::size_t> first_cells;  ///< how many cells the pieces before have
    std::size_t cells = 0;
    std::size_t with_cells = 0;  ///< how many pieces have any cells
    bool others = false;         ///< there are other cells than hexahedra
    bool cut = false;            ///< as in MeshFile
    Box box;
    double largest_cell = 0;
    std::vector<std::pair<FileArray, std::size_t>> arrays;  ///< each with the number of pieces that have it
    std::vector<Numbers> point_numbers, cell_numbers;
    const Numbers* order = nullptr;  ///< of the cells; null: that of the files
    std::vector<std::string> warnings;

    [[nodiscard]] std::size_t pieces() const { return hashes.size(); }
    /// Not the ghosts, nor the numbers that are the order of the cells.
    [[nodiscard]] bool is_field(const FileArray& array) const;
};

/// Reads all pieces once.
///
/// list:    the name of the list of pieces, for messages
/// returns: nothing if the pieces cannot be joined one by one; `why` is then a reason such as "it has curved cells"
/// throws:  Error(InvalidInput) if there are no cells, or too many
[[nodiscard]] std::optional<PieceSurvey> survey_pieces(PieceStream& stream, const std::string& list, std::string& why);

}  // namespace subvol::detail
