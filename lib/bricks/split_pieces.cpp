// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "assemble.h"
#include "brick_cells.h"
#include "brick_file.h"
#include "brick_folder.h"
#include "brick_layers.h"
#include "piece_centers.h"
#include "piece_tables.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

constexpr std::size_t kRecordsOfChunk = std::size_t{1} << 16;  // records that are taken apart together

/// Makes bricks of the tables, one at a time.
class BrickMaker {
public:
    BrickMaker(const PieceTables& tables, const BrickCells& cells, std::string list, const PiecesOptions& pieces, int layers)
        : tables_(tables), cells_(cells), list_(std::move(list)), pieces_(pieces), layers_(layers) {}

    [[nodiscard]] BrickMesh make(std::size_t b) const {
        std::vector<Index> stored = cells_.stored(b);
        BrickMesh brick;
        const std::span<const Index> own = cells_.owned_by(b);
        auto next = own.begin();
        for (const Index c : stored) {
            const bool owned = next != own.end() && *next == c;
            next += owned;
            brick.cell_numbers.push_back(c);
            brick.owned_cells.push_back(owned);
        }
        brick.mesh = mesh_of(stored, brick, b);
        if (tables_.cell_values) {  // the last layer was for the values at the points of the others
            std::vector<std::uint8_t> kept = brick.owned_cells;
            grow(brick.mesh, kept, layers_);
            brick = subset(brick, kept);
        }
        if (pieces_.change) brick.mesh = pieces_.change(std::move(brick.mesh));
        return brick;
    }

private:
    [[nodiscard]] HexMesh mesh_of(const std::vector<Index>& stored, BrickMesh& brick, std::size_t b) const {
        MeshFile part;
        part.turned = tables_.turned;
        part.hexes.corners.resize(stored.size());
        tables_.corners.read_some(stored, records_of(part.hexes.corners));
        {
            const CornersOfCells corners(part.hexes.corners);
            for (auto& cell : part.hexes.corners) {
                for (Index& p : cell) p = corners.place(p);
            }
            const std::vector<Index>& points = corners.points();
            part.points.resize(points.size());
            tables_.coordinates.read_some(points, records_of(part.points));
            brick.point_numbers.reserve(points.size());
            brick.owned_points.reserve(points.size());
            for (const Index p : points) {
                brick.point_numbers.push_back(tables_.used.count_before(p));
                brick.owned_points.push_back(cells_.owners[p] == b);
            }
            for (const FileArray& array : tables_.arrays) part.arrays.push_back(array);
            take_values(part, false, points);
            take_values(part, true, stored);
        }
        if (tables_.cell_values) {
            for (std::size_t c = 0; c < stored.size(); ++c) part.hexes.numbers.push_back(static_cast<Index>(c));
        }
        HexMesh mesh = assemble(std::move(part), list_, names_in_parts(), {.cell_values = CellValues::Mean}).mesh;
        std::erase_if(mesh.attributes,
                      [](const Attribute& field) { return field.name == kNodeNumbers || field.name == kGhosts; });
        return mesh;
    }

    void take_values(MeshFile& part, bool at_cells, std::span<const Index> numbers) const {
        const std::size_t length = tables_.components(at_cells);
        if (length == 0) return;
        for (FileArray& array : part.arrays) {
            if (array.at_cells == at_cells) array.values.reserve(numbers.size() * static_cast<std::size_t>(array.components));
        }
        std::vector<double> records;
        for (std::size_t begin = 0; begin < numbers.size(); begin += kRecordsOfChunk) {
            const auto some = numbers.subspan(begin, std::min(kRecordsOfChunk, numbers.size() - begin));
            records.resize(some.size() * length);
            (at_cells ? tables_.cell_values : tables_.point_values)->read_some(some, records_of(records));
            std::size_t column = 0;
            for (FileArray& array : part.arrays) {
                if (array.at_cells != at_cells) continue;
                for (std::size_t i = 0; i < some.size(); ++i) {
                    const auto first = records.begin() + static_cast<std::ptrdiff_t>(i * length + column);
                    array.values.insert(array.values.end(), first, first + array.components);
                }
                column += static_cast<std::size_t>(array.components);
            }
        }
    }

    const PieceTables& tables_;
    const BrickCells& cells_;
    std::string list_;
    const PiecesOptions& pieces_;
    int layers_;
};

}  // namespace

PiecesSplit split_pieces(const std::filesystem::path& folder, const std::filesystem::path& mesh, const PiecesOptions& pieces,
                         const SplitOptions& options) {
    check_options(options);
    PiecesSplit done;
    const std::optional<PartFiles> files = part_files(mesh, pieces.read);
    if (!files) return done;
    if (pieces.read.weld) done.held_whole = "its points are welded";
    if (pieces.read.cell_values == CellValues::Fit) done.held_whole = "its values at cells are fitted";
    if (!done.held_whole.empty()) return done;
    check_target(folder);
    const std::filesystem::path beside = std::filesystem::absolute(folder / "").parent_path().parent_path();
    const std::string list = mesh.string();
    const std::unique_ptr<PieceTables> tables =
        tables_of_pieces(*files, list, beside, pieces.read, options.progress, done.held_whole);
    if (!tables) return done;
    std::vector<std::uint32_t> brick_of_cell = bricks_of_cells(*centers_of(*tables, beside, options.progress), options);
    ByteHash id;
    id.add({reinterpret_cast<const char*>(&tables->hash), sizeof tables->hash});
    id.add_text(pieces.about_change);
    id.add({reinterpret_cast<const char*>(brick_of_cell.data()), brick_of_cell.size() * sizeof brick_of_cell[0]});
    BricksWriter writer(folder, id.value(), options.halo_layers);
    report_progress(options.progress, "halos", 0);
    const BrickCells cells = cells_of_bricks(tables->corners, tables->points, std::move(brick_of_cell),
                                             options.halo_layers + (tables->cell_values ? 1 : 0));
    const std::size_t count = cells.first.size() - 1;
    const BrickMaker maker(*tables, cells, list, pieces, options.halo_layers);
    for (std::size_t b = 0; b < count; ++b) {
        report_progress(options.progress, "split", static_cast<double>(b) / static_cast<double>(count));
        if (!cells.owned_by(b).empty() && !writer.keeps(b)) writer.write(b, maker.make(b));
    }
    report_progress(options.progress, "split", 1);
    done.result = writer.finish();
    done.warnings = std::move(tables->warnings);
    return done;
}

}  // namespace subvol
