// SPDX-License-Identifier: Apache-2.0
// Your own kernel: fitted to a scheme's basis function, written as JSON, and used to draw. Writes own_kernel.png.

#include <cstdio>

#include "subvol/compare.h"
#include "subvol/render.h"
#include "subvol/subvol.h"

int main() try {
    // The influence of one control point with value 1 on the space around it. Level 4 has 16 samples per cell edge.
    const subvol::BasisFunction basis = subvol::sample_basis_function(subvol::Scheme::Mcq, 4);

    const subvol::KernelFit plain = fit_kernel(basis, subvol::KernelShape::Gaussian);
    const subvol::KernelFit two = fit_kernel(basis, subvol::KernelShape::GaussianSum, {.terms = 2});
    std::printf("one Gaussian: rmse %.5f; two: rmse %.5f; nothing round is below %.5f\n", plain.report.errors.rmse,
                two.report.errors.rmse, radial_bound(basis).rmse);
    std::printf("%s\n", to_json(two.kernel).c_str());

    // Any kernel can be drawn. Its shape hardly matters, since kernels carry gradients and second moments.
    const subvol::HexMesh mesh = subvol::make_model("ball", 8);
    const subvol::View view(subvol::parse_camera("iso", bounds(mesh)), 128, 128);
    const subvol::Optics optics(subvol::transfer_function_preset("coolwarm", -1, 1), bounds(mesh).diagonal() / 100);
    const auto draw = [&](const subvol::Kernel& kernel) {
        return subvol::render_splats(subvol::sample_rbf_points(mesh, {.kernel = kernel}).volume, view, optics).image;
    };
    const subvol::Image own = draw(plain.kernel);
    subvol::write_image("own_kernel.png", own);
    const double psnr = subvol::compare_images(own, draw(subvol::CompactKernel{})).psnr;
    std::printf("drawn with the Gaussian and with the usual kernel: %.1f dB between them\n", psnr);
    return two.report.errors.rmse < plain.report.errors.rmse && psnr > 40 ? 0 : 1;
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
