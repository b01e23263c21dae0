// SPDX-License-Identifier: Apache-2.0
#include "points_input.h"

#include <algorithm>
#include <filesystem>

#include "grid_input.h"
#include "subvol/detail/near_name.h"
#include "subvol/error.h"
#include "subvol/points_io.h"
#include "subvol/vdb_points.h"
#include "text.h"
#include "vdb_functions.h"

namespace subvol::cli {
namespace {

constexpr std::initializer_list<const char*> kOfSampling{
    "--per-edge",     "--centers",      "--spacing",   "--spacing-voxels", "--correction",     "--scheme", "--tension",
    "--levels",       "--crease-angle", "--tolerance", "--footprint",      "--footprint-size", "--values", "--kernel",
    "--value-kernel", "--threshold",    "--reduce",    "--refine",         "--seconds"};

constexpr const char* kNeedsMesh = "needs a mesh; these are points that have been sampled already";

void refuse_sampling(const CLI::App& app) {
    refuse_mesh_options(app, kNeedsMesh);
    refuse_options(app, kOfSampling, kNeedsMesh);
}

[[noreturn]] void refuse_field(const std::string& name, const std::vector<std::string>& names, const std::string& input) {
    throw Error(ErrorCode::InvalidInput, "there is no field '" + name + "'" + detail::did_you_mean(name, names), input,
                "it has: " + join(names));
}

}  // namespace

bool holds_points(const std::string& input) {
    return is_points_file(input) || (is_vdb_file(input) && vdb().holds_vdb_points(input));
}

WithFacts<RbfVolume> read_points_input(const std::string& input, Progress* progress) {
    Facts facts;
    facts["input"] = input;
    RbfVolume volume =
        facts.timed(progress, "read", [&] { return is_vdb_file(input) ? vdb().read_vdb_points(input) : read_points(input); });
    facts["points"] = volume.size();
    if (volume.size() == 0) throw Error(ErrorCode::InvalidInput, "there are no points in it", input);
    return {std::move(volume), std::move(facts)};
}

WithFacts<RbfVolume> load_all_points(const std::string& input, const CLI::App& app, Progress* progress) {
    refuse_sampling(app);
    return read_points_input(input, progress);
}

WithFacts<RbfVolume> load_points(const std::string& input, const CommonOptions& options,
                                 const std::optional<std::string>& second, const CLI::App& app, Progress* progress) {
    WithFacts<RbfVolume> loaded = load_all_points(input, app, progress);
    RbfVolume& volume = loaded.value;
    const auto channel = [&](const std::string& name) { return volume.channels[find_channel(volume, name, input)]; };
    std::vector<RbfChannel> chosen{channel(options.field.value_or(volume.channels.front().name))};
    if (second && *second != chosen.front().name) chosen.push_back(channel(*second));
    volume.channels = std::move(chosen);
    loaded.facts["field"] = volume.channels.front().name;
    return loaded;
}

bool holds_levels(const std::string& input) {
    return std::filesystem::path(input).extension() == ".svk";
}

WithFacts<LevelsInput> open_levels(const std::string& input, const CommonOptions& options,
                                   const std::optional<std::string>& second, std::uint64_t cache_bytes, const CLI::App& app,
                                   Progress* progress) {
    refuse_sampling(app);
    Facts facts;
    facts["input"] = input;
    LevelsInput levels{facts.timed(progress, "read", [&] { return KernelFile(input, cache_bytes); }), {}};
    const KernelFileContents& contents = levels.file.contents();
    facts["points"] = contents.kernels;
    std::vector<std::string> names;
    for (const auto& channel : contents.channels) names.push_back(channel.name);
    const auto number_of = [&](const std::string& name) {
        const auto found = std::ranges::find(names, name);
        if (found == names.end()) refuse_field(name, names, input);
        return static_cast<std::size_t>(found - names.begin());
    };
    levels.channels.push_back(number_of(options.field.value_or(names.front())));
    facts["field"] = names[levels.channels.front()];
    if (second && *second != names[levels.channels.front()]) levels.channels.push_back(number_of(*second));
    return {std::move(levels), std::move(facts)};
}

std::size_t find_channel(const RbfVolume& volume, const std::string& name, const std::string& input) {
    const auto found = std::ranges::find(volume.channels, name, &RbfChannel::name);
    if (found != volume.channels.end()) return static_cast<std::size_t>(found - volume.channels.begin());
    std::vector<std::string> names;
    for (const RbfChannel& channel : volume.channels) names.push_back(channel.name);
    refuse_field(name, names, input);
}

Range channel_range(const RbfVolume& volume, std::size_t channel) {
    const auto [min, max] = std::ranges::minmax(volume.channels[channel].values);
    return {min, max};
}

}  // namespace subvol::cli
