// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "subvol/limit.h"
#include "subvol/mesh_source.h"
#include "subvol/option_names.h"

namespace subvol {

struct ProbeOptions {
    LimitOptions limit{};    ///< the scheme, and how exact the limit is: options of `evaluate_limit`
    double reach_world = 0;  ///< places outside, at most this far from the boundary, get the values of its nearest point; ≥ 0
};

[[nodiscard]] std::vector<Option> options_of(ProbeOptions& options);

/// Values of one attribute: channel c of place p at p × channels + c; its gradients by world position (per world unit). 0 where
/// the place is outside.
struct ProbedField {
    std::string name;
    std::size_t channels = 1;
    std::vector<double> values;
    std::vector<Vec3> gradients;
};

/// One entry per place.
struct ProbeResult {
    std::vector<Index> cells;       ///< the control cell, kNone outside the volume; where cells meet, one of them
    std::vector<Vec3> parameters;   ///< the place in the cell, (u,v,w) in [0,1]³
    std::vector<double> distances;  ///< 0 inside; with `reach_world` how far outside (world)
    std::vector<ProbedField> fields;
    int rounds = 0;  ///< how often the limit was evaluated for the last of the places

    [[nodiscard]] bool inside(std::size_t place) const { return cells[place] != kNone; }
};

/// The limit of a mesh as a function of places in the world.
///
/// The volume is cut into curved pieces that are near the limit (`find_limit_cells`), in a tree of boxes. A place is found in a
/// piece, and then in the limit by Newton's method, from cell to cell where it lies near a face.
class LimitProbe {
public:
    /// The mesh is copied.
    ///
    /// throws: Error(InvalidInput) as `evaluate_limit`, or if an option is out of range
    /// cost:   one search for the limit's pieces, about 1.5 kB for each
    explicit LimitProbe(HexMesh mesh, const ProbeOptions& options = {});
    ~LimitProbe();
    LimitProbe(LimitProbe&&) noexcept;
    LimitProbe& operator=(LimitProbe&&) noexcept;

    /// Values and gradients of all attributes at places: those of `evaluate_limit` at the place's parameters. A place counts as
    /// inside if it is within the tolerance of `evaluate_limit` of the volume.
    ///
    /// throws: Error(InvalidInput) if a place is not finite; Error(Cancelled)
    /// cost:   parallel; best are many places in one call. Bitwise the same for any number of threads
    [[nodiscard]] ProbeResult at(std::span<const Vec3> places, Progress* progress = nullptr) const;

    /// `at` for places that are near to known ones, such as the next places of a path. The search goes from there through the
    /// faces of cells and ends at the hull: what lies beyond it counts as outside, as does the other side of a crack.
    ///
    /// starts: places of the limit, one for each
    /// throws: Error(InvalidInput) as `at` and `evaluate_limit`, or if there are not as many starts
    [[nodiscard]] ProbeResult near(std::span<const Vec3> places, std::span<const LimitQuery> starts) const;

    [[nodiscard]] const HexMesh& mesh() const;
    /// Returns the bounding box of the limit, slightly enlarged.
    [[nodiscard]] Box box() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A mesh in memory of more cells is probed in the cells about the places alone, as their pieces would take too much.
inline constexpr std::size_t kMostCellsOfAProbe = std::size_t{1} << 18;

/// Values and gradients of the limit at places, as `LimitProbe::at`. A mesh that is stored in pieces is probed piece by piece:
/// each is read once, if a place may lie in it. Where cells meet, the one with the smallest number is found.
///
/// throws: Error(InvalidInput) as `LimitProbe`, or for a mesh in pieces if options.reach_world is not 0; what reading throws;
///         Error(Cancelled)
/// cost:   memory: as `LimitProbe`; of a mesh in pieces one piece, and the cells about the places in it
[[nodiscard]] ProbeResult probe_limit(const MeshSource& source, std::span<const Vec3> places, const ProbeOptions& options = {},
                                      Progress* progress = nullptr);

/// `count` places on a line, its ends included, equally far apart.
///
/// throws: Error(InvalidInput) if count is 0 or an end is not finite
[[nodiscard]] std::vector<Vec3> places_on_line(const Vec3& from, const Vec3& to, std::size_t count);

}  // namespace subvol
