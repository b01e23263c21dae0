// SPDX-License-Identifier: Apache-2.0
#include "subvol/hierarchy.h"

#include <algorithm>

#include "coarsen.h"
#include "subvol/detail/child_topology.h"
#include "subvol/error.h"
#include "subvol/refine.h"

namespace subvol {

using namespace detail;

namespace {

/// A cell of the hierarchy as the mesh has it.
struct Placed {
    Index cell;
    std::array<std::uint8_t, 8> corners;
};

[[noreturn]] void refuse(const std::string& why) {
    throw Error(ErrorCode::InvalidInput, "the mesh is not the refinement of a coarser one: " + why, {},
                "blocks of cells with even counts, as `subvol subdivide` makes them");
}

/// The hierarchy of a mesh without unused points; no levels if there is none.
MeshHierarchy hierarchy_of(const HexMesh& mesh, int most, std::string& why) {
    std::vector<CoarserMesh> steps;  // fine to coarse
    const HexMesh* current = &mesh;
    while (static_cast<int>(steps.size()) < most) {
        std::string reason;
        auto step = coarser_mesh(*current, reason);
        if (!step) {
            if (steps.empty()) why = reason;
            break;
        }
        steps.push_back(std::move(*step));
        current = &steps.back().mesh;
    }
    MeshHierarchy result;
    result.levels = static_cast<int>(steps.size());
    if (steps.empty()) return result;
    std::vector<Placed> placed(current->cells.size());
    for (Index c = 0; c < placed.size(); ++c) placed[c] = {c, {0, 1, 2, 3, 4, 5, 6, 7}};
    for (std::size_t l = steps.size(); l-- > 0;) {
        std::vector<Placed> finer(8 * placed.size());
        for (std::size_t c = 0; c < placed.size(); ++c) {
            const auto& [own, corners] = placed[c];
            for (std::size_t k = 0; k < 8; ++k) {
                Placed& child = finer[8 * c + k];
                child.cell = steps[l].children[own][corners[k]];
                for (std::size_t q = 0; q < 8; ++q) child.corners[q] = steps[l].corners[own][corners[k]][corners[q]];
            }
        }
        placed = std::move(finer);
    }
    Topology topology = build_topology(*current);
    for (int l = 1; l < result.levels; ++l) topology = child_topology(topology);
    const auto cells = child_cells(topology);
    result.points.assign(ChildNumbering(topology).end, kNone);
    result.cells.resize(placed.size());
    std::vector<Index> back(mesh.points.size(), kNone);
    for (std::size_t c = 0; c < cells.size(); ++c) {
        result.cells[c] = placed[c].cell;
        for (std::size_t k = 0; k < 8; ++k) {
            const Index p = mesh.cells[placed[c].cell][placed[c].corners[k]];
            Index& known = result.points[cells[c][k]];
            if ((known != kNone && known != p) || (back[p] != kNone && back[p] != cells[c][k])) {
                why = "its cells have the numbers of a refined mesh, but not its connections";
                return {};
            }
            known = p;
            back[p] = cells[c][k];
        }
    }
    result.coarse = std::move(steps.back().mesh);
    return result;
}

struct PaddedGrid {
    HexMesh mesh;
    std::vector<Index> points;  // of each point of the padded grid
    std::vector<Index> cells;
    std::vector<PaddedPoint> padded;
};

PaddedGrid pad_grid(const HexMesh& mesh, const StructuredCells& grid, std::size_t multiple) {
    PaddedGrid result;
    std::array<std::size_t, 3> counts{};
    for (std::size_t a = 0; a < 3; ++a) counts[a] = (grid.counts[a] + multiple - 1) / multiple * multiple;
    const auto point_of = [&](const std::array<std::size_t, 3>& at) {  // of the mesh
        std::size_t cell = 0, corner = 0;
        for (std::size_t a = 3; a-- > 0;) {
            const bool last = at[a] == grid.counts[a];
            cell = cell * grid.counts[a] + at[a] - (last ? 1 : 0);
            corner |= (last ? std::size_t{1} : 0) << a;
        }
        return mesh.cells[grid.cells[cell]][grid.corners[cell][corner ^ ((corner >> 1) & 1)]];
    };
    for (std::size_t k = 0; k <= counts[2]; ++k) {
        for (std::size_t j = 0; j <= counts[1]; ++j) {
            for (std::size_t i = 0; i <= counts[0]; ++i) {
                const std::array<std::size_t, 3> at{i, j, k};
                std::array<std::size_t, 3> inside = at;
                for (std::size_t a = 0; a < 3; ++a) inside[a] = std::min(at[a], grid.counts[a]);
                const Index base = point_of(inside);
                Vec3 x = mesh.points[base];
                if (inside == at) {
                    result.points.push_back(base);
                } else {
                    PaddedPoint padded{base, {base, base, base}, {}};
                    for (std::size_t a = 0; a < 3; ++a) {
                        std::array<std::size_t, 3> before = inside;
                        --before[a];
                        padded.steps[a] = static_cast<double>(at[a] - inside[a]);
                        if (at[a] != inside[a]) padded.before[a] = point_of(before);
                        x += padded.steps[a] * (mesh.points[base] - mesh.points[padded.before[a]]);
                    }
                    result.points.push_back(static_cast<Index>(mesh.points.size() + result.padded.size()));
                    result.padded.push_back(padded);
                }
                result.mesh.points.push_back(x);
            }
        }
    }
    const auto id = [&](std::size_t i, std::size_t j, std::size_t k) {
        return static_cast<Index>(i + (counts[0] + 1) * (j + (counts[1] + 1) * k));
    };
    for (std::size_t k = 0; k < counts[2]; ++k) {
        for (std::size_t j = 0; j < counts[1]; ++j) {
            for (std::size_t i = 0; i < counts[0]; ++i) {
                const bool own = i < grid.counts[0] && j < grid.counts[1] && k < grid.counts[2];
                result.cells.push_back(own ? grid.cells[i + grid.counts[0] * (j + grid.counts[1] * k)] : kNone);
                result.mesh.cells.push_back({id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k),
                                             id(i, j, k + 1), id(i + 1, j, k + 1), id(i + 1, j + 1, k + 1),
                                             id(i, j + 1, k + 1)});
            }
        }
    }
    return result;
}

/// The multiple, a power of two, to which the counts of a grid are filled up; 1 if none is worth it.
std::size_t best_multiple(const std::array<std::size_t, 3>& counts, int most) {
    std::size_t best = 1;
    for (int l = 1; l <= most; ++l) {
        const std::size_t multiple = std::size_t{1} << l;
        double part = 1;
        for (const std::size_t n : counts) {
            part *= static_cast<double>((n + multiple - 1) / multiple * multiple) / static_cast<double>(n);
        }
        if (part <= 1.5) best = multiple;
    }
    return best;
}

}  // namespace

MeshHierarchy find_hierarchy(const HexMesh& mesh, const HierarchyOptions& options) {
    if (options.levels < 1 || options.levels > 10) {
        throw Error(ErrorCode::InvalidInput, "the number of levels is " + std::to_string(options.levels), {}, "1 to 10");
    }
    validate(mesh);
    std::string why;
    MeshHierarchy found = hierarchy_of(mesh, options.levels, why);
    if (found.levels >= std::min(2, options.levels)) return found;
    if (options.pad && mesh.creases.empty() && mesh.sharp_faces.empty()) {
        if (const auto grid = structured_cells(build_topology(mesh))) {
            const std::size_t multiple = best_multiple(grid->counts, options.levels);
            if (multiple > std::size_t{1} << found.levels) {
                PaddedGrid padded = pad_grid(mesh, *grid, multiple);
                found = hierarchy_of(padded.mesh, options.levels, why);
                for (Index& p : found.points) p = padded.points[p];
                for (Index& c : found.cells) c = padded.cells[c];
                found.padded = std::move(padded.padded);
            } else if (found.levels == 0) {
                why = std::to_string(grid->counts[0]) + " × " + std::to_string(grid->counts[1]) + " × " +
                      std::to_string(grid->counts[2]) + " cells are too few to be filled up to even counts";
            }
        }
    }
    if (found.levels == 0) refuse(why);
    return found;
}

std::vector<double> in_hierarchy(const MeshHierarchy& hierarchy, std::span<const double> values, std::size_t channels) {
    const std::size_t points = channels == 0 ? 0 : values.size() / channels;
    const std::size_t added = hierarchy.padded.size();
    if (channels == 0 || values.size() % channels != 0 || points + added < hierarchy.points.size()) {
        throw Error(ErrorCode::InvalidInput, std::to_string(values.size()) + " values", "hierarchy", "those of all points");
    }
    std::vector<double> result(hierarchy.points.size() * channels);
    for (std::size_t i = 0; i < hierarchy.points.size(); ++i) {
        const Index p = hierarchy.points[i];
        for (std::size_t k = 0; k < channels; ++k) {
            double& value = result[i * channels + k];
            if (p < points) {
                value = values[p * channels + k];
                continue;
            }
            const PaddedPoint& padded = hierarchy.padded.at(p - points);
            const double base = values[padded.base * channels + k];
            value = base;
            for (std::size_t a = 0; a < 3; ++a) {
                value += padded.steps[a] * (base - values[padded.before[a] * channels + k]);
            }
        }
    }
    return result;
}

}  // namespace subvol
