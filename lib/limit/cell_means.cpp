// SPDX-License-Identifier: Apache-2.0
#include "subvol/cell_means.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "subvol/detail/parallel_each.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/limit.h"

namespace subvol {

namespace {

using detail::parallel_each;

constexpr std::size_t kNodes = 27;

// Limit points of a control cell: 3 along each axis, u fastest, from the corners of its children.
constexpr std::array<std::array<std::size_t, 3>, 8> kCorner{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

std::array<Index, kNodes> nodes_of(const std::vector<std::array<Index, 8>>& children, std::size_t cell) {
    std::array<Index, kNodes> nodes{};
    for (std::size_t k = 0; k < 8; ++k) {
        for (std::size_t j = 0; j < 8; ++j) {
            const auto at = [&](std::size_t a) { return kCorner[k][a] + kCorner[j][a]; };
            nodes[at(0) + 3 * at(1) + 9 * at(2)] = children[8 * cell + k][j];
        }
    }
    return nodes;
}

// Values and derivatives of the parabolas through 0, 1/2 and 1 at the points of Gauss, with these points' weights.
struct GaussLine {
    std::array<std::array<double, 3>, 3> value, slope;
    std::array<double, 3> weight{5. / 18, 8. / 18, 5. / 18};

    GaussLine() {
        const double h = std::sqrt(.15);
        const std::array<double, 3> at{.5 - h, .5, .5 + h};
        for (std::size_t g = 0; g < 3; ++g) {
            const double u = at[g];
            value[g] = {(1 - u) * (1 - 2 * u), 4 * u * (1 - u), u * (2 * u - 1)};
            slope[g] = {4 * u - 3, 4 - 8 * u, 4 * u - 1};
        }
    }
};

// The integral of each node's function times the Jacobian's determinant.
std::array<double, kNodes> integrals(const std::array<Vec3, kNodes>& x) {
    static const GaussLine line;
    std::array<double, kNodes> weights{};
    for (std::size_t gw = 0; gw < 3; ++gw) {
        for (std::size_t gv = 0; gv < 3; ++gv) {
            for (std::size_t gu = 0; gu < 3; ++gu) {
                std::array<double, kNodes> value;
                Vec3 u(0.0), v(0.0), w(0.0);
                for (std::size_t n = 0; n < kNodes; ++n) {
                    const std::size_t i = n % 3, j = n / 3 % 3, k = n / 9;
                    const double a = line.value[gu][i], b = line.value[gv][j], c = line.value[gw][k];
                    value[n] = a * b * c;
                    u += line.slope[gu][i] * b * c * x[n];
                    v += a * line.slope[gv][j] * c * x[n];
                    w += a * b * line.slope[gw][k] * x[n];
                }
                const double weight = line.weight[gu] * line.weight[gv] * line.weight[gw] * glm::dot(u, glm::cross(v, w));
                for (std::size_t n = 0; n < kNodes; ++n) weights[n] += weight * value[n];
            }
        }
    }
    return weights;
}

// As if the cell were a box.
std::array<double, kNodes> even_integrals() {
    std::array<double, kNodes> weights{};
    constexpr std::array<double, 3> kSimpson{1. / 6, 4. / 6, 1. / 6};
    for (std::size_t n = 0; n < kNodes; ++n) weights[n] = kSimpson[n % 3] * kSimpson[n / 3 % 3] * kSimpson[n / 9];
    return weights;
}

struct Matrix {
    std::vector<std::size_t> offsets{0};
    std::vector<Index> columns;
    std::vector<float> weights;

    [[nodiscard]] std::size_t rows() const { return offsets.size() - 1; }

    void apply(const std::vector<double>& in, std::vector<double>& out) const {
        parallel_each(rows(), [&](std::size_t r) {
            double sum = 0;
            for (std::size_t k = offsets[r]; k < offsets[r + 1]; ++k) sum += static_cast<double>(weights[k]) * in[columns[k]];
            out[r] = sum;
        });
    }

    [[nodiscard]] Matrix transposed(std::size_t count) const {
        Matrix result;
        result.offsets.assign(count + 1, 0);
        for (const Index column : columns) ++result.offsets[column + 1];
        std::partial_sum(result.offsets.begin(), result.offsets.end(), result.offsets.begin());
        result.columns.resize(columns.size());
        result.weights.resize(columns.size());
        std::vector<std::size_t> next(result.offsets.begin(), result.offsets.end() - 1);
        for (std::size_t r = 0; r < rows(); ++r) {
            for (std::size_t k = offsets[r]; k < offsets[r + 1]; ++k) {
                const std::size_t at = next[columns[k]]++;
                result.columns[at] = static_cast<Index>(r);
                result.weights[at] = weights[k];
            }
        }
        return result;
    }
};

// The wholes that cells are parts of, numbered without gaps, with their cells.
struct Wholes {
    std::vector<std::size_t> of_cell;
    std::vector<std::size_t> offsets{0};
    std::vector<Index> cells;

    [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
    [[nodiscard]] std::span<const Index> cells_of(std::size_t whole) const {
        return std::span(cells).subspan(offsets[whole], offsets[whole + 1] - offsets[whole]);
    }
};

Wholes wholes_of(std::size_t count, std::span<const Index> parts) {
    Wholes wholes;
    wholes.cells.resize(count);
    wholes.of_cell.resize(count);
    std::iota(wholes.cells.begin(), wholes.cells.end(), Index{0});
    if (!parts.empty()) std::ranges::stable_sort(wholes.cells, {}, [&](Index c) { return parts[c]; });
    for (std::size_t i = 0; i < count; ++i) {
        const bool same = i > 0 && !parts.empty() && parts[wholes.cells[i]] == parts[wholes.cells[i - 1]];
        if (same) {
            wholes.offsets.back() = i + 1;
        } else {
            wholes.offsets.push_back(i + 1);
        }
        wholes.of_cell[wholes.cells[i]] = wholes.size() - 1;
    }
    return wholes;
}

// The rows of means, and what the first guess needs of cells: their volumes and centres.
struct Means {
    Matrix matrix;
    std::vector<double> volumes;
    std::vector<Vec3> centres;
};

Means means_of(const HexMesh& mesh, const Topology& topology, const Wholes& wholes, const SchemeOptions& scheme,
               Progress* progress) {
    const RefinementTables tables = refinement_tables(topology, {.scheme = scheme, .levels = 1, .progress = progress});
    StencilTable table = tables.levels.front();
    if (!interpolates(scheme.kind)) {
        HexMesh fine;
        fine.points.resize(tables.points());
        fine.cells = tables.cells;
        fine.creases = tables.creases;
        fine.sharp_faces = tables.sharp_faces;
        table = limit_stencils(build_topology(fine), scheme.kind).after(table);
    }
    const CsrMatrix rows = table.csr();
    std::vector<Vec3> points(rows.offsets.size() - 1, Vec3(0.0));
    parallel_each(points.size(), [&](std::size_t r) {
        for (std::size_t k = rows.offsets[r]; k < rows.offsets[r + 1]; ++k)
            points[r] += rows.weights[k] * mesh.points[rows.columns[k]];
    });
    Means means;
    const std::size_t cells = mesh.cells.size();
    means.volumes.resize(cells);
    means.centres.resize(cells);
    std::vector<std::array<double, kNodes>> weights(cells);
    static const std::array<double, kNodes> kEven = even_integrals();
    parallel_each(cells, [&](std::size_t c) {
        const auto nodes = nodes_of(tables.cells, c);
        std::array<Vec3, kNodes> x;
        for (std::size_t n = 0; n < kNodes; ++n) x[n] = points[nodes[n]];
        weights[c] = integrals(x);
        double volume = 0, size = 0;
        for (const double weight : weights[c]) {
            volume += weight;
            size += std::abs(weight);
        }
        if (!(volume > .05 * size)) {  // a folded cell: its middle counts most, whatever its volume
            weights[c] = kEven;
            volume = std::max(std::abs(volume), 1e-300);
            for (double& weight : weights[c]) weight *= volume;
        }
        means.volumes[c] = volume;
        means.centres[c] = Vec3(0.0);
        for (std::size_t n = 0; n < kNodes; ++n) means.centres[c] += weights[c][n] / volume * x[n];
    });
    // Rows in parts, so that they are computed in parallel and stored in order.
    constexpr std::size_t kOfPart = 1024;
    const std::size_t parts = (wholes.size() + kOfPart - 1) / kOfPart;
    std::vector<Matrix> of_part(parts);
    tbb::enumerable_thread_specific<std::vector<double>> all_sums([&] { return std::vector<double>(mesh.points.size()); });
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        Matrix& out = of_part[part];
        std::vector<double>& sums = all_sums.local();
        std::vector<Index> touched;
        for (std::size_t w = part * kOfPart; w < std::min(wholes.size(), (part + 1) * kOfPart); ++w) {
            touched.clear();
            double volume = 0;
            for (const Index c : wholes.cells_of(w)) volume += means.volumes[c];
            for (const Index c : wholes.cells_of(w)) {
                const auto nodes = nodes_of(tables.cells, c);
                for (std::size_t n = 0; n < kNodes; ++n) {
                    const double weight = weights[c][n] / volume;
                    for (std::size_t k = rows.offsets[nodes[n]]; k < rows.offsets[nodes[n] + 1]; ++k) {
                        touched.push_back(rows.columns[k]);
                        sums[rows.columns[k]] += weight * rows.weights[k];
                    }
                }
            }
            std::ranges::sort(touched);
            touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
            for (const Index column : touched) {
                if (sums[column] != 0) {
                    out.columns.push_back(column);
                    out.weights.push_back(static_cast<float>(sums[column]));
                }
                sums[column] = 0;
            }
            out.offsets.push_back(out.columns.size());
        }
    });
    for (Matrix& part : of_part) {
        const std::size_t before = means.matrix.columns.size();
        for (std::size_t r = 1; r < part.offsets.size(); ++r) means.matrix.offsets.push_back(before + part.offsets[r]);
        means.matrix.columns.insert(means.matrix.columns.end(), part.columns.begin(), part.columns.end());
        means.matrix.weights.insert(means.matrix.weights.end(), part.weights.begin(), part.weights.end());
        part = {};
    }
    return means;
}

// Each cell's mean with a gradient by its neighbours; at points the mean over the cells, weighted by volume.
std::vector<double> first_guess(const HexMesh& mesh, const Topology& topology, const Means& means,
                                std::span<const double> values) {
    std::vector<Vec3> gradients(mesh.cells.size());
    parallel_each(mesh.cells.size(), [&](std::size_t c) {
        Mat3 normal(0.0);
        Vec3 right(0.0);
        for (const Index face : topology.cell_faces[c]) {
            const auto& sides = topology.face_cells[face];
            const Index other = sides[0] == c ? sides[1] : sides[0];
            if (other == kNone) continue;
            const Vec3 d = means.centres[other] - means.centres[c];
            const double weight = 1 / std::max(glm::dot(d, d), 1e-300);
            normal += weight * glm::outerProduct(d, d);
            right += weight * (values[other] - values[c]) * d;
        }
        const double few = 1e-6 * (normal[0][0] + normal[1][1] + normal[2][2]) + 1e-300;  // a direction without neighbours
        for (int a = 0; a < 3; ++a) normal[a][a] += few;
        gradients[c] = glm::inverse(normal) * right;
        if (!std::isfinite(gradients[c].x + gradients[c].y + gradients[c].z)) gradients[c] = Vec3(0.0);
    });
    std::vector<double> sums(mesh.points.size()), weights(mesh.points.size());
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (const Index p : mesh.cells[c]) {
            sums[p] += means.volumes[c] * (values[c] + glm::dot(gradients[c], mesh.points[p] - means.centres[c]));
            weights[p] += means.volumes[c];
        }
    }
    for (std::size_t p = 0; p < sums.size(); ++p) sums[p] = weights[p] > 0 ? sums[p] / weights[p] : 0;
    return sums;
}

// In blocks of a fixed size, so that it does not depend on the number of threads.
double dot(const std::vector<double>& a, const std::vector<double>& b) {
    constexpr std::size_t kBlock = 4096;
    std::vector<double> sums((a.size() + kBlock - 1) / kBlock);
    tbb::parallel_for(std::size_t{0}, sums.size(), [&](std::size_t k) {
        double sum = 0;
        for (std::size_t i = k * kBlock; i < std::min(a.size(), (k + 1) * kBlock); ++i) sum += a[i] * b[i];
        sums[k] = sum;
    });
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

void add(std::vector<double>& to, double factor, const std::vector<double>& what) {
    parallel_each(to.size(), [&](std::size_t i) { to[i] += factor * what[i]; });
}

double largest(const std::vector<double>& values) {
    double most = 0;
    for (const double value : values) most = std::max(most, std::abs(value));
    return most;
}

// Changes the values by conjugate gradients of the least squares |rows · values − means|² + tie |change|².
int fit(const Matrix& rows, const Matrix& columns, std::vector<double>& values, std::vector<double>& off, double enough,
        const CellMeansOptions& options) {
    std::vector<double> change(values.size()), gradient(values.size()), step(values.size()), of_step(off.size());
    columns.apply(off, gradient);
    step = gradient;
    double size = dot(gradient, gradient);
    int iteration = 0;
    for (; iteration < options.max_iterations && largest(off) > enough && size > 0; ++iteration) {
        rows.apply(step, of_step);
        const double curvature = dot(of_step, of_step) + options.tie * dot(step, step);
        if (!(curvature > 0)) break;
        const double length = size / curvature;
        add(change, length, step);
        add(off, -length, of_step);
        columns.apply(off, gradient);
        add(gradient, -options.tie, change);
        const double next = dot(gradient, gradient);
        const double factor = next / size;
        size = next;
        parallel_each(step.size(), [&](std::size_t i) { step[i] = gradient[i] + factor * step[i]; });
    }
    add(values, 1, change);
    return iteration;
}

void check(const HexMesh& mesh, std::span<const Attribute> means, std::span<const Index> parts,
           const CellMeansOptions& options) {
    const auto fail = [](const std::string& message) { throw Error(ErrorCode::InvalidInput, message); };
    if (!parts.empty() && parts.size() != mesh.cells.size()) fail("parts are not as many as cells");
    if (!(options.tie > 0) || !(options.tolerance > 0)) fail("tie and tolerance have to be greater than 0");
    for (const Attribute& field : means) {
        if (field.channels < 1 || field.values.size() != mesh.cells.size() * static_cast<std::size_t>(field.channels)) {
            fail("field \"" + field.name + "\" does not have a mean for each cell");
        }
        if (!std::ranges::all_of(field.values, [](double value) { return std::isfinite(value); })) {
            fail("a mean of field \"" + field.name + "\" is not finite");
        }
    }
}

}  // namespace

CellMeansFit fit_cell_means(const HexMesh& mesh, std::span<const Attribute> fields, std::span<const Index> parts,
                            const CellMeansOptions& options) {
    check(mesh, fields, parts, options);
    const detail::Stopwatch watch;
    const Topology topology = build_topology(mesh);
    const Wholes wholes = wholes_of(mesh.cells.size(), parts);
    const Means means = means_of(mesh, topology, wholes, options.scheme, options.progress);
    const Matrix columns = means.matrix.transposed(mesh.points.size());
    CellMeansFit result;
    for (const Attribute& field : fields) {
        const auto channels = static_cast<std::size_t>(field.channels);
        Attribute fitted{field.name, field.channels, std::vector<double>(mesh.points.size() * channels)};
        for (std::size_t channel = 0; channel < channels; ++channel) {
            std::vector<double> of_cells(mesh.cells.size()), off(wholes.size()), wanted(wholes.size());
            for (std::size_t c = 0; c < of_cells.size(); ++c) of_cells[c] = field.values[c * channels + channel];
            for (std::size_t w = 0; w < wanted.size(); ++w) wanted[w] = of_cells[wholes.cells_of(w).front()];
            const auto [least, most] = std::ranges::minmax(of_cells);
            const double range = most - least;
            std::vector<double> values = first_guess(mesh, topology, means, of_cells);
            means.matrix.apply(values, off);
            for (std::size_t w = 0; w < off.size(); ++w) off[w] = wanted[w] - off[w];
            const auto rms = [&] { return range > 0 ? std::sqrt(dot(off, off) / static_cast<double>(off.size())) / range : 0; };
            CellMeansReport& report = result.report;
            report.first_rms_off = std::max(report.first_rms_off, rms());
            report.iterations =
                std::max(report.iterations, fit(means.matrix, columns, values, off, options.tolerance * range, options));
            report.rms_off = std::max(report.rms_off, rms());
            if (range > 0) report.most_off = std::max(report.most_off, largest(off) / range);
            if (range == 0) std::ranges::fill(values, least);  // without rounding
            for (std::size_t p = 0; p < values.size(); ++p) fitted.values[p * channels + channel] = values[p];
        }
        result.fields.push_back(std::move(fitted));
    }
    result.report.seconds = watch.seconds();
    return result;
}

}  // namespace subvol
