// SPDX-License-Identifier: Apache-2.0
// The limit is taken as triquadratic pieces. Pieces that lie in the region are integrated by Gauss points. Those that its faces
// cut are halved along u, v and w again and again where they are cut:
//
//     ┌─────┬─────┐      in:   Gauss points
//     │ in  │ in╱ │      cut:  halved, down to a depth; there the part of the cube on the inner side of the plane
//     │     │ ╱cut│            d + g·u = 0 through the depths at its corners counts, at the cube's centre
//     ├─────┼╱──┬─┤      out:  nothing
//     │     ╱cut├─┤
//     └────╱┴───┴─┘
//
// Where several faces cut a cube, the product of the parts behind each counts.
//
// The sums of the depth before are made on the way; what they differ by is the error, and the depth grows until that is small
// enough. The error falls with the square of the cubes' size.
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "piece_tree.h"
#include "subvol/error.h"
#include "subvol/measure.h"

namespace subvol {
namespace {

using detail::QuadraticWeights;

constexpr int kFirstDepth = 3, kMostDepth = 6;  // of control cells
constexpr std::size_t kGrain = 64;              // pieces: fixed, so that sums do not depend on the number of threads

/// The part of the cube [−½, ½]³ where d + g·u > 0. Of the n axes along which g is not about 0, with a_k = |g_k| and
/// t = d + Σ a_k / 2, it is Σ_S (−1)^|S| max(0, t − Σ_S a_k)ⁿ / (n! Π a_k) over all sets S of them.
double part_inside(double d, const Vec3& g) {
    constexpr double kLeast = 1e-4;
    const double largest = std::max({std::abs(g.x), std::abs(g.y), std::abs(g.z)});
    if (largest == 0) return d > 0 ? 1 : 0;
    std::array<double, 3> a{};
    std::size_t n = 0;
    double whole = 0, divisor = 1;
    for (int k = 0; k < 3; ++k) {
        if (std::abs(g[k]) <= kLeast * largest) continue;
        a[n++] = std::abs(g[k]);
        whole += std::abs(g[k]);
        divisor *= std::abs(g[k]) * static_cast<double>(n);
    }
    const double t = d + whole / 2;
    if (t <= 0) return 0;
    if (t >= whole) return 1;
    double sum = 0;
    for (std::size_t set = 0; set < std::size_t{1} << n; ++set) {
        double left = t, sign = 1;
        for (std::size_t k = 0; k < n; ++k) {
            if ((set >> k & 1) == 0) continue;
            left -= a[k];
            sign = -sign;
        }
        if (left > 0) sum += sign * std::pow(left, static_cast<double>(n));
    }
    return std::clamp(sum / divisor, 0.0, 1.0);
}

/// The place, the volume element and the values at a place of a piece.
struct PieceSample {
    Vec3 place{0.0};
    double element = 0;
    std::vector<double> values;
};

/// Sums and extremes of the parts, the whole first. Sums are the volume, then the integrals without the channels' origins.
struct RegionSums {
    std::vector<std::vector<double>> fine, coarse;
    std::vector<std::vector<LimitExtreme>> least, most;
    std::vector<std::vector<double>> histograms;

    RegionSums(std::size_t parts, std::size_t channels, std::size_t bins)
        : fine(parts, std::vector<double>(channels + 1, 0)),
          coarse(fine),
          least(parts, std::vector<LimitExtreme>(channels, {.value = std::numeric_limits<double>::infinity()})),
          most(parts, std::vector<LimitExtreme>(channels, {.value = -std::numeric_limits<double>::infinity()})),
          histograms(channels, std::vector<double>(bins, 0)) {}

    void add(const RegionSums& other) {
        for (std::size_t part = 0; part < fine.size(); ++part) {
            for (std::size_t k = 0; k < fine[part].size(); ++k) {
                fine[part][k] += other.fine[part][k];
                coarse[part][k] += other.coarse[part][k];
            }
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

/// Works on one piece after the other, at one depth.
///
/// bounds: of the values of each channel
/// range:  of the histograms, for each channel; empty: there are none
class PieceCutter {
public:
    PieceCutter(const LimitPieces& pieces, std::span<const Region> regions, std::span<const Index> groups, int depth,
                std::span<const std::array<double, 2>> bounds, std::span<const std::array<double, 2>> range, RegionSums& sums)
        : pieces_(pieces), regions_(regions), groups_(groups), depth_(depth), bounds_(bounds), range_(range), sums_(sums) {
        sample_.values.resize(pieces.value_origins.size());
    }

    void cut(std::size_t piece) {
        piece_ = piece;
        double furthest = 0;
        const Vec3 center = pieces_.position(piece, kMiddle);
        for (std::size_t n = 0; n < LimitPieces::kNodes; ++n) {
            furthest = std::max(furthest, glm::distance(center, pieces_.position(piece, n)));
        }
        constexpr double kBulge = 1.5;  // a piece may lie beyond its nodes
        halve(Vec3(0.0), 1, pieces_.levels[piece_], kBulge * furthest);
    }

private:
    static constexpr std::size_t kMiddle = 13;

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

    [[nodiscard]] Vec3 place_at(const Vec3& at) const {
        const QuadraticWeights u(at.x), v(at.y), w(at.z);
        Vec3 place(0.0);
        for (std::size_t n = 0, k = 0; k < 3; ++k) {
            for (std::size_t j = 0; j < 3; ++j) {
                for (std::size_t i = 0; i < 3; ++i, ++n) {
                    const float* node = pieces_.node(piece_, n);
                    place += u.values[i] * v.values[j] * w.values[k] * Vec3(node[0], node[1], node[2]);
                }
            }
        }
        return pieces_.origins[piece_] + place;
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

    /// The sample with the volume that it stands for. coarse: also in the sums of the depth before; inside: the place itself
    void add_sample(const Vec3& at, double volume, bool fine, bool coarse, bool inside) {
        each_part([&](std::size_t part) {
            const auto add = [&](std::vector<double>& sums) {
                sums[0] += volume;
                for (std::size_t c = 0; c < sample_.values.size(); ++c) sums[1 + c] += volume * sample_.values[c];
            };
            if (fine) add(sums_.fine[part]);
            if (coarse) add(sums_.coarse[part]);
        });
        if (fine && volume != 0) note_value(at, volume, inside);
    }

    void note_value(const Vec3& at, double volume, bool inside) {
        for (std::size_t c = 0; c < sample_.values.size(); ++c) {
            const double value = pieces_.value_origins[c] + sample_.values[c];
            if (!range_.empty()) {
                const auto& [low, high] = range_[c];
                auto& bins = sums_.histograms[c];
                const double place = high > low ? (value - low) / (high - low) * static_cast<double>(bins.size()) : 0;
                const auto last = static_cast<double>(bins.size() - 1);
                bins[static_cast<std::size_t>(std::clamp(place, 0.0, last))] += volume;
            }
            if (!inside) continue;
            each_part([&](std::size_t part) {
                const LimitExtreme here{value, sample_.place, pieces_.cells[piece_], in_cell(at)};
                if (value < sums_.least[part][c].value) sums_.least[part][c] = here;
                if (value > sums_.most[part][c].value) sums_.most[part][c] = here;
            });
        }
    }

    /// A cube of the piece that lies in the region, by points³ Gauss points, and its corners for the extremes.
    void add_inside(const Vec3& lower, double side, int points, bool coarse) {
        static const std::array<double, 2> two{0.5 - std::sqrt(1.0 / 12), 0.5 + std::sqrt(1.0 / 12)};
        static const std::array<double, 3> three{0.5 - std::sqrt(3.0 / 20), 0.5, 0.5 + std::sqrt(3.0 / 20)};
        constexpr std::array<double, 3> weights{5.0 / 18, 8.0 / 18, 5.0 / 18};
        const auto at = [&](int k) {
            return points == 2 ? two[static_cast<std::size_t>(k)] : three[static_cast<std::size_t>(k)];
        };
        const auto weight = [&](int k) { return points == 2 ? 0.5 : weights[static_cast<std::size_t>(k)]; };
        for (int k = 0; k < points; ++k) {
            for (int j = 0; j < points; ++j) {
                for (int i = 0; i < points; ++i) {
                    const Vec3 place = lower + side * Vec3(at(i), at(j), at(k));
                    evaluate(place);
                    add_sample(place, sample_.element * side * side * side * weight(i) * weight(j) * weight(k), true, coarse,
                               true);
                }
            }
        }
        for (int corner = 0; corner < 8; ++corner) {
            const Vec3 place = lower + side * Vec3(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
            evaluate(place);
            note_value(place, 0, true);
        }
    }

    /// A cube of the piece that may be cut. reach: no place of the cube is farther from its centre (world)
    void halve(const Vec3& lower, double side, int level, double reach) {
        const Vec3 middle = lower + Vec3(side / 2);
        const double inside = depth(regions_, place_at(middle));
        if (inside < -reach) return;
        const int end = std::max(depth_, pieces_.levels[piece_] + 1);
        if (inside > reach) return add_inside(lower, side, side == 1 ? 3 : 2, level < end);
        const bool last = level == end;
        if (last || level + 1 == end) {
            const CutCube cube = cut_cube(lower, side);
            evaluate(middle + side * cube.centroid);
            add_sample(middle, sample_.element * side * side * side * cube.part, last, !last, inside >= 0);
        }
        if (last) return;
        constexpr double kShrinks = 0.6;  // a half's reach, where the piece is bent
        for (int k = 0; k < 8; ++k) {
            halve(lower + side / 2 * Vec3(k & 1, k >> 1 & 1, k >> 2 & 1), side / 2, level + 1, kShrinks * reach);
        }
    }

    /// part:     of a cube, that lies behind all faces
    /// centroid: about that of the part, from the cube's centre in parts of its side
    struct CutCube {
        double part = 1;
        Vec3 centroid{0.0};
    };

    /// Each face is taken as a plane. The parts behind several are multiplied, which is exact for planes along the cube.
    [[nodiscard]] CutCube cut_cube(const Vec3& lower, double side) const {
        const Vec3 center = place_at(lower + Vec3(side / 2));
        std::array<Vec3, 8> corners{};
        for (int k = 0; k < 8; ++k) {
            corners[static_cast<std::size_t>(k)] = place_at(lower + side * Vec3(k & 1, k >> 1 & 1, k >> 2 & 1));
        }
        CutCube cut;
        for (const Region& region : regions_) {
            for (std::size_t face = 0; face < region.faces(); ++face) {
                Vec3 slope(0.0);
                double mean = 0;
                for (int k = 0; k < 8; ++k) {
                    const double at_corner = region.depth(corners[static_cast<std::size_t>(k)], face);
                    slope += at_corner / 4 * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
                    mean += at_corner / 8;
                }
                const double part = part_inside((mean + 2 * region.depth(center, face)) / 3, slope);
                const double largest = std::max({std::abs(slope.x), std::abs(slope.y), std::abs(slope.z)});
                cut.part *= part;
                if (largest > 0) cut.centroid += (1 - part) / 2 / largest * slope;
            }
        }
        cut.centroid = glm::clamp(cut.centroid, Vec3(-0.5), Vec3(0.5));
        return cut;
    }

    const LimitPieces& pieces_;
    std::span<const Region> regions_;
    std::span<const Index> groups_;
    int depth_;
    std::span<const std::array<double, 2>> bounds_, range_;
    RegionSums& sums_;
    std::size_t piece_ = 0;
    PieceSample sample_;
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
        : mesh_(mesh), regions_(regions), options_(options), pieces_(pieces(1, 3)), coarse_(pieces(8, 2)) {
        for (const Attribute& field : mesh.attributes) {
            const auto [min, max] = std::ranges::minmax(field.values);
            constexpr double kInfinity = std::numeric_limits<double>::infinity();
            for (std::size_t c = 0; c < static_cast<std::size_t>(field.channels); ++c) {
                ranges_.push_back(max - min);
                bounds_.push_back(field.bounds.empty() ? std::array<double, 2>{-kInfinity, kInfinity} : field.bounds[c]);
            }
        }
    }

    [[nodiscard]] LimitMeasure measure() const {
        int depth = kFirstDepth;
        RegionSums sums = sums_at(*pieces_, depth, {});
        while (depth < kMostDepth && depth_error(sums, 0) > options_.tolerance) sums = sums_at(*pieces_, ++depth, {});
        if (!(sums.fine[0][0] > 0)) throw Error(ErrorCode::InvalidInput, "no part of the volume lies in the region");
        const RegionSums rough = sums_at(*coarse_, kFirstDepth, {}), same = sums_at(*pieces_, kFirstDepth, {});
        std::vector<std::array<double, 2>> range;
        for (std::size_t c = 0; c < ranges_.size(); ++c) range.push_back({sums.least[0][c].value, sums.most[0][c].value});
        sums.histograms = sums_at(*pieces_, depth, range).histograms;
        LimitMeasure result;
        result.pieces = pieces_->cells.size();
        for (std::size_t part = 0; part < sums.fine.size(); ++part) {
            constexpr double kLeft =
                0.5;  // of what coarser pieces change: each level of pieces leaves an eighth of it, or less
            const double of_pieces = kLeft * difference(same.fine[part], rough.fine[part]);
            PartMeasure measured = part_of(sums, part, depth_error(sums, part) + of_pieces);
            if (part == 0) {
                result.whole = std::move(measured);
            } else {
                measured.name = options_.names[part - 1];
                result.parts.push_back(std::move(measured));
            }
        }
        return result;
    }

private:
    [[nodiscard]] std::shared_ptr<const LimitPieces> pieces(double coarser, int levels) const {
        const RefineOptions refinement{.scheme = options_.scheme, .progress = options_.progress};
        const double tolerance = coarser * options_.tolerance;
        return detail::pieces_within(
                   mesh_, refinement,
                   {.position_world = tolerance * bounds(mesh_).diagonal(), .value_of_range = tolerance, .max_levels = levels})
            .pieces;
    }

    [[nodiscard]] RegionSums sums_at(const LimitPieces& pieces, int depth, std::span<const std::array<double, 2>> range) const {
        report_progress(options_.progress, "region", static_cast<double>(depth - kFirstDepth) / kMostDepth);
        const RegionSums none(options_.names.size() + 1, ranges_.size(), static_cast<std::size_t>(options_.bins));
        return tbb::parallel_deterministic_reduce(
            tbb::blocked_range<std::size_t>(0, pieces.cells.size(), kGrain), none,
            [&](const auto& some, RegionSums sums) {
                PieceCutter cutter(pieces, regions_, options_.groups, depth, bounds_, range, sums);
                for (std::size_t piece = some.begin(); piece < some.end(); ++piece) cutter.cut(piece);
                return sums;
            },
            [](RegionSums a, const RegionSums& b) {
                a.add(b);
                return a;
            });
    }

    /// What volumes and means differ by, as parts of them and of the ranges.
    [[nodiscard]] double difference(const std::vector<double>& a, const std::vector<double>& b) const {
        if (!(a[0] > 0) || !(b[0] > 0)) return a[0] == b[0] ? 0 : 1;
        const std::vector<double> x = means_of(a), y = means_of(b);
        double largest = std::abs(x[0] - y[0]) / x[0];
        for (std::size_t c = 0; c < ranges_.size(); ++c) {
            if (ranges_[c] > 0) largest = std::max(largest, std::abs(x[1 + c] - y[1 + c]) / ranges_[c]);
        }
        return largest;
    }

    /// What is left at a depth: a third of what the last one changed.
    [[nodiscard]] double depth_error(const RegionSums& sums, std::size_t part) const {
        return difference(sums.fine[part], sums.coarse[part]) / 3;
    }

    [[nodiscard]] PartMeasure part_of(const RegionSums& sums, std::size_t part, double error) const {
        std::vector<double> best = sums.fine[part];  // the error falls by a quarter a depth
        for (std::size_t k = 0; k < best.size(); ++k) best[k] += (sums.fine[part][k] - sums.coarse[part][k]) / 3;
        best = means_of(std::move(best));
        PartMeasure result;
        result.volume = best[0];
        result.error = error;
        result.cells = cells_of(part);
        std::size_t channel = 0;
        for (const Attribute& field : mesh_.attributes) {
            for (int k = 0; k < field.channels; ++k, ++channel) {
                const double mean = pieces_->value_origins[channel] + best[1 + channel];
                const std::string suffix = field.channels > 1 ? "." + std::to_string(k) : "";
                result.fields.push_back({.name = field.name + suffix,
                                         .integral = mean * best[0],
                                         .mean = mean,
                                         .min = sums.least[part][channel],
                                         .max = sums.most[part][channel],
                                         .extreme_error = std::ldexp(ranges_[channel], -kMostDepth),
                                         .histogram = part == 0 ? sums.histograms[channel] : std::vector<double>()});
            }
        }
        return result;
    }

    [[nodiscard]] std::size_t cells_of(std::size_t part) const {
        std::vector<std::uint8_t> seen(mesh_.cells.size(), 0);
        for (std::size_t piece = 0; piece < pieces_->cells.size(); ++piece) {
            const Index cell = pieces_->cells[piece];
            const bool of_part = part == 0 || static_cast<std::size_t>(options_.groups[cell]) + 1 == part;
            if (of_part && depth(regions_, pieces_->position(piece, LimitPieces::kNodes / 2)) >= 0) seen[cell] = 1;
        }
        return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), 1));
    }

    const HexMesh& mesh_;
    std::span<const Region> regions_;
    const MeasureOptions& options_;
    std::shared_ptr<const LimitPieces> pieces_, coarse_;
    std::vector<double> ranges_;                 // of the channels
    std::vector<std::array<double, 2>> bounds_;  // of the channels
};

}  // namespace

LimitMeasure measure_limit_in(const HexMesh& mesh, std::span<const Region> regions, const MeasureOptions& options) {
    check_options(options);
    std::vector<Region> space, cells;
    for (const Region& region : regions) (region.chooses_cells() ? cells : space).push_back(region);
    if (cells.empty()) return RegionMeasurer(mesh, space, options).measure();
    if (!options.groups.empty()) {
        throw Error(ErrorCode::InvalidInput, "chooses cells, which have no groups then", cells.front().text(),
                    "parts of space");
    }
    const HexMesh part = only_in(mesh, cells);
    return space.empty() ? measure_limit(part, options) : RegionMeasurer(part, space, options).measure();
}

}  // namespace subvol
