// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "assemble.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

// The cube of a lattice that holds a point: as wide as the tolerance. Without a tolerance, the coordinates themselves.
using Cube = std::array<double, 3>;

struct CubeHash {
    std::size_t operator()(const Cube& cube) const {
        std::uint64_t hash = 0;
        for (const double x : cube) hash = (std::rotl(hash, 21) ^ std::bit_cast<std::uint64_t>(x)) * 0x9E3779B97F4A7C15u;
        return static_cast<std::size_t>(hash ^ (hash >> 32));
    }
};

class Welder {
public:
    Welder(std::span<const Vec3> points, double tolerance)
        : points_(points), tolerance_(tolerance), before_(points.size(), kNone) {}

    /// The first of the points kept so far that `p` coincides with; `p` itself, which is then kept, if there is none.
    Index join(Index p) {
        const Cube home = cube_of(points_[p]);
        const Index found = tolerance_ > 0 ? first_around(p, home) : first_in(p, home);
        if (found != kNone) return found;
        Index& last = last_in_.try_emplace(home, kNone).first->second;
        before_[p] = std::exchange(last, p);
        return p;
    }

private:
    [[nodiscard]] Cube cube_of(const Vec3& x) const {
        const auto along = [&](double v) { return (tolerance_ > 0 ? std::floor(v / tolerance_) : v) + 0.0; };  // -0 is 0
        return {along(x.x), along(x.y), along(x.z)};
    }

    [[nodiscard]] Index first_in(Index p, const Cube& cube) const {
        const auto last = last_in_.find(cube);
        Index first = kNone;
        for (Index q = last == last_in_.end() ? kNone : last->second; q != kNone; q = before_[q]) {
            if (glm::distance(points_[q], points_[p]) <= tolerance_) first = q;
        }
        return first;
    }

    [[nodiscard]] Index first_around(Index p, const Cube& home) const {
        Index first = kNone;
        for (int n = 0; n < 27; ++n) {
            const int x = n % 3 - 1, y = n / 3 % 3 - 1, z = n / 9 - 1;
            first = std::min(first, first_in(p, {home[0] + x, home[1] + y, home[2] + z}));
        }
        return first;
    }

    std::span<const Vec3> points_;
    double tolerance_;
    std::unordered_map<Cube, Index, CubeHash> last_in_;
    std::vector<Index> before_;  // for each point that is kept, the one before it in its cube
};

template <class Call>
void for_each_cell(MeshFile& found, const Call& call) {
    each_kind(found, [&](auto& cells) { std::ranges::for_each(cells.corners, call); });
}

}  // namespace

void weld_points(MeshFile& found, double tolerance, std::string_view file, const EntityNames& names) {
    std::vector<Index> joined(found.points.size(), kNone);
    for_each_cell(found, [&](const auto& cell) {
        for (const Index p : cell) joined[p] = p;
    });
    for (const Index p : found.curved.nodes) joined[p] = p;
    Welder welder(found.points, tolerance);
    std::size_t welded = 0;
    for (Index p = 0; p < joined.size(); ++p) {
        if (joined[p] == kNone) continue;
        joined[p] = welder.join(p);
        welded += joined[p] != p;
    }
    for_each_cell(found, [&](auto& cell) {
        for (std::size_t k = 0; k < cell.size(); ++k) {
            for (std::size_t j = 0; j < k; ++j) {
                if (tolerance == 0 || cell[j] != joined[cell[k]]) continue;
                throw Error(ErrorCode::InvalidInput,
                            "a cell has " + names.point(cell[j]) + " and " + names.point(cell[k]) + ", which would be welded",
                            std::string(file), "a smaller tolerance, or no welding");
            }
            cell[k] = joined[cell[k]];
        }
    });
    for (Index& p : found.curved.nodes) p = joined[p];
    // The points of shells come last, so that the cells have the points that they have without shells.
    const auto join_shell = [&](auto& corners) {
        for (Index& p : corners) {
            if (joined[p] == kNone) {
                joined[p] = welder.join(p);
                welded += joined[p] != p;
            }
            p = joined[p];
        }
    };
    std::ranges::for_each(found.quads.corners, join_shell);
    std::ranges::for_each(found.lines.corners, join_shell);
    const auto join_tag = [&](auto& tag) {
        for (Index& p : tag) p = joined[p] == kNone ? p : joined[p];
    };
    std::ranges::for_each(found.sharp.faces, join_tag);
    std::ranges::for_each(found.sharp.edges, join_tag);
    for (FilePatch& patch : found.patches) join_tag(patch.corners);
    found.warnings.push_back(counted(welded, "point", "points") + " welded to others " +
                             (tolerance > 0 ? "nearby" : "at the same place") + "; the values of the first point are kept");
}

void say_points_of_their_own(MeshFile& found) {
    std::size_t cells = 0;
    each_kind(found, [&](const auto& of_kind) { cells += of_kind.corners.size(); });
    // Meshes of more than a few cells have about as many points as hexahedra, and fewer than other cells.
    constexpr std::size_t kMostOfPatch = 64, kFewCells = 8;
    if (cells < kFewCells || 3 * cells > 2 * found.points.size()) return;
    // Groups of cells that share points, by the least point of each.
    std::vector<Index> group(found.points.size());
    std::iota(group.begin(), group.end(), Index{0});
    const auto root = [&](Index p) {
        while (group[p] != p) p = group[p] = group[group[p]];
        return p;
    };
    each_kind(found, [&](const auto& of_kind) {
        for (const auto& cell : of_kind.corners) {
            for (const Index p : cell) {
                const Index a = root(cell[0]), b = root(p);
                group[std::max(a, b)] = std::min(a, b);
            }
        }
    });
    const std::vector<std::uint8_t> used = used_points(found);
    std::size_t groups = 0, points = 0, joined = 0;
    Welder welder(found.points, 0);
    for (std::size_t p = 0; p < found.points.size(); ++p) {
        if (!used[p]) continue;
        ++points;
        groups += group[p] == p;
    }
    if (groups < 2 || cells > kMostOfPatch * groups) return;
    for (std::size_t p = 0; p < found.points.size(); ++p) {
        if (used[p]) joined += welder.join(static_cast<Index>(p)) != p;
    }
    if (4 * joined < points) return;
    found.warnings.push_back(counted(groups, "group", "groups") + " of cells share no points, though " +
                             std::to_string(joined) + " of " + std::to_string(points) +
                             " points lie at the places of others: --weld joins these");
}

}  // namespace subvol::detail
