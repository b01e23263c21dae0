// SPDX-License-Identifier: Apache-2.0
// What readers of all formats share on the way from a file to cells, and the options by which meshes are read. A point that is
// not finite is kept with its place in the file: it is an error only if a cell uses it. A structured grid of i × j × k points,
// i fastest, becomes (i − 1)(j − 1)(k − 1) hexahedra; products of sizes stop at the largest index, so that sizes of a hostile
// file do not overflow. Quads and lines that are faces or edges of hexahedra are parts of these and no shells: they are sorted
// by their points, and each face and edge of a cell is looked up among them. Names that several arrays have are made
// different, blocks are chosen by name without regard to case if no name is equal, and the last step is read unless one is
// chosen.
#include "mesh_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh_format.h"
#include "sharp_groups.h"
#include "subvol/cell.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/index.h"
#include "subvol/option.h"

namespace subvol::detail {

namespace {

template <std::size_t N, std::size_t Parts>
std::vector<std::uint8_t> are_parts(std::span<const std::array<Index, N>> items, std::span<const std::array<Index, 8>> hexes,
                                    std::size_t points, const std::array<std::array<std::size_t, N>, Parts>& parts) {
    using Item = std::pair<std::array<Index, N>, std::size_t>;
    std::vector<Item> sorted;
    std::vector<std::uint8_t> used(points, 0), found(items.size(), 0);
    for (std::size_t i = 0; i < items.size(); ++i) {
        sorted.emplace_back(items[i], i);
        std::sort(sorted.back().first.begin(), sorted.back().first.end());
        for (const Index p : items[i]) used[p] = 1;
    }
    if (items.empty()) return found;
    std::sort(sorted.begin(), sorted.end());
    for (const auto& hex : hexes) {
        for (const auto& part : parts) {
            std::array<Index, N> key;
            bool all = true;
            for (std::size_t k = 0; k < N; ++k) {
                key[k] = hex[part[k]];
                all = all && used[key[k]] != 0;
            }
            if (!all) continue;
            std::sort(key.begin(), key.end());
            auto at = std::lower_bound(sorted.begin(), sorted.end(), Item{key, 0});
            for (; at != sorted.end() && at->first == key; ++at) found[at->second] = 1;
        }
    }
    return found;
}

// A flag for each quad: whether it is a face of one of the hexahedra; for each line: whether it is an edge of one.
//
// points: how many there are
// cost:   O(n log n) in the quads or lines, and a pass over the hexahedra
std::vector<std::uint8_t> are_faces(std::span<const std::array<Index, 4>> quads, std::span<const std::array<Index, 8>> hexes,
                                    std::size_t points) {
    return are_parts(quads, hexes, points, kCellFaces);
}

std::vector<std::uint8_t> are_edges(std::span<const std::array<Index, 2>> lines, std::span<const std::array<Index, 8>> hexes,
                                    std::size_t points) {
    return are_parts(lines, hexes, points, kCellEdges);
}

std::size_t product(const std::array<std::size_t, 3>& factors) {
    std::size_t result = 1;
    for (const std::size_t factor : factors) {
        if (factor == 0) return 0;
    }
    for (const std::size_t factor : factors) {
        if (factor >= kNone / result) return kNone;
        result *= factor;
    }
    return result;
}

std::array<std::size_t, 3> cells_along(const StructuredGrid& grid) {
    std::array<std::size_t, 3> cells{};
    for (std::size_t a = 0; a < 3; ++a) cells[a] = grid.points[a] == 0 ? 0 : grid.points[a] - 1;
    return cells;
}

}  // namespace

void add_point(MeshFile& file, const Vec3& point, std::size_t position) {
    if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) {
        file.not_finite.push_back({file.points.size(), position});
    }
    file.points.push_back(point);
}

std::string ignored_text(const IgnoredPart& part) {
    return part.kind + (part.name.empty() ? "" : " " + in_quotes(part.name)) + " ignored" +
           (part.reason.empty() ? "" : ": " + part.reason);
}

void MeshFile::ignore(IgnoredPart part) {
    warnings.push_back(ignored_text(part));
    ignored.push_back(std::move(part));
}

std::string elements_of_type(const IgnoredPart& type) {
    return counted(type.count, "element", "elements") + " of type " + printable(type.name);
}

void add_left_out_warning(MeshFile& found, const std::vector<IgnoredPart>& types, std::optional<std::string_view> file,
                          const std::function<std::string(const IgnoredPart&)>& text) {
    bool has_cells = !found.quads.corners.empty() || !found.lines.corners.empty();  // shells that are wanted
    each_kind(found, [&](const auto& cells) { has_cells = has_cells || !cells.corners.empty(); });
    std::string list;
    for (const IgnoredPart& type : types) list += (list.empty() ? "" : ", ") + text(type);
    if (!has_cells && file) {
        throw Error(ErrorCode::InvalidInput, "no hexahedra" + (list.empty() ? "" : ", but " + list + ", which are ignored"),
                    std::string(*file));
    }
    if (!list.empty()) found.warnings.push_back(list + " ignored");
    found.ignored.insert(found.ignored.end(), types.begin(), types.end());
}

std::array<std::size_t, 2> drop_parts_of_cells(MeshFile& found, bool alone) {
    if (found.quads.corners.empty() && found.lines.corners.empty()) return {0, 0};
    const bool others = !found.tets.corners.empty() || !found.prisms.corners.empty() || !found.pyramids.corners.empty();
    if (others || found.curved.size() > 0 || (found.hexes.corners.empty() && !alone)) {
        const std::array all{found.quads.corners.size(), found.lines.corners.size()};
        found.quads = {};
        found.lines = {};
        return all;
    }
    const std::size_t points = found.points.size();
    const auto of_cells = [](auto& cells, const std::vector<std::uint8_t>& flags) {
        return drop_where(cells, [&](std::size_t c) { return flags[c] != 0; });
    };
    return {of_cells(found.quads, are_faces(found.quads.corners, found.hexes.corners, points)),
            of_cells(found.lines, are_edges(found.lines.corners, found.hexes.corners, points))};
}

const FileArray* find_array(const MeshFile& found, std::string_view name, bool at_cells, int components) {
    const auto place = std::ranges::find_if(found.arrays, [&](const FileArray& array) {
        return array.name == name && array.at_cells == at_cells && array.components == components;
    });
    return place == found.arrays.end() ? nullptr : &*place;
}

std::vector<std::uint8_t> used_points(const MeshFile& found) {
    std::vector<std::uint8_t> used(found.points.size());
    each_kind(found, [&](const auto& cells) {
        for (const auto& cell : cells.corners) {
            for (const Index p : cell) used[p] = 1;
        }
    });
    for (const Index p : found.curved.nodes) used[p] = 1;
    return used;
}

std::size_t StructuredGrid::point_count() const {
    return product(points);
}

std::size_t StructuredGrid::cell_count() const {
    return product(cells_along(*this));
}

std::string size_text(const StructuredGrid& grid) {
    const auto& [i, j, k] = grid.points;
    return std::to_string(i) + " x " + std::to_string(j) + " x " + std::to_string(k) + " points";
}

std::size_t most_points(std::size_t values) {
    constexpr std::size_t kFew = 1 << 16;
    return kFew + values;
}

void add_points(MeshFile& into, const std::array<std::vector<double>, 3>& at, std::size_t position) {
    for (const double z : at[2]) {
        for (const double y : at[1]) {
            for (const double x : at[0]) add_point(into, {x, y, z}, position);
        }
    }
}

void add_hexes(MeshFile& into, const StructuredGrid& grid, std::size_t first_point, std::size_t first_cell) {
    const auto cells = cells_along(grid);
    const std::size_t row = grid.points[0], layer = grid.points[0] * grid.points[1];
    std::size_t number = first_cell;
    for (std::size_t k = 0; k < cells[2]; ++k) {
        for (std::size_t j = 0; j < cells[1]; ++j) {
            for (std::size_t i = 0; i < cells[0]; ++i) {
                const std::size_t p = first_point + i + j * row + k * layer;
                auto& corners = into.hexes.corners.emplace_back();
                const std::array<std::size_t, 4> bottom{p, p + 1, p + 1 + row, p + row};
                for (std::size_t c = 0; c < 4; ++c) {
                    corners[c] = static_cast<Index>(bottom[c]);
                    corners[c + 4] = static_cast<Index>(bottom[c] + layer);
                }
                into.hexes.numbers.push_back(static_cast<Index>(number++));
            }
        }
    }
}

void LeftOut::report(std::string_view one, std::string_view many, std::vector<std::string>& warnings,
                     std::vector<IgnoredPart>& ignored) const {
    if (parts_.empty()) return;
    constexpr std::size_t kNamed = 6;
    std::string names;
    for (std::size_t k = 0; k < std::min(kNamed, parts_.size()); ++k) names += (k == 0 ? "" : ", ") + in_quotes(parts_[k].name);
    if (parts_.size() > kNamed) names += ", …";
    warnings.push_back((parts_.size() == 1 ? std::string(one) + " " + names + " left out: "
                                           : counted(parts_.size(), one, many) + " left out (" + names + "): ") +
                       parts_.front().reason);
    for (IgnoredPart part : parts_) {
        part.kind = one;
        ignored.push_back(std::move(part));
    }
}

std::string NamesApart::take(const std::string& name) {
    const std::string wanted = name.empty() ? "unnamed" : name;
    std::string taken = distinct_.take(wanted);
    if (taken == wanted) return taken;
    const auto [at, is_new] = places_.try_emplace(wanted, repeated_.size());
    if (is_new) repeated_.push_back({wanted, taken, {}, 0});
    Repeated& repeated = repeated_[at->second];
    repeated.last = taken;
    ++repeated.others;
    return taken;
}

void NamesApart::report(std::vector<std::string>& warnings) const {
    constexpr std::size_t kNamed = 6;
    for (std::size_t k = 0; k < std::min(kNamed, repeated_.size()); ++k) {
        const Repeated& one = repeated_[k];
        warnings.push_back("there is more than one " + thing_ + " " + in_quotes(one.name) + ": " +
                           (one.others > 1 ? std::to_string(one.others) + " others are called " : "another is called ") +
                           in_quotes(one.first) + (one.others > 1 ? " to " + in_quotes(one.last) : ""));
    }
    if (repeated_.size() > kNamed) {
        warnings.push_back(std::to_string(repeated_.size() - kNamed) + " more names are those of more than one " + thing_);
    }
}

BlockChoice::BlockChoice(std::span<const std::string> wanted, const std::vector<std::string>& there, std::string_view file) {
    for (const std::string& name : wanted) {
        const auto same = [&](const std::string& other) { return upper_case(other) == upper_case(name); };
        if (std::ranges::find(there, name) != there.end()) {
            wanted_.insert(name);
            continue;
        }
        if (std::ranges::any_of(there, same)) {
            std::ranges::copy_if(there, std::inserter(wanted_, wanted_.end()), same);
            continue;
        }
        throw Error(ErrorCode::InvalidInput, "there is no block " + in_quotes(name), std::string(file),
                    there.empty() ? "it has none" : "it has: " + listed(there));
    }
}

std::size_t chosen_step(const ReadOptions& options, std::size_t steps, std::string_view file,
                        std::vector<std::string>& warnings) {
    if (!options.step) {
        if (steps > 1) warnings.push_back("the file has " + std::to_string(steps) + " steps; the last one is read");
        return steps - 1;
    }
    if (*options.step < steps) return *options.step;
    throw Error(ErrorCode::InvalidInput, "there is no step " + std::to_string(*options.step), std::string(file),
                steps == 1 ? "it has one step, number 0" : "steps are 0 to " + std::to_string(steps - 1));
}

void order_symmetric(std::vector<double>& values, const std::array<std::size_t, 6>& places) {
    std::array<double, 6> given{};
    for (auto tensor = values.begin(); values.end() - tensor >= 6; tensor += 6) {
        std::copy_n(tensor, given.size(), given.begin());
        for (std::size_t k = 0; k < given.size(); ++k) tensor[static_cast<std::ptrdiff_t>(k)] = given[places[k]];
    }
}

void warn_of_lost_fields(std::string_view extension, std::span<const Attribute> fields, std::vector<std::string>& warnings) {
    std::vector<std::string> names;
    for (const Attribute& field : fields) names.push_back(in_quotes(field.name));
    if (!names.empty())
        warnings.push_back(std::string(extension) + " cannot hold attributes: " + listed(names) + " not written");
}

void warn_of_lost_creases(std::string_view extension, const HexMesh& mesh, std::vector<std::string>& warnings) {
    if (mesh.creases.empty() && mesh.sharp_faces.empty()) return;
    warnings.push_back(sharp_counts(mesh) + " not written: " + std::string(extension) + " files do not have them");
}

}  // namespace subvol::detail

namespace subvol {

namespace {

constexpr const char* kCorners = "corners";

constexpr const char* kAutoAngle = "auto";
constexpr const char* kNoAngle = "none";

/// Nothing is "auto", 0 is "none".
WordValue crease_value(std::optional<double>& angle) {
    return {.get =
                [&angle] {
                    return !angle ? std::string(kAutoAngle) : *angle == 0 ? std::string(kNoAngle) : detail::exact_text(*angle);
                },
            .set =
                [&angle](const std::string& text, const std::string& where) {
                    if (text == kAutoAngle) {
                        angle.reset();
                        return;
                    }
                    double degrees = 0;
                    if (text != kNoAngle) {
                        try {
                            Option("crease-angle", degrees).between(0, 180).read(text, where);
                        } catch (const Error& error) {
                            throw Error(error.code(), error.message(), error.where(), error.allowed() + ", auto or none");
                        }
                    }
                    angle = degrees;
                },
            .numbers = true};
}

/// The word "corners" stands for no tolerance.
WordValue curved_value(std::optional<double>& tolerance) {
    return {.get = [&tolerance] { return tolerance ? detail::exact_text(*tolerance) : std::string(kCorners); },
            .set =
                [&tolerance](const std::string& text, const std::string& where) {
                    if (text == kCorners) {
                        tolerance.reset();
                        return;
                    }
                    double part = 0;
                    try {
                        Option("curved", part).positive().read(text, where);
                    } catch (const Error& error) {
                        throw Error(error.code(), error.message(), error.where(), error.allowed() + ", or corners");
                    }
                    tolerance = part;
                },
            .numbers = true};
}

}  // namespace

std::vector<Option> options_of(ReadOptions& options) {
    constexpr double kMostSteps = 1e9;
    return {
        Option("other-cells", options.other_cells)
            .help("WHAT", "what to do with tetrahedra, prisms and pyramids: split (all cells, into hexahedra), ignore, refuse"),
        Option("weld-distance", options.weld)
            .called("weld")
            .not_negative()
            .help("D", "join points of a file whose distance is at most D; 0: those at the same place"),
        Option("curved", curved_value(options.curved_tolerance))
            .also("curved-tolerance")
            .offer({kCorners})
            .help(
                "T|corners",
                "split curved hexahedra into smaller ones, to within this part T of the mesh's size from their true shape, and "
                "400 T of the fields' ranges; corners: use nothing but their corners"),
        Option("cell-values", options.cell_values)
            .help("HOW",
                  "what values at cells are: fit (the volume follows the cells' means without waves; the default for "
                  "OpenFOAM), mean (values at points, of the cells around each; the default for all others), exact (the volume "
                  "has the cells' means), constant (as they are, in each cell; the default for integers, such as materials), "
                  "auto"),
        Option("patch-values", options.patch_values)
            .help("HOW",
                  "what OpenFOAM has on patches of the boundary: normal (points there get it, but of vectors at walls only the "
                  "component along the normal: integrals over the volume hardly change; not with --cell-values exact), meet "
                  "(vectors at walls get all of it, such as a velocity of 0), ignore"),
        Option("step", options.step).between(0, kMostSteps).help("N", "a step of a series, from 0 (default: the last one)"),
        Option("time", options.time).help("T", "the step of a series whose time is nearest to this").instead_of({"step"}),
        Option("blocks", options.blocks)
            .with_commas()
            .help("A,B", "the named parts of the mesh to read (info lists them; default: all)"),
        Option("sharp", options.sharp)
            .help("NAME",
                  "a group of the file whose faces inside the mesh and edges are kept sharp: a physical group of Gmsh by "
                  "its name or number, a reference of MEDIT, or Ridges (repeatable)"),
        Option("mesh", options.deck)
            .help("DECK.inp",
                  "of a .frd file of CalculiX, the deck that it has the results of: its sets of elements and surfaces become "
                  "sets and patches"),
        Option("crease-angle", crease_value(options.crease_angle_deg))
            .offer({kAutoAngle, kNoAngle})
            .help(
                "DEG|none",
                "keep boundary edges sharp that bend by more than this, in degrees; none: none; auto: those that bend by more "
                "than 40, and on round bodies of few cells by more than 60, unless the file has creases")};
}

}  // namespace subvol
