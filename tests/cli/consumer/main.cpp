// SPDX-License-Identifier: Apache-2.0
// Calls into every component, so that each must have been installed with what it links to.
#include <subvol/compare.h>
#include <subvol/io.h>
#include <subvol/render.h>
#include <subvol/subvol.h>
#include <subvol/vdb.h>

#include <filesystem>

static_assert(SUBVOL_VERSION_MAJOR == 0 && SUBVOL_VERSION_MINOR == 2);

int main() {
    // As programs of the release before do, of which subvol::lib is all that they link.
    const auto mesh_file = std::filesystem::temp_directory_path() / "subvol_consumer.vtu";
    subvol::write_mesh(mesh_file, subvol::make_model("ball", 2));
    const subvol::HexMesh mesh = subvol::read_mesh(mesh_file).mesh;
    std::filesystem::remove(mesh_file);
    const subvol::HexMesh fine = subvol::refine(mesh, {.levels = 1});
    const subvol::Attribute& density = fine.attributes.front();
    const auto grids = subvol::rasterize(fine, std::vector{density.name}, {.resolution = 16});
    const subvol::View view(subvol::parse_camera("iso", bounds(fine)), 16, 16);
    const subvol::Optics optics(subvol::transfer_function_preset("viridis", 0, 1), 0.1);
    const subvol::Image image = render_tets(fine, density.name, view, optics).image;
    // Pictures are read and written by a module, which the program finds in the installation.
    const auto file = std::filesystem::temp_directory_path() / "subvol_consumer.exr";
    subvol::write_image(file, image);
    const subvol::Image again = subvol::read_image(file);
    std::filesystem::remove(file);
    const bool right = fine.cells.size() == 8 * mesh.cells.size() && grids.front().report().active_voxels > 0 &&
                       compare_images(image, again).max == 0;
    return right ? 0 : 1;
}
