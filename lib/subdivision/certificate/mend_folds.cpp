// SPDX-License-Identifier: Apache-2.0
#include "subvol/mend_folds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fold_checker.h"
#include "movable_patch.h"
#include "subvol/cell.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/topology.h"

// Points near bad cells move, and with them the limit of the cells two layers around. These are the patch; two more layers
// shape it and do not change:
//
//     bad cells ── reach ──► points that move ── 2 ──► cells that are kept sound ── 2 ──► the patch

namespace subvol {

using namespace detail;

namespace {

constexpr int kWindow = 2;      // layers of cells on which the limit in a cell depends
constexpr double kAcross = 99;  // how much more a way across the boundary counts than one along it

/// How each point of a mesh may move.
std::vector<Freedom> freedom_of(const HexMesh& mesh, double boundary_edges) {
    const Topology topology = build_topology(mesh);
    std::vector<Freedom> points(mesh.points.size());
    for (Freedom& at : points) at.edge = std::numeric_limits<double>::infinity();
    for (const auto& [a, b] : topology.edges) {
        const double length = glm::distance(mesh.points[a], mesh.points[b]);
        points[a].edge = std::min(points[a].edge, length);
        points[b].edge = std::min(points[b].edge, length);
    }
    // The mean of n nᵀ over the faces at a point: where they are flat only their normal counts, at a corner all directions.
    std::vector<double> faces(mesh.points.size(), 0);
    std::vector<Mat3> normals(mesh.points.size(), Mat3(0.0));
    for (Index f = 0; f < topology.faces.size(); ++f) {
        if (!topology.face_on_boundary(f)) continue;
        const auto& [a, b, c, d] = topology.faces[f];
        const Vec3 normal = glm::cross(mesh.points[c] - mesh.points[a], mesh.points[d] - mesh.points[b]);
        const double length = glm::length(normal);
        for (const Index p : topology.faces[f]) {
            faces[p] += 1;
            if (length > 0) normals[p] += glm::outerProduct(normal, normal) / (length * length);
        }
    }
    for (std::size_t p = 0; p < points.size(); ++p) {
        Freedom& at = points[p];
        at.weight = Mat3(1.0);
        at.reach = std::numeric_limits<double>::infinity();
        if (!(at.edge > 0) || std::isinf(at.edge)) {  // two points in one place, or a point of no cell
            at.edge = 1;
            at.reach = 0;
            continue;
        }
        if (faces[p] == 0) continue;
        at.on_boundary = true;
        at.weight += kAcross / faces[p] * normals[p];
        at.reach = boundary_edges * at.edge;
    }
    return points;
}

bool is_bad(FoldVerdict verdict) {
    return verdict == FoldVerdict::Folded || verdict == FoldVerdict::Open;
}

class Mender {
public:
    Mender(HexMesh mesh, const MendOptions& options)
        : mesh_(std::move(mesh)), options_(options), start_(mesh_.points), checker_(mesh_, options.folds) {}

    Mended run() {
        stale_.assign(mesh_.cells.size(), 1);
        std::vector<std::uint8_t> bad(mesh_.cells.size(), 0);
        const bool any_bad = check_all(bad) > 0;
        FoldCheck check = checker_.found();
        MendReport report;
        report.before = check.report;
        constexpr std::size_t kBudget = 200'000, kOfCell = 200;
        report.budget = budget_ = kBudget + kOfCell * mesh_.cells.size();
        first_tests_ = checker_.tests();
        if (any_bad) {
            freedom_ = freedom_of(mesh_, options_.boundary_edges);
            work(bad, report);
            report.work = used();
            check = checker_.found();
        }
        for (std::size_t c = 0; c < bad.size(); ++c) {
            if (is_bad(check.verdicts[c])) report.left.push_back({static_cast<Index>(c), reason(mesh_.cells[c])});
        }
        for (std::size_t p = 0; p < freedom_.size(); ++p) {
            const double way = glm::distance(start_[p], mesh_.points[p]);
            if (way == 0) continue;
            ++report.moved;
            double& farthest = freedom_[p].on_boundary ? report.boundary_edges : report.farthest_edges;
            farthest = std::max(farthest, way / freedom_[p].edge);
        }
        report.farthest_edges = std::max(report.farthest_edges, report.boundary_edges);
        return {std::move(mesh_), std::move(check), std::move(report)};
    }

private:
    /// The tests since the mesh was checked first, and the steps that take as long.
    [[nodiscard]] std::size_t used() const { return checker_.tests() - first_tests_ + steps_; }

    // Ends early where three rounds in a row left as many bad cells as before. bad: of each cell how often it was bad
    void work(std::vector<std::uint8_t>& bad, MendReport& report) {
        std::size_t fewest = bad.size() + 1, left = 0;
        Found best;
        constexpr int kPatience = 3;
        int in_vain = 0;
        for (int round = 0; round < options_.rounds && in_vain < kPatience && used() < budget_; ++round) {
            ++report.rounds;
            left = move_around(bad, round);
            if (left == 0) left = check_all(bad);  // which finds more folds near irregular edges
            if (left == 0) return;
            in_vain = left < fewest ? 0 : in_vain + 1;
            if (left > fewest) continue;
            fewest = left;
            best = {mesh_.points, checker_.states(), stale_};
        }
        if (left > fewest) restore(std::move(best));
        check_all(bad);
    }

    /// Points, and what is known with them: to find it again would cost another check.
    struct Found {
        std::vector<Vec3> points;
        FoldChecker::States states;
        std::vector<std::uint8_t> stale;
    };

    void restore(Found found) {
        checker_.move(found.points);
        checker_.restore(std::move(found.states));
        mesh_.points = std::move(found.points);
        stale_ = std::move(found.stale);
    }

    // Checks the cells near points that move.
    void move(const std::vector<Vec3>& points) {
        std::vector<std::uint8_t> near(mesh_.cells.size(), 0);
        for (std::size_t c = 0; c < near.size(); ++c) {
            near[c] = std::ranges::any_of(mesh_.cells[c], [&](Index p) { return points[p] != mesh_.points[p]; }) ? 1 : 0;
        }
        grow(mesh_, near, kWindow);
        std::vector<Index> cells;
        for (Index c = 0; c < near.size(); ++c) {
            if (near[c] != 0) cells.push_back(c);
        }
        mesh_.points = points;
        checker_.move(points);
        checker_.check(cells, FoldEffort::Verdict);
        for (const Index c : cells) stale_[c] = checker_.verdict(c) == FoldVerdict::Proved ? 0 : 1;
    }

    // Finds out all about the cells near points that have moved. returns how many are bad, which are counted in `bad`
    std::size_t check_all(std::vector<std::uint8_t>& bad) {
        std::vector<Index> cells;
        std::vector<std::uint8_t> counted;
        for (Index c = 0; c < stale_.size(); ++c) {
            if (std::exchange(stale_[c], std::uint8_t{0}) == 0) continue;
            cells.push_back(c);
            counted.push_back(bad[c] != 0 && is_bad(checker_.verdict(c)) ? 1 : 0);
        }
        checker_.check(cells, FoldEffort::Whole);
        for (std::size_t k = 0; k < cells.size(); ++k) {
            if (counted[k] == 0 && is_bad(checker_.verdict(cells[k]))) ++bad[cells[k]];
        }
        const auto is_left = [&](Index c) { return is_bad(checker_.verdict(c)); };
        return static_cast<std::size_t>(std::ranges::count_if(cells, is_left));
    }

    // Moves the points near bad cells, and looks whether the cells there are sound, which costs far less than the whole check.
    // returns how many are bad then, which are counted in `bad`
    std::size_t move_around(std::vector<std::uint8_t>& bad, int round) {
        std::vector<std::uint8_t> cells = bad;
        grow(mesh_, cells, 1 + round / 3);  // more of them where the nearest are not enough
        std::vector<std::uint8_t> moves(mesh_.points.size(), 0);
        for (std::size_t c = 0; c < cells.size(); ++c) {
            if (cells[c] == 0) continue;
            for (const Index p : mesh_.cells[c]) moves[p] = 1;
        }
        grow(mesh_, cells, kWindow);
        std::vector<std::uint8_t> whole = cells;
        grow(mesh_, whole, kWindow);
        MeshSubset patch = subset(mesh_, whole);
        patch.mesh.attributes.clear();

        std::vector<Freedom> freedom;
        std::vector<Vec3> start;
        for (const Index p : patch.points) {
            freedom.push_back(freedom_[p]);
            start.push_back(start_[p]);
            if (moves[p] == 0) freedom.back().reach = 0;
        }
        constexpr double kShare = 0.1, kMoreEachTime = 1.5, kMost = 0.4;
        std::vector<PatchCell> patch_cells;
        std::vector<Index> near;
        for (const Index c : patch.cells) {
            const CellRole role = bad[c] != 0 ? CellRole::Bad : cells[c] != 0 ? CellRole::Kept : CellRole::Around;
            patch_cells.push_back({role, std::min(kMost, kShare * std::pow(kMoreEachTime, std::max(0, bad[c] - 1)))});
            if (role != CellRole::Around) near.push_back(c);
        }
        const int levels = round == 0 || options_.folds.scheme.kind == Scheme::Linear ? 1 : 2;
        MovablePatch movable(patch.mesh, options_.folds.scheme, levels, std::move(start), std::move(freedom), patch_cells);
        const auto used_with = [&] { return used() + movable.tests(); };
        patch.mesh.points = movable.move([&](double part) {
            const double spent = static_cast<double>(used_with()) / static_cast<double>(budget_);
            report_progress(options_.folds.progress, "mend", std::min(1.0, std::max((round + part) / options_.rounds, spent)));
            return spent < 1;
        });
        steps_ += movable.tests();
        std::vector<Vec3> points = mesh_.points;
        for (std::size_t k = 0; k < patch.points.size(); ++k) {
            if (moves[patch.points[k]] != 0) points[patch.points[k]] = patch.mesh.points[k];
        }
        move(points);
        std::size_t left = 0;
        for (const Index c : near) {
            if (!is_bad(checker_.verdict(c))) continue;
            ++bad[c];
            ++left;
        }
        return left;
    }

    [[nodiscard]] std::string reason(const std::array<Index, 8>& cell) const {
        constexpr double kAlmost = 0.99;
        const auto at_end = [&](Index p) {
            const Freedom& at = freedom_[p];
            return at.on_boundary && glm::distance(start_[p], mesh_.points[p]) >= kAlmost * at.reach;
        };
        if (std::ranges::all_of(cell, at_end)) return "all of its points are on the boundary, which may move no farther";
        if (std::ranges::any_of(cell, at_end)) return "points of it on the boundary may move no farther";
        return "no better places were found for its points";
    }

    HexMesh mesh_;
    const MendOptions& options_;
    std::vector<Vec3> start_;
    std::vector<Freedom> freedom_;
    FoldChecker checker_;
    std::vector<std::uint8_t> stale_;  // of which more can be known than the last check found
    std::size_t budget_ = 0, first_tests_ = 0, steps_ = 0;
};

}  // namespace

std::vector<Option> options_of(MendOptions& options) {
    return {Option("boundary-move", options.boundary_edges)
                .between(0, 10)
                .help("PART", "points of the boundary may move by this part of their shortest edge"),
            Option("rounds", options.rounds).between(1, 50).help("N", "move points and check again up to N times")};
}

Facts facts_of(const MendReport& report) {
    Facts facts;
    facts["folded"] = report.before.folded;
    facts["open"] = report.before.open;
    facts["moved"] = report.moved;
    facts["farthest_edges"] = report.farthest_edges;
    facts["boundary_edges"] = report.boundary_edges;
    facts["rounds"] = report.rounds;
    facts["work"] = report.work;
    facts["budget"] = report.budget;
    FactValue::List left;
    for (const MendReport::Left& cell : report.left) {
        Facts one;
        one["cell"] = cell.cell;
        one["reason"] = cell.reason;
        left.emplace_back(std::move(one));
    }
    facts["left"] = std::move(left);
    return facts;
}

Mended mend_folds(HexMesh mesh, const MendOptions& options) {
    check_options(options);
    if (options.folds.scheme.crease_angle_deg) tag_creases(mesh, *options.folds.scheme.crease_angle_deg);
    MendOptions tagged = options;
    tagged.folds.scheme.crease_angle_deg.reset();
    return Mender(std::move(mesh), tagged).run();
}

}  // namespace subvol
