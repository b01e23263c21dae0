// SPDX-License-Identifier: Apache-2.0
// Regions of a mesh, one a line, and what they choose; seeds of streamlines (what follows the letter s).

#include <sstream>
#include <vector>

#include "input.h"
#include "subvol/model.h"
#include "subvol/region.h"
#include "subvol/streamlines.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    static const HexMesh mesh = make_model("ball", 2);
    static const MeshSets sets{{{"inlet", {{0, 1}, {3, 5}}}}, {{"core", {1, 2, 4}}}};
    std::istringstream text{std::string(fuzz::text_of(data, size))};
    if (size > 0 && data[0] == 's') {
        return fuzz::run([&] { fuzz::check(parse_seeds(text.str().substr(1), 7).size() <= 7); });
    }
    std::vector<std::string> lines;
    for (std::string line; lines.size() < 4 && std::getline(text, line);) lines.push_back(line);
    return fuzz::run([&] {
        const std::vector<Region> regions = parse_regions(lines);
        fuzz::check(cells_in(mesh, regions, sets).size() == mesh.cells.size());
        std::vector<Region> of_space;
        for (const Region& region : regions) {
            if (!region.chooses_cells()) of_space.push_back(region);
        }
        for (const Vec3& place : mesh.points) fuzz::check(depth(of_space, place) == depth(of_space, place));
    });
}
