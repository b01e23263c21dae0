// SPDX-License-Identifier: Apache-2.0
// The limit is taken as triquadratic pieces. Pieces that lie in the region are integrated by Gauss points. Those that its faces
// may cut shrink to a box around what lies in it, which is halved some times along its long axes:
//
//     ┌─────┬─────┐      in:   Gauss points
//     │ in  │ in╱ │      cut:  the box around the rest is halved; in the last ones there are Gauss points on lines from face
//     │     │ ╱cut│            to face (CutPiece)
//     ├─────┼╱──┬─┤      out:  nothing, as the Bézier coefficients prove
//     │     ╱cut├─┤
//     └────╱┴───┴─┘
//
// However small or thin the region is, its box is as small. Where few lines meet it, as with a needle across a cell, boxes are
// halved further; a box in which nothing was found in the end, and which may not be empty, counts for the error.
//
// Sums with one halving less show how exact they are; the number of halvings grows until that is enough. Extremes are
// searched for in the same pieces by branch and bound (`find_extreme`).
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "cut_piece.h"
#include "given_figures.h"
#include "overlapping_sets.h"
#include "region_extremes.h"
#include "seen_folds.h"
#include "subvol/detail/piece_tree.h"
#include "subvol/error.h"
#include "subvol/field_range.h"
#include "subvol/measure.h"
#include "subvol/option.h"

namespace subvol {
namespace {

using detail::CutPiece;
using detail::PieceBox;
using detail::PieceNode;
using detail::QuadraticWeights;

constexpr int kMostHalvings = 5;
constexpr std::uint8_t kMet = 1, kTurned = 2;  // of a piece: a part of it lies in the region; its determinant is negative there
constexpr std::size_t kGrain = 64;             // pieces: fixed, so that sums do not depend on the number of threads

/// The place, the volume element and the values at a place of a piece.
struct PieceSample {
    Vec3 place{0.0};
    double element = 0;
    std::vector<double> values;
};

/// Sums and extremes of the parts, the whole first. Sums are the volume, then the integrals without the channels' origins.
///
/// missed: the volume of boxes in which nothing was found, although they may not be empty
struct RegionSums {
    std::vector<std::vector<double>> sums;
    std::vector<std::vector<LimitExtreme>> least, most;
    std::vector<std::vector<double>> histograms;
    double missed = 0;

    RegionSums(std::size_t parts, std::size_t channels, std::size_t bins)
        : sums(parts, std::vector<double>(channels + 1, 0)),
          least(parts, std::vector<LimitExtreme>(channels, {.value = std::numeric_limits<double>::infinity()})),
          most(parts, std::vector<LimitExtreme>(channels, {.value = -std::numeric_limits<double>::infinity()})),
          histograms(channels, std::vector<double>(bins, 0)) {}

    void add(const RegionSums& other) {
        missed += other.missed;
        for (std::size_t part = 0; part < sums.size(); ++part) {
            for (std::size_t k = 0; k < sums[part].size(); ++k) sums[part][k] += other.sums[part][k];
            for (std::size_t c = 0; c < least[part].size(); ++c) {
                if (other.least[part][c].value < least[part][c].value) least[part][c] = other.least[part][c];
                if (other.most[part][c].value > most[part][c].value) most[part][c] = other.most[part][c];
            }
        }
        for (std::size_t c = 0; c < histograms.size(); ++c) {
            for (std::size_t b = 0; b < histograms[c].size(); ++b) histograms[c][b] += other.histograms[c][b];
        }
    }
};

/// Works on one piece after the other.
///
/// halvings: of the box around what lies in the region
/// bounds:   of the values of each channel
/// range:    of the histograms, for each channel; empty: there are none
/// met:      a flag for each piece, set if it has a part in the region
class PieceCutter {
public:
    PieceCutter(const LimitPieces& pieces, std::span<const Region> regions, std::span<const Index> groups, int halvings,
                std::span<const std::array<double, 2>> bounds, std::span<const std::array<double, 2>> range,
                std::span<std::uint8_t> met, RegionSums& sums)
        : pieces_(pieces),
          cutter_(regions),
          groups_(groups),
          halvings_(halvings),
          bounds_(bounds),
          range_(range),
          met_(met),
          sums_(sums) {
        sample_.values.resize(pieces.value_origins.size());
    }

    void cut(std::size_t piece) {
        constexpr std::size_t kRoom = 4096;
        piece_ = piece;
        cutter_.take(pieces_, piece);
        room_ = kRoom;
        halve({}, 0);
    }

private:
    /// Evaluates the piece at a place in it.
    void evaluate(const Vec3& at) {
        const QuadraticWeights u(at.x), v(at.y), w(at.z);
        sample_.place = pieces_.origins[piece_];
        std::ranges::fill(sample_.values, 0);
        Mat3 jacobian(0.0);
        for (std::size_t n = 0, k = 0; k < 3; ++k) {
            for (std::size_t j = 0; j < 3; ++j) {
                for (std::size_t i = 0; i < 3; ++i, ++n) {
                    const float* node = pieces_.node(piece_, n);
                    const Vec3 x(node[0], node[1], node[2]);
                    const double weight = u.values[i] * v.values[j] * w.values[k];
                    sample_.place += weight * x;
                    jacobian[0] += u.slopes[i] * v.values[j] * w.values[k] * x;
                    jacobian[1] += u.values[i] * v.slopes[j] * w.values[k] * x;
                    jacobian[2] += u.values[i] * v.values[j] * w.slopes[k] * x;
                    for (std::size_t c = 0; c < sample_.values.size(); ++c) {
                        sample_.values[c] += weight * static_cast<double>(node[3 + c]);
                    }
                }
            }
        }
        for (std::size_t c = 0; c < sample_.values.size(); ++c) {
            const double origin = pieces_.value_origins[c], value = sample_.values[c] * pieces_.value_units[c];
            sample_.values[c] = std::clamp(value, bounds_[c][0] - origin, bounds_[c][1] - origin);
        }
        sample_.element = glm::determinant(jacobian);
    }

    [[nodiscard]] Vec3 in_cell(const Vec3& at) const {
        const auto& lowest = pieces_.lowest[piece_];
        const double side = std::ldexp(1, -pieces_.levels[piece_]);
        return (Vec3(lowest[0], lowest[1], lowest[2]) + at) * side;
    }

    template <class Act>
    void each_part(const Act& act) const {
        act(std::size_t{0});
        if (!groups_.empty()) act(1 + static_cast<std::size_t>(groups_[pieces_.cells[piece_]]));
    }

    void add(const PieceNode& node) {
        evaluate(node.at);
        if (sample_.element < 0) met_[piece_] |= kTurned;
        const double volume = sample_.element * node.weight;
        each_part([&](std::size_t part) {
            std::vector<double>& sums = sums_.sums[part];
            sums[0] += volume;
            for (std::size_t c = 0; c < sample_.values.size(); ++c) sums[1 + c] += volume * sample_.values[c];
        });
        note_values(node.at, volume);
    }

    void note_values(const Vec3& at, double volume) {
        for (std::size_t c = 0; c < sample_.values.size(); ++c) {
            const double value = pieces_.value_origins[c] + sample_.values[c];
            if (!range_.empty()) {
                const auto& [low, high] = range_[c];
                auto& bins = sums_.histograms[c];
                const double place = high > low ? (value - low) / (high - low) * static_cast<double>(bins.size()) : 0;
                const auto last = static_cast<double>(bins.size() - 1);
                bins[static_cast<std::size_t>(std::clamp(place, 0.0, last))] += volume;
            }
            each_part([&](std::size_t part) {
                LimitExtreme &least = sums_.least[part][c], &most = sums_.most[part][c];
                if (value < least.value) least = {value, sample_.place, pieces_.cells[piece_], in_cell(at)};
                if (value > most.value) most = {value, sample_.place, pieces_.cells[piece_], in_cell(at)};
            });
        }
    }

    /// A box that lies in the region, by 3³ Gauss points.
    void add_inside(const PieceBox& box) {
        static const std::array<double, 3> places{0.5 - std::sqrt(3.0 / 20), 0.5, 0.5 + std::sqrt(3.0 / 20)};
        constexpr std::array<double, 3> weights{5.0 / 18, 8.0 / 18, 5.0 / 18};
        const double volume = box.volume();
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t j = 0; j < 3; ++j) {
                for (std::size_t i = 0; i < 3; ++i) {
                    add({box.at(Vec3(places[i], places[j], places[k])), volume * weights[i] * weights[j] * weights[k]});
                }
            }
        }
        met_[piece_] |= kMet;
    }

    /// A box that may be cut, after some halvings.
    void halve(PieceBox box, int halvings) {
        constexpr double kFewLines = 0.1;
        const CutPiece::Place place = cutter_.narrow(box);
        if (place == CutPiece::Place::Outside) return;
        if (place == CutPiece::Place::Inside) return add_inside(box);
        if (halvings >= halvings_) {
            nodes_.clear();
            const double met = cutter_.add_nodes(box, nodes_);
            if (met >= kFewLines || room_ == 0) {
                for (const PieceNode& node : nodes_) add(node);
                if (met > 0) met_[piece_] |= kMet;
                if (met > 0) return;
                evaluate(box.at(Vec3(0.5)));
                sums_.missed += std::abs(sample_.element) * box.volume();
                return;
            }
            --room_;
        }
        constexpr double kLong = 0.3;  // of the longest
        Vec3 lengths;
        for (int axis = 0; axis < 3; ++axis) {
            Vec3 from(0.5), to(0.5);
            from[axis] = 0;
            to[axis] = 1;
            lengths[axis] = glm::distance(cutter_.place_at(box.at(from)), cutter_.place_at(box.at(to)));
        }
        const double longest = std::max({lengths.x, lengths.y, lengths.z});
        const Vec3 middle = box.at(Vec3(0.5));
        for (int k = 0; k < 8; ++k) {
            PieceBox part = box;
            bool is_one = true;
            for (int axis = 0; axis < 3; ++axis) {
                const bool upper = (k >> axis & 1) != 0;
                if (lengths[axis] < kLong * longest) {
                    is_one = is_one && !upper;
                } else {
                    (upper ? part.lower : part.upper)[axis] = middle[axis];
                }
            }
            if (is_one) halve(part, halvings + 1);
        }
    }

    const LimitPieces& pieces_;
    CutPiece cutter_;
    std::span<const Index> groups_;
    int halvings_;
    std::span<const std::array<double, 2>> bounds_, range_;
    std::span<std::uint8_t> met_;
    RegionSums& sums_;
    std::size_t piece_ = 0, room_ = 0;  // room: for halvings where few lines meet the region
    PieceSample sample_;
    std::vector<PieceNode> nodes_;
};

/// The volume and the means of a part.
std::vector<double> means_of(std::vector<double> sums) {
    for (std::size_t c = 1; c < sums.size(); ++c) sums[c] = sums[0] > 0 ? sums[c] / sums[0] : 0;
    return sums;
}

/// What a region is measured with: the limit's pieces, and coarser ones, which show how exact they are.
class RegionMeasurer {
public:
    RegionMeasurer(const HexMesh& mesh, std::span<const Region> regions, const MeasureOptions& options)
        : mesh_(mesh),
          regions_(regions),
          options_(options),
          limit_(within(1, 3)),
          pieces_(*limit_.pieces),
          coarse_(within(8, 2)),
          met_(pieces_.cells.size(), 0) {
        for (const Attribute& field : mesh.attributes) {
            const auto [min, max] = std::ranges::minmax(own_values(field));
            constexpr double kInfinity = std::numeric_limits<double>::infinity();
            for (std::size_t c = 0; c < static_cast<std::size_t>(field.channels); ++c) {
                const double origin = pieces_.value_origins[ranges_.size()];
                ranges_.push_back(max - min);
                largest_.push_back(std::max(std::abs(max - origin), std::abs(min - origin)));
                bounds_.push_back(field.bounds.empty() ? std::array<double, 2>{-kInfinity, kInfinity} : field.bounds[c]);
            }
        }
    }

    /// Nothing if no part of the volume was found in the region.
    ///
    /// missed: becomes the volume of boxes in which nothing was found, although they may not be empty
    [[nodiscard]] std::optional<LimitMeasure> measure(double& missed) {
        int halvings = 1;
        RegionSums before = sums_at(pieces_, 0, {}), sums = sums_at(pieces_, 1, {});
        const RegionSums same = sums, rough = sums_at(*coarse_.pieces, 1, {});
        while (halvings < kMostHalvings && halving_error(sums, before, 0) / 3 > options_.tolerance) {
            before = std::exchange(sums, sums_at(pieces_, ++halvings, {}));
        }
        missed = sums.missed;
        if (!(sums.sums[0][0] > 0)) return {};
        LimitMeasure result;
        result.pieces = pieces_.cells.size();
        for (std::size_t part = 0; part < sums.sums.size(); ++part) {
            constexpr double kLeft =
                0.5;  // of what coarser pieces change: each level of pieces leaves an eighth of it, or less
            const double of_pieces = kLeft * difference(same.sums[part], rough.sums[part]);
            PartMeasure measured = part_of(sums, part, halving_error(sums, before, part) + of_pieces);
            if (part == 0) {
                result.whole = std::move(measured);
            } else {
                measured.name = options_.names[part - 1];
                result.parts.push_back(std::move(measured));
            }
        }
        find_extremes(sums, result);
        std::vector<std::array<double, 2>> range;
        for (const FieldMeasure& field : result.whole.fields) range.push_back({field.min.value, field.max.value});
        sums = sums_at(pieces_, halvings, range);
        for (std::size_t c = 0; c < range.size(); ++c) result.whole.fields[c].histogram = std::move(sums.histograms[c]);
        result.folds = folds();
        return result;
    }

private:
    [[nodiscard]] LimitCells within(double coarser, int levels) const {
        const RefineOptions refinement{.scheme = options_.scheme, .progress = options_.progress};
        const double tolerance = coarser * options_.tolerance;
        LimitCells found = detail::pieces_within(
            mesh_, refinement,
            {.position_world = tolerance * bounds(mesh_).diagonal(), .value_of_range = tolerance, .max_levels = levels});
        if (!options_.cells.empty()) found.pieces = detail::pieces_of(*found.pieces, options_.cells);
        return found;
    }

    [[nodiscard]] RegionSums sums_at(const LimitPieces& pieces, int halvings, std::span<const std::array<double, 2>> range) {
        report_progress(options_.progress, "region", static_cast<double>(halvings) / kMostHalvings);
        const RegionSums none(options_.names.size() + 1, ranges_.size(), static_cast<std::size_t>(options_.bins));
        std::vector<std::uint8_t> met(pieces.cells.size(), 0);
        RegionSums all = tbb::parallel_deterministic_reduce(
            tbb::blocked_range<std::size_t>(0, pieces.cells.size(), kGrain), none,
            [&](const auto& some, RegionSums sums) {
                PieceCutter cutter(pieces, regions_, options_.groups, halvings, bounds_, range, met, sums);
                for (std::size_t piece = some.begin(); piece < some.end(); ++piece) cutter.cut(piece);
                return sums;
            },
            [](RegionSums a, const RegionSums& b) {
                a.add(b);
                return a;
            });
        if (&pieces == &pieces_) met_ = std::move(met);
        return all;
    }

    /// What volumes and means differ by, as parts of them and of the ranges.
    [[nodiscard]] double difference(const std::vector<double>& a, const std::vector<double>& b) const {
        if (!(a[0] > 0) || !(b[0] > 0)) return a[0] == b[0] ? 0 : 1;
        const std::vector<double> x = means_of(a), y = means_of(b);
        double largest = std::abs(x[0] - y[0]) / x[0];
        for (std::size_t c = 0; c < ranges_.size(); ++c) {
            if (ranges_[c] > rounding(c)) largest = std::max(largest, std::abs(x[1 + c] - y[1 + c]) / ranges_[c]);
        }
        return largest;
    }

    /// What the last halving has changed, and what was missed.
    [[nodiscard]] double halving_error(const RegionSums& sums, const RegionSums& before, std::size_t part) const {
        const double volume = sums.sums[part][0];
        return difference(sums.sums[part], before.sums[part]) + (volume > 0 ? sums.missed / volume : 0);
    }

    /// Of the values of a channel, which pieces keep as floats.
    [[nodiscard]] double rounding(std::size_t channel) const {
        return static_cast<double>(std::numeric_limits<float>::epsilon()) * largest_[channel];
    }

    [[nodiscard]] PartMeasure part_of(const RegionSums& sums, std::size_t part, double error) const {
        const std::vector<double> means = means_of(sums.sums[part]);
        PartMeasure result;
        result.volume = means[0];
        result.error = error;
        result.cells = cells_of(part);
        std::size_t channel = 0;
        for (const Attribute& field : mesh_.attributes) {
            for (int k = 0; k < field.channels; ++k, ++channel) {
                const double mean = means[0] > 0 ? pieces_.value_origins[channel] + means[1 + channel]
                                                 : std::numeric_limits<double>::quiet_NaN();
                const std::string suffix = field.channels > 1 ? "." + std::to_string(k) : "";
                FieldMeasure& one = result.fields.emplace_back();
                one.name = field.name + suffix;
                one.derived = field.derived;
                one.integral = means[0] > 0 ? mean * means[0] : 0;
                one.mean = mean;
            }
        }
        return result;
    }

    /// sums: with the extremes of the places that were summed
    void find_extremes(const RegionSums& sums, LimitMeasure& result) const {
        report_progress(options_.progress, "extremes", 0);
        std::vector<detail::RegionExtreme> all;
        for (std::size_t part = 0; part < sums.sums.size(); ++part) {
            for (std::size_t c = 0; c < ranges_.size(); ++c) {
                for (const bool high : {false, true}) {
                    detail::RegionExtreme& one = all.emplace_back();
                    if (part > 0) one.part = static_cast<Index>(part - 1);
                    one.channel = c;
                    one.sign = high ? 1 : -1;
                    one.limit = high ? bounds_[c][1] : -bounds_[c][0];
                    one.best = high ? sums.most[part][c] : sums.least[part][c];
                }
            }
        }
        tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
            const std::size_t part = i / 2 / ranges_.size(), c = all[i].channel;
            if (!(sums.sums[part][0] > 0)) return;
            const double in_region = sums.most[part][c].value - sums.least[part][c].value;
            detail::find_extreme(pieces_, regions_, options_.groups,
                                 std::max(options_.tolerance * in_region, of_pieces(c, 0) / 4), all[i]);
        });
        for (std::size_t i = 0; i < all.size(); ++i) {
            const std::size_t part = i / 2 / ranges_.size();
            const detail::RegionExtreme& one = all[i];
            FieldMeasure& field = (part == 0 ? result.whole : result.parts[part - 1]).fields[one.channel];
            if (!(sums.sums[part][0] > 0)) continue;  // no cell of the part lies in the region
            (one.sign > 0 ? field.max : field.min) = one.best;
            const double gap = one.open - one.sign * one.best.value;
            field.extreme_error = std::max(field.extreme_error, gap + of_pieces(one.channel, one.slope));
        }
    }

    /// How far a value of the pieces may be from that of the limit at the same place in the world.
    ///
    /// slope: of the value (value / world)
    [[nodiscard]] double of_pieces(std::size_t channel, double slope) const {
        constexpr auto kRounding = static_cast<double>(std::numeric_limits<float>::epsilon());
        constexpr double kKinks = 2;  // more than what the last level shows is left where the limit is least smooth
        const double position = kKinks * limit_.position_world + kRounding * bounds(mesh_).diagonal();
        return kKinks * limit_.value_of_range * ranges_[channel] + rounding(channel) + slope * position;
    }

    [[nodiscard]] SeenFolds folds() const {
        std::vector<Index> turned;
        for (std::size_t piece = 0; piece < pieces_.cells.size(); ++piece) {
            if ((met_[piece] & kTurned) != 0) turned.push_back(pieces_.cells[piece]);
        }
        return detail::seen_folds(mesh_, std::move(turned), options_.scheme, options_.progress);
    }

    /// Those with a part in the region.
    [[nodiscard]] std::size_t cells_of(std::size_t part) const {
        std::vector<std::uint8_t> seen(mesh_.cells.size(), 0);
        for (std::size_t piece = 0; piece < pieces_.cells.size(); ++piece) {
            const Index cell = pieces_.cells[piece];
            const bool of_part = part == 0 || static_cast<std::size_t>(options_.groups[cell]) + 1 == part;
            if (of_part && (met_[piece] & kMet) != 0) seen[cell] = 1;
        }
        return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), 1));
    }

    const HexMesh& mesh_;
    std::span<const Region> regions_;
    const MeasureOptions& options_;
    const LimitCells limit_;
    const LimitPieces& pieces_;
    const LimitCells coarse_;
    std::vector<std::uint8_t> met_;              // flags of each piece: kMet, kTurned
    std::vector<double> ranges_, largest_;       // of the channels; the largest value without the origin
    std::vector<std::array<double, 2>> bounds_;  // of the channels
};

/// regions: parts of space
LimitMeasure measured_in(const HexMesh& mesh, std::span<const Region> regions, const MeasureOptions& options) {
    if (!options.sets.empty()) {
        return detail::measured_by_sets(options, mesh.cells.size(),
                                        [&](const MeasureOptions& by) { return measured_in(mesh, regions, by); });
    }
    double missed = 0;
    std::optional<LimitMeasure> found = detail::with_given_figures(options, [&](const MeasureOptions& by, bool given) {
        if (!given) return RegionMeasurer(mesh, regions, by).measure(missed);
        const HexMesh of_file = detail::as_given(mesh);
        return RegionMeasurer(of_file, regions, by).measure(missed);
    });
    if (!found)
        throw Error(ErrorCode::InvalidInput, missed > 0 ? "too little of the volume lies in the region to be found"
                                                        : "no part of the volume lies in the region");
    return std::move(*found);
}

}  // namespace

LimitMeasure measure_limit_in(const HexMesh& mesh, std::span<const Region> regions, const MeasureOptions& options) {
    check_options(options);
    const auto [space, cells] = space_and_cells(regions);
    if (!cells.empty()) {
        if (!options.groups.empty() || !options.cells.empty()) {
            throw Error(ErrorCode::InvalidInput, "chooses cells, which have no groups and flags then", cells.front().text(),
                        "parts of space");
        }
        MeasureOptions in_cells = options;
        const std::vector<std::uint8_t> chosen = cells_in(mesh, cells);
        in_cells.cells = chosen;
        return space.empty() ? measure_limit(mesh, in_cells) : measure_limit_in(mesh, space, in_cells);
    }
    const std::span<const Region> parts = space;  // clang 14 cannot capture a structured binding
    return detail::measured_in_cells(
        mesh, options, [&](const MeshSource& part, const MeasureOptions& by) { return measured_in(*part.mesh(), parts, by); });
}

}  // namespace subvol
