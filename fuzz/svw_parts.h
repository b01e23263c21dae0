// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "io/series/series_parts.h"
#include "subvol/detail/read_file.h"
#include "subvol/model.h"
#include "subvol/refine.h"
#include "subvol/series_file.h"

namespace subvol::fuzz {

/// The parts that are damaged: the index, a mesh, the head and the block of a step, and those of the next; in capital letters
/// those of the file with refined cells and many steps.
inline constexpr std::string_view kSeriesParts = "imhbncIMHBNC";

inline bool is_of_refined(char letter) {
    return letter >= 'A' && letter <= 'Z';
}

inline std::string* part_of(test::SeriesParts& parts, char letter) {
    switch (is_of_refined(letter) ? letter - 'A' + 'a' : letter) {
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

/// The parts of a file of so many steps of a moving mesh with a field.
inline test::SeriesParts parts_of_steps(const HexMesh& mesh, std::size_t steps, const SeriesFileOptions& options) {
    const std::filesystem::path path = std::filesystem::temp_directory_path() / ("good_" + std::to_string(::getpid()) + ".svw");
    const auto step = [&](std::size_t k) {
        HexMesh moved = mesh;
        for (Vec3& p : moved.points) p *= 1 + static_cast<double>(k) / 10;
        for (double& x : moved.attributes.front().values) x = x * x + static_cast<double>(k);
        moved.attributes.front().bounds = {{-1, 99}};
        return moved;
    };
    const auto sets = [] { return MeshSets{{{"inlet", {{0, 1}, {3, 5}}}}, {{"core", {1, 2, 4}}}}; };
    MeshSteps all{{}, step, sets};
    for (std::size_t k = 0; k < steps; ++k) all.times.push_back(static_cast<double>(k));
    write_series_file(path, all, options);
    const std::string file = detail::read_text(path);
    std::filesystem::remove(path);
    return test::SeriesParts::of(file, mesh.points.size());
}

inline test::SeriesParts good_steps() {
    return parts_of_steps(make_model("ball", 2), 3, {.tolerance = .01});
}

/// The cells are stored as those of a control mesh; most steps depend on several others.
inline test::SeriesParts refined_steps() {
    return parts_of_steps(refine(make_model("ball", 2), {.levels = 2}), 12, {.tolerance = .01, .key_steps = 5});
}

}  // namespace subvol::fuzz
