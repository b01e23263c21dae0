// SPDX-License-Identifier: Apache-2.0
#include "points_input.h"

#include <algorithm>
#include <filesystem>

#include "subvol/error.h"
#include "subvol/points_io.h"
#include "subvol/vdb_points.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr std::initializer_list<const char*> kOfMeshes{
    "--density",        "--other-cells", "--weld",           "--weld-distance", "--per-edge", "--spacing",
    "--spacing-voxels", "--correction",  "--scheme",         "--tension",       "--levels",   "--crease-angle",
    "--tolerance",      "--footprint",   "--footprint-size", "--values",        "--kernel",   "--value-kernel",
    "--threshold",      "--reduce",      "--refine",         "--seconds"};

bool is_vdb(const std::string& input) {
    return std::filesystem::path(input).extension() == ".vdb";
}

}  // namespace

bool holds_points(const std::string& input) {
    return is_points_file(input) || (is_vdb(input) && holds_vdb_points(input));
}

RbfVolume read_points_input(const std::string& input, Report& report) {
    report["input"] = input;
    RbfVolume volume = report.timed("read", [&] { return is_vdb(input) ? read_vdb_points(input) : read_points(input); });
    report["points"] = volume.size();
    if (volume.size() == 0) throw Error(ErrorCode::InvalidInput, "there are no points in it", input);
    return volume;
}

RbfVolume load_points(const std::string& input, const CommonOptions& options, const std::optional<std::string>& second,
                      const CLI::App& app, Report& report) {
    refuse_options(app, kOfMeshes, "needs a mesh; these are points that have been sampled already");
    RbfVolume volume = read_points_input(input, report);
    std::vector<std::string> names;
    for (const RbfChannel& channel : volume.channels) names.push_back(channel.name);
    const auto find = [&](const std::string& wanted) {
        const auto found = std::ranges::find(names, wanted);
        if (found == names.end()) {
            throw Error(ErrorCode::InvalidInput, "there is no field '" + wanted + "'", input, "it has: " + join(names));
        }
        return volume.channels[static_cast<std::size_t>(found - names.begin())];
    };
    std::vector<RbfChannel> chosen{find(options.field.value_or(names.front()))};
    if (second && *second != chosen.front().name) chosen.push_back(find(*second));
    volume.channels = std::move(chosen);
    report["field"] = volume.channels.front().name;
    return volume;
}

Range channel_range(const RbfVolume& volume, std::size_t channel) {
    const auto [min, max] = std::ranges::minmax(volume.channels[channel].values);
    return {min, max};
}

}  // namespace subvol::cli
