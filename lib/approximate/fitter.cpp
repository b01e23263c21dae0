// SPDX-License-Identifier: Apache-2.0
#include "fitter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "least_squares.h"
#include "subvol/cell.h"
#include "subvol/detail/parallel_sums.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"
#include "subvol/probe.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

using Vector = std::vector<double>;

/// How well the samples decide a control value: the sum of the squares of its trilinear weights in them.
Vector support_of(const Topology& topology, const std::vector<LimitQuery>& places) {
    return parallel_sums(topology.point_count, places.size(), [&](std::size_t k, Vector& sums) {
        const auto& cell = topology.cells[places[k].cell];
        const Vec3& at = places[k].uvw;
        for (std::size_t c = 0; c < 8; ++c) {
            double weight = 1;
            for (std::size_t a = 0; a < 3; ++a) {
                const double t = at[static_cast<int>(a)];
                weight *= kCornerParameters[c][a] != 0 ? t : 1 - t;
            }
            sums[cell[c]] += weight * weight;
        }
    });
}

/// Differences along edges and their weights: everywhere with the smoothing that was asked for, and where samples hardly decide
/// a value with so much that it follows its neighbours.
WeightedDifferences smoothing_of(const Topology& topology, const Vector& support, double asked) {
    constexpr double kPoor = 0.05, kPull = 0.01;  // parts of the usual support: the corner of a box has an eighth of it
    Vector sorted = support;
    std::erase(sorted, 0.0);
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::ranges::nth_element(sorted, middle);
    WeightedDifferences smoothing;
    for (const auto& edge : topology.edges) {
        const bool poor = std::min(support[edge[0]], support[edge[1]]) < kPoor * *middle;
        const double weight = (asked + (poor ? kPull : 0)) * *middle;
        if (weight == 0) continue;
        smoothing.edges.push_back(edge);
        smoothing.weights.push_back(std::sqrt(weight));
    }
    return smoothing;
}

std::vector<Vec3> chosen(std::span<const Vec3> positions, std::span<const Index> samples) {
    std::vector<Vec3> taken;
    for (const Index s : samples) taken.push_back(positions[s]);
    return taken;
}

/// Samples that lie in the volume, with their places.
struct Located {
    std::vector<LimitQuery> places;
    std::vector<Index> samples;
    std::size_t outside = 0, snapped = 0;
};

Located locate(const ProbeResult& found, std::span<const Vec3> positions) {
    Located located;
    for (std::size_t p = 0; p < positions.size(); ++p) {
        if (!found.inside(p)) {
            ++located.outside;
            continue;
        }
        if (found.distances[p] > 0) ++located.snapped;
        located.places.push_back({found.cells[p], found.parameters[p]});
        located.samples.push_back(static_cast<Index>(p));
    }
    if (located.places.empty()) {
        throw Error(ErrorCode::InvalidInput, "none of the samples lies in the limit of the mesh", "samples",
                    "places in the box of the mesh");
    }
    return located;
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
    ErrorSum(const std::vector<Vec3>& positions, const Located& located, const std::vector<std::uint8_t>& at_boundary)
        : positions_(positions), located_(located), at_boundary_(at_boundary) {}

    void add(const Vector& wanted, const Vector& found) {
        const auto [low, high] = std::ranges::minmax(wanted);
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
            if (error > error_.max) {
                error_.max = error;
                error_.max_at = positions_[located_.samples[k]];
            }
        }
    }

    [[nodiscard]] FieldError result(const std::string& name) const {
        FieldError error = error_;
        error.name = name;
        error.rms = root_mean(squares_, count_);
        error.rms_boundary = root_mean(squares_of_boundary_, boundary_count_);
        return error;
    }

private:
    static double root_mean(long double squares, std::size_t count) {
        return static_cast<double>(std::sqrt(squares / static_cast<long double>(std::max<std::size_t>(count, 1))));
    }

    const std::vector<Vec3>& positions_;
    const Located& located_;
    const std::vector<std::uint8_t>& at_boundary_;
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
    std::vector<Vec3> positions;
    Topology topology;
    double diagonal;
    Located located;
    LimitMatrix limit;
    Vector support;
    WeightedDifferences smoothing;
    LeastSquares system;
    Start start;
    std::vector<std::uint8_t> at_boundary;

    Parts(HexMesh given, std::vector<Vec3> at, const ApproximateOptions& asked, SampleFinder& finder)
        : options(asked),
          mesh(std::move(given)),
          positions(std::move(at)),
          topology(build_topology(mesh)),
          diagonal(bounds(mesh).diagonal()),
          located(locate(finder.at(positions, options.progress), positions)),
          limit(mesh, {.scheme = options.scheme, .levels = options.levels, .progress = options.progress}, located.places,
                {chosen(positions, located.samples), LimitOptions{}.tolerance * diagonal},
                option_name("levels", options.names)),
          support(support_of(topology, located.places)),
          smoothing(smoothing_of(topology, support, options.smoothing)),
          system(limit, smoothing, support),
          start(topology, located.places),
          at_boundary(cells_at_boundary(topology)) {}
};

Fitter::Fitter(HexMesh mesh, std::vector<Vec3> positions, const ApproximateOptions& options, SampleFinder& finder)
    : parts_(std::make_unique<Parts>(std::move(mesh), std::move(positions), options, finder)) {
}

Fitter::~Fitter() = default;

bool Fitter::is_for(std::span<const Vec3> positions) const {
    return std::ranges::equal(positions, parts_->positions);
}

Approximation Fitter::fit(std::span<const Attribute> fields, Progress* progress) const {
    const Parts& parts = *parts_;
    const Located& located = parts.located;
    Approximation made{.mesh = parts.mesh, .report = {}};
    ApproximateReport& report = made.report;
    report.samples = located.places.size();
    report.outside = located.outside;
    report.snapped = located.snapped;
    report.unseen = parts.start.unseen();
    for (const Attribute& field : fields) {
        const auto channels = static_cast<std::size_t>(field.channels);
        Attribute fitted{.name = field.name, .channels = field.channels, .values = Vector(parts.mesh.points.size() * channels)};
        ErrorSum errors(parts.positions, located, parts.at_boundary);
        for (std::size_t c = 0; c < channels; ++c) {
            Vector wanted;
            for (const Index s : located.samples) wanted.push_back(field.values[s * channels + c]);
            Vector x = parts.start.values(wanted);
            report.iterations = std::max(report.iterations, parts.system.solve(wanted, x, parts.options.iterations, progress));
            errors.add(wanted, parts.limit.apply(x));
            for (std::size_t p = 0; p < x.size(); ++p) fitted.values[p * channels + c] = x[p];
        }
        report.fields.push_back(errors.result(field.name));
        made.mesh.attributes.push_back(std::move(fitted));
    }
    return made;
}

std::vector<std::uint8_t> Fitter::cells_beyond(double tolerance, std::span<const Attribute> fields,
                                               const Approximation& fit) const {
    const Located& located = parts_->located;
    std::vector<std::uint8_t> beyond(parts_->mesh.cells.size(), 0);
    for (std::size_t f = 0; f < fields.size(); ++f) {
        const double enough = tolerance * fit.report.fields[f].range;
        const auto channels = static_cast<std::size_t>(fields[f].channels);
        for (std::size_t c = 0; c < channels; ++c) {
            Vector x(parts_->mesh.points.size());
            for (std::size_t p = 0; p < x.size(); ++p) x[p] = fit.mesh.attributes[f].values[p * channels + c];
            const Vector found = parts_->limit.apply(x);
            for (std::size_t k = 0; k < found.size(); ++k) {
                const double wanted = fields[f].values[located.samples[k] * channels + c];
                if (std::abs(found[k] - wanted) > enough) beyond[located.places[k].cell] = 1;
            }
        }
    }
    return beyond;
}

}  // namespace subvol::detail
