// Writes a grid and what it holds at a lattice of voxel centres, to be checked by another reader of .vdb files:
//   write_reference_grid FILE.vdb FILE.json
#include <fstream>
#include <iomanip>
#include <sstream>

#include "subvol/vdb.h"
#include "vdb/test_meshes.h"

int main(int argc, char** argv) {
    using namespace subvol;
    if (argc != 3) return 2;
    const auto mesh = test::with_field(test::ball_mesh(6), "heat", [](const Vec3& p) { return std::exp(p.x) + p.y * p.z; });
    const std::vector<std::string> fields{"heat"};
    const auto grids = rasterize(mesh, fields, {.voxel_size_world = 0.07});
    write_vdb(argv[1], grids);

    std::ostringstream points, values;
    points << std::setprecision(17);
    values << std::setprecision(17);
    const char* separator = "";
    test::for_each_centre(0.07, 16, [&](const Vec3& p) {
        points << separator << '[' << p.x << ',' << p.y << ',' << p.z << ']';
        values << separator;
        if (const auto found = grids[0].value(p)) {
            values << *found;
        } else {
            values << "null";
        }
        separator = ",";
    });
    std::ofstream json(argv[2]);
    json << "{\"points\": [" << points.str() << "], \"values\": [" << values.str() << "]}\n";
    return json.flush() ? 0 : 1;
}
