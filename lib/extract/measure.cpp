// SPDX-License-Identifier: Apache-2.0
#include "subvol/measure.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "piece_tree.h"
#include "subvol/detail/limit_of_part.h"
#include "subvol/error.h"
#include "subvol/limit_level.h"

namespace subvol {

namespace {

constexpr std::size_t kMostBytes = std::size_t{4} << 30;
constexpr std::size_t kChunks = 64;  // of the pieces: fixed, so that sums do not depend on the number of threads
constexpr std::size_t kStarts = 6;   // places from which an extreme is searched for
constexpr int kMostRounds = 16;
constexpr double kShrink = 0.35;

constexpr std::array<double, 3> kGaussPlaces{0.11270166537925831, 0.5, 0.88729833462074169};
constexpr std::array<double, 3> kGaussWeights{5.0 / 18, 8.0 / 18, 5.0 / 18};

/// For each node the weight of its value and those of the derivatives by u, v, w.
using NodeWeights = std::array<std::array<double, 4>, 27>;

std::array<NodeWeights, 27> gauss_weights() {
    std::array<NodeWeights, 27> table;
    for (std::size_t g = 0; g < 27; ++g) {
        const detail::QuadraticWeights u(kGaussPlaces[g % 3]), v(kGaussPlaces[g / 3 % 3]), w(kGaussPlaces[g / 9]);
        for (std::size_t n = 0; n < 27; ++n) {
            const std::size_t i = n % 3, j = n / 3 % 3, k = n / 9;
            table[g][n] = {u.values[i] * v.values[j] * w.values[k], u.slopes[i] * v.values[j] * w.values[k],
                           u.values[i] * v.slopes[j] * w.values[k], u.values[i] * v.values[j] * w.slopes[k]};
        }
    }
    return table;
}

/// A place with the value of one channel, from which an extreme is searched for.
struct Start {
    double value;
    LimitQuery place;
    double step;  // in parameters: how far the extreme may be
};

/// The smallest and the largest values so far, at most kStarts of each, in order.
struct Extremes {
    std::vector<Start> low, high;

    void add(const Start& start) {
        keep(low, start, [](double a, double b) { return a < b; });
        keep(high, start, [](double a, double b) { return a > b; });
    }
    void add(const Extremes& more) {
        for (const Start& start : more.low) keep(low, start, [](double a, double b) { return a < b; });
        for (const Start& start : more.high) keep(high, start, [](double a, double b) { return a > b; });
    }

private:
    template <class Before>
    static void keep(std::vector<Start>& list, const Start& start, const Before& before) {
        if (list.size() == kStarts && !before(start.value, list.back().value)) return;
        auto at = list.end();
        while (at != list.begin() && before(start.value, (at - 1)->value)) --at;
        list.insert(at, start);
        if (list.size() > kStarts) list.pop_back();
    }
};

/// What the pieces of a part sum up to.
struct Sums {
    double volume = 0;
    std::vector<double> integrals;
    std::vector<Extremes> extremes;
};

class Measurer {
public:
    /// owned:        a flag for each cell that is measured, the others are a halo; none: all are
    /// longest_side: of the box of the whole mesh
    Measurer(const HexMesh& mesh, std::span<const std::uint8_t> owned, double longest_side, const MeasureOptions& options)
        : mesh_(mesh), options_(options), owned_(owned) {
        check();
        const LimitCellsOptions cells{.position_world = options.tolerance * std::max(longest_side, 1e-300),
                                      .value_of_range = options.tolerance,
                                      .max_bytes = kMostBytes};
        pieces_ = find_limit_cells(mesh, {.scheme = options.scheme, .levels = 0, .progress = options.progress}, cells).pieces;
        if (!pieces_) {
            throw Error(ErrorCode::MissingCapability, "the pieces of the limit take more than 4 GB", "measure",
                        "a larger tolerance");
        }
        channels_ = pieces_->node_size - 3;
        parts_ = 1;
        for (const Index group : options.groups) parts_ = std::max(parts_, static_cast<std::size_t>(group) + 1);
    }

    LimitMeasure measure(bool histograms) {
        std::vector<Sums> sums = integrate();
        Sums whole = sums.front();
        for (std::size_t p = 1; p < sums.size(); ++p) add(sums[p], whole);
        std::vector<PartMeasure> found(1, summed(whole));
        found[0].cells = owned_.empty() ? mesh_.cells.size() : static_cast<std::size_t>(std::ranges::count(owned_, 1));
        if (!options_.groups.empty()) {
            for (const Sums& part : sums) found.push_back(summed(part));
            for (std::size_t p = 0; p < parts_; ++p) found[p + 1].name = p < options_.names.size() ? options_.names[p] : "";
            for (const Index group : options_.groups) ++found[group + 1].cells;
        }
        std::vector<const Sums*> searched{&whole};
        for (std::size_t p = 0; p + 1 < found.size(); ++p) searched.push_back(&sums[p]);
        search(searched, found);
        if (histograms) add_histograms(found);
        LimitMeasure result{std::move(found.front()), {}, count_pieces()};
        result.parts.assign(std::make_move_iterator(found.begin() + 1), std::make_move_iterator(found.end()));
        return result;
    }

    /// found: the whole, whose extremes are those of the histograms, and then the parts
    void add_histograms(std::vector<PartMeasure>& found) const {
        const auto bins = static_cast<std::size_t>(options_.bins);
        const std::size_t size = found.size() * channels_ * bins;
        std::vector<std::vector<double>> chunks(kChunks);
        tbb::parallel_for(std::size_t{0}, kChunks, [&](std::size_t chunk) {
            auto& counts = chunks[chunk];
            counts.assign(size, 0);
            for (std::size_t piece = chunk_begin(chunk); piece < chunk_begin(chunk + 1); ++piece) {
                if (!is_owned(piece)) continue;
                const std::size_t part = part_of(pieces_->cells[piece]) + 1;
                each_gauss_point(piece, [&](const Vec3&, double weight, std::span<const double> values) {
                    for (std::size_t c = 0; c < channels_; ++c) {
                        const FieldMeasure& whole = found[0].fields[c];
                        const double width = whole.max.value - whole.min.value;
                        const double t = width > 0 ? (values[c] - whole.min.value) / width * static_cast<double>(bins) : 0;
                        const auto bin = static_cast<std::size_t>(std::clamp(t, 0.0, static_cast<double>(bins - 1)));
                        counts[c * bins + bin] += weight;
                        if (found.size() > 1) counts[(part * channels_ + c) * bins + bin] += weight;
                    }
                });
            }
        });
        for (std::size_t p = 0; p < found.size(); ++p) {
            for (std::size_t c = 0; c < channels_; ++c) {
                auto& histogram = found[p].fields[c].histogram;
                histogram.assign(bins, 0);
                for (std::size_t b = 0; b < bins; ++b) {
                    for (const auto& counts : chunks) histogram[b] += counts[(p * channels_ + c) * bins + b];
                }
            }
        }
    }

private:
    [[nodiscard]] bool is_owned(std::size_t piece) const { return owned_.empty() || owned_[pieces_->cells[piece]] != 0; }

    [[nodiscard]] std::size_t count_pieces() const {
        std::size_t count = 0;
        for (std::size_t piece = 0; piece < pieces_->cells.size(); ++piece) count += is_owned(piece) ? 1 : 0;
        return count;
    }

    void check() const {
        const auto refuse = [](const std::string& what, const std::string& allowed) {
            throw Error(ErrorCode::InvalidInput, what, "measure", allowed);
        };
        if (!(options_.tolerance > 0 && options_.tolerance <= 1))
            refuse("the tolerance is out of range", "greater than 0, at most 1");
        if (options_.bins < 1 || options_.bins > 100000) refuse("the number of bins is out of range", "1 to 100,000");
        if (!options_.groups.empty() && options_.groups.size() != mesh_.cells.size()) {
            refuse("there are " + std::to_string(options_.groups.size()) + " groups of cells", "one for each of the cells");
        }
    }

    [[nodiscard]] std::size_t part_of(Index cell) const { return options_.groups.empty() ? 0 : options_.groups[cell]; }
    [[nodiscard]] std::size_t chunk_begin(std::size_t chunk) const { return chunk * pieces_->cells.size() / kChunks; }

    /// Calls visit(uvw in the piece, weight, values) for the Gauss points of a piece. The weights sum to its volume.
    template <class Visit>
    void each_gauss_point(std::size_t piece, const Visit& visit) const {
        static const std::array<NodeWeights, 27> table = gauss_weights();
        values_of_thread().resize(channels_);
        const std::span<double> values = values_of_thread();
        for (std::size_t g = 0; g < 27; ++g) {
            const std::size_t a = g % 3, b = g / 3 % 3, c = g / 9;
            Mat3 jacobian(0.0);
            std::ranges::fill(values, 0);
            const float* node = pieces_->node(piece, 0);
            for (std::size_t n = 0; n < 27; ++n, node += pieces_->node_size) {
                const auto& [value, du, dv, dw] = table[g][n];
                const Vec3 p(node[0], node[1], node[2]);
                jacobian[0] += du * p;
                jacobian[1] += dv * p;
                jacobian[2] += dw * p;
                for (std::size_t s = 0; s < channels_; ++s) values[s] += value * static_cast<double>(node[3 + s]);
            }
            const double weight = kGaussWeights[a] * kGaussWeights[b] * kGaussWeights[c] * glm::determinant(jacobian);
            visit(Vec3(kGaussPlaces[a], kGaussPlaces[b], kGaussPlaces[c]), weight, values);
        }
    }

    static std::vector<double>& values_of_thread() {
        thread_local std::vector<double> values;
        return values;
    }

    [[nodiscard]] LimitQuery place_of(std::size_t piece, const Vec3& t) const {
        const auto& lowest = pieces_->lowest[piece];
        const double size = std::ldexp(1.0, -pieces_->levels[piece]);
        return {pieces_->cells[piece], glm::clamp(size * (Vec3(lowest[0], lowest[1], lowest[2]) + t), Vec3(0.0), Vec3(1.0))};
    }

    std::vector<Sums> integrate() const {
        std::vector<std::vector<Sums>> chunks(kChunks);
        tbb::parallel_for(std::size_t{0}, kChunks, [&](std::size_t chunk) {
            auto& sums = chunks[chunk];
            sums.resize(parts_);
            for (Sums& part : sums) part = {0, std::vector<double>(channels_), std::vector<Extremes>(channels_)};
            for (std::size_t piece = chunk_begin(chunk); piece < chunk_begin(chunk + 1); ++piece) {
                if (!is_owned(piece)) continue;
                Sums& part = sums[part_of(pieces_->cells[piece])];
                const double step = 0.5 * std::ldexp(1.0, -pieces_->levels[piece]);
                each_gauss_point(piece, [&](const Vec3& t, double weight, std::span<const double> values) {
                    part.volume += weight;
                    for (std::size_t c = 0; c < channels_; ++c) {
                        part.integrals[c] += weight * values[c];
                        part.extremes[c].add({values[c], place_of(piece, t), step});
                    }
                });
                for (std::size_t n = 0; n < LimitPieces::kNodes; ++n) {
                    const LimitQuery place = place_of(piece, 0.5 * Vec3(n % 3, n / 3 % 3, n / 9));
                    for (std::size_t c = 0; c < channels_; ++c) {
                        part.extremes[c].add({static_cast<double>(pieces_->node(piece, n)[3 + c]), place, step});
                    }
                }
            }
        });
        std::vector<Sums> sums = std::move(chunks.front());
        for (std::size_t chunk = 1; chunk < kChunks; ++chunk) {
            for (std::size_t p = 0; p < parts_; ++p) add(chunks[chunk][p], sums[p]);
        }
        return sums;
    }

    static void add(const Sums& more, Sums& to) {
        to.volume += more.volume;
        for (std::size_t c = 0; c < to.integrals.size(); ++c) {
            to.integrals[c] += more.integrals[c];
            to.extremes[c].add(more.extremes[c]);
        }
    }

    [[nodiscard]] PartMeasure summed(const Sums& sums) const {
        PartMeasure part;
        part.volume = sums.volume;
        std::size_t c = 0;
        for (std::size_t a = 0; a < pieces_->names.size(); ++a) {
            for (int k = 0; k < pieces_->channels[a]; ++k, ++c) {
                FieldMeasure field;
                field.name = pieces_->names[a] + (pieces_->channels[a] > 1 ? "." + std::to_string(k) : "");
                field.integral = sums.integrals[c];
                field.mean = sums.volume != 0 ? sums.integrals[c] / sums.volume : 0;
                part.fields.push_back(std::move(field));
            }
        }
        return part;
    }

    /// A search about one start, with its pattern of 27 places.
    struct Search {
        std::size_t part, channel;
        bool high;
        Start best;
        Vec3 position{0.0};
    };

    /// Fields are searched some at a time: all of those in question are evaluated at the places of each.
    void search(std::span<const Sums* const> of, std::vector<PartMeasure>& found) const {
        constexpr std::size_t kTogether = 16;
        const std::size_t count = mesh_.attributes.size();
        std::size_t first = 0;
        for (std::size_t a = 0; a < count; a += kTogether) {
            const auto begin = mesh_.attributes.begin() + static_cast<std::ptrdiff_t>(a);
            const auto end = mesh_.attributes.begin() + static_cast<std::ptrdiff_t>(std::min(a + kTogether, count));
            std::size_t channels = 0;
            for (auto field = begin; field != end; ++field) channels += static_cast<std::size_t>(field->channels);
            if (count <= kTogether) return search(mesh_, 0, channels, of, found);
            const HexMesh some{mesh_.points, mesh_.cells, {begin, end}, mesh_.creases, mesh_.sharp_faces};
            search(some, first, channels, of, found);
            first += channels;
        }
    }

    /// Goes from each start to the best of the places around it, which are nearer each time that it is the best itself.
    ///
    /// fields: have so many channels, which are those from the first one on
    void search(const HexMesh& fields, std::size_t first, std::size_t channels, std::span<const Sums* const> of,
                std::vector<PartMeasure>& found) const {
        std::vector<Search> searches;
        for (std::size_t p = 0; p < of.size(); ++p) {
            for (std::size_t c = first; c < first + channels; ++c) {
                for (const Start& start : of[p]->extremes[c].low) searches.push_back({p, c, false, start});
                for (const Start& start : of[p]->extremes[c].high) searches.push_back({p, c, true, start});
            }
        }
        for (Search& one : searches) one.best.value = one.high ? -INFINITY : INFINITY;
        std::vector<LimitQuery> queries(27 * searches.size());
        const LimitEvaluator limit(fields, {.scheme = options_.scheme});
        for (int round = 0; round < kMostRounds && !searches.empty(); ++round) {
            report_progress(options_.progress, "extremes", static_cast<double>(round) / kMostRounds);
            for (std::size_t q = 0; q < queries.size(); ++q) {
                const Start& from = searches[q / 27].best;
                const std::size_t n = q % 27;
                const Vec3 offset = from.step * (Vec3(n % 3, n / 3 % 3, n / 9) - Vec3(1.0));
                queries[q] = {from.place.cell, glm::clamp(from.place.uvw + offset, Vec3(0.0), Vec3(1.0))};
            }
            const LimitSamples samples = limit.at(queries);
            for (std::size_t s = 0; s < searches.size(); ++s) step(searches[s], first, 27 * s, queries, samples);
        }
        for (const Search& one : searches) {
            FieldMeasure& field = found[one.part].fields[one.channel];
            LimitExtreme& to = one.high ? field.max : field.min;
            if (to.cell == kNone || (one.high ? one.best.value > to.value : one.best.value < to.value)) {
                to = {one.best.value, one.position, one.best.place.cell, one.best.place.uvw};
            }
        }
    }

    void step(Search& one, std::size_t channel, std::size_t first, std::span<const LimitQuery> queries,
              const LimitSamples& samples) const {
        std::size_t best = 27;
        for (std::size_t n = 0; n < 27; ++n) {
            const double value = value_of(samples, first + n, one.channel - channel);
            if (one.high ? value <= one.best.value : value >= one.best.value) continue;
            one.best.value = value;
            best = n;
        }
        if (best == 27 || best == 13) one.best.step *= kShrink;  // 13: where it is
        if (best == 27) return;
        one.best.place = queries[first + best];
        one.position = samples.positions[first + best];
    }

    static double value_of(const LimitSamples& samples, std::size_t query, std::size_t channel) {
        for (const LimitAttribute& attribute : samples.attributes) {
            if (channel < attribute.channels) return attribute.values[query * attribute.channels + channel];
            channel -= attribute.channels;
        }
        return 0;
    }

    const HexMesh& mesh_;
    const MeasureOptions& options_;
    std::span<const std::uint8_t> owned_;
    std::shared_ptr<const LimitPieces> pieces_;
    std::size_t channels_ = 0, parts_ = 1;
};

LimitExtreme in_whole(LimitExtreme extreme, const MeshPiece& piece) {
    const std::uint64_t number = extreme.cell == kNone ? kNone : piece.cell_numbers[extreme.cell];
    extreme.cell = number < kNone ? static_cast<Index>(number) : kNone;
    return extreme;
}

/// Adds the measure of a piece to those before it. first: there are none
void add(const LimitMeasure& measured, const MeshPiece& piece, bool first, LimitMeasure& all) {
    all.pieces += measured.pieces;
    all.whole.cells += measured.whole.cells;
    all.whole.volume += measured.whole.volume;
    all.whole.fields.resize(measured.whole.fields.size());
    for (std::size_t f = 0; f < measured.whole.fields.size(); ++f) {
        const FieldMeasure& from = measured.whole.fields[f];
        FieldMeasure& to = all.whole.fields[f];
        to.name = from.name;
        to.integral += from.integral;
        if (first || from.min.value < to.min.value) to.min = in_whole(from.min, piece);
        if (first || from.max.value > to.max.value) to.max = in_whole(from.max, piece);
    }
}

/// Adds the volumes of a piece to the histograms of the whole.
void add_to_histograms(const Measurer& measurer, PartMeasure& whole) {
    std::vector<PartMeasure> piece(1, whole);
    measurer.add_histograms(piece);
    for (std::size_t f = 0; f < whole.fields.size(); ++f) {
        for (std::size_t b = 0; b < whole.fields[f].histogram.size(); ++b) {
            whole.fields[f].histogram[b] += piece[0].fields[f].histogram[b];
        }
    }
}

}  // namespace

LimitMeasure measure_limit(const MeshSource& source, const MeasureOptions& options) {
    const HexMesh* const mesh = source.mesh();
    if (mesh != nullptr) validate(*mesh);
    const Vec3 size = source.bounds().size();
    const double longest_side = std::max({size.x, size.y, size.z});
    if (mesh != nullptr) return Measurer(*mesh, {}, longest_side, options).measure(true);
    source.check_halo(detail::kHaloOfLimit, "values of the limit");
    if (!options.groups.empty()) throw Error(ErrorCode::InvalidInput, "bricks have no groups of cells", "measure");
    MeasureOptions quiet = options;
    quiet.progress = nullptr;
    LimitMeasure all;
    for_each_piece(source.stored(), "measure", options.progress, [&](std::size_t number, const MeshPiece& piece) {
        add(Measurer(piece.mesh, piece.owned_cells, longest_side, quiet).measure(false), piece, number == 0, all);
    });
    for (FieldMeasure& field : all.whole.fields) {
        field.mean = all.whole.volume != 0 ? field.integral / all.whole.volume : 0;
        field.histogram.assign(static_cast<std::size_t>(options.bins), 0);
    }
    for_each_piece(source.stored(), "histogram", options.progress, [&](std::size_t, const MeshPiece& piece) {
        add_to_histograms(Measurer(piece.mesh, piece.owned_cells, longest_side, quiet), all.whole);
    });
    return all;
}

}  // namespace subvol
