// SPDX-License-Identifier: Apache-2.0
// Dense grids level by level: seconds, segments, and the difference of each level's picture from that of the finest; and the
// same for the tetrahedra of the refined mesh, which give the same picture. The order is the logarithm of the quotient of two
// differences.
//
// Each level takes eight times as long as the last, or more if the grids do not fit into memory: half a minute for 64 cells.
//
//   dense_levels [model = twist] [resolution = 4] [finest = 6] [size = 256]
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "subvol/error.h"
#include "subvol/limit.h"
#include "subvol/model.h"
#include "subvol/render_dense.h"
#include "subvol/render_tets.h"

namespace {

using namespace subvol;

// Refined meshes are in memory as a whole: 6 tetrahedra per cell, each with its neighbours.
constexpr std::size_t kMostCells = 1'000'000;

double rms(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(double{a.rgba[i]} - double{b.rgba[i]}, 2);
    return std::sqrt(sum / static_cast<double>(a.rgba.size()));
}

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Drawn {
    Image image;
    std::size_t segments = 0;
    double cpu = 0;
};

template <class Draw>
Drawn timed(const Draw& draw) {
    const double start = cpu_seconds();
    auto result = draw();
    return {std::move(result.image), result.report.segments, cpu_seconds() - start};
}

void print(const char* method, const std::vector<Drawn>& levels, const Image& finest) {
    double last = 0;
    for (std::size_t l = 0; l < levels.size(); ++l) {
        const double error = rms(levels[l].image, finest);
        std::printf("%-5s level %zu: %7.2f CPU-s, %6.1f M segments, rms to the finest %.3e", method, l + 1, levels[l].cpu,
                    static_cast<double>(levels[l].segments) * 1e-6, error);
        if (l > 0 && error > 0) std::printf(", order %.2f", std::log2(last / error));
        std::printf("\n");
        last = error;
    }
}

void measure(const std::string& name, int resolution, int finest, int size) {
    const HexMesh mesh = make_model(name, resolution);
    const Box box = bounds(mesh);
    const View view(fit_camera(box, {-1, 1.3, -0.8}), size, size);
    const Optics optics(transfer_function_preset("viridis", -1, 1), box.diagonal() / 30);
    std::vector<Drawn> dense, tets;
    for (int l = 1; l <= finest; ++l) {
        dense.push_back(timed([&] { return render_dense(mesh, {}, view, optics, {.levels = l}); }));
        if ((mesh.cells.size() << (3 * l)) > kMostCells) continue;
        const HexMesh fine = on_limit(refine(mesh, {.levels = l}), Scheme::Mcq);
        tets.push_back(timed([&] { return render_tets(fine, {}, view, optics); }));
    }
    std::printf("%s %d: %zu control cells\n", name.c_str(), resolution, mesh.cells.size());
    print("dense", dense, dense.back().image);
    print("tets", tets, dense.back().image);
}

}  // namespace

int main(int argc, char** argv) try {
    const auto number = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
    measure(argc > 1 ? argv[1] : "twist", number(2, 4), number(3, 6), number(4, 256));
} catch (const subvol::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
