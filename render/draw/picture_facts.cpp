// SPDX-License-Identifier: Apache-2.0
#include "picture_facts.h"

#include <tbb/global_control.h>

#include <map>
#include <string>
#include <utility>

#include "subvol/detail/number_text.h"

namespace subvol::detail {
namespace {

/// The methods that always run on the same kind of device.
void add_method(Method method, const char* backend, Facts& facts) {
    facts["method"] = name_of(method);
    facts["backend"] = backend;
}

void add_rays(std::size_t rays, std::size_t lost, Facts& facts) {
    facts["rays"] = rays;
    facts["lost_rays"] = lost;
    if (lost > 0) facts.warn(std::to_string(lost) + " rays were lost inside the mesh");
}

}  // namespace

std::string cpu_threads() {
    return std::to_string(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)) + " CPU threads";
}

void add_facts(const SplatReport& splats, Method method, Facts& facts) {
    facts["method"] = name_of(method);
    if (splats.seconds_light > 0) facts.add_seconds("light", splats.seconds_light);
    facts.add_seconds("prepare", splats.seconds_prepare - splats.seconds_light);
    facts.add_seconds("draw", splats.seconds_draw);
    if (splats.seconds_colors > 0) facts.add_seconds("colors", splats.seconds_colors);
    facts["backend"] = splats.backend;
    facts["device"] = splats.device;
    if (!splats.warning.empty()) facts.warn(splats.warning);
    facts["sheets"] = splats.sheets;
}

void add_facts_of_first_hits(const Surface& boundary, Facts& facts) {
    add_method(Method::Splat, "cpu", facts);
    facts["device"] = cpu_threads();
    facts["points"] = boundary.points.size();
    facts["triangles"] = boundary.triangles.size();
    facts["sheets"] = std::size_t{0};
}

void add_facts(const TetsReport& tets, Facts& facts) {
    add_method(Method::Tets, "cpu", facts);
    facts.add_seconds("draw", tets.seconds_draw);
    facts["tets"] = tets.tets;
    facts["degenerate_tets"] = tets.degenerate_tets;
    facts["inverted_tets"] = tets.inverted_tets;
    add_rays(tets.rays, tets.lost_rays, facts);
}

void add_facts(const ProjectedReport& pt, ProjectedOrder order, Facts& facts) {
    add_method(Method::Projected, "gl", facts);
    facts.add_seconds("prepare", pt.seconds_prepare);
    facts.add_seconds("sort", pt.seconds_sort);
    facts.add_seconds("draw", pt.seconds_draw);
    facts["device"] = pt.device;
    facts["order"] = name_of(order);
    facts["tets"] = pt.tets;
    facts["degenerate_tets"] = pt.degenerate_tets;
    facts["inverted_tets"] = pt.inverted_tets;
    if (order == ProjectedOrder::Topological) facts["cycles"] = pt.cycles;
    if (order == ProjectedOrder::Lists || order == ProjectedOrder::Havs) facts["fragments"] = pt.fragments;
    if (order == ProjectedOrder::Havs) {
        facts["faces"] = pt.faces;
        facts["faces_drawn"] = pt.faces_drawn;
        facts["late_faces"] = pt.late_faces;
    }
    if (pt.violations) facts["order_violations"] = *pt.violations;
    if (pt.cycles > 0)
        facts.warn("the order of the tetrahedra has cycles, which were broken " + std::to_string(pt.cycles) + " times");
    if (pt.late_faces > 0)
        facts.warn(std::to_string(pt.late_faces) +
                   " faces came too late for the k-buffer; use a larger --kbuffer, or --order lists");
}

void add_facts(const DenseReport& dense, bool chosen_level, Facts& facts) {
    add_method(Method::Dense, "cpu", facts);
    facts.add_seconds("prepare", dense.seconds_build);
    facts.add_seconds("draw", dense.seconds_draw);
    facts["levels"] = dense.levels;
    if (dense.error_px) facts["error_px"] = *dense.error_px;
    if (dense.error_color) facts["error_color"] = *dense.error_color;
    if (dense.image_change) facts["image_change"] = *dense.image_change;
    facts["converged"] = dense.converged;
    facts["blocks"] = dense.blocks;
    facts["skipped_blocks"] = dense.skipped_blocks;
    facts["micro_cells"] = dense.micro_cells;
    facts["passes"] = dense.passes;
    facts["bytes"] = dense.bytes;
    add_rays(dense.rays, dense.lost_rays, facts);
    if (chosen_level || dense.converged) return;
    const std::string level = " at level " + std::to_string(dense.levels) + ": --levels draws a finer one";
    facts.warn(dense.error_px
                   ? "the boundary and jumps of colours lie about " + number_text(*dense.error_px) +
                         " pixels and colours about " + number_text(dense.error_color.value_or(0)) + " from the limit" + level
                   : "the picture still changes by " + number_text(dense.image_change.value_or(0)) + level);
}

void add_facts(const GridTraceReport& grid, Facts& facts) {
    add_method(Method::Grid, "cpu", facts);
    facts.add_seconds("draw", grid.seconds_draw);
    facts["rays"] = grid.rays;
    facts["cells"] = grid.cells;
    facts["blocks"] = grid.blocks;
}

std::size_t count_tiny_bodies(std::span<const Box> boxes, const View& view) {
    constexpr int kMostNeighbours = 8;
    std::map<std::pair<int, int>, int> at;  // tiny bodies by their pixel
    for (const Box& box : boxes) {
        Box seen;
        for (int k = 0; k < 8; ++k) {
            const auto end = [&](int axis) { return (k >> axis & 1) != 0 ? box.upper[axis] : box.lower[axis]; };
            const Vec3 eye = view.to_eye({end(0), end(1), end(2)});
            if (view.perspective() && !(eye.z > 0)) break;  // behind the eye
            const Vec2 px = view.to_pixels(eye);
            seen.add({px.x, px.y, k});
        }
        if (!(seen.upper.z == 7 && seen.upper.x - seen.lower.x < 1 && seen.upper.y - seen.lower.y < 1)) continue;
        const Vec3 center = seen.center();
        if (center.x >= 0 && center.y >= 0 && center.x < view.width() && center.y < view.height())
            ++at[{static_cast<int>(center.x), static_cast<int>(center.y)}];
    }
    std::size_t tiny = 0;
    for (const auto& [pixel, count] : at) {
        int near = 0;
        for (int y = -1; y <= 1; ++y) {
            for (int x = -1; x <= 1; ++x) {
                const auto found = at.find({pixel.first + x, pixel.second + y});
                near += found == at.end() ? 0 : found->second;
            }
        }
        if (near <= kMostNeighbours) tiny += static_cast<std::size_t>(count);
    }
    return tiny;
}

}  // namespace subvol::detail
