// SPDX-License-Identifier: Apache-2.0
// Control values x whose limit is near to samples b, by least squares: min |A x − b|² + |D x|².
//
// Once for all fields: places of the samples in the limit; A, the limit there as a matrix; D, weighted first and second
// differences of control values, which continue values where samples do not decide them; places between the samples, to compare
// with the data.
//
// For each channel: the linear trend of the samples is taken off, unless smoothing is asked for ──► x starts as means of
// samples in the cells about a point, continued layer by layer ──► the solver's steps ──► values that samples hardly decide are
// kept near the range of what is left ──► the trend is added again ──► values are clamped to the range, if asked for. Very
// large or small values are scaled by a power of two first, so that their squares are numbers.
//
// Errors at the samples are those of A. At the worst samples, or at all if these are not many, between the samples and at
// extremes the limit itself is evaluated. Cells with errors beyond a tolerance can then be asked for.
#include "fitter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "comparison.h"
#include "data_field.h"
#include "differences.h"
#include "least_squares.h"
#include "located.h"
#include "subvol/detail/limit_place.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"
#include "subvol/option.h"
#include "subvol/probe.h"
#include "subvol/topology.h"
#include "trend.h"

namespace subvol::detail {

namespace {

using Vector = std::vector<double>;

// Times 2^exponent.
Vector scaled(Vector values, int exponent) {
    for (double& value : values) value = std::ldexp(value, exponent);
    return values;
}

/// Second differences continue what is around a value as far as the samples leave it open. With these weights errors of samples
/// are blown up by two or three at most where values alternate from point to point: a tenth of the second weight leaves more of
/// them, ten times of it meets samples worse. First differences let slopes fade over some ten cells without a sample.
DifferenceWeights weights_of(double usual_support, double asked) {
    constexpr double kSecond = 1e-3, kFirst = 1e-5;
    return {.first = (asked + kFirst) * usual_support, .second = kSecond * usual_support};
}

std::vector<Vec3> chosen(std::span<const Vec3> positions, std::span<const Index> samples) {
    std::vector<Vec3> taken;
    for (const Index s : samples) taken.push_back(positions[s]);
    return taken;
}

/// Values that continue samples to all control points: the mean over the cells about a point, and layer by layer outwards the
/// mean of the neighbours. unseen: the points without a sample in their cells
class Start {
public:
    Start(const Topology& topology, const std::vector<LimitQuery>& places) : topology_(topology), places_(places) {
        std::vector<std::uint8_t> seen(topology.point_count, 0);
        for (const LimitQuery& place : places) {
            for (const Index p : topology.cells[place.cell]) seen[p] = 1;
        }
        unseen_ = static_cast<std::size_t>(std::ranges::count(seen, 0));
        for (std::size_t left = unseen_, before = 0; left > 0 && left != before;) {
            before = left;
            std::vector<Index> layer;
            for (Index p = 0; p < seen.size(); ++p) {
                if (seen[p] == 0 &&
                    std::ranges::any_of(topology.point_edges[p], [&](Index e) { return seen[other(e, p)] == 1; })) {
                    layer.push_back(p);
                }
            }
            for (const Index p : layer) seen[p] = 2;  // so that a layer does not see itself
            layers_.push_back(layer);
            for (const Index p : layer) seen[p] = 1;
            left -= layer.size();
        }
    }

    [[nodiscard]] std::size_t unseen() const { return unseen_; }

    [[nodiscard]] Vector values(const Vector& wanted) const {
        Vector sums(topology_.point_count, 0), counts(topology_.point_count, 0);
        double all = 0;
        for (std::size_t k = 0; k < places_.size(); ++k) {
            all += wanted[k] / static_cast<double>(places_.size());
            for (const Index p : topology_.cells[places_[k].cell]) {
                sums[p] += wanted[k];
                counts[p] += 1;
            }
        }
        for (std::size_t p = 0; p < sums.size(); ++p) sums[p] = counts[p] > 0 ? sums[p] / counts[p] : all;
        for (const std::vector<Index>& layer : layers_) {
            Vector means;
            for (const Index p : layer) means.push_back(mean_of_neighbors(p, sums, counts));
            for (std::size_t k = 0; k < layer.size(); ++k) sums[layer[k]] = means[k];
            for (const Index p : layer) counts[p] = 1;
        }
        return sums;
    }

private:
    [[nodiscard]] Index other(Index edge, Index point) const {
        return topology_.edges[edge][0] == point ? topology_.edges[edge][1] : topology_.edges[edge][0];
    }

    [[nodiscard]] double mean_of_neighbors(Index point, const Vector& values, const Vector& counts) const {
        double sum = 0, count = 0;
        for (const Index e : topology_.point_edges[point]) {
            if (counts[other(e, point)] == 0) continue;
            sum += values[other(e, point)];
            count += 1;
        }
        return sum / count;
    }

    const Topology& topology_;
    const std::vector<LimitQuery>& places_;
    std::size_t unseen_ = 0;
    std::vector<std::vector<Index>> layers_;
};

std::vector<std::uint8_t> cells_at_boundary(const Topology& topology) {
    std::vector<std::uint8_t> at_boundary(topology.cells.size());
    parallel_each(at_boundary.size(), [&](std::size_t c) {
        at_boundary[c] = std::ranges::any_of(topology.cell_faces[c], [&](Index f) { return topology.face_on_boundary(f); });
    });
    return at_boundary;
}

/// The errors of one field, from its channels.
class ErrorSum {
public:
    ErrorSum(const Located& located, const std::vector<std::uint8_t>& at_boundary)
        : located_(located), at_boundary_(at_boundary), errors_(located.places.size(), 0) {}

    void add(const Vector& wanted, const Vector& found) {
        const auto [low, high] = located_.range_of(wanted);
        error_.range = std::max(error_.range, high - low);
        for (std::size_t k = 0; k < wanted.size(); ++k) {
            const double error = std::abs(found[k] - wanted[k]);
            const long double square = static_cast<long double>(error) * error;
            squares_ += square;
            ++count_;
            if (at_boundary_[located_.places[k].cell] != 0) {
                squares_of_boundary_ += square;
                ++boundary_count_;
            }
            errors_[k] = std::max(errors_[k], error);
        }
    }

    /// The samples with the largest errors, at most so many.
    [[nodiscard]] std::vector<Index> worst(std::size_t count) const {
        std::vector<Index> order(errors_.size());
        std::iota(order.begin(), order.end(), Index{0});
        count = std::min(count, order.size());
        std::ranges::partial_sort(order, order.begin() + static_cast<std::ptrdiff_t>(count), {},
                                  [&](Index k) { return std::pair(-errors_[k], k); });
        order.resize(count);
        return order;
    }

    void note_max(double error, const Vec3& at) {
        if (error > error_.max || std::isnan(error_.max_at.x)) {  // the first, even if nothing is off there
            error_.max = error;
            error_.max_at = at;
        }
    }

    [[nodiscard]] FieldError result(const std::string& name) const {
        FieldError error = error_;
        error.name = name;
        error.rms = root_mean(squares_, count_);
        if (boundary_count_ > 0) error.rms_boundary = root_mean(squares_of_boundary_, boundary_count_);
        return error;
    }

private:
    static double root_mean(long double squares, std::size_t count) {
        return static_cast<double>(std::sqrt(squares / static_cast<long double>(std::max<std::size_t>(count, 1))));
    }

    const Located& located_;
    const std::vector<std::uint8_t>& at_boundary_;
    std::vector<double> errors_;  // of each sample, the largest of the channels
    FieldError error_;
    long double squares_ = 0, squares_of_boundary_ = 0;  // the square of an error of 1e284 is no double
    std::size_t count_ = 0, boundary_count_ = 0;
};

}  // namespace

HexMesh prepared(HexMesh onto, ApproximateOptions& options) {
    check_options(options);
    check_options(options.scheme);
    onto.attributes.clear();
    validate(onto);
    if (options.scheme.crease_angle_deg) tag_creases(onto, *options.scheme.crease_angle_deg);
    options.scheme.crease_angle_deg.reset();
    return onto;
}

void check_samples(const HexMesh& samples) {
    if (samples.attributes.empty()) throw Error(ErrorCode::InvalidInput, "there is no field to approximate", "samples");
    for (const Attribute& field : samples.attributes) {
        const std::size_t count = samples.points.size() * static_cast<std::size_t>(field.channels);
        if (field.values.size() != count) {
            throw Error(
                ErrorCode::InvalidInput,
                "\"" + field.name + "\" has " + std::to_string(field.values.size()) + " values, not " + std::to_string(count),
                "samples");
        }
        const auto bad = std::ranges::find_if(field.values, [](double value) { return !std::isfinite(value); });
        if (bad != field.values.end()) {
            const auto row = static_cast<std::size_t>(bad - field.values.begin()) / static_cast<std::size_t>(field.channels);
            throw Error(ErrorCode::InvalidInput, "\"" + field.name + "\" has no finite value at sample " + std::to_string(row),
                        "samples");
        }
    }
}

SampleFinder::SampleFinder(const HexMesh& mesh, const ApproximateOptions& options) : mesh_(mesh) {
    options_.limit.scheme = options.scheme;
    options_.reach_world = options.reach * bounds(mesh).diagonal();
}

ProbeResult SampleFinder::at(std::span<const Vec3> positions, Progress* progress) {
    if (!inside_) inside_.emplace(mesh_, ProbeOptions{.limit = options_.limit});
    ProbeResult found = inside_->at(positions, progress);
    const auto outside = numbers_where<std::vector<Index>>(positions.size(), [&](std::size_t p) { return !found.inside(p); });
    if (outside.empty() || options_.reach_world == 0) return found;
    if (!near_) near_.emplace(mesh_, options_);
    const ProbeResult near = near_->at(chosen(positions, outside), progress);
    for (std::size_t k = 0; k < outside.size(); ++k) {
        found.cells[outside[k]] = near.cells[k];
        found.parameters[outside[k]] = near.parameters[k];
        found.distances[outside[k]] = near.distances[k];
    }
    return found;
}

struct Fitter::Parts {
    ApproximateOptions options;
    HexMesh mesh;
    DataField data;
    Topology topology;
    double diagonal;
    Located located;
    Comparison comparison;
    LimitMatrix limit;
    std::vector<Vec3> positions;  // of the samples in the limit
    Support support;
    CsrMatrix differences;
    LeastSquares system;
    Start start;
    std::vector<std::uint8_t> at_boundary;

    Parts(HexMesh given, DataField of_samples, const ApproximateOptions& asked, SampleFinder& finder)
        : options(asked),
          mesh(std::move(given)),
          data(std::move(of_samples)),
          topology(build_topology(mesh)),
          diagonal(bounds(mesh).diagonal()),
          located(located_samples(mesh, topology, data, options, finder)),
          comparison(data.has_cells() ? comparison_in_data(data, finder, options.progress)
                                      : comparison_with_samples(mesh, topology, located, options.scheme)),
          limit(mesh, {.scheme = options.scheme, .levels = options.levels, .progress = options.progress}, located.places,
                {located.positions, LimitOptions{}.tolerance * diagonal}, option_name("levels", options.names)),
          positions(in_limit()),
          support(topology, located.places),
          differences(detail::differences(mesh, topology, weights_of(support.usual, options.smoothing))),
          system(limit, differences, options.smoothing > 0 || !is_decided(), support.of_points),
          start(topology, located.places),
          at_boundary(cells_at_boundary(topology)) {}

    [[nodiscard]] std::vector<Vec3> in_limit() const {
        std::vector<Vec3> places = located.positions;
        if (located.snapped == 0) return places;
        for (int axis = 0; axis < 3; ++axis) {
            Vector control;
            for (const Vec3& x : mesh.points) control.push_back(x[axis]);
            const Vector found = limit.apply(control);
            for (std::size_t k = 0; k < found.size(); ++k) {
                if (located.is_snapped[k] != 0) places[k][axis] = found[k];
            }
        }
        return places;
    }

    [[nodiscard]] std::size_t undecided() const {
        std::size_t count = 0;
        for (std::size_t p = 0; p < topology.point_count; ++p)
            count += !topology.point_edges[p].empty() && support.is_poor(p) ? 1 : 0;
        return count;
    }

    /// Whether a field that is a limit of the mesh follows from its samples.
    [[nodiscard]] bool is_decided() const { return undecided() == 0 && limit.rows() >= limit.columns(); }

    /// The control values of a channel, the limit of which is near to the samples.
    ///
    /// wanted: at the samples
    /// found:  becomes the limit there
    [[nodiscard]] Vector control_values(const Vector& wanted, Vector& found, int& iterations, Progress* progress) const {
        // Squares of values are doubles for values of this size alone; powers of two change no digit.
        constexpr int kLargestExponent = 300;
        int exponent = 0;
        const auto [smallest, largest] = std::ranges::minmax(wanted);
        std::ignore = std::frexp(std::max(std::abs(smallest), std::abs(largest)), &exponent);
        if (std::abs(exponent) > kLargestExponent) {
            Vector values = control_values(scaled(wanted, -exponent), found, iterations, progress);
            found = scaled(std::move(found), exponent);
            return scaled(std::move(values), exponent);
        }
        // Smoothing that somebody asked for is that of the values themselves.
        const Trend trend = options.smoothing > 0 ? Trend() : trend_of(positions, wanted);
        Vector rest = wanted;
        for (std::size_t k = 0; k < rest.size(); ++k) rest[k] -= trend.at(positions[k]);
        Vector x = start.values(rest);
        iterations = std::max(iterations, system.solve(rest, x, options.iterations, progress));
        const auto [low, high] = std::ranges::minmax(rest);
        constexpr double kBeyond = 0.25;
        const double beyond = kBeyond * (high - low);
        for (std::size_t p = 0; p < x.size(); ++p) {
            if (support.is_poor(p)) x[p] = std::clamp(x[p], low - beyond, high + beyond);
        }
        found = limit.apply(x);
        for (std::size_t k = 0; k < found.size(); ++k) found[k] += trend.at(positions[k]);
        for (std::size_t p = 0; p < x.size(); ++p)
            x[p] += topology.point_edges[p].empty() ? trend.mean : trend.at(mesh.points[p]);
        if (!options.clamp && !options.keep_sign) return x;
        const auto [least, most] = located.range_of(wanted);
        if (!options.clamp && least < 0) return x;
        const double low_end = options.clamp ? least : 0;
        const double high_end = options.clamp ? most : std::numeric_limits<double>::infinity();
        for (double& value : x) value = std::clamp(value, low_end, high_end);
        found = limit.apply(x);
        return x;
    }

    /// Evaluates the limit itself where its matrix may not be exact enough for what is said: at the worst samples, or all if
    /// they are not many, between the samples, and at extremes.
    ///
    /// field:   the fitted one; wanted: at the samples, channel by channel
    /// between: at the places of the comparison, if the data has values there
    void compare(const Attribute& field, const std::vector<Vector>& wanted, const Vector& between, ErrorSum& errors,
                 FieldError& error) const {
        const auto channels = static_cast<std::size_t>(field.channels);
        constexpr std::size_t kEvaluated = 8192, kWorst = 64;
        const std::size_t count = located.places.size();
        const std::vector<Index> worst = errors.worst(count <= kEvaluated ? count : kWorst);
        std::vector<LimitQuery> places;
        for (const Index k : worst) places.push_back(located.places[k]);
        places.insert(places.end(), comparison.places.begin(), comparison.places.end());
        const std::vector<LimitQuery> extremes = places_of_extremes(topology, field);
        places.insert(places.end(), extremes.begin(), extremes.end());
        HexMesh fitted = mesh;
        fitted.attributes = {field};
        constexpr double kTolerance = 1e-10;  // a field that can be met has errors of rounding alone
        const LimitSamples limit_there = limit_at(fitted, places, {.scheme = options.scheme, .tolerance = kTolerance});
        const LimitAttribute& values_there = limit_there.attributes[0];
        Vector found = values_there.values;
        // Samples lie beside the places where they were found, as far as the search for them may be off.
        for (std::size_t i = 0; i < worst.size(); ++i) {
            const Vec3 off = located.positions[worst[i]] - limit_there.positions[i];
            if (located.is_snapped[worst[i]] != 0) continue;
            for (std::size_t c = 0; c < channels; ++c) {
                const std::size_t k = i * channels + c;
                found[k] += glm::dot(world_gradient(limit_there.jacobians[i], values_there.derivatives[k]), off);
            }
        }
        ErrorSum exact(located, at_boundary);  // of all samples, if all were evaluated
        for (std::size_t c = 0; c < channels && worst.size() == count; ++c) {
            Vector values(count);
            for (std::size_t i = 0; i < count; ++i) values[worst[i]] = found[i * channels + c];
            exact.add(wanted[c], values);
        }
        ErrorSum& known = worst.size() == count ? exact : errors;
        for (std::size_t i = 0; i < worst.size(); ++i) {
            double most = 0;
            for (std::size_t c = 0; c < channels; ++c)
                most = std::max(most, std::abs(found[i * channels + c] - wanted[c][worst[i]]));
            known.note_max(most, located.positions[worst[i]]);
        }
        error = known.result(field.name);
        double squares = 0;
        for (std::size_t i = 0; i < comparison.places.size(); ++i) {
            for (std::size_t c = 0; c < channels; ++c) {
                const double value = comparison.nearest.empty() ? between[i * channels + c] : wanted[c][comparison.nearest[i]];
                const double off = std::abs(found[(worst.size() + i) * channels + c] - value);
                squares += off * off;
                if (off > error.max_between || std::isnan(error.max_between_at.x)) {
                    error.max_between = off;
                    error.max_between_at = limit_there.positions[worst.size() + i];
                }
            }
        }
        if (!comparison.places.empty())
            error.rms_between = std::sqrt(squares / static_cast<double>(comparison.places.size() * channels));
        for (std::size_t c = 0; c < channels; ++c) {
            const auto [low, high] = located.range_of(wanted[c]);
            for (std::size_t i = 0; i < places.size(); ++i)
                error.beyond = std::max({error.beyond, low - found[i * channels + c], found[i * channels + c] - high});
        }
    }
};

Fitter::Fitter(HexMesh mesh, DataField data, const ApproximateOptions& options, SampleFinder& finder)
    : parts_(std::make_unique<Parts>(std::move(mesh), std::move(data), options, finder)) {
}

Fitter::~Fitter() = default;

bool Fitter::is_for(const HexMesh& samples) const {
    const HexMesh& data = parts_->data.mesh();
    return std::ranges::equal(samples.points, data.points) && std::ranges::equal(samples.cells, data.cells);
}

std::vector<Vector> Fitter::wanted(const Attribute& field, const Vector& between) const {
    const Located& located = parts_->located;
    const auto channels = static_cast<std::size_t>(field.channels);
    std::vector<Vector> wanted(channels);
    for (std::size_t c = 0; c < channels; ++c) {
        wanted[c].reserve(located.places.size());
        for (const Index s : located.samples) wanted[c].push_back(field.values[s * channels + c]);
        for (std::size_t k = 0; k < located.between.size(); ++k) wanted[c].push_back(between[k * channels + c]);
    }
    return wanted;
}

Approximation Fitter::fit(std::span<const Attribute> fields, Progress* progress) const {
    const Parts& parts = *parts_;
    const Located& located = parts.located;
    Approximation made{.mesh = parts.mesh, .report = {}};
    ApproximateReport& report = made.report;
    report.samples = located.samples.size();
    report.between = located.between.size();
    report.outside = located.outside;
    report.snapped = located.snapped;
    report.unseen = parts.start.unseen();
    report.undecided = parts.undecided();
    report.continuous = parts.data.has_cells();
    const auto between = parts.data.values(fields, located.between),
               compared = parts.data.values(fields, parts.comparison.in_data);
    for (std::size_t f = 0; f < fields.size(); ++f) {
        const auto channels = static_cast<std::size_t>(fields[f].channels);
        Attribute fitted{.name = fields[f].name, .channels = fields[f].channels, .values = {}};
        fitted.values.resize(parts.mesh.points.size() * channels);
        ErrorSum errors(located, parts.at_boundary);
        const std::vector<Vector> wanted = this->wanted(fields[f], between[f]);
        for (std::size_t c = 0; c < channels; ++c) {
            Vector found;
            const Vector x = parts.control_values(wanted[c], found, report.iterations, progress);
            errors.add(wanted[c], found);
            for (std::size_t p = 0; p < x.size(); ++p) fitted.values[p * channels + c] = x[p];
        }
        parts.compare(fitted, wanted, compared[f], errors, report.fields.emplace_back());
        made.mesh.attributes.push_back(std::move(fitted));
    }
    return made;
}

std::vector<std::uint8_t> Fitter::cells_beyond(double tolerance, std::span<const Attribute> fields,
                                               const Approximation& fit) const {
    const Located& located = parts_->located;
    std::vector<std::uint8_t> beyond(parts_->mesh.cells.size(), 0);
    const auto between = parts_->data.values(fields, located.between);
    for (std::size_t f = 0; f < fields.size(); ++f) {
        const double enough = tolerance * fit.report.fields[f].range;
        const auto channels = static_cast<std::size_t>(fields[f].channels);
        const std::vector<Vector> wanted = this->wanted(fields[f], between[f]);
        for (std::size_t c = 0; c < channels; ++c) {
            Vector x(parts_->mesh.points.size());
            for (std::size_t p = 0; p < x.size(); ++p) x[p] = fit.mesh.attributes[f].values[p * channels + c];
            const Vector found = parts_->limit.apply(x);
            for (std::size_t k = 0; k < found.size(); ++k) {
                if (std::abs(found[k] - wanted[c][k]) > enough) beyond[located.places[k].cell] = 1;
            }
        }
    }
    return beyond;
}

}  // namespace subvol::detail
