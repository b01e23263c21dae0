// SPDX-License-Identifier: Apache-2.0
#include "mesh_frames.h"

#include <algorithm>
#include <filesystem>

#include "subvol/error.h"
#include "subvol/mesh_motion.h"
#include "text.h"

namespace subvol::cli {
namespace {

bool same_fields(const HexMesh& a, const HexMesh& b) {
    return std::equal(a.attributes.begin(), a.attributes.end(), b.attributes.begin(), b.attributes.end(),
                      [](const Attribute& x, const Attribute& y) { return x.name == y.name && x.channels == y.channels; });
}

}  // namespace

FrameRange frames_of(const Share& share, const FrameRange& all) {
    const auto [begin, end] = share.range(static_cast<std::size_t>(all.count()));
    return {all.first + static_cast<int>(begin), all.first + static_cast<int>(end) - 1};
}

bool has_number(const std::string& pattern) {
    return pattern.find('#') != std::string::npos;
}

void check_numbered(const std::string& pattern, const char* of, const std::string& example) {
    if (has_number(pattern)) return;
    throw Error(ErrorCode::InvalidInput, std::string("has no # for the number of the ") + of, pattern, example);
}

std::string with_number(const std::string& pattern, int number) {
    const std::size_t last = pattern.find_last_of('#');
    if (last == std::string::npos) return pattern;
    std::size_t first = last;
    while (first > 0 && pattern[first - 1] == '#') --first;
    const std::string digits = std::to_string(number);
    const std::size_t width = last + 1 - first;
    const std::string zeros(width > digits.size() ? width - digits.size() : 0, '0');
    return pattern.substr(0, first) + zeros + digits + pattern.substr(last + 1);
}

void check_frames(const std::string& pattern, const FrameRange& range) {
    constexpr std::size_t kMostNamed = 3;
    if (pattern.starts_with("model:")) return;
    std::vector<std::string> missing;
    for (int frame = range.first; frame <= range.last; ++frame) {
        const std::string name = with_number(pattern, frame);
        std::error_code ignored;
        if (!std::filesystem::exists(name, ignored)) missing.push_back(name);
    }
    if (missing.empty()) return;
    std::string names =
        join({missing.begin(), missing.begin() + static_cast<std::ptrdiff_t>(std::min(missing.size(), kMostNamed))});
    if (missing.size() > kMostNamed) names += text(" and ", missing.size() - kMostNamed, " more");
    throw Error(ErrorCode::Io, text(missing.size(), " of ", range.count(), " frames are missing: ", names), "--frames",
                "nothing was written");
}

MeshFrames::MeshFrames(std::string input, const std::optional<std::string>& to, FrameRange range, Load load) : range_(range) {
    if (!to) {
        load_ = [input, load = std::move(load)](int frame) { return load(with_number(input, frame)); };
        return;
    }
    from_ = load(input);
    to_ = load(*to);
    if (!moved_cells(*from_, *to_)) {
        throw Error(ErrorCode::InvalidInput, "does not have the same cells as " + input, *to,
                    "two meshes that differ in points and values");
    }
    if (!same_fields(*from_, *to_)) {
        throw Error(ErrorCode::InvalidInput, "does not have the same fields as " + input, *to,
                    "--fields with those that both have");
    }
}

MeshFrames::MeshFrames(FrameRange range, std::vector<double> times, std::function<HexMesh(int)> load)
    : range_(range), load_(std::move(load)), times_(std::move(times)) {
}

const HexMesh& MeshFrames::mesh(int frame) {
    meshes_.erase(meshes_.begin(), meshes_.lower_bound(frame - 2));
    const auto found = meshes_.find(frame);
    if (found != meshes_.end()) return found->second;
    const double t = range_.count() > 1 ? static_cast<double>(frame - range_.first) / (range_.count() - 1) : 0;
    return meshes_.emplace(frame, from_ ? mesh_between(*from_, *to_, t) : load_(frame)).first->second;
}

Attribute MeshFrames::velocity(int frame) {
    if (range_.count() < 2) throw Error(ErrorCode::InvalidInput, "needs at least two frames", "--velocity");
    const int before = std::max(frame - 1, range_.first), after = std::min(frame + 1, range_.last);
    const HexMesh &a = mesh(before), &here = mesh(frame), &b = mesh(after);
    if (!moved_cells(a, here) || !moved_cells(here, b)) {
        throw Error(ErrorCode::InvalidInput, text("the cells change between the frames ", before, " and ", after), "--velocity",
                    "meshes of the same cells");
    }
    const auto time = [&](int k) { return times_.empty() ? k : times_[static_cast<std::size_t>(k)]; };
    const double passed = time(after) - time(before);
    if (!(passed > 0)) {
        throw Error(ErrorCode::InvalidInput, text("no time passes between the steps ", before, " and ", after), "--velocity");
    }
    return velocity_between(a, b, passed);
}

}  // namespace subvol::cli
