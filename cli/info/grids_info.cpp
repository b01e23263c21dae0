// SPDX-License-Identifier: Apache-2.0
// Grids of a .vdb file: kind, active voxels, range and hash of each, and values at given places.
#include <optional>

#include "file_info.h"
#include "grid_input.h"
#include "mesh_figures.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/vdb_grid.h"
#include "text.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

class GridsInfo : public FileInfo {
public:
    using FileInfo::FileInfo;

    [[nodiscard]] std::vector<std::string> field_names(Report& /*report*/) override {
        std::vector<std::string> names;
        for (const VdbGrid& grid : vdb().read_vdb(request().input)) names.push_back(grid.report().name);
        return names;
    }

    void describe(Report& report) override {
        report["input"] = request().input;
        const VdbContents contents = report.timed("read", [&] { return vdb().read_vdb_contents(request().input); });
        if (request().common.field)
            (void)select_grid(contents, request().common.field, request().input);  // refuses what does not exist
        report["grids"] = Json::array();
        for (const VdbGrid& grid : contents.grids) {
            const GridReport& about = grid.report();
            if (!request().shows(about.name)) continue;
            report["grids"].push_back({{"name", about.name},
                                       {"kind", about.kind},
                                       {"active_voxels", about.active_voxels},
                                       {"voxel_size", about.voxel_size_world},
                                       {"bounds", json_of(about.bounds)},
                                       {"min", about.min},
                                       {"max", about.max},
                                       {"bytes", about.bytes},
                                       {"hash", detail::hex_digits(vdb().hash_of_grid(grid))}});
        }
        for (const auto& [name, type] : contents.others) {
            if (request().shows(name)) report["grids"].push_back({{"name", name}, {"kind", type}});
        }
        if (request().places.empty()) return;
        const std::vector<VdbGrid> scalars = probed(contents);
        for (const std::string& point : request().places) {
            const Vec3 x = parse_vector("--at", point);
            for (const VdbGrid& scalar : scalars) {
                const std::optional<double> value = scalar.value(x);
                report["at"].push_back(
                    {{"point", json_of(x)}, {"field", scalar.report().name}, {"value", value ? Json(*value) : Json(nullptr)}});
            }
        }
    }

private:
    /// What --at reads: the grid that --field names, else all, vectors by their components.
    [[nodiscard]] std::vector<VdbGrid> probed(const VdbContents& contents) const {
        std::vector<VdbGrid> scalars;
        if (request().common.field) {
            scalars.push_back(select_grid(contents, request().common.field, request().input));
            return scalars;
        }
        for (const VdbGrid& grid : contents.grids) {
            const std::string& name = grid.report().name;
            if (grid.report().kind == "vector") {
                for (int c = 0; c < 3; ++c) scalars.push_back(vdb().scalar_of(grid, c, name + "." + "xyz"[c]));
            } else {
                scalars.push_back(vdb().scalar_of(grid, std::nullopt, name));
            }
        }
        return scalars;
    }
};

}  // namespace

std::unique_ptr<FileInfo> make_grids_info(const InfoRequest& request) {
    return std::make_unique<GridsInfo>(request);
}

}  // namespace subvol::cli
