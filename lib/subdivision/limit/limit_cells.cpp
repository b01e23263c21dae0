// SPDX-License-Identifier: Apache-2.0
// The limit as pieces. All cells are refined once; those that are too coarse are refined again by way of their children, and
// each child as far as it needs. Every grid of nodes goes to a PieceCutter, which keeps the pieces that are fine enough:
//
//     cells ── level 1 ──► fine enough: pieces
//                └─ others ── level 2 ──► the cell, or some of its children
//                               └─ other children ── 2, 3 … levels of the child ──► the child, or parts of it

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>
#include <vector>

#include "subvol/cell.h"
#include "subvol/detail/all_cells.h"
#include "subvol/detail/cell_refiner.h"
#include "subvol/detail/flat_array.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/node_steps.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/part_of_progress.h"
#include "subvol/detail/place_function.h"
#include "subvol/detail/refine_steps.h"
#include "subvol/detail/word_hash.h"
#include "subvol/field_range.h"
#include "subvol/limit_level.h"

namespace subvol {

using namespace detail;

namespace {

/// Pieces, as in LimitPieces, with what is left between each and the limit.
struct PieceList {
    std::vector<Index> cells;
    std::vector<std::uint8_t> levels;
    std::vector<std::array<std::uint8_t, 3>> lowest;
    std::vector<Step> left;
    std::vector<float> trilinear;  // the level whose trilinear cells are as near
    std::vector<Vec3> origins;
    FlatArray<float> nodes;
    bool has_nodes = true;  // otherwise origins and nodes are empty

    [[nodiscard]] std::size_t size() const { return cells.size(); }
    void drop_nodes();
    /// Takes back all pieces but the first ones.
    void truncate(std::size_t pieces);
};

/// Cuts a part of a control cell into pieces that are fine enough, from a grid of its nodes.
///
///     N  the 27 nodes of a part: its corners, and the middles between them
///     ●     ○     ●     ○     ●     new nodes ○ of its children are compared with the parabola through ●: if all are near
///     |     part        |           it, the part is a piece. Otherwise each child is a piece if a quarter of its own distance
///     |  child  | child |           is small enough; if it is not, its children are looked at in the same way
class PieceCutter {
public:
    /// scales:    as `value_scales`
    /// functions: there are fields that are functions
    PieceCutter(std::vector<double> scales, bool functions, const LimitCellsOptions& options);

    /// Whether a whole cell is fine enough, from its nodes of level 1, or there will be no other; if so, it is added to the
    /// list.
    bool cut_cell(const DenseCell& grid, bool last, PieceList& list);

    /// Cuts the part of level `level` at `lowest` that `grid` covers, into the list. Returns the children, bit k: child k, that
    /// need more nodes than the grid has, all eight for the part as a whole.
    ///
    /// last: there will be no finer grid: a part that needs more nodes is added with what it has
    std::uint8_t cut(const DenseCell& grid, int level, const std::array<std::uint8_t, 3>& lowest, bool last, PieceList& list);

private:
    struct Part {
        int level;
        std::array<std::uint8_t, 3> lowest;
        std::array<std::size_t, 3> first;  // node of the grid
        std::size_t width;                 // steps of the grid
    };
    [[nodiscard]] bool is_near(const Step& left, int level) const;
    void gather(const DenseCell& grid, const Part& part, std::size_t side);
    void add(const DenseCell& grid, const Part& part, const Step& left, PieceList& list);
    /// The same with the part's 27 nodes gathered. step: of their positions, from trilinear predictions
    void add_gathered(const DenseCell& grid, const Part& part, const Step& left, double step, PieceList& list);
    std::uint8_t cut_part(const DenseCell& grid, const Part& part, Step left, bool last, PieceList& list);

    std::vector<double> scales_;
    bool functions_;
    double position_, value_;
    NodeBlock nodes_;  // scratch memory
};

constexpr double kLeft = 0.25;  // the next step is this part of the last one, where the field is smooth
constexpr std::size_t kPieceNodes = 27;

/// The steps of a child's nodes, in a block of five nodes along each axis.
Step largest_in(std::size_t child, const std::vector<Step>& steps) {
    const auto& at = kCornerParameters[child];
    Step most;
    for (int w = 0; w < 3; ++w) {
        for (int v = 0; v < 3; ++v) {
            for (int u = 0; u < 3; ++u) {
                const int n = u + 2 * at[0] + 5 * (v + 2 * at[1] + 5 * (w + 2 * at[2]));
                most = larger(most, steps[static_cast<std::size_t>(n)]);
            }
        }
    }
    return most;
}

/// An estimate of the next level's step: the steps of a smooth limit shrink by four with each level.
Step quarter(const Step& step) {
    return {kLeft * step.position, kLeft * step.value};
}

void PieceList::truncate(std::size_t pieces) {
    if (pieces == size()) return;
    if (has_nodes) {
        nodes.resize(nodes.size() / size() * pieces);
        origins.resize(pieces);
    }
    cells.resize(pieces);
    levels.resize(pieces);
    lowest.resize(pieces);
    left.resize(pieces);
    trilinear.resize(pieces);
}

void PieceList::drop_nodes() {
    has_nodes = false;
    origins = {};
    nodes = {};
}

PieceCutter::PieceCutter(std::vector<double> scales, bool functions, const LimitCellsOptions& options)
    : scales_(std::move(scales)), functions_(functions), position_(options.position_world), value_(options.value_of_range) {
}

/// A function may have kinks, as a length where it is 0, or jumps. There the steps shrink by two or not at all, so that its
/// values end the search after some levels.
bool PieceCutter::is_near(const Step& left, int level) const {
    constexpr int kMostLevels = 3;
    return left.position <= position_ && (left.value <= value_ || (functions_ && level >= kMostLevels));
}

void PieceCutter::gather(const DenseCell& grid, const Part& part, std::size_t side) {
    nodes_.gather(grid, part.first, part.width / (side - 1), side);
}

void PieceCutter::add(const DenseCell& grid, const Part& part, const Step& left, PieceList& list) {
    gather(grid, part, 3);
    add_gathered(grid, part, left, nodes_.largest_step(Prediction::Trilinear, scales_).position, list);
}

void PieceCutter::add_gathered(const DenseCell& grid, const Part& part, const Step& left, double step, PieceList& list) {
    list.cells.push_back(grid.cell);
    list.levels.push_back(static_cast<std::uint8_t>(part.level));
    list.lowest.push_back(part.lowest);
    list.left.push_back(left);
    // How many levels trilinear cells would need for the same tolerance, starting from this part's own step.
    list.trilinear.push_back(static_cast<float>(std::max(0.0, part.level + levels_between(position_, step))));
    if (!list.has_nodes) return;
    // Nodes are stored in floats relative to the first one: the rounding is then relative to the size of the piece, and not to
    // its place in the world.
    list.origins.push_back(nodes_.origin());
    const std::size_t count = kPieceNodes * nodes_.channels(), first = list.nodes.size();
    list.nodes.resize(first + count);
    std::transform(nodes_.node(0), nodes_.node(0) + count, &list.nodes[first], [](double x) { return static_cast<float>(x); });
}

bool PieceCutter::cut_cell(const DenseCell& grid, bool last, PieceList& list) {
    const Part whole{.level = 0, .lowest = {}, .first = {}, .width = 2};
    gather(grid, whole, 3);
    const Step step = nodes_.largest_step(Prediction::Trilinear, scales_);
    if (!last && !is_near(quarter(step), 0)) return false;
    add_gathered(grid, whole, quarter(step), step.position, list);
    return true;
}

std::uint8_t PieceCutter::cut(const DenseCell& grid, int level, const std::array<std::uint8_t, 3>& lowest, bool last,
                              PieceList& list) {
    return cut_part(grid, {.level = level, .lowest = lowest, .first = {}, .width = grid.side - 1}, {HUGE_VAL, HUGE_VAL}, last,
                    list);
}

/// A part with at least five nodes on each axis is compared with the parabolas through every second node: their distance from
/// the other nodes bounds what a triquadratic piece leaves out. If it is too large, the children are judged. A child is near
/// enough if a quarter of the smaller of two distances is: that of its nodes from the parabolas of this part, and that of its
/// middle nodes from the means of their neighbours. Where the limit is smooth each level shortens the steps by four.
std::uint8_t PieceCutter::cut_part(const DenseCell& grid, const Part& part, Step left, bool last, PieceList& list) {
    if (part.width < 4) {
        if (last) add(grid, part, left, list);
        return last ? 0 : 0xff;
    }
    gather(grid, part, 5);
    std::vector<Step> steps;
    nodes_.steps(Prediction::Triquadratic, scales_, steps);
    Step most;
    for (const Step& step : steps) most = larger(most, step);
    // Both bounds hold, so the smaller one does.
    left = smaller(left, most);
    if (is_near(left, part.level)) {
        add(grid, part, left, list);
        return 0;
    }
    std::uint8_t open = 0;
    for (std::size_t child = 0; child < 8; ++child) {
        Part of_child{.level = part.level + 1, .lowest = {}, .first = {}, .width = part.width / 2};
        for (std::size_t d = 0; d < 3; ++d) {
            const bool upper = kCornerParameters[child][d] == 1;
            of_child.first[d] = part.first[d] + (upper ? of_child.width : 0);
            of_child.lowest[d] = static_cast<std::uint8_t>(2 * part.lowest[d] + (upper ? 1 : 0));
        }
        gather(grid, of_child, 3);
        const Step of_next = quarter(smaller(largest_in(child, steps), nodes_.largest_step(Prediction::Trilinear, scales_)));
        if (is_near(of_next, of_child.level)) {
            add(grid, of_child, of_next, list);
        } else if (cut_part(grid, of_child, of_next, last, list) != 0) {
            open |= static_cast<std::uint8_t>(1U << child);
        }
    }
    return open;
}

constexpr double kMostSurfaceCells = 3e7;  // trilinear, were all cells refined to the surface's level

/// A multiplication and a shift for each word: fast, and enough to tell that pieces belong to another mesh by mistake.
std::uint64_t mixed(std::uint64_t hash, std::uint64_t word) {
    hash = detail::hash_with(hash, word);
    return hash ^ hash >> 29;
}

std::uint64_t hash_of(const HexMesh& mesh) {
    std::uint64_t hash = mesh.cells.size();
    for (const Vec3& p : mesh.points) {
        for (int d = 0; d < 3; ++d) hash = mixed(hash, std::bit_cast<std::uint64_t>(p[d]));
    }
    for (const auto& cell : mesh.cells) {
        for (const Index p : cell) hash = mixed(hash, p);
    }
    for (const auto& crease : mesh.creases) hash = mixed(mixed(hash, crease[0]), crease[1]);
    for (const auto& face : mesh.sharp_faces) {
        for (const Index p : face) hash = mixed(hash, p);
    }
    return hash;
}

std::uint64_t hash_of(const Attribute& attribute) {
    auto hash = static_cast<std::uint64_t>(attribute.channels);
    for (const auto* numbers : {&own_values(attribute), &attribute.arguments}) {
        for (const double number : *numbers) hash = mixed(hash, std::bit_cast<std::uint64_t>(number));
    }
    return hash;
}

/// What one thread has found. Threads never share a list; the lists are merged and sorted at the end, so that the pieces do not
/// depend on which thread found them.
struct Found {
    PieceCutter cutter;
    PieceList list;
    std::size_t counted = 0;  // pieces
};

using FoundByThreads = tbb::enumerable_thread_specific<Found>;

/// How values become floats: less an origin, in a unit, for each channel; and 1/range of what results, or 0 for a constant.
struct FloatValues {
    std::vector<double> origins, units, scales;

    FloatValues(const HexMesh& mesh, std::span<const std::array<double, 2>> ranges) {
        constexpr int kPlain = 100;  // exponents of floats, with room for differences of their small parts
        for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
            const auto& [min, max] = ranges[a];
            const double origin = value_origin(min, max), most = std::max(std::abs(min - origin), std::abs(max - origin));
            const int exponent = most > 0 && std::isfinite(most) ? std::ilogb(most) : 0;
            const double unit = std::abs(exponent) > kPlain ? std::ldexp(1.0, exponent) : 1;
            const auto channels = static_cast<std::size_t>(mesh.attributes[a].channels);
            origins.insert(origins.end(), channels, origin);
            units.insert(units.end(), channels, unit);
            const double scale = value_scale(min, max);
            scales.insert(scales.end(), channels, unit == 1 ? scale : scale * unit);
        }
    }

    [[nodiscard]] bool as_they_are() const {
        return std::ranges::all_of(origins, [](double x) { return x == 0; }) &&
               std::ranges::all_of(units, [](double x) { return x == 1; });
    }

    [[nodiscard]] HexMesh stored(HexMesh mesh) const {
        std::size_t first = 0;
        for (Attribute& attribute : mesh.attributes) {
            const double origin = origins[first], unit = units[first];
            first += static_cast<std::size_t>(attribute.channels);
            if (origin == 0 && unit == 1) continue;
            change_values(attribute, [origin, unit](double value) { return (value - origin) / unit; });
            for (double& value : attribute.cells) value = (value - origin) / unit;
        }
        return mesh;
    }
};

/// A mesh as it is searched: the mesh itself where nothing differs, so that a large one is in memory once.
class SearchedMesh {
public:
    /// mesh: must be valid
    SearchedMesh(const HexMesh& mesh, const SchemeOptions& scheme, const FloatValues& floats) : mesh_(&mesh) {
        const auto used = used_points(mesh);
        const bool all_used = std::ranges::all_of(used, [](auto is_used) { return is_used != 0; });
        if (all_used && !scheme.crease_angle_deg && floats.as_they_are()) return;
        copy_ = floats.stored(control_mesh(mesh, scheme, 1));
        mesh_ = &copy_;
    }
    SearchedMesh(const SearchedMesh&) = delete;
    SearchedMesh& operator=(const SearchedMesh&) = delete;

    [[nodiscard]] const HexMesh& get() const { return *mesh_; }

private:
    const HexMesh* mesh_;
    HexMesh copy_;
};

class Search {
public:
    Search(const HexMesh& mesh, const RefineOptions& refinement, const LimitCellsOptions& options, FloatValues floats)
        : floats_(std::move(floats)),
          searched_(mesh, refinement.scheme, floats_),
          control_(searched_.get()),
          refiner_(control_, refinement.scheme, true),
          options_(options),
          found_([this] {
              return Found{PieceCutter(floats_.scales, has_functions(control_), options_), {}, 0};
          }) {
        for (const Attribute& attribute : control_.attributes) node_size_ += static_cast<std::size_t>(attribute.channels);
        result_.cell_levels.assign(control_.cells.size(), 1);
    }

    // Each callback adds the pieces that are fine enough, and returns what needs a finer grid: the cell, some children of it
    // (one bit for each), or the child.
    void run(std::span<const Index> cells, Progress* progress) {
        refiner_.descend(cells, options_.max_levels, progress,
                         {.cell =
                              [&](const DenseCell& grid) {
                                  Found& found = found_.local();
                                  const bool more = !found.cutter.cut_cell(grid, options_.max_levels == 1, found.list);
                                  spare(found);
                                  return more;
                              },
                          .whole =
                              [&](const DenseCell& grid) {
                                  Found& found = found_.local();
                                  const std::uint8_t more = found.cutter.cut(grid, 0, {}, options_.max_levels <= 2, found.list);
                                  spare(found);
                                  return more;
                              },
                          .part =
                              [&](const DenseCell& grid, std::size_t child, int levels) {
                                  Found& found = found_.local();
                                  std::array<std::uint8_t, 3> lowest;
                                  for (std::size_t d = 0; d < 3; ++d)
                                      lowest[d] = static_cast<std::uint8_t>(kCornerParameters[child][d]);
                                  const std::size_t before = found.list.size();
                                  const bool more =
                                      found.cutter.cut(grid, 1, lowest, levels + 1 >= options_.max_levels, found.list) != 0;
                                  // A child that needs a finer grid is cut anew from that, so what it has added so far is taken
                                  // back.
                                  if (more) found.list.truncate(before);
                                  spare(found);
                                  return more;
                              }});
        for (const Found& found : found_) add(found.list);
    }

    /// How fine the pieces are that were found so far.
    [[nodiscard]] LimitCells result() {
        result_.converged =
            result_.position_world <= options_.position_world && result_.value_of_range <= options_.value_of_range;
        // The level of a mesh of trilinear cells that is as near to the limit, as far as there is room for so many cells.
        while (trilinear_ > static_cast<float>(result_.level) && result_.level < options_.max_levels &&
               std::ldexp(static_cast<double>(control_.cells.size()), 3 * (result_.level + 1)) <= kMostSurfaceCells) {
            ++result_.level;
        }
        return std::move(result_);
    }

    /// Whether the pieces are few enough to be kept.
    [[nodiscard]] bool has_pieces() const { return (before_ + pieces_) * bytes_of_piece() <= options_.max_bytes; }

    /// Collects the pieces of the cells that were run last, in the order of the cells, behind the first ones of others.
    void collect(LimitPieces& pieces, std::size_t first = 0) {
        const std::vector<Place> places = sorted_places();
        const std::size_t count = first + places.size();
        pieces.cells.resize(count);
        pieces.levels.resize(count);
        pieces.lowest.resize(count);
        pieces.hull_sides.resize(count);
        pieces.origins.resize(count);
        pieces.node_size = node_size_;
        const std::size_t numbers = LimitPieces::kNodes * node_size_;
        pieces.nodes.resize(numbers * count);
        parallel_each(places.size(), [&](std::size_t p) {
            const Place& place = places[p];
            const PieceList& from = *place.list;
            const std::size_t i = first + p;
            pieces.cells[i] = place.cell;
            pieces.levels[i] = place.level;
            pieces.lowest[i] = place.lowest;
            pieces.hull_sides[i] = hull_sides(place);
            pieces.origins[i] = from.origins[place.number];
            std::copy_n(&from.nodes[numbers * place.number], numbers, &pieces.nodes[numbers * i]);
        });
        pieces.value_origins = floats_.origins;
        pieces.value_units = floats_.units;
    }

    /// Makes room for so many pieces in each list. What a thread does not find takes no memory, as it is never touched.
    void reserve(std::size_t pieces) {
        found_ = FoundByThreads([this, pieces] {
            Found found{PieceCutter(floats_.scales, has_functions(control_), options_), {}, 0};
            found.list.nodes.reserve(pieces * LimitPieces::kNodes * node_size_);
            return found;
        });
    }

    /// Forgets the pieces of the cells that were run last, and keeps their memory for the next ones.
    void clear() {
        before_ += pieces_;
        pieces_ = 0;
        for (Found& found : found_) {
            found.list.truncate(0);
            found.counted = 0;
        }
    }

private:
    /// Where a piece lies, and where its nodes are. Places are sorted and not pieces, so that the nodes are copied only once,
    /// to where they belong.
    struct Place {
        Index cell;
        std::uint8_t level;
        std::array<std::uint8_t, 3> lowest;
        std::uint32_t number;
        const PieceList* list;
    };

    [[nodiscard]] std::size_t bytes_of_piece() const { return sizeof(Vec3) + LimitPieces::kNodes * node_size_ * sizeof(float); }

    /// Drops the nodes of pieces when there are too many to be kept.
    void spare(Found& found) {
        const std::size_t more = found.list.size() - found.counted;
        found.counted = found.list.size();
        if (((pieces_ += more) + before_) * bytes_of_piece() > options_.max_bytes && found.list.has_nodes)
            found.list.drop_nodes();
    }

    /// Takes how fine the pieces of a list are into account.
    void add(const PieceList& list) {
        for (std::size_t i = 0; i < list.size(); ++i) {
            auto& level = result_.cell_levels[list.cells[i]];
            level = std::max(level, static_cast<std::uint8_t>(list.levels[i] + 1));
            result_.position_world = std::max(result_.position_world, list.left[i].position);
            result_.value_of_range = std::max(result_.value_of_range, list.left[i].value);
            trilinear_ = std::max(trilinear_, list.trilinear[i]);
        }
        result_.piece_count += list.size();
    }

    [[nodiscard]] std::vector<Place> sorted_places() const {
        std::vector<Place> places;
        places.reserve(pieces_);
        for (const Found& found : found_) {
            const PieceList& list = found.list;
            for (std::size_t i = 0; i < list.size(); ++i) {
                places.push_back({list.cells[i], list.levels[i], list.lowest[i], static_cast<std::uint32_t>(i), &list});
            }
        }
        tbb::parallel_sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
            return std::tie(a.cell, a.level, a.lowest) < std::tie(b.cell, b.level, b.lowest);
        });
        return places;
    }

    [[nodiscard]] std::uint8_t hull_sides(const Place& place) const {
        const auto& neighbors = refiner_.links().neighbors[place.cell];
        const int last = (1 << place.level) - 1;
        unsigned sides = 0;
        for (std::size_t d = 0; d < 3; ++d) {
            if (place.lowest[d] == 0 && neighbors[2 * d] == kNone) sides |= 1U << (2 * d);
            if (place.lowest[d] == last && neighbors[2 * d + 1] == kNone) sides |= 2U << (2 * d);
        }
        return static_cast<std::uint8_t>(sides);
    }

    FloatValues floats_;
    SearchedMesh searched_;
    const HexMesh& control_;
    CellRefiner refiner_;
    const LimitCellsOptions& options_;
    std::size_t node_size_ = 3;
    std::atomic<std::size_t> pieces_{0};
    std::size_t before_ = 0;  // pieces that were forgotten
    FoundByThreads found_;
    LimitCells result_;
    float trilinear_ = 0;
};

/// What the pieces belong to.
void set_owner(const HexMesh& mesh, LimitPieces& pieces) {
    pieces.mesh_hash = hash_of(mesh);
    for (const Attribute& attribute : mesh.attributes) {
        pieces.names.push_back(attribute.name);
        pieces.channels.push_back(attribute.channels);
        pieces.attribute_hashes.push_back(hash_of(attribute));
    }
}

/// The cells of a mesh in some runs, so that what is found is in memory twice for one of them only.
std::size_t cells_of_run(std::size_t cells, std::size_t runs) {
    return (cells / runs / CellRefiner::kRun + 1) * CellRefiner::kRun;
}

/// cells:  ascending
/// ranges: of the attributes
LimitCells search(const HexMesh& mesh, std::span<const Index> cells, RefineOptions refinement, const LimitCellsOptions& options,
                  std::span<const std::array<double, 2>> ranges) {
    const std::size_t count = cells.size();
    if (count == 0 || options.max_levels < 1) {
        return {.cell_levels = {}, .converged = count == 0};
    }
    refinement.levels = 1;
    Search search(mesh, refinement, options, FloatValues(mesh, ranges));
    constexpr std::size_t kRuns = 8;
    const std::size_t size = cells_of_run(count, kRuns);
    auto pieces = std::make_shared<LimitPieces>();
    for (std::size_t first = 0; first < count; first += size) {
        PartOfProgress of_run(refinement.progress, "limit", first / size, (count + size - 1) / size);
        search.run(cells.subspan(first, std::min(size, count - first)), &of_run);
        if (!search.has_pieces()) pieces.reset();
        if (pieces) search.collect(*pieces, pieces->cells.size());
        search.clear();
    }
    LimitCells found = search.result();
    if (pieces) set_owner(mesh, *pieces);
    found.pieces = std::move(pieces);
    return found;
}

}  // namespace

LimitCells find_limit_cells(const HexMesh& mesh, RefineOptions refinement, const LimitCellsOptions& options) {
    if (mesh.cells.empty() || options.max_levels < 1) return {.cell_levels = {}, .converged = mesh.cells.empty()};
    validate(mesh);  // before its ranges are taken
    return search(mesh, all_cells(mesh), refinement, options, limit_extent(mesh).ranges);
}

LimitCells detail::find_limit_cells(const HexMesh& part, std::span<const Index> cells, RefineOptions refinement,
                                    const LimitCellsOptions& options, std::span<const std::array<double, 2>> ranges) {
    validate(part);
    return search(part, cells, refinement, options, ranges);
}

LimitCells visit_limit_pieces(const HexMesh& mesh, RefineOptions refinement, const LimitCellsOptions& options,
                              const std::function<void(const LimitPieces&)>& take) {
    constexpr std::size_t kParts = 16, kMost = std::size_t{1} << 19;
    if (mesh.cells.empty() || options.max_levels < 1) return find_limit_cells(mesh, refinement, options);
    validate(mesh);
    refinement.levels = 1;
    LimitCellsOptions without_limit = options;
    without_limit.max_bytes = std::numeric_limits<std::size_t>::max();
    Search search(mesh, refinement, without_limit, FloatValues(mesh, limit_extent(mesh).ranges));
    const std::vector<Index> cells = all_cells(mesh);
    const std::size_t size = std::min(cells_of_run(cells.size(), kParts), kMost);
    search.reserve(std::min(size, cells.size()));
    LimitPieces pieces;
    for (std::size_t first = 0; first < cells.size(); first += size) {
        search.run(std::span(cells).subspan(first, std::min(size, cells.size() - first)), nullptr);
        search.collect(pieces);
        search.clear();
        take(pieces);
    }
    return search.result();
}

bool are_pieces_of(const LimitPieces& pieces, const HexMesh& mesh) {
    return pieces.mesh_hash == hash_of(mesh);
}

std::optional<std::size_t> place_in(const LimitPieces& pieces, const Attribute& attribute) {
    std::size_t first = 3;
    for (std::size_t a = 0; a < pieces.names.size(); ++a) {
        if (pieces.names[a] == attribute.name && pieces.attribute_hashes[a] == hash_of(attribute)) return first;
        first += static_cast<std::size_t>(pieces.channels[a]);
    }
    return {};
}

int finest_level(const LimitCells& limit) {
    int levels = limit.level;
    for (const int level : limit.cell_levels) levels = std::max(levels, level);
    return levels;
}

LimitCells limit_for_voxels(const HexMesh& mesh, const RefineOptions& refinement, double voxel_world) {
    return find_limit_cells(mesh, refinement, {.position_world = kLimitTolerance_voxels * voxel_world});
}

}  // namespace subvol
