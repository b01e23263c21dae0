// SPDX-License-Identifier: Apache-2.0
#include "piece_centers.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "assemble.h"
#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kCellsOfChunk = std::size_t{1} << 16;  // cells that are worked on together

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

std::unique_ptr<CellCenters> centers_of(PieceTables& tables, const std::filesystem::path& folder, Progress* progress) {
    auto centers = std::make_unique<SpilledCenters>(tables.cells, folder);
    std::atomic<std::size_t> turned = 0, folded = 0;
    std::vector<std::array<Index, 8>> cells;
    std::vector<Vec3> points;
    std::array<std::vector<double>, 3> of_axis;
    for (std::uint64_t begin = 0; begin < tables.cells; begin += kCellsOfChunk) {
        report_progress(progress, "measure", static_cast<double>(begin) / static_cast<double>(tables.cells));
        cells.resize(std::min<std::uint64_t>(kCellsOfChunk, tables.cells - begin));
        tables.corners.read(begin, records_of(cells));
        const CornersOfCells corners(cells);
        points.resize(corners.points().size());
        tables.coordinates.read_some(corners.points(), records_of(points));
        for (auto& values : of_axis) values.resize(cells.size());
        parallel_each(cells.size(), [&](std::size_t c) {
            std::array<Vec3, 8> x;
            for (std::size_t k = 0; k < 8; ++k) x[k] = points[corners.place(cells[c][k])];
            if (!tables.turned && cell_volume(x) < 0) {
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
