// SPDX-License-Identifier: Apache-2.0
// Limits at random places of a generated model. Arguments: model, resolution, queries.
#include <cstdio>
#include <cstdlib>
#include <random>

#include "measure.h"
#include "subvol/limit.h"
#include "subvol/model.h"

int main(int argc, char** argv) {
    using namespace subvol;
    const HexMesh mesh = make_model(argc > 1 ? argv[1] : "ball", argc > 2 ? std::atoi(argv[2]) : 16);
    const std::size_t count = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 20000;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> t(0, 1);
    std::vector<LimitQuery> queries;
    for (std::size_t i = 0; i < count; ++i) {
        queries.push_back({static_cast<Index>(random() % mesh.cells.size()), {t(random), t(random), t(random)}});
    }
    const std::pair<const char*, Scheme> schemes[] = {
        {"mcq", Scheme::Mcq}, {"cc", Scheme::CatmullClark}, {"bsxw", Scheme::Bsxw}, {"linear", Scheme::Linear}};
    for (const auto& [name, scheme] : schemes) {
        const LimitOptions options{.scheme = {scheme}};
        LimitReport report;
        const double seconds = bench::seconds_of([&] { report = evaluate_limit(mesh, queries, options).report; }, 1);
        std::printf("%-6s %8.0f queries/s  exact %zu, refined %zu, not converged %zu, deepest level %d\n", name,
                    static_cast<double>(count) / seconds, report.exact, report.refined, report.unconverged,
                    report.deepest_level);
    }
}
