// SPDX-License-Identifier: Apache-2.0
// Reads adaptive mesh refinement of VTKHDF: a group for each level, with its boxes in one dataset and each array of all boxes
// in another, of all steps one after the other.
#include <algorithm>
#include <utility>

#include "amr_grid.h"
#include "assemble.h"
#include "formats.h"
#include "mesh_arrays.h"
#include "subvol/detail/hdf5_file.h"
#include "subvol/error.h"
#include "vtk_cells.h"

namespace subvol::detail {

namespace {

class HdfAmrReader {
public:
    HdfAmrReader(const Hdf5File& file, const ReadOptions& options) : file_(file), options_(options) {}

    ReadResult read() {
        std::vector<std::string> warnings;
        const std::size_t steps = std::max<std::size_t>(1, vtkhdf_times(file_).size());
        step_ = chosen_step(options_, steps, file_.name(), warnings);
        const std::string description = file_.text(kAmrRoot, "GridDescription").value_or("XYZ");
        if (description != "XYZ") {
            file_.fail("its GridDescription is " + in_quotes(description) + ", which has no volume",
                       "XYZ, of three dimensions");
        }
        grid_.origin = three(kAmrRoot, "Origin");
        std::vector<Range> ranges;
        while (file_.has(level_path(grid_.levels.size()) + "/AMRBox")) ranges.push_back(read_level());
        check_amr(grid_, file_.name());
        for (std::size_t l = 0; l < grid_.levels.size(); ++l) {
            read_arrays(l, true, ranges[l].cells);
            read_arrays(l, false, ranges[l].points);
        }
        MeshFile found = mesh_of_amr(grid_, file_.name());
        if (found.hexes.corners.empty()) file_.fail("no hexahedra in any of its boxes");
        found.warnings.insert(found.warnings.begin(), warnings.begin(), warnings.end());
        return assemble(std::move(found), file_.name(), kVtkNames, options_);
    }

private:
    const std::string kAmrRoot = "/VTKHDF";

    // The points and cells of the boxes of steps before, which come first in the arrays.
    struct Range {
        std::size_t points = 0, cells = 0;
    };

    [[nodiscard]] std::string level_path(std::size_t level) const { return kAmrRoot + "/Level" + std::to_string(level); }

    [[nodiscard]] std::array<double, 3> three(const std::string& object, const std::string& name) const {
        const std::vector<double> numbers = file_.real_numbers(object, name);
        if (numbers.size() != 3)
            file_.fail("the attribute " + in_quotes(name) + " of " + in_quotes(object) + " is not three numbers");
        return {numbers[0], numbers[1], numbers[2]};
    }

    // A number of the step. The names of version 2.2 lack an s at the end.
    [[nodiscard]] std::optional<std::size_t> of_amr_step(std::size_t level, const std::string& group,
                                                         const std::string& name) const {
        const std::string begin = kAmrRoot + "/Steps/Level" + std::to_string(level) + "/" + group;
        for (const char* end : {"s", ""}) {
            const std::string path = begin + end + (name.empty() ? "" : "/" + name);
            if (!file_.has(path)) continue;
            const auto values = file_.integers(path, step_, 1);
            if (values.empty() || values[0] < 0 || static_cast<std::uint64_t>(values[0]) >= kNone) {
                file_.fail(in_quotes(path) + ": count out of range");
            }
            return static_cast<std::size_t>(values[0]);
        }
        return {};
    }

    Range read_level() {
        const std::size_t l = grid_.levels.size();
        const std::string path = level_path(l) + "/AMRBox";
        AmrLevel& level = grid_.levels.emplace_back();
        level.spacing = three(level_path(l), "Spacing");
        const std::size_t rows = file_.rows(path);
        if (file_.columns(path) != 6) file_.fail(in_quotes(path) + " does not have six columns");
        const std::size_t first = of_amr_step(l, "AMRBoxOffset", {}).value_or(0);
        auto count = of_amr_step(l, "NumberOfAMRBoxe", {});
        if (!count) count = of_amr_step(l, "NumberOfAMRBox", {});
        if (first > rows) file_.fail(in_quotes(path) + " ends before the boxes of step " + std::to_string(step_));
        const std::size_t end = first + count.value_or(rows - first);
        const std::vector<std::int64_t> ends = file_.integers(path, 0, end);
        Range before;
        for (std::size_t b = 0; b < end; ++b) {
            AmrBlock block;
            for (std::size_t a = 0; a < 3; ++a) {
                block.box.low[a] = ends[6 * b + 2 * a];
                block.box.high[a] = ends[6 * b + 2 * a + 1];
            }
            if (b >= first) {
                block.place = file_.name();
                level.blocks.push_back(std::move(block));
                continue;
            }
            before.points += box_count(block.box, true);
            before.cells += box_count(block.box, false);
        }
        return before;
    }

    // 0 of boxes that are out of range: those of other steps are not checked.
    [[nodiscard]] static std::size_t box_count(const AmrBox& box, bool points) {
        for (std::size_t a = 0; a < 3; ++a) {
            constexpr std::int64_t kFar = std::int64_t{1} << 31;
            if (box.low[a] < -kFar || box.high[a] > kFar) return 0;
        }
        const std::size_t count = points ? box.grid().point_count() : box.grid().cell_count();
        return count == kNone ? 0 : count;
    }

    // first: of the values of this step, if the file does not say it for an array
    void read_arrays(std::size_t l, bool at_cells, std::size_t first) {
        AmrLevel& level = grid_.levels[l];
        std::size_t count = 0;
        for (const AmrBlock& block : level.blocks) count += box_count(block.box, !at_cells);
        const std::string group = at_cells ? "CellData" : "PointData";
        for (const std::string& name : file_.names(level_path(l) + "/" + group)) {
            const std::string path = level_path(l) + "/" + group + "/" + name;
            if (!file_.has(path)) continue;  // texts
            FileArray array;
            array.name = as_utf8(name);
            array.components = static_cast<int>(file_.columns(path));
            if (array.components == 0) continue;
            array.at_cells = at_cells;
            array.integers = is_integer(file_.dataset(path).type);
            array.values = file_.reals(path, of_amr_step(l, group + "Offset", name).value_or(first), count);
            level.arrays.push_back(std::move(array));
        }
    }

    const Hdf5File& file_;
    ReadOptions options_;
    std::size_t step_ = 0;
    AmrGrid grid_;
};

}  // namespace

ReadResult read_vtkhdf_amr(const Hdf5File& file, const ReadOptions& options) {
    return HdfAmrReader(file, options).read();
}

}  // namespace subvol::detail
