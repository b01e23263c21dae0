// SPDX-License-Identifier: Apache-2.0
// Writes grids of a mesh with irregular edges, and their values at 1,000 voxel centres, to be checked by another reader of
// .vdb files:
//   write_reference_grid FILE.vdb FILE.json
#include <fstream>
#include <iomanip>
#include <random>
#include <sstream>

#include "subvol/model.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_grid.h"
#include "test_meshes.h"

namespace {

using namespace subvol;

constexpr double kVoxel = 0.03;
constexpr int kPoints = 1000;

/// Linear, so that cells of any shape reproduce it.
Vec3 flow(const Vec3& p) {
    return {1 + p.x - 2 * p.y, 0.5 * p.z - 3, p.x + p.y + p.z};
}

HexMesh make_mesh() {
    HexMesh mesh = make_model("ball");  // a cube within shells: valences 3 and 4, eight singular nodes
    mesh.attributes.clear();
    test::add_field(mesh, "heat", [](const Vec3& p) { return std::exp(p.x) + p.y * p.z; });
    Attribute attribute{"flow", 3, {}};
    for (const Vec3& p : mesh.points) {
        const Vec3 v = flow(p);
        attribute.values.insert(attribute.values.end(), {v.x, v.y, v.z});
    }
    mesh.attributes.push_back(std::move(attribute));
    return mesh;
}

std::string list(const Vec3& v) {
    std::ostringstream out;
    out << std::setprecision(17) << '[' << v.x << ',' << v.y << ',' << v.z << ']';
    return out.str();
}

std::string number(double v) {
    std::ostringstream out;
    out << std::setprecision(17) << v;
    return out.str();
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    const HexMesh mesh = make_mesh();
    const std::vector<std::string> fields{"heat", "flow"};
    const auto grids = rasterize(mesh, fields, {.voxel_size_world = kVoxel});
    write_vdb(argv[1], grids);

    std::mt19937 random(7);
    const auto index = [&] { return static_cast<int>(random() % 71) - 35; };  // the ball's radius is 33 voxels
    std::string points, heat, vectors;
    for (int i = 0; i < kPoints; ++i) {
        const Vec3 p = kVoxel * Vec3(index(), index(), index());
        const auto found = grids[0].value(p);
        const char* separator = i == 0 ? "" : ",";
        points += separator + list(p);
        heat += separator + (found ? number(*found) : "null");
        vectors += separator + (found ? list(flow(p)) : "null");
    }
    std::ofstream json(argv[2]);
    json << "{\"points\": [" << points << "], \"grids\": {\"heat\": [" << heat << "], \"flow\": [" << vectors << "]}}\n";
    return json.flush() ? 0 : 1;
}
