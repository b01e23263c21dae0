// SPDX-License-Identifier: Apache-2.0
// Each value is predicted from values as they are read again, and what it differs from its prediction is rounded to whole
// steps: the error is that of this rounding, whatever the prediction. Both sides compute in whole numbers, 2⁸ to a step, so
// that every machine reads the same. Which prediction is best differs from field to field and from step to step: all are tried,
// and the one is taken whose residuals are compressed best.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "output_file.h"
#include "series_format.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/hierarchy.h"
#include "subvol/mesh_report.h"
#include "subvol/series_file.h"
#include "vtu_bytes.h"
#include "wavelet_bytes.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kLeastTolerance = 1e-12;

void check_error(double tolerance, const std::string& what) {
    if (tolerance >= kLeastTolerance && tolerance <= 1) return;
    throw Error(ErrorCode::InvalidInput, "the " + what + " is " + std::to_string(tolerance), "series", "1e-12 to 1");
}

/// The finite values of a channel in all steps.
struct ChannelRange {
    double min = std::numeric_limits<double>::infinity(), max = -min;

    void add(double x) {
        if (!std::isfinite(x)) return;
        min = std::min(min, x);
        max = std::max(max, x);
    }
    [[nodiscard]] double size() const { return max > min ? max - min : 0; }
};

struct ArrayRange {
    std::string name;
    std::vector<ChannelRange> channels;

    /// The longest side of the box of the values.
    [[nodiscard]] double scale() const {
        double most = 0;
        for (const ChannelRange& channel : channels) most = std::max(most, channel.size());
        return most;
    }
};

/// A step that rounds by `most` at most, or a little less so that the ends of the range are whole numbers of steps; 0 is one
/// where the values have either sign.
Quantization quantization(const ChannelRange& range, double most) {
    if (!(range.max > range.min)) {
        const double only = range.max < range.min ? 0 : range.min;
        return {only, 0, only, only};
    }
    const bool around_zero = range.min < 0 && range.max > 0;
    const double length = around_zero ? std::max(range.max, -range.min) : range.size();
    // A residual is rounded by half a step at most, and a target by half of 2⁻⁸ of one.
    const double steps = std::max(1.0, std::ceil(length / (2 * most) * (1 + 1e-9 + std::ldexp(1.0, -kFractionBits))));
    return {around_zero ? 0 : range.min, length / steps, range.min, range.max};
}

/// `values` are those of all channels, point-major.
std::vector<double> rounded_values(std::span<const double> values, std::span<const Quantization> channels) {
    std::vector<double> rounded(values.begin(), values.end());
    parallel_each(rounded.size(), [&](std::size_t i) {
        const Quantization& q = channels[i % channels.size()];
        if (std::isfinite(rounded[i]) && q.step > 0)
            rounded[i] = q.value(std::llround((rounded[i] - q.origin) / q.step) * (std::int64_t{1} << kFractionBits));
    });
    return rounded;
}

std::size_t inverted_cells_at(const HexMesh& mesh, std::span<const double> places) {
    HexMesh moved;
    moved.cells = mesh.cells;
    moved.points.reserve(mesh.points.size());
    for (std::size_t i = 0; i < places.size(); i += 3) moved.points.emplace_back(places[i], places[i + 1], places[i + 2]);
    return measure_cells(moved).inverted_cells;
}

bool same_cells(const HexMesh& a, const HexMesh& b) {
    return a.points.size() == b.points.size() && a.cells == b.cells && a.creases == b.creases && a.sharp_faces == b.sharp_faces;
}

/// A mesh whose refinement has the same cells, numbered alike.
struct CoarseCells {
    HexMesh mesh;
    int levels = 0;
};

std::optional<CoarseCells> coarse_cells(const HexMesh& cells) {
    if (cells.cells.size() > kMostRefinedCells) return std::nullopt;
    try {
        // A control mesh that was refined may itself have the cells of a coarser one, but in another order.
        for (int levels = find_hierarchy(cells, {.levels = kMostLevels}).levels; levels > 0; --levels) {
            CoarseCells found{find_hierarchy(cells, {.levels = levels}).coarse, levels};
            found.mesh.points.assign(found.mesh.points.size(), Vec3(0));
            found.mesh.attributes.clear();
            if (same_cells(refined_cells(found.mesh, levels), cells)) return found;
        }
    } catch (const Error&) {  // it refines none
    }
    return std::nullopt;
}

/// What the first look at all steps finds: ranges, and how exact points have to be.
class SeriesSurvey {
public:
    SeriesSurvey(const MeshSteps& steps, const SeriesFileOptions& options) : options_(options) {
        ranges_.push_back({"", std::vector<ChannelRange>(3)});
        for (std::size_t k = 0; k < steps.times.size(); ++k) {
            report_progress(options.progress, "ranges of fields", k, steps.times.size());
            look_at(steps.read(k));
        }
    }

    /// quantizations, the points first
    [[nodiscard]] std::vector<SeriesArray> arrays() const {
        std::vector<SeriesArray> arrays;
        for (const ArrayRange& range : ranges_) {
            const double most = arrays.empty() ? point_error_ : options_.tolerance * range.scale();
            SeriesArray& array = arrays.emplace_back(SeriesArray{range.name, {}});
            for (const ChannelRange& channel : range.channels) array.channels.push_back(quantization(channel, most));
        }
        return arrays;
    }
    /// The most error of an array's values, in world units or those of the field.
    [[nodiscard]] double most_error(std::size_t array) const {
        return array == 0 ? point_error_ : options_.tolerance * ranges_[array].scale();
    }
    /// What errors of an array are told in parts of.
    [[nodiscard]] double unit(std::size_t array) const {
        const double scale = array == 0 ? length_ : ranges_[array].scale();
        return scale > 0 ? scale : 1;
    }

private:
    void look_at(const HexMesh& mesh) {
        if (mesh.points.size() > 8 * mesh.cells.size()) {
            throw Error(ErrorCode::InvalidInput,
                        std::to_string(mesh.points.size()) + " points are more than the corners of the cells", "series",
                        "without_unused_points leaves out those that no cell uses");
        }
        for (const Vec3& p : mesh.points) {
            for (int k = 0; k < 3; ++k) ranges_[0].channels[static_cast<std::size_t>(k)].add(p[k]);
        }
        for (const Attribute& attribute : mesh.attributes) {
            const auto channels = static_cast<std::size_t>(attribute.channels);
            ArrayRange& range = range_of_array(attribute.name, channels);
            for (std::size_t i = 0; i < attribute.values.size(); ++i) range.channels[i % channels].add(attribute.values[i]);
        }
        if (length_ == 0) {
            length_ = ranges_[0].scale();
            point_error_ = options_.point_tolerance.value_or(std::max(options_.tolerance / 10, kLeastTolerance)) * length_;
        }
        if (!options_.point_tolerance) keep_cells_sound(mesh);
    }

    ArrayRange& range_of_array(const std::string& name, std::size_t channels) {
        const auto found = std::find_if(ranges_.begin() + 1, ranges_.end(), [&](const ArrayRange& range) {
            return range.name == name && range.channels.size() == channels;
        });
        if (found != ranges_.end()) return *found;
        ranges_.push_back({name, std::vector<ChannelRange>(channels)});
        return ranges_.back();
    }

    void keep_cells_sound(const HexMesh& mesh) {
        constexpr int kMostThirds = 8;
        const std::vector<double> places = coordinates(mesh.points);
        const std::size_t before = inverted_cells_at(mesh, places);
        for (int attempt = 0; attempt < kMostThirds; ++attempt) {
            std::vector<Quantization> channels;
            for (const ChannelRange& channel : ranges_[0].channels) channels.push_back(quantization(channel, point_error_));
            if (inverted_cells_at(mesh, rounded_values(places, channels)) <= before) return;
            if (point_error_ / 3 < kLeastTolerance * length_) return;
            point_error_ /= 3;
        }
    }

    const SeriesFileOptions& options_;
    std::vector<ArrayRange> ranges_;
    double length_ = 0, point_error_ = 0;
};

/// A channel in parts of steps; 0 where a value is not finite or too large.
std::vector<std::int64_t> targets_of(std::span<const double> values, std::size_t channel, std::size_t channels,
                                     const Quantization& q) {
    std::vector<std::int64_t> targets(values.size() / channels, 0);
    if (q.step == 0) return targets;
    for (std::size_t p = 0; p < targets.size(); ++p) {
        const double part = std::ldexp((values[p * channels + channel] - q.origin) / q.step, kFractionBits);
        if (std::abs(part) <= static_cast<double>(kMostQuantized / 2)) targets[p] = std::llround(part);
    }
    return targets;
}

/// What is kept of a channel.
///
/// exact: the points whose values are kept as they are, and these
struct KeptValues {
    std::vector<std::size_t> exact_points;
    std::vector<double> exact_values;
    double max_error = 0;
};

KeptValues kept_values(std::span<const double> values, std::size_t channel, std::size_t channels, const Quantization& q,
                       std::span<const std::int64_t> numbers, double most) {
    KeptValues kept;
    for (std::size_t p = 0; p < numbers.size(); ++p) {
        const double x = values[p * channels + channel], error = std::abs(q.value(numbers[p]) - x);
        if (error <= most) {
            kept.max_error = std::max(kept.max_error, error);
            continue;
        }
        kept.exact_points.push_back(p);
        kept.exact_values.push_back(x);
    }
    return kept;
}

/// The predictions of a mesh.
struct Predictions {
    explicit Predictions(const HexMesh& mesh) {
        HexMesh cells_alone;  // neither creases nor sharp faces matter
        cells_alone.points.resize(mesh.points.size());
        cells_alone.cells = mesh.cells;
        const Topology topology = build_topology(cells_alone);
        by_number = predict_by_number(mesh.points.size());
        in_cells = predict_in_cells(topology);
        between_sheets = predict_between_sheets(topology);
    }
    ValuePrediction by_number, in_cells, between_sheets;

    [[nodiscard]] const ValuePrediction* of(Spatial spatial) const {
        return spatial == Spatial::None       ? nullptr
               : spatial == Spatial::ByNumber ? &by_number
               : spatial == Spatial::InCells  ? &in_cells
                                              : &between_sheets;
    }
};

/// Residuals as planes of bytes, and the numbers that they give.
struct Residuals {
    std::size_t bytes_each = 0;
    std::string planes;
    std::vector<std::int64_t> numbers;
};

/// base: what earlier steps predict
Residuals residuals_of(const std::vector<std::int64_t>& targets, const std::vector<std::int64_t>& base,
                       const ValuePrediction* prediction) {
    constexpr std::int64_t kHalf = std::int64_t{1} << (kFractionBits - 1);
    Residuals made;
    std::vector<std::int64_t>& changes = made.numbers;
    changes.resize(targets.size());
    std::vector<std::uint64_t> rest(targets.size());
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const std::size_t p = prediction == nullptr ? i : prediction->order[i];
        const std::int64_t predicted = prediction == nullptr ? 0 : prediction->predict(i, changes);
        const std::int64_t residual = (targets[p] - base[p] - predicted + kHalf) >> kFractionBits;
        changes[p] = predicted + residual * (std::int64_t{1} << kFractionBits);
        rest[i] = folded(residual);
        all |= rest[i];
    }
    for (std::size_t p = 0; p < changes.size(); ++p) changes[p] += base[p];
    made.bytes_each = (static_cast<std::size_t>(std::bit_width(all)) + 7) / 8;
    made.planes.resize(made.bytes_each * rest.size());
    for (std::size_t plane = 0; plane < made.bytes_each; ++plane) {
        char* out = made.planes.data() + plane * rest.size();
        for (std::size_t i = 0; i < rest.size(); ++i) out[i] = static_cast<char>(rest[i] >> 8 * plane & 255);
    }
    return made;
}

struct Mode {
    Spatial spatial = Spatial::None;
    Temporal temporal = Temporal::None;
};

/// What is tried, given how many steps before are known.
std::vector<Mode> modes(std::size_t steps_before) {
    std::vector<Mode> tried;
    if (steps_before > 0) tried.push_back({Spatial::None, Temporal::Same});
    for (const Spatial spatial : {Spatial::ByNumber, Spatial::InCells, Spatial::BetweenSheets}) {
        tried.push_back({spatial, Temporal::None});
        if (steps_before > 0) tried.push_back({spatial, Temporal::Same});
        if (steps_before > 1) tried.push_back({spatial, Temporal::Linear});
    }
    if (steps_before > 1) tried.push_back({Spatial::None, Temporal::Linear});
    return tried;
}

struct CodedChannel {
    Mode mode;
    Residuals residuals;
    std::uint64_t bytes = 0;
};

/// before: the numbers in the steps before, the latest first; empty ones are not known
CodedChannel coded(const std::vector<std::int64_t>& targets, const std::array<const std::vector<std::int64_t>*, 2>& before,
                   const Predictions& predictions) {
    static const std::vector<std::int64_t> kNothing;
    const std::vector<std::int64_t>&last = before[0] ? *before[0] : kNothing, &two_before = before[1] ? *before[1] : kNothing;
    CodedChannel best;
    best.bytes = std::numeric_limits<std::uint64_t>::max();
    std::vector<std::int64_t> base(targets.size());
    for (const Mode mode : modes(last.empty() ? 0 : two_before.empty() ? 1 : 2)) {
        for (std::size_t p = 0; p < base.size(); ++p) base[p] = earlier(mode.temporal, last, two_before, p);
        Residuals residuals = residuals_of(targets, base, predictions.of(mode.spatial));
        const std::uint64_t bytes = residuals.planes.empty() ? 0 : compressed_numbers(residuals.planes, Effort::Least).size();
        if (bytes >= best.bytes) continue;
        best = {mode, std::move(residuals), bytes};
        if (bytes == 0) break;
    }
    return best;
}

class SeriesWriter {
public:
    SeriesWriter(const std::filesystem::path& path, const MeshSteps& steps, const SeriesFileOptions& options)
        : steps_(steps), options_(options), survey_(steps, options), file_(path) {
        index_.arrays = survey_.arrays();
        for (const SeriesArray& array : index_.arrays) {
            SeriesArrayReport& kept = report_.arrays.emplace_back();
            kept.name = array.name;
            kept.channels = static_cast<int>(array.channels.size());
        }
        before_.resize(index_.arrays.size());
    }

    SeriesFileReport write() {
        file_.write(kSeriesMagic);
        file_.write(std::string(24, '\0'));
        for (std::size_t k = 0; k < steps_.times.size(); ++k) {
            report_progress(options_.progress, "steps", k, steps_.times.size());
            put_step(k);
        }
        put_index();
        report_.steps = index_.steps.size();
        report_.meshes = index_.meshes.size();
        report_.bytes = file_.position();
        file_.commit();
        return std::move(report_);
    }

private:
    void put_step(std::size_t k) {
        const HexMesh mesh = steps_.read(k);
        SeriesStep step{.time = steps_.times[k], .mesh = 0, .key = false, .place = {}};
        const bool other_mesh = index_.meshes.empty() || !same_cells(mesh, cells_);
        if (other_mesh) put_mesh_block(mesh);
        step.mesh = index_.meshes.size() - 1;
        step.key = other_mesh || since_key_ >= static_cast<std::size_t>(options_.key_steps);
        if (step.key) {
            since_key_ = 0;
            ++report_.key_steps;
            for (auto& array : before_) array = {};
        }
        ++since_key_;
        step.place.place = file_.position();
        put_values(mesh);
        step.place.length = file_.position() - step.place.place;
        index_.steps.push_back(step);
        report_.points = mesh.points.size();
        report_.cells = mesh.cells.size();
    }

    void put_mesh_block(const HexMesh& mesh) {
        predictions_.emplace(mesh);
        cells_ = {};
        cells_.points.resize(mesh.points.size());
        cells_.cells = mesh.cells;
        cells_.creases = mesh.creases;
        cells_.sharp_faces = mesh.sharp_faces;
        Bytes out;
        const std::optional<CoarseCells> coarse = coarse_cells(cells_);
        out.number(coarse ? static_cast<std::uint64_t>(coarse->levels) : 0);
        put_mesh(coarse ? coarse->mesh : cells_, out);
        const std::string packed = compressed_numbers(out.all());
        index_.meshes.push_back({{file_.position(), packed.size()}, out.all().size()});
        report_.mesh_bytes += packed.size();
        file_.write(packed);
    }

    [[nodiscard]] const Attribute* attribute_of(const HexMesh& mesh, std::size_t array) const {
        const SeriesArray& wanted = index_.arrays[array];
        for (const Attribute& a : mesh.attributes) {
            if (a.name == wanted.name && static_cast<std::size_t>(a.channels) == wanted.channels.size()) return &a;
        }
        return nullptr;
    }

    void put_values(const HexMesh& mesh) {
        struct Task {
            std::size_t array, channel;
            std::span<const double> values;
            CodedChannel coded{};
            KeptValues kept{};
        };
        const std::vector<double> places = coordinates(mesh.points);
        Bytes head;
        std::vector<Task> tasks;
        std::vector<const Attribute*> there;
        for (std::size_t a = 0; a < index_.arrays.size(); ++a) {
            const Attribute* attribute = a == 0 ? nullptr : attribute_of(mesh, a);
            const bool present = a == 0 || attribute != nullptr;
            head.byte(present ? 1 : 0);
            if (!present) {
                before_[a] = {};
                continue;
            }
            there.push_back(attribute);
            ++report_.arrays[a].steps;
            const std::span<const double> values = a == 0 ? std::span<const double>(places) : attribute->values;
            for (std::size_t c = 0; c < index_.arrays[a].channels.size(); ++c) tasks.push_back({a, c, values});
        }
        tbb::parallel_for(std::size_t{0}, tasks.size(), [&](std::size_t t) {
            Task& task = tasks[t];
            const auto& channels = index_.arrays[task.array].channels;
            const Quantization& q = channels[task.channel];
            const History& history = before_[task.array];
            std::array<const std::vector<std::int64_t>*, 2> known{};
            for (std::size_t k = 0; k < 2 && k < history.size(); ++k) known[k] = &history[k][task.channel];
            task.coded = coded(targets_of(task.values, task.channel, channels.size(), q), known, *predictions_);
            task.kept = kept_values(task.values, task.channel, channels.size(), q, task.coded.residuals.numbers,
                                    survey_.most_error(task.array));
        });
        for (const Task& task : tasks) {
            head.byte(static_cast<std::uint64_t>(task.coded.mode.spatial) +
                      4 * static_cast<std::uint64_t>(task.coded.mode.temporal));
            head.byte(task.coded.residuals.bytes_each);
            head.number(task.kept.exact_points.size());
            std::size_t last = 0;
            for (std::size_t k = 0; k < task.kept.exact_points.size(); ++k) {
                head.number(task.kept.exact_points[k] - last);
                head.real(task.kept.exact_values[k]);
                last = task.kept.exact_points[k];
            }
            SeriesArrayReport& kept = report_.arrays[task.array];
            kept.bytes += task.coded.bytes + 10 * task.kept.exact_points.size();
            kept.exact += task.kept.exact_points.size();
            kept.max = std::max(kept.max, task.kept.max_error / survey_.unit(task.array));
        }
        for (const Attribute* attribute : there) {
            head.number(attribute == nullptr ? 0 : attribute->bounds.size());
            if (attribute == nullptr) continue;
            for (const auto& bound : attribute->bounds) {
                head.real(bound[0]);
                head.real(bound[1]);
            }
        }
        put_blocks(tasks, head);
        measure_shapes(mesh, places, tasks);
        for (Task& task : tasks) {
            History& history = before_[task.array];
            if (task.channel == 0) {
                history.insert(history.begin(), std::vector<std::vector<std::int64_t>>());
                history.resize(std::min<std::size_t>(history.size(), 2));
            }
            history.front().push_back(std::move(task.coded.residuals.numbers));
        }
    }

    template <class Tasks>
    void put_blocks(const Tasks& tasks, Bytes& head) {
        std::vector<std::string> blocks;
        bool full = true;
        for (const auto& task : tasks) {
            const std::string& planes = task.coded.residuals.planes;
            if (planes.empty()) continue;
            if (full) blocks.emplace_back();
            blocks.back() += planes;
            full = blocks.back().size() >= kBlockBytes;
        }
        tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) { blocks[b] = compressed_numbers(blocks[b]); });
        for (const std::string& block : blocks) head.number(block.size());
        file_.write(head.all());
        for (const std::string& block : blocks) file_.write(block);
    }

    /// The first three tasks have the coordinates.
    template <class Tasks>
    void measure_shapes(const HexMesh& mesh, std::span<const double> places, const Tasks& tasks) {
        std::vector<double> kept(places.begin(), places.end());
        for (std::size_t c = 0; c < 3; ++c) {
            const auto& numbers = tasks[c].coded.residuals.numbers;
            for (std::size_t p = 0; p < numbers.size(); ++p) kept[3 * p + c] = index_.arrays[0].channels[c].value(numbers[p]);
            for (const std::size_t p : tasks[c].kept.exact_points) kept[3 * p + c] = places[3 * p + c];
        }
        report_.inverted_cells_before = inverted_cells_at(mesh, places);
        report_.inverted_cells = inverted_cells_at(mesh, kept);
    }

    void put_index() {
        Bytes out;
        out.number(index_.meshes.size());
        for (const SeriesMesh& mesh : index_.meshes) {
            out.number(mesh.place.place);
            out.number(mesh.place.length);
            out.number(mesh.unpacked);
        }
        out.number(index_.arrays.size());
        for (const SeriesArray& array : index_.arrays) {
            out.text(array.name);
            out.number(array.channels.size());
            for (const Quantization& q : array.channels) {
                for (const double x : {q.origin, q.step, q.min, q.max}) out.real(x);
            }
        }
        out.number(index_.steps.size());
        for (const SeriesStep& step : index_.steps) {
            out.real(step.time);
            out.number(step.mesh);
            out.number(step.key ? 1 : 0);
            out.number(step.place.place);
            out.number(step.place.length);
        }
        const std::string packed = compressed_numbers(out.all());
        std::string head;
        for (const std::uint64_t n : {file_.position(), std::uint64_t{packed.size()}, std::uint64_t{out.all().size()}}) {
            for (int k = 0; k < 8; ++k) head += static_cast<char>(n >> 8 * k & 255);
        }
        file_.write(packed);
        report_.bytes = file_.position();
        file_.overwrite(kSeriesMagic.size(), head);
    }

    /// Of an array: the numbers of its channels in the step before, and in the one before that.
    using History = std::vector<std::vector<std::vector<std::int64_t>>>;

    const MeshSteps& steps_;
    const SeriesFileOptions& options_;
    SeriesSurvey survey_;
    OutputFile file_;
    SeriesIndex index_;
    std::optional<Predictions> predictions_;
    HexMesh cells_;
    std::vector<History> before_;
    std::size_t since_key_ = 0;
    SeriesFileReport report_;
};

}  // namespace

SeriesFileReport write_series_file(const std::filesystem::path& path, const MeshSteps& steps,
                                   const SeriesFileOptions& options) {
    check_error(options.tolerance, "most error");
    check_error(options.point_tolerance.value_or(1), "most error of points");
    if (options.key_steps < 1 || options.key_steps > 1000) {
        throw Error(ErrorCode::InvalidInput, "the number of steps to a key step is " + std::to_string(options.key_steps),
                    "series", "1 to 1000");
    }
    if (steps.times.empty()) throw Error(ErrorCode::InvalidInput, "there is no step", "series", "at least one");
    for (std::size_t k = 0; k < steps.times.size(); ++k) {
        if (std::isfinite(steps.times[k]) && (k == 0 || steps.times[k - 1] < steps.times[k])) continue;
        throw Error(ErrorCode::InvalidInput, "the time of step " + std::to_string(k) + " is " + std::to_string(steps.times[k]),
                    "series", "finite times that ascend");
    }
    return SeriesWriter(path, steps, options).write();
}

SeriesFileReport write_series_file(const std::filesystem::path& path, const HexMesh& mesh, const SeriesFileOptions& options) {
    return write_series_file(path, {{mesh.time.value_or(0)}, [&](std::size_t) { return mesh; }}, options);
}

std::vector<Option> options_of(SeriesFileOptions& options) {
    return {
        Option("max-error", options.tolerance)
            .between(kLeastTolerance, 1)
            .help("T", "the most error of each value, in parts of the field's range in all steps"),
        Option("max-point-error", options.point_tolerance)
            .between(kLeastTolerance, 1)
            .help(
                "T",
                "the same for the coordinates of points, in parts of the mesh's longest side (default: a tenth of --max-error, "
                "and less where cells would be inverted)"),
        Option("key-steps", options.key_steps)
            .between(1, 1000)
            .help("K", "every K steps one that does not depend on others: no more are decoded to read one")};
}

}  // namespace subvol
