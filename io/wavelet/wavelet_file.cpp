// SPDX-License-Identifier: Apache-2.0
// Writes a mesh with its fields as wavelets. A coarser mesh whose refinement has the cells is found; over it each array is
// taken apart into coarse values and details, rounded as much as its tolerance allows, and written as whole numbers:
//
//     magic, length │ compressed: scheme, levels, coarse mesh, cells that are there │ points │ fields │ numbers at cells
//
// Coarse numbers are differences. A detail is a byte; 255 means that the rest follows after all details of the channel. Points
// are the first array; unless their tolerance is given, it is divided by 3, some times, until no more cells are inverted than
// before. Errors are root mean squares over the mesh's own points in parts of the range: points that the hierarchy adds do not
// count. Values at cells are differences in the order of the refined cells, and whole numbers stay what they are.
#include "subvol/wavelet_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/vtu_bytes.h"
#include "subvol/error.h"
#include "subvol/hierarchy.h"
#include "subvol/mesh_report.h"
#include "subvol/option.h"
#include "subvol/wavelet.h"
#include "wavelet_bytes.h"
#include "wavelet_format.h"

namespace subvol {

using namespace detail;

namespace {

void put_cells(const MeshHierarchy& hierarchy, Bytes& out) {
    const bool all = std::find(hierarchy.cells.begin(), hierarchy.cells.end(), kNone) == hierarchy.cells.end();
    out.number(all ? 0 : 1);
    if (all) return;
    for (std::size_t c = 0; c < hierarchy.cells.size(); c += 8) {  // refined at least once
        std::uint64_t bits = 0;
        for (std::size_t k = 0; k < 8; ++k) bits |= std::uint64_t{hierarchy.cells[c + k] != kNone} << k;
        out.byte(bits);
    }
}

void put_array(const QuantizedWavelets& numbers, std::string_view name, Bytes& out) {
    out.text(name);
    out.number(numbers.channels);
    out.real(numbers.step);
    constexpr std::uint64_t kMore = 255;
    for (std::size_t k = 0; k < numbers.channels; ++k) {
        std::int64_t before = 0;
        for (std::size_t i = k; i < numbers.coarse.size(); i += numbers.channels) {
            out.number(folded(numbers.coarse[i] - before));
            before = numbers.coarse[i];
        }
        std::vector<std::uint64_t> rest;
        for (const auto& details : numbers.details) {
            for (std::size_t i = k; i < details.size(); i += numbers.channels) {
                const std::uint64_t n = folded(details[i]);
                out.byte(std::min(n, kMore));
                if (n >= kMore) rest.push_back(n - kMore);
            }
        }
        for (const std::uint64_t n : rest) out.number(n);
    }
}

constexpr double kMostWhole = 0x1p50;  // of the numbers of cells, so that differences are exact

/// The longest side of the box of the values that count: of a scalar its range.
double range_of(std::span<const double> values, std::size_t channels, std::span<const std::uint8_t> counted) {
    double most = 0;
    for (std::size_t k = 0; k < channels; ++k) {
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (std::size_t p = 0; p < counted.size(); ++p) {
            if (counted[p] == 0) continue;
            low = std::min(low, values[p * channels + k]);
            high = std::max(high, values[p * channels + k]);
        }
        most = std::max(most, high - low);
    }
    return most;
}

/// The least error that may be asked for, in parts of a range.
constexpr double kLeastRms = 1e-15;

/// How often the tolerance of points is divided by 3 to keep cells from being inverted.
constexpr int kMostAttempts = 8;

std::size_t kept_numbers(const QuantizedWavelets& numbers) {
    const auto kept = [](const std::vector<std::int64_t>& of) {
        return of.size() - static_cast<std::size_t>(std::count(of.begin(), of.end(), 0));
    };
    std::size_t sum = kept(numbers.coarse);
    for (const auto& details : numbers.details) sum += kept(details);
    return sum;
}

std::size_t inverted_cells_of(const MeshHierarchy& hierarchy, const WaveletBasis& basis, std::span<const double> places) {
    HexMesh mesh;
    mesh.points.reserve(places.size() / 3);
    for (std::size_t i = 0; i < places.size(); i += 3) mesh.points.emplace_back(places[i], places[i + 1], places[i + 2]);
    for (std::size_t c = 0; c < basis.cells.size(); ++c) {
        if (hierarchy.cells[c] != kNone) mesh.cells.push_back(basis.cells[c]);
    }
    return measure_cells(mesh).inverted_cells;
}

/// What a file contains, array by array, and the report on it.
class FileWriter {
public:
    FileWriter(const HexMesh& mesh, const WaveletFileOptions& options)
        : mesh_(mesh),
          options_(options),
          hierarchy_(find_hierarchy(mesh, {.levels = options.levels})),
          topology_(build_topology(hierarchy_.coarse)),
          basis_(
              wavelet_basis(topology_, {.scheme = options.scheme, .levels = hierarchy_.levels, .progress = options.progress})) {
        // Points that the hierarchy has added do not count in errors.
        for (const Index p : hierarchy_.points) counted_.push_back(p < mesh.points.size() ? 1 : 0);
        report_.levels = hierarchy_.levels;
        report_.coarse_cells = hierarchy_.coarse.cells.size();
        report_.cells = mesh.cells.size();
        report_.added_cells = hierarchy_.cells.size() - mesh.cells.size();
        report_.inverted_cells_before = measure_cells(mesh).inverted_cells;
    }

    void put_head() {
        out_.number(static_cast<std::uint64_t>(options_.scheme.kind));
        out_.real(options_.scheme.tension);
        out_.number(static_cast<std::uint64_t>(hierarchy_.levels));
        put_mesh(hierarchy_.coarse, out_);
        put_cells(hierarchy_, out_);
        out_.number(mesh_.attributes.size() + 1);
    }

    /// Positions are the array without a name. Unless their tolerance is given, it is reduced until no more cells are inverted
    /// than before.
    void put_points() {
        report_array();
        const std::vector<double> values = in_hierarchy(hierarchy_, coordinates(mesh_.points), 3);
        const double scale = range_of(values, 3, counted_);
        double tolerance = options_.point_tolerance.value_or(options_.tolerance / 10);
        QuantizedWavelets numbers;
        std::vector<double> restored;
        for (int attempt = 0;; ++attempt) {
            numbers = quantize_within(basis_, values, 3, tolerance * scale, counted_, options_.progress);
            restored = synthesize(basis_, restore(basis_, numbers));
            report_.inverted_cells = inverted_cells_of(hierarchy_, basis_, restored);
            const bool sound = report_.inverted_cells <= report_.inverted_cells_before;
            if (sound || options_.point_tolerance || attempt == kMostAttempts) break;
            tolerance /= 3;
        }
        put("", values, numbers, restored, scale);
    }

    void put_attribute(const Attribute& attribute) {
        report_array();
        const auto channels = static_cast<std::size_t>(attribute.channels);
        const std::vector<double> values = in_hierarchy(hierarchy_, attribute.values, channels);
        const double range = range_of(values, channels, counted_), scale = range > 0 ? range : 1;
        const QuantizedWavelets numbers =
            quantize_within(basis_, values, channels, options_.tolerance * scale, counted_, options_.progress);
        put(attribute.name, values, numbers, synthesize(basis_, restore(basis_, numbers)), scale);
    }

    /// The numbers of fields at cells, rounded to the tolerance, as differences in the order of the refined cells; nothing if
    /// there are no such fields. Whole numbers, as those of labels, stay what they are.
    void put_fields_at_cells() {
        const auto at_cells = [&](const Attribute& field) { return is_at_cells(mesh_, field); };
        const auto count = std::ranges::count_if(mesh_.attributes, at_cells);
        if (count == 0) return;
        out_.number(static_cast<std::uint64_t>(count));
        for (std::size_t a = 0; a < mesh_.attributes.size(); ++a) {
            const Attribute& field = mesh_.attributes[a];
            if (!at_cells(field)) continue;
            const auto channels = static_cast<std::size_t>(field.channels);
            const auto [low, high] = std::ranges::minmax(field.cells);
            const bool whole = std::ranges::all_of(
                field.cells, [](double value) { return value == std::floor(value) && std::abs(value) < kMostWhole; });
            const double wanted = whole || !(high > low) ? 1 : options_.tolerance * (high - low);
            const double step = std::max(wanted, std::max(std::abs(low), std::abs(high)) / kMostWhole);
            out_.number(a);
            out_.number(field.constant ? 1 : 0);
            out_.real(whole ? 0 : low);
            out_.real(step);
            for (std::size_t k = 0; k < channels; ++k) {
                std::int64_t before = 0;
                for (const Index cell : hierarchy_.cells) {
                    if (cell == kNone) continue;
                    const std::int64_t number = std::llround((field.cells[cell * channels + k] - (whole ? 0 : low)) / step);
                    out_.number(folded(number - before));
                    before = number;
                }
            }
        }
    }

    WaveletFileReport write(const std::filesystem::path& path) {
        const std::string packed = compressed_numbers(out_.all());
        std::string length;
        for (int k = 0; k < 8; ++k) length += static_cast<char>(out_.all().size() >> 8 * k & 255);
        OutputFile file(path);
        file.write(kWaveletMagic);
        file.write(length);
        file.write(packed);
        report_.bytes = file.position();
        file.commit();
        return std::move(report_);
    }

private:
    void report_array() const {
        report_progress(options_.progress, "wavelets",
                        static_cast<double>(report_.arrays.size()) / static_cast<double>(mesh_.attributes.size() + 1));
    }

    void put(std::string name, std::span<const double> values, const QuantizedWavelets& numbers,
             std::span<const double> restored, double scale) {
        put_array(numbers, name, out_);
        const WaveletError error = difference(restored, values, numbers.channels, counted_);
        report_.arrays.push_back({std::move(name), values.size(), kept_numbers(numbers), error.rms / scale, error.max / scale});
    }

    const HexMesh& mesh_;
    const WaveletFileOptions& options_;
    MeshHierarchy hierarchy_;
    Topology topology_;
    WaveletBasis basis_;
    std::vector<std::uint8_t> counted_;
    Bytes out_;
    WaveletFileReport report_;
};

}  // namespace

WaveletFileReport write_wavelet_file(const std::filesystem::path& path, const HexMesh& mesh,
                                     const WaveletFileOptions& options) {
    check_options(options);
    report_progress(options.progress, "find the coarser mesh", 0);
    FileWriter writer(mesh, options);
    writer.put_head();
    writer.put_points();
    for (const Attribute& attribute : mesh.attributes) writer.put_attribute(attribute);
    writer.put_fields_at_cells();
    return writer.write(path);
}

std::vector<Option> options_of(WaveletFileOptions& options) {
    return {
        Option("wavelet-tolerance", options.tolerance)
            .between(kLeastRms, 1)
            .help("T", "the most root mean square error of each field, in parts of its range")
            .called("tolerance"),
        Option("wavelet-point-tolerance", options.point_tolerance)
            .between(kLeastRms, 1)
            .help("T",
                  "the same for the points, in parts of the mesh's longest side (default: a tenth of the tolerance of fields, "
                  "and less where cells would be inverted)")
            .called("point_tolerance"),
        Option("levels", options.levels).between(1, 10).help("L", "the most levels of wavelets")};
}

}  // namespace subvol
