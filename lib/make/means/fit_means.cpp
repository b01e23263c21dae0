// SPDX-License-Identifier: Apache-2.0
// Values at points from cell means, without a search. A mean over cells loses the wave that alternates from cell to cell, so
// nothing that meets all means exactly can keep from amplifying waves near it. Here the mean at points is corrected twice:
//
//     u = B m + ends,   twice: u += B (m − A u),   limits,   three times: u += 1.5 B (m − A u), limits,   then one change for
//     the whole integral
//
//     B m at p    Σ w m + (Σ w g)·(x_p − Σ w x) over the cells at p, w their parts of the volume, x their centres, g gradients
//                 by their neighbours: the mean inside even grids, a linear reconstruction on the boundary
//     ends        on the boundary: (4/3) t1 t2 m[t1, t2, t3], the divided difference of the cells behind a face at distances
//                 t, so that the error there is that inside, +h² u''/6; without what a linear function has there
//     A u         T (u − (D u − s) / 12): means of straight cells (T, by corners) of the limit of MCQ, whose cell runs that far
//                 from its corners' surface. D: second differences along lines of the mesh; s_p = (Σ w g)·(D x)_p leaves out
//                 what the lines' own bends contribute, so that linear functions stay exact
//
// In an even grid, with c = cos(θ/2), S = 1 − c²: B = c, A = c (1 + S/3), and 1 − cA = S (2 + S) / 3 is between 0 and 1: after
// k corrections u = (sinc(θ/2) / A) (1 − (1 − cA)^(k+1)) of the truth. Nothing diverges, the alternating wave stays 0, and for
// k = 2 the error is 11 θ⁴/720: fourth order. The largest gain is 1.25. Limits take from the means what lies beyond those
// around a point; the corrections after them, a half larger as they have less to do, give back what can be given within the
// limits.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "mean_channels.h"
#include "mean_stencils.h"
#include "subvol/cell_means.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/stopwatch.h"
#include "whole_integral.h"

namespace subvol {

namespace {

using detail::kLanes;
using detail::Lanes;
using detail::MeanStencils;
using detail::parallel_each;

constexpr int kCorrections = 2, kWithin = 3;
constexpr double kMore = 1.5;  // below 2, so that nothing diverges
using LaneVectors = std::array<Lanes, 3>;

void add_lanes(Lanes& sum, double weight, const Lanes& value) {
    for (std::size_t l = 0; l < kLanes; ++l) sum[l] += weight * value[l];
}

Lanes along(const LaneVectors& vectors, const Vec3& direction) {
    Lanes sum{};
    for (std::size_t a = 0; a < 3; ++a) add_lanes(sum, direction[static_cast<int>(a)], vectors[a]);
    return sum;
}

// What the file says of a channel on faces of patches.
struct ChannelOnPatches {
    const FieldOnPatches* field = nullptr;
    std::size_t channel = 0;
    int exponent = 0;
    double low = 0;  // what the means are relative to

    // Whether the field on the face is known, or that it does not change across.
    [[nodiscard]] bool settles(Index face) const {
        if (field == nullptr || face == kNone) return false;
        const auto channels = static_cast<std::size_t>(field->channels);
        return std::isfinite(field->values[face * channels]) || field->is_level(face) || field->along[face] != 0;
    }
    // Not a number where it is not known.
    [[nodiscard]] double value(Index face) const {
        if (field == nullptr) return std::nan("");
        return std::ldexp(field->values[face * static_cast<std::size_t>(field->channels) + channel], -exponent) - low;
    }
};

// Up to kLanes channels, which are fitted together. beyond: how far the gradients lead beyond the means at each point
struct FitBatch {
    std::vector<Lanes> means, values, beyond, straight;  // straight: s
    std::vector<Lanes> from, to;                         // what values are kept between
    std::vector<Lanes> longest;                          // what the length of a vector is kept below, at its first lane
    std::array<bool, kLanes> is_vector{};                // of a field's first lane
    std::array<ChannelOnPatches, kLanes> on_patches{};
    Lanes high{};           // of the means, whose least is 0
    Lanes least{}, most{};  // that values may have: infinite where nothing bounds them
};

class LocalFit {
public:
    LocalFit(const HexMesh& mesh, const MeanStencils& stencils) : mesh_(mesh), stencils_(stencils) {}

    void fit(FitBatch& batch) {
        start(batch);
        for (int k = 0; k < kCorrections; ++k) {
            defects(batch, off_);
            correct(batch);
        }
        find_bounds(batch);
        find_ranges(batch);
        limit(batch);
        for (int k = 0; k < kWithin; ++k) {
            defects(batch, off_);
            correct(batch, kMore);
            limit(batch);
        }
    }

    /// m − A u, for each whole.
    void defects(const FitBatch& batch, std::vector<Lanes>& off) {
        straight_values_.resize(mesh_.points.size());
        parallel_each(mesh_.points.size(), [&](std::size_t p) {
            Lanes value = batch.values[p];
            add_lanes(value, 1. / 12, batch.straight[p]);
            for (const auto& [q, weight] : stencils_.bends[p]) add_lanes(value, -weight / 12, batch.values[q]);
            straight_values_[p] = value;
        });
        off.resize(batch.means.size());
        parallel_each(off.size(), [&](std::size_t w) {
            Lanes sum{};
            for (const Index c : stencils_.wholes.cells_of(w)) {
                for (std::size_t k = 0; k < 8; ++k) {
                    add_lanes(sum, stencils_.corners[c][k], straight_values_[mesh_.cells[c][k]]);
                }
            }
            for (std::size_t l = 0; l < kLanes; ++l) off[w][l] = batch.means[w][l] - sum[l] / stencils_.volumes[w];
        });
    }

private:
    void find_gradients(const std::vector<Lanes>& means) {
        gradients_.resize(means.size());
        parallel_each(means.size(), [&](std::size_t w) {
            LaneVectors gradient{};
            for (const auto& [n, slope] : stencils_.slopes[w]) {
                for (std::size_t l = 0; l < kLanes; ++l) {
                    const double step = means[n][l] - means[w][l];
                    for (std::size_t a = 0; a < 3; ++a) gradient[a][l] += slope[static_cast<int>(a)] * step;
                }
            }
            gradients_[w] = gradient;
        });
    }

    [[nodiscard]] LaneVectors gradient_at(std::size_t p) const {
        LaneVectors sum{};
        for (const auto& [w, weight] : stencils_.around[p]) {
            for (std::size_t a = 0; a < 3; ++a) add_lanes(sum[a], weight, gradients_[w][a]);
        }
        return sum;
    }

    [[nodiscard]] Lanes mean_at(const std::vector<Lanes>& means, std::size_t p) const {
        Lanes sum{};
        for (const auto& [w, weight] : stencils_.around[p]) add_lanes(sum, weight, means[w]);
        return sum;
    }

    void start(FitBatch& batch) {
        const std::size_t count = mesh_.points.size();
        batch.values.resize(count);
        batch.beyond.resize(count);
        batch.straight.resize(count);
        find_gradients(batch.means);
        parallel_each(count, [&](std::size_t p) {
            const LaneVectors gradient = gradient_at(p);
            batch.beyond[p] = along(gradient, stencils_.offsets[p]);
            batch.straight[p] = along(gradient, stencils_.mesh_bends[p]);
            Lanes value = mean_at(batch.means, p);
            add_lanes(value, 1, batch.beyond[p]);
            for (const auto& [w, weight] : stencils_.ends[p]) add_lanes(value, weight, batch.means[w]);
            add_lanes(value, -1, along(gradient, stencils_.mesh_ends[p]));
            batch.values[p] = value;
        });
    }

    void correct(FitBatch& batch, double factor = 1) {
        find_gradients(off_);
        parallel_each(mesh_.points.size(), [&](std::size_t p) {
            add_lanes(batch.values[p], factor, mean_at(off_, p));
            add_lanes(batch.values[p], factor, along(gradient_at(p), stencils_.offsets[p]));
        });
    }

    // Where at least one cell of 50 has the least mean, and all its neighbours have it, as in the water or the air of a tank,
    // no value is less; and so for the greatest. A linear field has no such cells.
    void find_bounds(FitBatch& batch) const {
        constexpr double kPlateau = .02, kNear = 1e-3, kNoBound = std::numeric_limits<double>::infinity();
        const double many = kPlateau * static_cast<double>(batch.means.size());
        for (std::size_t l = 0; l < kLanes; ++l) {
            const double near = kNear * batch.high[l];
            const auto flat_cells = [&](const auto& is_near) {
                std::size_t count = 0;
                for (std::size_t w = 0; w < batch.means.size(); ++w) {
                    if (!is_near(batch.means[w][l])) continue;
                    const auto neighbours = stencils_.slopes[w];
                    count += std::ranges::all_of(neighbours, [&](const auto& n) { return is_near(batch.means[n.column][l]); });
                }
                return static_cast<double>(count);
            };
            batch.least[l] = flat_cells([&](double mean) { return mean <= near; }) >= many ? 0 : -kNoBound;
            batch.most[l] =
                flat_cells([&](double mean) { return mean >= batch.high[l] - near; }) >= many ? batch.high[l] : kNoBound;
        }
    }

    // The range of the means around each point, and of the values that the file has on faces there. Across a side of the
    // boundary of which it says nothing the means lead on: by twice the smaller of the last two steps towards it, from the
    // centre half a cell on, so that a linear function is free, and a layer of one cell leads nowhere. In uneven meshes the
    // linear reconstruction may lie a little beyond. Parts of a whole see the neighbours of the whole, too: its own mean alone
    // does not make a range.
    void find_ranges(FitBatch& batch) const {
        batch.from.resize(mesh_.points.size());
        batch.to.resize(mesh_.points.size());
        parallel_each(mesh_.points.size(), [&](std::size_t p) {
            constexpr double kFar = std::numeric_limits<double>::infinity();
            // Of the range: the points of uneven cells may lie beside all between their centres, and corners of the boundary
            // beyond what the sides there reach.
            const double uneven = stencils_.reaches[p].empty() ? .25 : 1;
            Lanes low, high;
            low.fill(kFar);
            high.fill(-kFar);
            const auto widen = [&](const Lanes& mean) {
                for (std::size_t l = 0; l < kLanes; ++l) {
                    low[l] = std::min(low[l], mean[l]);
                    high[l] = std::max(high[l], mean[l]);
                }
            };
            bool parts = false;
            for (const auto& [w, weight] : stencils_.around[p]) {
                widen(batch.means[w]);
                if (stencils_.wholes.cells_of(w).size() == 1) continue;
                parts = true;
                for (const auto& [n, slope] : stencils_.slopes[w]) widen(batch.means[n]);
            }
            each_reached(batch, p, widen);
            const Lanes mean = mean_at(batch.means, p);
            for (std::size_t l = 0; l < kLanes && low[l] <= high[l]; ++l) {
                const bool settled =
                    std::ranges::any_of(stencils_.faces[p], [&](Index face) { return batch.on_patches[l].settles(face); });
                const double width = high[l] - low[l], linear = mean[l] + batch.beyond[p][l];
                if (!settled && parts) {
                    const double more = std::min(2 * std::abs(batch.beyond[p][l]), width);
                    low[l] -= more;
                    high[l] += more;
                } else if (!settled) {
                    low[l] = std::min(low[l], std::max(linear, low[l] - uneven * width));
                    high[l] = std::max(high[l], std::min(linear, high[l] + uneven * width));
                }
                for (const Index face : stencils_.faces[p]) {
                    const double there = batch.on_patches[l].value(face);
                    if (!std::isfinite(there)) continue;
                    low[l] = std::min(low[l], there);
                    high[l] = std::max(high[l], there);
                }
                low[l] = std::min(std::max(low[l], batch.least[l]), batch.most[l]);
                high[l] = std::max(std::min(high[l], batch.most[l]), batch.least[l]);
            }
            batch.from[p] = low;
            batch.to[p] = high;
        });
        find_lengths(batch);
    }

    // Components that are each within their range may make a vector longer than all around it.
    void find_lengths(FitBatch& batch) const {
        if (std::ranges::none_of(batch.is_vector, [](bool is) { return is; })) return;
        batch.longest.resize(mesh_.points.size());
        parallel_each(mesh_.points.size(), [&](std::size_t p) {
            Lanes longest{};
            const auto widen = [&](const Lanes& mean) {
                for (std::size_t l = 0; l + 2 < kLanes; ++l) {
                    if (batch.is_vector[l]) longest[l] = std::max(longest[l], length_at(batch, mean, l));
                }
            };
            for (const auto& [w, weight] : stencils_.around[p]) {
                widen(batch.means[w]);
                if (stencils_.wholes.cells_of(w).size() == 1) continue;
                for (const auto& [n, slope] : stencils_.slopes[w]) widen(batch.means[n]);
            }
            each_reached(batch, p, widen);
            for (const Index face : stencils_.faces[p]) {
                Lanes there{};
                for (std::size_t l = 0; l < kLanes; ++l) {
                    const double value = batch.on_patches[l].value(face);
                    there[l] = std::isfinite(value) ? value : batch.means[stencils_.around[p].front().column][l];
                }
                widen(there);
            }
            Lanes linear = mean_at(batch.means, p);
            bool settled = stencils_.around[p].empty();
            for (std::size_t l = 0; l < kLanes; ++l) {
                for (const Index face : stencils_.faces[p]) settled = settled || batch.on_patches[l].settles(face);
                linear[l] = std::max(batch.from[p][l], std::min(linear[l] + batch.beyond[p][l], batch.to[p][l]));
            }
            if (!settled) widen(linear);
            batch.longest[p] = longest;
        });
    }

    [[nodiscard]] static double length_at(const FitBatch& batch, const Lanes& values, std::size_t lane) {
        double square = 0;
        for (std::size_t l = lane; l < lane + 3; ++l) square += std::pow(values[l] + batch.on_patches[l].low, 2);
        return std::sqrt(square);
    }

    // Calls call(values) for what the means of each cell at a point of the boundary lead to there.
    template <class Call>
    void each_reached(const FitBatch& batch, std::size_t p, const Call& call) const {
        const auto reaches = stencils_.reaches[p];
        for (std::size_t i = 0; i < reaches.size();) {
            const Index w = reaches[i].first;
            Lanes reached = batch.means[w];
            for (; i < reaches.size() && reaches[i].first == w; ++i) reach(batch, reaches[i], reached);
            call(reached);
        }
    }

    static void reach(const FitBatch& batch, const detail::MeanReach& end, Lanes& reached) {
        for (std::size_t l = 0; l < kLanes; ++l) {
            if (batch.on_patches[l].settles(end.face)) continue;
            const double last = batch.means[end.first][l] - batch.means[end.second][l];
            const double before = end.third == kNone ? last : batch.means[end.second][l] - batch.means[end.third][l];
            if ((last > 0) == (before > 0)) reached[l] += 2 * end.part * (std::abs(last) < std::abs(before) ? last : before);
        }
    }

    void limit(FitBatch& batch) const {
        parallel_each(mesh_.points.size(), [&](std::size_t p) {
            Lanes& values = batch.values[p];
            const auto keep_between = [&](std::size_t first, std::size_t last) {
                for (std::size_t l = first; l < last && batch.from[p][l] <= batch.to[p][l]; ++l)
                    values[l] = std::clamp(values[l], batch.from[p][l], batch.to[p][l]);
            };
            keep_between(0, kLanes);
            for (std::size_t l = 0; l + 2 < kLanes; ++l) {
                if (!batch.is_vector[l]) continue;
                const double length = length_at(batch, values, l), most = batch.longest[p][l];
                if (!(length > most)) continue;
                for (std::size_t k = l; k < l + 3; ++k) {
                    const double low = batch.on_patches[k].low;
                    values[k] = most / length * (values[k] + low) - low;
                }
                keep_between(l, l + 3);
            }
        });
    }

    const HexMesh& mesh_;
    const MeanStencils& stencils_;
    std::vector<Lanes> off_, straight_values_;
    std::vector<LaneVectors> gradients_;
};

class FieldsFit {
public:
    FieldsFit(const HexMesh& mesh, const MeanStencils& stencils, const ValuesOnPatches* on_patches)
        : stencils_(stencils), on_patches_(on_patches), fit_(mesh, stencils) {}

    std::vector<detail::FittedChannel> fit(std::span<const Attribute> fields) {
        const std::vector<detail::MeanChannel> numbers = detail::mean_channels(fields);
        std::vector<detail::FittedChannel> channels;
        for (std::size_t first = 0, last = 0; first < numbers.size(); first = last) {
            // A vector is fitted as a whole.
            last = std::min(first + kLanes, numbers.size());
            while (last < numbers.size() && numbers[last].number > 0 && numbers[last].number < kLanes - 1 && last > first + 1 &&
                   numbers[last].field != numbers[first].field)
                --last;
            fit_some(fields, std::span(numbers).subspan(first, last - first), channels);
        }
        return channels;
    }

    [[nodiscard]] const CellMeansReport& report() const { return report_; }

private:
    void fit_some(std::span<const Attribute> fields, std::span<const detail::MeanChannel> numbers,
                  std::vector<detail::FittedChannel>& channels) {
        FitBatch batch;
        batch.means.resize(stencils_.wholes.size());
        for (std::size_t l = 0; l < numbers.size(); ++l) {
            detail::FittedChannel& channel = channels.emplace_back(detail::FittedChannel{.channel = numbers[l], .values = {}});
            std::vector<double> of_cells = detail::channel_values(fields, numbers[l]);
            channel.exponent = detail::mean_exponent(of_cells);
            detail::divide_values(of_cells, channel.exponent);
            const auto [low, high] = std::ranges::minmax(of_cells);
            channel.low = low;
            channel.high = high;
            batch.high[l] = channel.high - channel.low;
            batch.on_patches[l] = {on_patches_of(fields[numbers[l].field]), numbers[l].number, channel.exponent, channel.low};
            for (std::size_t w = 0; w < batch.means.size(); ++w) {
                batch.means[w][l] = of_cells[stencils_.wholes.cells_of(w).front()] - channel.low;
                channel.integral += stencils_.volumes[w] * batch.means[w][l];
            }
        }
        for (std::size_t l = 0; l + 2 < numbers.size(); ++l) {
            const bool vector = numbers[l].number == 0 && fields[numbers[l].field].channels == 3;
            const int exponent = batch.on_patches[l].exponent;  // one for all, so that a length can be had of them
            batch.is_vector[l] =
                vector && batch.on_patches[l + 1].exponent == exponent && batch.on_patches[l + 2].exponent == exponent;
        }
        fit_.fit(batch);
        fit_.defects(batch, off_);
        for (std::size_t l = 0; l < numbers.size(); ++l) {
            detail::FittedChannel& channel = channels[channels.size() - numbers.size() + l];
            constexpr double kNoBound = std::numeric_limits<double>::infinity();
            const bool scalar = fields[numbers[l].field].channels == 1;  // the limit of others is not kept within bounds
            channel.least = scalar ? batch.least[l] : -kNoBound;
            channel.most = scalar ? batch.most[l] : kNoBound;
            channel.values.resize(batch.values.size());
            channel.from.resize(batch.values.size());
            channel.to.resize(batch.values.size());
            for (std::size_t p = 0; p < batch.values.size(); ++p) {
                channel.values[p] = batch.values[p][l];
                channel.from[p] = batch.from[p][l];
                channel.to[p] = batch.to[p][l];
            }
            for (std::size_t w = 0; w < off_.size(); ++w) channel.lacks += stencils_.volumes[w] * off_[w][l];
            take_defects(l, batch.high[l]);
        }
    }

    [[nodiscard]] const FieldOnPatches* on_patches_of(const Attribute& field) const {
        if (on_patches_ == nullptr) return nullptr;
        const auto found = std::ranges::find(on_patches_->fields, field.name, &FieldOnPatches::name);
        return found != on_patches_->fields.end() && found->channels == field.channels ? &*found : nullptr;
    }

    void take_defects(std::size_t lane, double range) {
        if (!(range > 0)) return;
        double squares = 0;
        for (const Lanes& off : off_) {
            squares += off[lane] / range * (off[lane] / range);
            report_.most_off = std::max(report_.most_off, std::abs(off[lane]) / range);
        }
        report_.rms_off = std::max(report_.rms_off, std::sqrt(squares / static_cast<double>(off_.size())));
    }

    const MeanStencils& stencils_;
    const ValuesOnPatches* on_patches_;
    LocalFit fit_;
    CellMeansReport report_;
    std::vector<Lanes> off_;
};

// on_patches: or null
CellMeansFit fitted(const HexMesh& mesh, std::span<const Attribute> fields, std::span<const Index> parts, Progress* progress,
                    const ValuesOnPatches* on_patches) {
    detail::check_means(mesh, fields, parts);
    const detail::Stopwatch watch;
    CellMeansFit result;
    result.fields = detail::empty_fields(mesh, fields);
    std::vector<detail::FittedChannel> channels;
    detail::StraightVolume straight;
    {
        const MeanStencils stencils = detail::mean_stencils(mesh, build_topology(mesh), parts, on_patches);
        FieldsFit fit(mesh, stencils, on_patches);
        channels = fit.fit(fields);
        result.report = fit.report();
        straight = detail::straight_volume(mesh, stencils);
    }
    detail::correct_integrals(mesh, straight, channels, progress);
    for (const detail::FittedChannel& channel : channels) {
        Attribute& field = result.fields[channel.channel.field];
        const auto width = static_cast<std::size_t>(field.channels);
        for (std::size_t p = 0; p < channel.values.size(); ++p) {
            field.values[p * width + channel.channel.number] = channel.value(p);
        }
        const auto bounds = channel.bounds();
        if (std::ranges::any_of(bounds, [](double bound) { return std::isfinite(bound); })) field.bounds = {bounds};
    }
    result.report.seconds = watch.seconds();
    return result;
}

}  // namespace

CellMeansFit fit_cell_means(const HexMesh& mesh, std::span<const Attribute> fields, std::span<const Index> parts,
                            Progress* progress) {
    return fitted(mesh, fields, parts, progress, nullptr);
}

CellMeansFit fit_cell_means(const HexMesh& mesh, std::span<const Attribute> fields, const ValuesOnPatches& on_patches,
                            std::span<const Index> parts, Progress* progress) {
    return fitted(mesh, fields, parts, progress, &on_patches);
}

}  // namespace subvol
