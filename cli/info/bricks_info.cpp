// SPDX-License-Identifier: Apache-2.0
// A folder of bricks: the counts of the whole, found brick by brick.
#include <cstdint>

#include "bricks_input.h"
#include "file_info.h"
#include "joined_figures.h"
#include "mesh_figures.h"
#include "subvol/mesh_report.h"

namespace subvol::cli {
namespace {

class BricksInfo : public FileInfo {
public:
    using FileInfo::FileInfo;

    [[nodiscard]] std::vector<std::string> field_names(Report& report) override {
        std::vector<std::string> names;
        for (const BrickField& field : report.unpack(open_bricks_input(request().input, request().app)).fields)
            names.push_back(field.name);
        return names;
    }

    void describe(Report& report) override {
        const Bricks bricks = report.unpack(open_bricks_input(request().input, request().app));
        if (request().common.field)
            (void)named_brick_field(bricks, *request().common.field, true);  // refuses what does not exist
        const detail::MeshShare about = joined_figures(request(), report, [&](const Share& share) {
            return detail::inspect_share(source_of(bricks), share, kCellsNamed, report.progress());
        });
        if (is_silent(request())) return;
        report.merge(facts_of(about.counts));
        report["halo_layers"] = bricks.halo_layers;
        std::uint64_t bytes = 0;
        for (const Brick& brick : bricks.bricks) bytes += brick.bytes;
        report["bytes"] = bytes;
        report["fields"] = Json::array();
        for (const BrickField& field : bricks.fields) {
            if (!request().shows(field.name)) continue;
            report["fields"].push_back({{"name", field.name},
                                        {"location", "point"},
                                        {"components", field.channels},
                                        {"min", field.shortest},
                                        {"max", field.longest}});
        }
        if (!request().is_part) report["verdict"] = verdict(about.counts, about.inverted);
    }
};

}  // namespace

std::unique_ptr<FileInfo> make_bricks_info(const InfoRequest& request) {
    return std::make_unique<BricksInfo>(request);
}

}  // namespace subvol::cli
