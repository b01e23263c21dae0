// SPDX-License-Identifier: Apache-2.0
// Kernels: their shape, channels, and the boundary.
#include <algorithm>

#include "file_info.h"
#include "mesh_figures.h"
#include "points_input.h"
#include "subvol/kernel_file.h"
#include "subvol/points_io.h"

namespace subvol::cli {
namespace {

/// A file with levels of detail: its head alone is read.
class LevelsInfo : public FileInfo {
public:
    using FileInfo::FileInfo;

    [[nodiscard]] std::vector<std::string> field_names(Report& report) override {
        report["input"] = request().input;
        const KernelFile file(request().input);
        std::vector<std::string> names;
        for (const auto& channel : file.contents().channels) names.push_back(channel.name);
        return names;
    }

    void describe(Report& report) override {
        report["input"] = request().input;
        KernelFileContents contents = report.timed("read", [&] { return KernelFile(request().input).contents(); });
        if (request().common.field) {
            const LevelsInput levels =
                report.unpack(open_levels(request().input, request().common, {}, 0, request().app, report.progress()));
            contents.channels = {contents.channels[levels.channels.front()]};
        }
        report["points"] = contents.kernels;
        report["kernel"] = Json::parse(subvol::to_json(contents.kernel));
        report["bounds"] = json_of(contents.bounds);
        report["boundary_triangles"] = contents.boundary_triangles;
        for (const auto& channel : contents.channels) {
            report["channels"].push_back({{"name", channel.name}, {"min", channel.min}, {"max", channel.max}});
        }
        report["levels"] = contents.levels;
        report["blocks"] = contents.blocks;
        report["bytes"] = contents.bytes;
    }
};

class PointsInfo : public FileInfo {
public:
    using FileInfo::FileInfo;

    [[nodiscard]] std::vector<std::string> field_names(Report& report) override {
        report["input"] = request().input;
        const RbfVolume volume = report.unpack(read_points_input(request().input, report.progress()));
        std::vector<std::string> names;
        for (const RbfChannel& channel : volume.channels) names.push_back(channel.name);
        return names;
    }

    void describe(Report& report) override {
        report["input"] = request().input;
        RbfVolume volume = report.unpack(read_points_input(request().input, report.progress()));
        if (request().common.field)
            volume.channels = {volume.channels[find_channel(volume, *request().common.field, request().input)]};
        report["kernel"] = Json::parse(subvol::to_json(volume.kernel));
        report["bounds"] = json_of(volume.bounds);
        report["boundary_triangles"] = volume.boundary.triangles.size();
        for (const RbfChannel& channel : volume.channels) {
            const auto [min, max] = std::ranges::minmax(channel.values);
            report["channels"].push_back({{"name", channel.name}, {"min", min}, {"max", max}});
        }
    }
};

}  // namespace

std::unique_ptr<FileInfo> make_points_info(const InfoRequest& request) {
    if (holds_levels(request.input)) return std::make_unique<LevelsInfo>(request);
    return std::make_unique<PointsInfo>(request);
}

}  // namespace subvol::cli
