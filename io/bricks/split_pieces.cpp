// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "assemble.h"
#include "brick_cells.h"
#include "brick_file.h"
#include "brick_folder.h"
#include "brick_shapes.h"
#include "piece_tables.h"
#include "subvol/cell.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/mesh_pieces.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/option.h"

// A mesh that comes in pieces is cut into bricks without being held:
//
//      pieces ──read one at a time──▶ tables in files ──▶ centres of cells ──▶ the brick of each cell
//                                          │                                        │
//                                          └──▶ brick by brick: its cells, halo, points and values ◀──┘
//
// Tables have a record for each point and each cell of the whole, so a brick reads the records that it needs. A mesh whose
// pieces cannot be joined one at a time (curved cells, welded points) is left to the caller, which holds it whole.

namespace subvol {

using namespace detail;

namespace {

constexpr std::size_t kCellsOfChunk = std::size_t{1} << 16;  // cells that are worked on together

/// The centres of cells in files, one for each axis.
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

/// The centres of the cells of the tables, and how many cells are folded.
std::unique_ptr<CellCenters> centers_of(const PieceTables& tables, const std::filesystem::path& folder, std::size_t& folded,
                                        Progress* progress) {
    auto centers = std::make_unique<SpilledCenters>(tables.cells, folder);
    std::atomic<std::size_t> found = 0;
    std::vector<std::array<Index, 8>> cells;
    std::vector<Vec3> points;
    std::array<std::vector<double>, 3> coordinates;
    for (std::uint64_t begin = 0; begin < tables.cells; begin += kCellsOfChunk) {
        report_progress(progress, "measure", begin, tables.cells);
        cells.resize(std::min<std::uint64_t>(kCellsOfChunk, tables.cells - begin));
        tables.corners.read(begin, records_of(cells));
        const CornersOfCells corners(cells);
        points.resize(corners.points().size());
        tables.coordinates.read_some(corners.points(), records_of(points));
        for (auto& values : coordinates) values.resize(cells.size());
        parallel_each(cells.size(), [&](std::size_t c) {
            std::array<Vec3, 8> x;
            for (std::size_t k = 0; k < 8; ++k) x[k] = points[corners.place(cells[c][k])];
            if (is_folded(x)) ++found;
            Vec3 sum(0.0);
            for (const Vec3& corner : x) sum += corner;
            for (int axis = 0; axis < 3; ++axis) coordinates[static_cast<std::size_t>(axis)][c] = sum[axis] / 8.0;
        });
        for (std::size_t axis = 0; axis < 3; ++axis) centers->write(axis, begin, coordinates[axis]);
    }
    folded = found;
    return centers;
}

constexpr std::size_t kRecordsOfChunk = std::size_t{1} << 16;  // records that are taken apart together

/// How many layers of cells a brick needs about its halo. Values at cells become the mean of the cells at each point, and a
/// point of the outermost layer lacks some of its cells. Which edges are sharp depends on the faces behind those at the edge,
/// and the outermost cells have faces that are not on the boundary of the whole.
int layers_more(const PieceTables& tables, const ReadOptions& read) {
    if (read.crease_angle_deg != 0) return 2;
    return tables.cell_values ? 1 : 0;
}

/// Makes bricks of the tables, one at a time.
class BrickMaker {
public:
    BrickMaker(const PieceTables& tables, const BrickCells& cells, std::string list, const PiecesOptions& pieces, int layers)
        : tables_(tables), cells_(cells), list_(std::move(list)), pieces_(pieces), layers_(layers) {}

    [[nodiscard]] MeshPiece make(std::size_t b) const {
        std::vector<Index> stored = cells_.stored(b);
        MeshPiece brick;
        const std::span<const Index> owned_cells = cells_.owned_by(b);
        auto next = owned_cells.begin();
        for (const Index c : stored) {
            const bool owned = next != owned_cells.end() && *next == c;
            next += owned;
            brick.cell_numbers.push_back(c);
            brick.owned_cells.push_back(owned);
        }
        brick.mesh = mesh_of(stored, brick, b);
        // More layers were gathered than the halo has, and are dropped here: the outermost cells lack neighbours.
        if (layers_more(tables_, pieces_.read) > 0) {
            std::vector<std::uint8_t> kept = brick.owned_cells;
            grow(brick.mesh, kept, layers_);
            brick = subset(brick, kept);
        }
        if (pieces_.change) brick.mesh = pieces_.change(std::move(brick.mesh));
        return brick;
    }

private:
    [[nodiscard]] HexMesh mesh_of(const std::vector<Index>& stored, MeshPiece& brick, std::size_t b) const {
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
        // The values at cells were taken in the order of the stored cells, so these are their numbers in the arrays.
        if (tables_.cell_values) {
            for (Index c = 0; c < stored.size(); ++c) part.hexes.numbers.push_back(c);
        }
        HexMesh mesh = assemble(std::move(part), list_, names_in_parts(),
                                {.cell_values = CellValues::Mean, .crease_angle_deg = pieces_.read.crease_angle_deg})
                           .mesh;
        std::erase_if(mesh.attributes,
                      [](const Attribute& field) { return field.name == kNodeNumbers || field.name == kGhosts; });
        for (Attribute& field : mesh.attributes) field.cells.clear();  // bricks hold values at points
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
                    const auto first = records.data() + (i * length + column);
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
    if (files->means) done.held_whole = "its values at cells are fitted";
    if (!done.held_whole.empty()) return done;
    check_target(folder);
    // Tables are as large as the mesh, so they lie on the disk that the bricks go to, and not in the folder for temporary
    // files, which is often in memory.
    const std::filesystem::path beside = std::filesystem::absolute(folder / "").parent_path().parent_path();
    const std::string list = mesh.string();
    const std::unique_ptr<PieceTables> tables =
        tables_of_pieces(*files, list, beside, pieces.read, options.progress, done.held_whole);
    if (!tables) return done;
    const std::size_t turned = orient_tables(*tables, beside, options.progress);
    std::size_t folded = 0;
    std::vector<std::uint32_t> brick_of_cell = bricks_of_cells(*centers_of(*tables, beside, folded, options.progress), options);
    ByteHash id;
    id.add({reinterpret_cast<const char*>(&tables->hash), sizeof tables->hash});
    // The id stands for all that the bricks depend on, so that an interrupted split is continued only if it would make the same
    // bricks.
    id.add_text(pieces.about_change);
    if (pieces.read.crease_angle_deg) id.add_text(std::to_string(*pieces.read.crease_angle_deg));
    id.add({reinterpret_cast<const char*>(brick_of_cell.data()), brick_of_cell.size() * sizeof brick_of_cell[0]});
    BricksWriter writer(folder, id.value(), options.halo_layers);
    report_progress(options.progress, "halos", 0);
    const BrickCells cells = cells_of_bricks(tables->corners, tables->points, std::move(brick_of_cell),
                                             options.halo_layers + layers_more(*tables, pieces.read));
    const std::size_t count = cells.first.size() - 1;
    const BrickMaker maker(*tables, cells, list, pieces, options.halo_layers);
    for (std::size_t b = 0; b < count; ++b) {
        report_progress(options.progress, "split", b, count);
        // Random bricks may be empty: they are not written. Bricks of an earlier run that are whole are not made again.
        if (!cells.owned_by(b).empty() && !writer.keeps(b)) writer.write(b, maker.make(b));
    }
    report_progress(options.progress, "split", 1);
    done.result = writer.finish();
    done.warnings = std::move(tables->warnings);
    if (turned > 0) done.warnings.push_back(cells_turned(turned, tables->cells));
    if (folded > 0) done.warnings.push_back(cells_folded(folded, tables->cells));
    return done;
}

}  // namespace subvol
