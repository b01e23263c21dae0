// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "lib/wavelet/series_parts.h"
#include "subvol/detail/read_file.h"
#include "subvol/model.h"
#include "subvol/series_file.h"

namespace subvol::fuzz {

/// The parts that are damaged: the index, a mesh, the head and the block of a step, and those of the next.
inline constexpr std::string_view kSeriesParts = "imhbnc";

inline std::string* part_of(test::SeriesParts& parts, char letter) {
    switch (letter) {
        case 'i':
            return &parts.index_text.emplace();
        case 'm':
            return &parts.meshes.front();
        case 'h':
            return &parts.steps.front().head;
        case 'b':
            return &parts.steps.front().block;
        case 'n':
            return &parts.steps.at(1).head;
        case 'c':
            return &parts.steps.at(1).block;
        default:
            return nullptr;
    }
}

/// Three steps of a moving mesh with a field, and its parts.
inline test::SeriesParts good_steps() {
    const std::filesystem::path path = std::filesystem::temp_directory_path() / ("good_" + std::to_string(::getpid()) + ".svw");
    const HexMesh mesh = make_model("ball", 2);
    const auto step = [&](std::size_t k) {
        HexMesh moved = mesh;
        for (Vec3& p : moved.points) p *= 1 + static_cast<double>(k) / 10;
        for (double& x : moved.attributes.front().values) x = x * x + static_cast<double>(k);
        moved.attributes.front().bounds = {{-1, 9}};
        return moved;
    };
    const auto sets = [] { return MeshSets{{{"inlet", {{0, 1}, {3, 5}}}}, {{"core", {1, 2, 4}}}}; };
    write_series_file(path, {{0, 1, 2}, step, sets}, {.tolerance = .01});
    const std::string file = detail::read_text(path);
    std::filesystem::remove(path);
    return test::SeriesParts::of(file, mesh.points.size());
}

}  // namespace subvol::fuzz
