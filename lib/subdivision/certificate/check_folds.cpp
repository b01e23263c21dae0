// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "edge_window.h"
#include "fold_checker.h"
#include "link_kind.h"
#include "moving_part.h"
#include "point_window.h"
#include "segment_rules.h"
#include "subvol/cell.h"
#include "subvol/certificate.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/regular_grid.h"
#include "subvol/error.h"
#include "subvol/limit.h"
#include "subvol/option.h"
#include "subvol/refine.h"
#include "subvol/topology.h"

// A cell whose surroundings are a grid is tested, cut into eight parts where that does not decide, and so on. Around an
// irregular edge the rules of the grid do not hold, but most children of the cells there are in a grid again:
//
//      ┌───┬───┬───────┐      refined with the cells around them, cells at irregular edges leave
//      │ × │ × │       │      those of their children open that touch the edge, or are one further:
//      ├───╋───┤       │      a tube whose volume is a quarter after each level.
//      │ × │ × │       │
//      └───┴───┴───────┘

namespace subvol {

namespace detail {

namespace {

double volume_of(const PartFrame& frame) {
    return frame.size * frame.size * frame.size;
}

double largest_coordinate(const HexMesh& mesh) {
    double largest = 0;
    for (const Vec3& x : mesh.points) largest = std::max({largest, std::abs(x.x), std::abs(x.y), std::abs(x.z)});
    for (const Attribute& motion : mesh.attributes) {
        for (const double x : motion.values) largest = std::max(largest, std::abs(x));
    }
    return largest;
}

// What is irregular at the corners of a cell.
UndecidedKind kind_of_cell(const Topology& topology, Index cell) {
    constexpr std::size_t kMostCells = 8;
    bool sharp = false, boundary = false, crowded = false, point = false, edge = false;
    for (const Index p : topology.cells[cell]) {
        std::size_t irregular = 0;
        for (const Index e : topology.point_edges[p]) {
            const std::size_t cells = topology.edge_cells[e].size();
            for (const Index f : topology.edge_faces[e]) {
                sharp = sharp || (topology.face_on_boundary(f) && !topology.face_on_hull(f));
            }
            boundary = boundary ||
                       (topology.edge_on_boundary[e] != 0 && (cells > 2 || (cells == 2 && topology.edge_is_crease[e] != 0)));
            if (topology.edge_on_boundary[e] != 0 || (topology.edge_has_ring[e] != 0 && cells == 4)) continue;
            crowded = crowded || topology.edge_has_ring[e] == 0 || cells > kMostCells;
            ++irregular;
        }
        edge = edge || irregular > 0;
        point = point || (irregular > 0 && (irregular != 2 || topology.point_on_boundary[p] != 0));
    }
    return sharp      ? UndecidedKind::SharpFace
           : boundary ? UndecidedKind::BoundaryEdge
           : crowded  ? UndecidedKind::CrowdedEdge
           : point    ? UndecidedKind::IrregularPoint
           : edge     ? UndecidedKind::IrregularEdge
                      : UndecidedKind::Regular;
}

FoldPlace fold_at(const Vec3& place, const PartDecision& decision, const PartFrame& frame) {
    return {0, place, {}, decision.determinant / volume_of(frame)};
}

}  // namespace

/// What became of a part of a cell. open: its volume that is left, in cells
struct FoldChecker::PartResult {
    std::optional<FoldPlace> fold;
    double open = 0;
    std::size_t tests = 0;
    int deepest = 0;
    bool moves = false;  ///< it may be proved for shorter times
};

/// limits of the search in a part. error: of the points' coordinates; halvings: how often the time may yet be
/// halved, to which what moves much is left
struct FoldChecker::Limits {
    int levels;
    std::size_t tests;
    double error;
    FoldEffort effort;
    int halvings = 0;
};

// Level by level, so that large folds are found before small parts are proved.
template <class Part>
FoldChecker::PartResult FoldChecker::decide_part(Part part, const Limits& limits) {
    PartResult result;
    const double whole = volume_of(part.frame());
    if (limits.effort == FoldEffort::Witness) {
        result.open = whole;
        // Derivatives by the part's parameters change twice as much with points of children as those of the children.
        const PartDecision decision =
            limits.levels > 0 ? witness(part.corners_of_children(), 2 * limits.error) : witness(part.corners(), limits.error);
        if (decision.verdict == PartVerdict::Folded) {
            const PartFrame& at = part.frame();
            result.fold =
                fold_at(limits.levels > 0 ? at.corner_of_child(decision.place) : at.corner(decision.place), decision, at);
        }
        return result;
    }
    const bool in_haste = limits.effort == FoldEffort::Verdict;
    std::vector<Part> open;
    open.push_back(std::move(part));
    for (int level = 0; !open.empty(); ++level) {
        std::vector<Part> next;
        for (std::size_t k = 0; k < open.size(); ++k) {
            const Part& at = open[k];
            if (in_haste && result.tests + (open.size() - k) + next.size() > limits.tests) {
                result.open = whole;
                return result;
            }
            if (result.tests == limits.tests) {
                result.open += volume_of(at.frame());
                continue;
            }
            ++result.tests;
            result.deepest = level;
            const PartDecision decision = decide(at, limits.error);
            if (decision.verdict == PartVerdict::Folded) {
                result.fold = fold_at(at.frame().corner(decision.place), decision, at.frame());
                return result;
            }
            if (decision.verdict == PartVerdict::Proved) continue;
            if constexpr (requires { at.norm_of_motion(); }) {
                constexpr double kMuch = 0.25, kLittle = 0.02;
                const double motion = limits.halvings > 0 ? at.norm_of_motion() : 0;
                result.moves = result.moves || motion > kMuch || (level == limits.levels && motion > kLittle);
                if (motion > kMuch) {
                    result.open = whole;
                    return result;
                }
            }
            if (level == limits.levels) {
                result.open += volume_of(at.frame());
                if (in_haste) return result;
            } else {
                std::ranges::move(at.children(), std::back_inserter(next));
            }
        }
        open = std::move(next);
    }
    return result;
}

/// The cells of a level whose surroundings are grids.
class FoldChecker::Grids {
public:
    Grids(const HexMesh& mesh, Scheme scheme) : mesh_(mesh), scheme_(scheme) {
        if (scheme_ == Scheme::Linear) return;
        topology_ = build_topology(mesh);
        is_grid_.resize(mesh.points.size());
        points_.assign(mesh.points.size(), kUnknown);
        segments_.assign(topology_.edges.size(), kUnknown);
        parallel_each(is_grid_.size(), [&](std::size_t p) { is_grid_[p] = is_grid_point(topology_, static_cast<Index>(p)); });
    }

    /// Decides a cell of the level; nothing if it has no grid.
    [[nodiscard]] std::optional<PartResult> decide(Index cell, const PartFrame& frame, const Limits& limits) const {
        if (scheme_ == Scheme::Linear) {
            const auto corners_of = [&](const auto& place_of) {
                std::array<Vec3, 8> corners;
                for (std::size_t k = 0; k < 8; ++k) corners[k] = place_of(mesh_.cells[cell][k]);
                return corners;
            };
            if (passes_at_once(
                    cell, [&](const auto& place_of) { return slopes_of(corners_of(place_of)); }, limits))
                return passed();
            return decide_parts(
                cell, [&](const auto& place_of) { return PolynomialPart::trilinear(corners_of(place_of), frame); }, limits);
        }
        return scheme_ == Scheme::Mcq ? decide_window(cell, frame, limits) : decide_spline(cell, frame, limits);
    }

    /// Whether a cell that is not decided may be for shorter times.
    [[nodiscard]] bool is_open_for_motion(Index cell) const {
        if (!moves() || scheme_ == Scheme::Linear) return false;
        const std::optional<Index> edge = irregular_edge(topology_, cell);
        return (edge && segments_[*edge] == kMoves) ||
               std::ranges::any_of(topology_.cells[cell], [&](Index p) { return points_[p] == kMoves; });
    }

private:
    // About the cell's first corner: differences of near coordinates are exact, or nearly so.
    [[nodiscard]] Vec3 place(Index cell, Index point) const { return mesh_.points[point] - mesh_.points[mesh_.cells[cell][0]]; }

    [[nodiscard]] bool moves() const { return !mesh_.attributes.empty(); }
    [[nodiscard]] Vec3 motion_of(Index cell, Index point) const { return motion_at(point) - motion_at(mesh_.cells[cell][0]); }
    [[nodiscard]] Vec3 motion_at(std::size_t p) const {
        const std::vector<double>& all = mesh_.attributes[0].values;
        return {all[3 * p], all[3 * p + 1], all[3 * p + 2]};
    }

    // part_of: the part that the places of its points give, which are returned by a function
    template <class PartOf>
    [[nodiscard]] PartResult decide_parts(Index cell, const PartOf& part_of, const Limits& limits) const {
        auto middle = part_of([&](Index p) { return place(cell, p); });
        if (!moves()) return decide_part(std::move(middle), limits);
        return decide_part(MovingPart(std::move(middle), part_of([&](Index p) { return motion_of(cell, p); })), limits);
    }

    [[nodiscard]] static PartResult passed() { return {.fold = {}, .tests = 1}; }

    // Most cells that do not move pass one test. slopes_at: the derivatives that the places of the points give
    template <class SlopesOf>
    [[nodiscard]] bool passes_at_once(Index cell, const SlopesOf& slopes_at, const Limits& limits) const {
        if (moves() || limits.effort == FoldEffort::Witness || limits.tests == 0) return false;
        return passes_norm(slopes_at([&](Index p) { return place(cell, p); }), limits.error);
    }

    // proves(time): whether a window is proved if it moves for that part of the time
    template <class Proves>
    [[nodiscard]] std::uint8_t state_of(const Limits& limits, const Proves& proves) const {
        if (proves(1.0)) return kProved;
        return moves() && limits.halvings > 0 && proves(std::ldexp(1.0, -limits.halvings)) ? kMoves : kOther;
    }

    [[nodiscard]] std::optional<PartResult> decide_window(Index cell, const PartFrame& frame, const Limits& limits) const {
        WidePoints grid;
        if (!wide_grid(topology_, is_grid_, cell, grid)) return std::nullopt;
        // Layers that are there, along the lines through the cell's first corner.
        BoxType type;
        std::array<std::size_t, 3> low{};
        constexpr std::array<std::size_t, 3> kStrides{1, 6, 36};
        constexpr std::size_t kCorner = 2 * (1 + 6 + 36);
        for (std::size_t a = 0; a < 3; ++a) {
            const auto is_there = [&](std::size_t layer) {
                return grid[kCorner + layer * kStrides[a] - 2 * kStrides[a]] != kNone;
            };
            type[a].low = static_cast<std::uint8_t>(is_there(0) ? 2 : is_there(1) ? 1 : 0);
            type[a].high = static_cast<std::uint8_t>(is_there(5) ? 2 : is_there(4) ? 1 : 0);
            low[a] = std::size_t{2} - type[a].low;
        }
        if (!has_bounds(type)) return std::nullopt;
        const auto part_of = [&](const auto& place_of) {
            std::vector<Vec3> points;
            points.reserve(window_points(type));
            for (std::size_t i = 0; i < type[0].points(); ++i) {
                for (std::size_t j = 0; j < type[1].points(); ++j) {
                    for (std::size_t k = 0; k < type[2].points(); ++k) {
                        points.push_back(place_of(grid[(low[0] + i) + 6 * (low[1] + j) + 36 * (low[2] + k)]));
                    }
                }
            }
            return GridPart(type, std::move(points), frame);
        };
        return decide_parts(cell, part_of, limits);
    }

    [[nodiscard]] std::optional<PartResult> decide_spline(Index cell, const PartFrame& frame, const Limits& limits) const {
        GridPoints grid;
        if (!regular_grid(topology_, cell, grid)) {
            // Proved at once with all other cells at its segment of an irregular edge, or at its irregular point; or left.
            const bool is_proved = is_at_proved_segment(cell, limits) || is_at_proved_point(cell, limits);
            return is_proved ? std::optional(passed()) : std::nullopt;
        }
        const auto bezier_of = [&](const auto& place_of) {
            std::array<Vec3, 64> points{};
            for (std::size_t n = 0; n < 64; ++n) {
                if (grid[n] != kNone) points[n] = place_of(grid[n]);
            }
            // Beyond the boundary the spline goes on straight: then its edge is the spline of the boundary alone.
            for (const std::size_t stride : {std::size_t{1}, std::size_t{4}, std::size_t{16}}) {
                constexpr std::size_t kCorner = 1 + 4 + 16;
                const bool low = grid[kCorner - stride] == kNone, high = grid[kCorner + 2 * stride] == kNone;
                for (std::size_t n = 0; n < 64; ++n) {
                    const std::size_t at = n / stride % 4;
                    if (low && at == 0) points[n] = points[n + stride] * 2.0 - points[n + 2 * stride];
                    if (high && at == 3) points[n] = points[n - stride] * 2.0 - points[n - 2 * stride];
                }
            }
            return bezier_of_spline_points(points);
        };
        if (passes_at_once(
                cell, [&](const auto& place_of) { return slopes_of(bezier_of(place_of)); }, limits))
            return passed();
        return decide_parts(
            cell, [&](const auto& place_of) { return PolynomialPart::tricubic(bezier_of(place_of), frame); }, limits);
    }

    // The volume of BSXW goes on straight beyond the boundary, as splines of a grid do; that of Catmull-Clark does not.
    [[nodiscard]] bool has_rules(const EdgeWindow& window) const {
        return scheme_ == Scheme::Bsxw || (!window.is_beyond(0) && !window.is_beyond(3));
    }

    // What was found for a segment holds for all cells at it, so it is kept.
    [[nodiscard]] bool is_at_proved_segment(Index cell, const Limits& limits) const {
        const std::optional<Index> edge = irregular_edge(topology_, cell);
        if (!edge) return false;
        const std::uint8_t known = std::atomic_ref(segments_[*edge]).load();
        if (known != kUnknown) return known == kProved;
        const std::uint8_t state = state_of_segment(std::ranges::min(topology_.edge_cells[*edge]), limits);
        std::atomic_ref(segments_[*edge]).store(state);
        return state == kProved;
    }

    [[nodiscard]] std::uint8_t state_of_segment(Index cell, const Limits& limits) const {
        const std::optional<EdgeWindow> window = edge_window(topology_, cell);
        if (!window || !has_rules(*window)) return kOther;
        const auto rows_of = [&](const auto& place_of) {
            Eigen::MatrixXd rows(window->points.size(), 3);
            for (std::size_t p = 0; p < window->points.size(); ++p) {
                const Vec3 x = window->points[p] == kNone ? Vec3(0.0) : place_of(window->points[p]);
                rows.row(static_cast<Eigen::Index>(p)) << x.x, x.y, x.z;
            }
            const Eigen::Index layer = rows.rows() / static_cast<Eigen::Index>(EdgeWindow::kLayers);
            for (const auto& [beyond, last, before] : {std::array{0, 1, 2}, std::array{3, 2, 1}}) {
                if (!window->is_beyond(static_cast<std::size_t>(beyond))) continue;
                rows.middleRows(beyond * layer, layer) =
                    2 * rows.middleRows(last * layer, layer) - rows.middleRows(before * layer, layer);
            }
            return rows;
        };
        const Eigen::MatrixXd points = rows_of([&](Index p) { return place(cell, p); });
        const Eigen::MatrixXd motion = moves() ? rows_of([&](Index p) { return motion_of(cell, p); }) : Eigen::MatrixXd(0, 3);
        return state_of(limits, [&](double time) {
            std::vector<DividedSegment> divided;
            const DividedSegment whole{&segment_rules(scheme_, window->cells), points, time * motion, 3 * limits.error};
            return divide_segment(whole, kMostHalvings, divided) && std::ranges::all_of(divided, proves_ring);
        });
    }

    // What was found for a point holds for all cells at it, so it is kept.
    [[nodiscard]] bool is_at_proved_point(Index cell, const Limits& limits) const {
        for (const Index p : topology_.cells[cell]) {
            if (is_grid_[p] != 0) continue;
            const std::uint8_t known = std::atomic_ref(points_[p]).load();
            if (known == kProved) return true;
            if (known != kUnknown) continue;
            const std::uint8_t state = state_of_point(p, cell, limits);
            std::atomic_ref(points_[p]).store(state);
            if (state == kProved) return true;
        }
        return false;
    }

    [[nodiscard]] std::uint8_t state_of_point(Index point, Index cell, const Limits& limits) const {
        if (is_inside_straight_edge(point)) return kOther;  // the segments on both sides are proved by themselves
        const std::optional<PointWindow> window = point_window(topology_, point, cell);
        if (!window) return kOther;
        std::vector<Vec3> points;
        for (const Index p : window->points) points.push_back(mesh_.points[p] - mesh_.points[point]);
        const LinkKind& kind = link_kind(scheme_, window->link);
        return state_of(limits, [&](double time) {
            std::vector<Vec3> motion;
            for (std::size_t k = 0; moves() && k < points.size(); ++k) motion.push_back(time * motion_at(window->points[k]));
            return proves_point(kind, points, motion, limits.error);
        });
    }

    [[nodiscard]] bool is_inside_straight_edge(Index point) const {
        const auto edges = topology_.point_edges[point];
        return std::ranges::any_of(edges, [&](Index e) {
            const std::size_t cells = topology_.edge_cells[e].size();
            return cells != 4 && is_on_straight_edge(topology_, point, cells, false);
        });
    }

    // kMoves: it would be proved if it did not move
    static constexpr std::uint8_t kUnknown = 0, kProved = 1, kOther = 2, kMoves = 3;

    const HexMesh& mesh_;
    Scheme scheme_;
    Topology topology_;
    std::vector<std::uint8_t> is_grid_;
    mutable std::vector<std::uint8_t> points_, segments_;
};

// The cells of `open`, in their order, and then those of some layers around them.
std::vector<Index> FoldChecker::with_neighbors(const HexMesh& mesh, const std::vector<OpenCell>& open, int layers) {
    std::vector<Index> cells;
    std::vector<std::uint8_t> taken(mesh.cells.size(), 0), met(mesh.points.size(), 0);
    const auto take = [&](Index c) {
        taken[c] = 1;
        cells.push_back(c);
    };
    for (const OpenCell& at : open) take(at.cell);
    std::size_t begin = 0;
    for (int layer = 0; layer < layers; ++layer) {
        for (; begin < cells.size(); ++begin) {
            for (const Index p : mesh.cells[cells[begin]]) met[p] = 1;
        }
        for (Index c = 0; c < mesh.cells.size(); ++c) {
            if (taken[c] == 0 && std::ranges::any_of(mesh.cells[c], [&](Index p) { return met[p] != 0; })) take(c);
        }
    }
    return cells;
}

FoldChecker::FoldChecker(const HexMesh& mesh, const FoldOptions& options) : mesh_(mesh), options_(options) {
    check_options(options);
    check_options(options.scheme);
    validate(mesh_);
    if (options.scheme.kind == Scheme::Mcq && options.scheme.tension != 1.0 / 16 && options.scheme.tension != 0) {
        throw Error(ErrorCode::InvalidInput, "folds of mcq cannot be excluded with this tension",
                    option_name("tension", options.names), "1/16, or 0");
    }
    mesh_.attributes.clear();
    scheme_ = options.scheme;
    if (scheme_.crease_angle_deg) tag_creases(mesh_, *scheme_.crease_angle_deg);
    scheme_.crease_angle_deg.reset();
    if (scheme_.kind == Scheme::Mcq && scheme_.tension == 0) scheme_.kind = Scheme::Linear;
    states_.cells.resize(mesh_.cells.size());
}

void FoldChecker::move_straight(std::vector<Vec3> middle, const std::vector<Vec3>& motion, int halvings) {
    mesh_.points = std::move(middle);
    mesh_.attributes = {{"motion", 3, {}}};
    mesh_.attributes[0].values.reserve(3 * motion.size());
    for (const Vec3& m : motion) mesh_.attributes[0].values.insert(mesh_.attributes[0].values.end(), {m.x, m.y, m.z});
    halvings_ = halvings;
}

void FoldChecker::check(std::span<const Index> cells, FoldEffort effort) {
    for (const Index cell : cells) forget(cell);
    std::vector<OpenCell> irregular;
    {
        const Grids grids(mesh_, scheme_.kind);
        // Points between two meshes are rounded.
        constexpr double kOfTime = 4 * std::numeric_limits<double>::epsilon();
        const double error = mesh_.attributes.empty() ? 0 : kOfTime * largest_coordinate(mesh_);
        const Limits limits{options_.levels, static_cast<std::size_t>(options_.tests), error, effort, halvings_};
        constexpr std::size_t kRun = std::size_t{1} << 13;
        std::vector<std::optional<PartResult>> results;
        for (std::size_t begin = 0; begin < cells.size(); begin += kRun) {
            if (effort == FoldEffort::Whole) report_progress(options_.progress, "check", begin, cells.size());
            results.assign(std::min(kRun, cells.size() - begin), {});
            tbb::parallel_for(std::size_t{0}, results.size(),
                              [&](std::size_t k) { results[k] = grids.decide(cells[begin + k], {}, limits); });
            for (std::size_t k = 0; k < results.size(); ++k) {
                const Index cell = cells[begin + k];
                if (results[k]) {
                    add(cell, *results[k]);
                } else {
                    states_.cells[cell].moves = states_.cells[cell].moves || grids.is_open_for_motion(cell);
                    irregular.push_back({cell, cell, {}});
                }
            }
        }
    }
    descend_together(irregular, effort == FoldEffort::Verdict ? FoldEffort::Witness : effort);
    if (effort == FoldEffort::Whole && mesh_.attributes.empty()) sample(cells);
    if (effort != FoldEffort::Verdict) return;
    // What remains is decided after all where no descendant is irregular.
    std::erase_if(irregular, [&](const OpenCell& at) {
        const CellState& cell = states_.cells[at.control];
        return cell.is_folded || cell.irregular > 0;
    });
    for (const OpenCell& at : irregular) forget(at.control);
    descend_together(irregular, effort);
}

void FoldChecker::descend_together(const std::vector<OpenCell>& irregular, FoldEffort effort) {
    constexpr std::size_t kTogether = std::size_t{1} << 12;
    for (std::size_t begin = 0; begin < irregular.size(); begin += kTogether) {
        if (effort == FoldEffort::Whole) report_progress(options_.progress, "refine", begin, irregular.size());
        const auto first = irregular.begin() + static_cast<std::ptrdiff_t>(begin);
        descend(mesh_, {first, first + static_cast<std::ptrdiff_t>(std::min(kTogether, irregular.size() - begin))}, 0, effort);
    }
}

void FoldChecker::forget(Index cell) {
    states_.cells[cell] = {};
    states_.folds.erase(cell);
    states_.samples.erase(cell);
}

void FoldChecker::add_fold(const FoldPlace& fold) {
    states_.cells[fold.cell].is_folded = true;
    states_.folds[fold.cell] = fold;
}

void FoldChecker::add(Index control, const PartResult& result, int level) {
    CellState& cell = states_.cells[control];
    cell.open += result.open;
    cell.tests += result.tests;
    cell.moves = cell.moves || result.moves;
    tests_ += result.tests;
    cell.deepest = std::max(cell.deepest, level + result.deepest);
    if (result.fold && !cell.is_folded) {
        FoldPlace fold = *result.fold;
        fold.cell = control;
        add_fold(fold);
    }
}

// open: cells of a level, all of which are descendants of cells at irregular edges
void FoldChecker::descend(const HexMesh& mesh, std::vector<OpenCell> open, int level, FoldEffort effort) {
    if (level >= options_.irregular_levels) {
        for (const OpenCell& at : open) states_.cells[at.control].irregular += volume_of(at.frame);
        return;
    }
    if (open.empty()) return;
    // Windows reach two children away, and those of grandchildren need the rules of children two further.
    const bool is_last = level + 1 == options_.irregular_levels;
    const std::vector<Index> around = with_neighbors(mesh, open, is_last ? 1 : 2);
    constexpr std::size_t kRefined = 4;  // tests that take as long as to refine a cell
    tests_ += kRefined * around.size();
    const HexMesh fine = refine_cells(mesh, around, {.scheme = scheme_, .levels = 1});
    // Each level sums up to some tens of products of coordinates.
    constexpr double kOfLevel = 256 * std::numeric_limits<double>::epsilon();
    const Limits limits{std::max(0, options_.levels - level - 1), static_cast<std::size_t>(std::max(1, options_.tests / 8)),
                        kOfLevel * (level + 1) * largest_coordinate(fine), effort, halvings_};
    const Grids grids(fine, scheme_.kind);
    std::vector<std::optional<PartResult>> results(8 * open.size());
    const auto child_of = [&](std::size_t n) {
        const auto& [u, v, w] = kCornerParameters[n % 8];
        const OpenCell& parent = open[n / 8];
        return OpenCell{static_cast<Index>(n), parent.control, parent.frame.child(static_cast<std::size_t>(4 * u + 2 * v + w))};
    };
    tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t n) {
        const OpenCell child = child_of(n);
        results[n] = grids.decide(child.cell, child.frame, limits);
    });
    std::vector<OpenCell> next;
    for (std::size_t n = 0; n < results.size(); ++n) {
        const OpenCell child = child_of(n);
        if (results[n]) {
            add(child.control, *results[n], level + 1);
        } else {
            CellState& state = states_.cells[child.control];
            state.moves = state.moves || grids.is_open_for_motion(child.cell);
            next.push_back(child);
        }
    }
    std::erase_if(next, [&](const OpenCell& at) { return states_.cells[at.control].is_folded; });
    descend(fine, std::move(next), level + 1, effort);
}

void FoldChecker::sample(std::span<const Index> cells) {
    std::vector<Index> undecided;
    for (const Index c : cells) {
        const FoldVerdict found = verdict(c);
        if (found == FoldVerdict::Irregular || found == FoldVerdict::Open) undecided.push_back(c);
    }
    const std::vector<CellSamples> samples = sample_folds(mesh_, undecided, scheme_, options_.progress);
    for (std::size_t k = 0; k < undecided.size(); ++k) {
        states_.samples[undecided[k]] = samples[k];
        tests_ += samples[k].places;  // a place takes about as long as a test
        if (samples[k].least.determinant < 0) add_fold(samples[k].least);
    }
}

FoldVerdict FoldChecker::verdict(Index number) const {
    const CellState& cell = states_.cells[number];
    return cell.is_folded       ? FoldVerdict::Folded
           : cell.irregular > 0 ? FoldVerdict::Irregular
           : cell.open > 0      ? FoldVerdict::Open
                                : FoldVerdict::Proved;
}

void FoldChecker::count_kinds(const std::vector<FoldVerdict>& verdicts, FoldReport& report) const {
    std::optional<Topology> topology;
    for (Index c = 0; c < verdicts.size(); ++c) {
        if (verdicts[c] != FoldVerdict::Open && verdicts[c] != FoldVerdict::Irregular) continue;
        if (verdicts[c] == FoldVerdict::Irregular && !topology) topology = build_topology(mesh_);
        const UndecidedKind kind = verdicts[c] == FoldVerdict::Open ? UndecidedKind::Regular : kind_of_cell(*topology, c);
        ++report.undecided_kinds[static_cast<std::size_t>(kind)];
    }
}

FoldCheck FoldChecker::found() const {
    FoldCheck check;
    check.verdicts.reserve(states_.cells.size());
    check.open.reserve(states_.cells.size());
    FoldReport& report = check.report;
    double least = std::numeric_limits<double>::infinity(), size = 0;
    for (Index c = 0; c < states_.cells.size(); ++c) {
        const CellState& cell = states_.cells[c];
        check.verdicts.push_back(verdict(c));
        check.open.push_back(cell.is_folded ? 0 : cell.open + cell.irregular);
        report.tests += cell.tests;
        report.deepest = std::max(report.deepest, cell.deepest);
        switch (check.verdicts.back()) {
            case FoldVerdict::Folded:
                ++report.folded;
                check.places.push_back(states_.folds.at(c));
                break;
            case FoldVerdict::Irregular:
                ++report.irregular;
                break;
            case FoldVerdict::Open:
                ++report.open;
                break;
            case FoldVerdict::Proved:
                ++report.proved;
                break;
        }
        if (cell.is_folded) continue;
        report.open_volume += cell.open;
        report.irregular_volume += cell.irregular;
    }
    for (const auto& [c, samples] : states_.samples) {
        ++report.sampled.cells;
        report.sampled.places += samples.places;
        report.sampled.folded += states_.cells[c].is_folded ? 1 : 0;
        least = std::min(least, samples.least.determinant);
        size += samples.size;
    }
    count_kinds(check.verdicts, report);
    if (size > 0) report.sampled.least = least * static_cast<double>(report.sampled.places) / size;
    place(check.places);
    return check;
}

void FoldChecker::place(std::vector<FoldPlace>& places) const {
    std::vector<LimitQuery> queries;
    for (const FoldPlace& at : places) queries.push_back({at.cell, at.uvw});
    if (queries.empty()) return;
    const LimitSamples samples = evaluate_limit(mesh_, queries, {.scheme = scheme_, .progress = options_.progress});
    for (std::size_t k = 0; k < places.size(); ++k) places[k].position = samples.positions[k];
}

}  // namespace detail

using namespace detail;

std::vector<Option> options_of(FoldOptions& options) {
    return {Option("levels", options.levels)
                .between(0, 8)
                .help("L", "cut a cell into eight parts up to L times where a test does not decide"),
            Option("irregular-levels", options.irregular_levels)
                .between(0, 6)
                .help("L", "refine cells near irregular edges up to L times"),
            Option("tests", options.tests).between(1, 1000000).help("N", "the most tests of a cell")};
}

Facts facts_of(const FoldReport& report) {
    const std::size_t undecided = report.open + report.irregular;
    Facts facts;
    facts["verdict"] = report.folded > 0 ? "folded" : undecided > 0 ? "undecided" : "sound";
    Facts& cells = facts.group("cells");
    cells["proved"] = report.proved;
    cells["folded"] = report.folded;
    cells["undecided"] = undecided;
    cells["irregular"] = report.irregular;
    if (undecided > 0) {
        Facts& kinds = facts.group("undecided_kinds");
        for (const auto& row : NameTable<UndecidedKind>::rows) {
            const std::size_t count = report.undecided_kinds[static_cast<std::size_t>(row.value)];
            if (count > 0) kinds[std::string(row.name)] = count;
        }
    }
    facts["open_volume"] = report.open_volume + report.irregular_volume;
    Facts& sampled = facts.group("sampled");
    sampled["cells"] = report.sampled.cells;
    sampled["places"] = report.sampled.places;
    sampled["folded"] = report.sampled.folded;
    sampled["least"] = report.sampled.least;
    return facts;
}

std::vector<FoldVerdict> detail::fold_verdicts(const HexMesh& mesh, std::span<const Index> cells, const FoldOptions& options) {
    FoldChecker checker(mesh, options);
    checker.check(cells, FoldEffort::Whole);
    std::vector<FoldVerdict> verdicts;
    for (const Index c : cells) verdicts.push_back(checker.verdict(c));
    return verdicts;
}

FoldCheck check_folds(const HexMesh& mesh, const FoldOptions& options) {
    FoldChecker checker(mesh, options);
    std::vector<Index> cells(mesh.cells.size());
    std::iota(cells.begin(), cells.end(), Index{0});
    checker.check(cells, FoldEffort::Whole);
    return checker.found();
}

}  // namespace subvol
