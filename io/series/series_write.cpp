// SPDX-License-Identifier: Apache-2.0
// Writes a mesh that changes with time into one file. Steps are read twice: a survey of all finds the ranges of values, from
// which the rounding of each array follows; then they are written one after the other. What fits into a fixed memory is kept
// between.
//
//     head │ mesh │ key step │ step │ step │ key step │ … │ mesh │ key step │ … │ zeros │ index
//
// A mesh is written when the cells change: as the coarser one whose refinement has the same cells in the same order, if there
// is one. From a value is taken what one or two steps before say, and what the neighbours predict of the rest; what is left is
// stored as a whole number of roundings. Each channel takes the predictions with the fewest bytes. Values whose error would be
// too large are kept exactly. A key step depends on no other one. Residuals of all channels are packed in blocks, in parallel.
// Zeros make a file as long as readers demand for the memory that a step takes. The head, with the place and the hash of the
// index, is written last.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "series_channels.h"
#include "series_survey.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/vtu_bytes.h"
#include "subvol/error.h"
#include "subvol/hierarchy.h"
#include "subvol/mesh_motion.h"
#include "subvol/option.h"
#include "subvol/series_file.h"
#include "wavelet_bytes.h"

namespace subvol {

using namespace detail;

namespace {

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

/// Ascending numbers, and others, as differences.
template <class Items, class NumberOf>
void put_differences(const Items& items, const NumberOf& number_of, Bytes& out) {
    out.number(items.size());
    std::int64_t before = 0;
    for (const auto& item : items) {
        const auto number = static_cast<std::int64_t>(number_of(item));
        out.number(folded(number - before));
        before = number;
    }
}

void put_sets(const MeshSets& sets, Bytes& out) {
    out.number(sets.patches.size());
    for (const Patch& patch : sets.patches) {
        out.text(patch.name);
        put_differences(
            patch.sides, [](const CellSide& side) { return 6 * std::uint64_t{side.cell} + side.side; }, out);
    }
    out.number(sets.sets.size());
    for (const CellSet& set : sets.sets) {
        out.text(set.name);
        put_differences(
            set.cells, [](Index cell) { return cell; }, out);
    }
}

/// Steps that are read for the survey and again for writing: what fits into a fixed memory is kept in between, since making
/// values at points of means of cells takes far longer than the rest.
class StepsReadTwice {
public:
    explicit StepsReadTwice(const MeshSteps& steps) : steps_(steps) {}

    [[nodiscard]] MeshSteps steps() {
        return {steps_.times, [this](std::size_t k) { return read(k); }, [this] { return sets_; }};
    }

private:
    struct Kept {
        HexMesh mesh;
        MeshSets sets;
    };
    static constexpr std::size_t kMostBytes = std::size_t{256} << 20;

    static std::size_t bytes_of(const HexMesh& mesh, const MeshSets& sets) {
        std::size_t bytes = mesh.points.size() * sizeof(Vec3) + mesh.cells.size() * sizeof(mesh.cells[0]) +
                            mesh.creases.size() * sizeof(mesh.creases[0]) +
                            mesh.sharp_faces.size() * sizeof(mesh.sharp_faces[0]);
        for (const Attribute& attribute : mesh.attributes) bytes += attribute.values.size() * sizeof(double);
        for (const Patch& patch : sets.patches) bytes += patch.sides.size() * sizeof(CellSide);
        for (const CellSet& set : sets.sets) bytes += set.cells.size() * sizeof(Index);
        return bytes;
    }

    HexMesh read(std::size_t k) {
        if (const auto found = kept_.find(k); found != kept_.end()) {
            Kept step = std::move(found->second);
            kept_.erase(found);
            sets_ = std::move(step.sets);
            return std::move(step.mesh);
        }
        HexMesh mesh = steps_.read(k);
        sets_ = steps_.sets ? steps_.sets() : MeshSets{};
        const bool first = k == read_;  // the second time nothing is kept
        if (!first) return mesh;
        ++read_;
        const std::size_t bytes = bytes_of(mesh, sets_);
        if (bytes > kMostBytes - bytes_) return mesh;
        bytes_ += bytes;
        kept_.emplace(k, Kept{mesh, sets_});
        return mesh;
    }

    const MeshSteps& steps_;
    std::map<std::size_t, Kept> kept_;
    MeshSets sets_;
    std::size_t bytes_ = 0, read_ = 0;
};

class SeriesWriter {
public:
    SeriesWriter(const std::filesystem::path& path, MeshSteps steps, const SeriesFileOptions& options)
        : steps_(std::move(steps)), options_(options), survey_(steps_, options), file_(path) {
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
        file_.write(std::string(kSeriesHead - kSeriesMagic.size(), '\0'));
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
        const std::uint64_t values = index_.channels() * mesh.points.size();
        step.key = other_mesh || since_key_ >= static_cast<std::size_t>(options_.key_steps) ||
                   (since_key_ + 1) * values > kMostDecoded;
        if (step.key) {
            since_key_ = 0;
            ++report_.key_steps;
            for (auto& array : before_) array = {};
        }
        ++since_key_;
        step.place.place = file_.position();
        step.place.hash = put_values(mesh);
        step.place.length = file_.position() - step.place.place;
        index_.steps.push_back(step);
        report_.points = mesh.points.size();
        report_.cells = mesh.cells.size();
    }

    void put_mesh_block(const HexMesh& mesh) {
        predictions_.emplace(mesh);
        for (const Spatial spatial : kSpatials) predictions_->make(spatial);
        cells_ = {};
        cells_.points.resize(mesh.points.size());
        cells_.cells = mesh.cells;
        cells_.creases = mesh.creases;
        cells_.sharp_faces = mesh.sharp_faces;
        Bytes out;
        const std::optional<CoarseCells> coarse = coarse_cells(cells_);
        out.number(coarse ? static_cast<std::uint64_t>(coarse->levels) : 0);
        put_mesh(coarse ? coarse->mesh : cells_, out);
        const std::size_t before_sets = out.all().size();
        put_sets(steps_.sets ? steps_.sets() : MeshSets{}, out);
        memory_ = std::max(
            memory_, series_memory(mesh.cells.size(), mesh.points.size(), index_.channels(), out.all().size() - before_sets));
        const std::string packed = compressed_numbers(out.all());
        index_.meshes.push_back({{file_.position(), packed.size(), hash_of(packed)}, out.all().size()});
        report_.mesh_bytes += packed.size();
        file_.write(packed);
    }

    /// For each array, points included, the attribute with its name and channels; null if the mesh has none.
    [[nodiscard]] std::vector<const Attribute*> attributes_of(const HexMesh& mesh) const {
        std::map<std::pair<std::string_view, std::size_t>, const Attribute*> known;
        for (const Attribute& a : mesh.attributes) known.try_emplace({a.name, static_cast<std::size_t>(a.channels)}, &a);
        std::vector<const Attribute*> found(index_.arrays.size(), nullptr);
        for (std::size_t a = 1; a < found.size(); ++a) {
            const auto at = known.find({index_.arrays[a].name, index_.arrays[a].channels.size()});
            if (at != known.end()) found[a] = at->second;
        }
        return found;
    }

    /// The hash of what is written.
    std::uint64_t put_values(const HexMesh& mesh) {
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
        const std::vector<const Attribute*> attributes = attributes_of(mesh);
        for (std::size_t a = 0; a < index_.arrays.size(); ++a) {
            const Attribute* attribute = attributes[a];
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
        const std::uint64_t hash = put_blocks(tasks, head);
        measure_shapes(mesh, places, tasks);
        for (Task& task : tasks) {
            History& history = before_[task.array];
            if (task.channel == 0) {
                history.insert(history.begin(), std::vector<std::vector<std::int64_t>>());
                history.resize(std::min<std::size_t>(history.size(), 2));
            }
            history.front().push_back(std::move(task.coded.residuals.numbers));
        }
        return hash;
    }

    template <class Tasks>
    std::uint64_t put_blocks(const Tasks& tasks, Bytes& head) {
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
        ByteHash hash;
        const auto put = [&](const std::string& bytes) {
            hash.add(bytes);
            file_.write(bytes);
        };
        put(head.all());
        for (const std::string& block : blocks) put(block);
        return hash.value();
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
            put_place(mesh.place, out);
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
            put_place(step.place, out);
        }
        const std::string packed = compressed_numbers(out.all());
        pad_to(memory_ <= kSeriesMemory ? 0 : memory_ / kMostGrowth + 1, packed.size());
        std::string head(kSeriesMagic);
        const auto put_number = [&](std::uint64_t n) {
            for (int k = 0; k < 8; ++k) head += static_cast<char>(n >> 8 * k & 255);
        };
        for (const std::uint64_t n : {file_.position(), std::uint64_t{packed.size()}, std::uint64_t{out.all().size()}}) {
            put_number(n);
        }
        put_number(hash_of(head + packed));
        file_.write(packed);
        report_.bytes = file_.position();
        file_.overwrite(kSeriesMagic.size(), std::string_view(head).substr(kSeriesMagic.size()));
    }

    static void put_place(const SeriesPlace& place, Bytes& out) {
        out.number(place.place);
        out.number(place.length);
        out.number(place.hash.value_or(0));
    }

    /// Zeros, so that the file has at least so many bytes with those that follow.
    void pad_to(std::uint64_t bytes, std::uint64_t follow) {
        const std::uint64_t there = file_.position() + follow;
        if (there < bytes) file_.write(std::string(bytes - there, '\0'));
    }

    /// The numbers of an array's channels in the step before, and in the one before that.
    using History = std::vector<std::vector<std::vector<std::int64_t>>>;

    MeshSteps steps_;
    const SeriesFileOptions& options_;
    SeriesSurvey survey_;
    OutputFile file_;
    SeriesIndex index_;
    std::optional<Predictions> predictions_;
    HexMesh cells_;
    std::vector<History> before_;
    std::size_t since_key_ = 0;
    std::uint64_t memory_ = 0;  // that reading a step takes
    SeriesFileReport report_;
};

}  // namespace

SeriesFileReport write_series_file(const std::filesystem::path& path, const MeshSteps& steps,
                                   const SeriesFileOptions& options) {
    check_options(options);
    if (steps.times.empty()) throw Error(ErrorCode::InvalidInput, "there is no step", "series", "at least one");
    for (std::size_t k = 0; k < steps.times.size(); ++k) {
        if (std::isfinite(steps.times[k]) && (k == 0 || steps.times[k - 1] < steps.times[k])) continue;
        throw Error(ErrorCode::InvalidInput, "the time of step " + std::to_string(k) + " is " + std::to_string(steps.times[k]),
                    "series", "finite times that ascend");
    }
    StepsReadTwice reader(steps);
    return SeriesWriter(path, reader.steps(), options).write();
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
            .between(1, kMostKeySteps)
            .help("K", "every K steps one that does not depend on others: no more are decoded to read one")};
}

Facts facts_of(const SeriesFileReport& report) {
    Facts facts;
    facts["steps"] = report.steps;
    facts["key_steps"] = report.key_steps;
    facts["meshes"] = report.meshes;
    facts["points"] = report.points;
    facts["cells"] = report.cells;
    facts["bytes"] = report.bytes;
    facts["mesh_bytes"] = report.mesh_bytes;
    double most = 0;
    std::vector<Facts> arrays;
    for (const SeriesArrayReport& array : report.arrays) {
        if (!array.name.empty()) most = std::max(most, array.max);
        Facts& kept = arrays.emplace_back();
        kept["name"] = array.name;
        kept["channels"] = array.channels;
        kept["steps"] = array.steps;
        kept["bytes"] = array.bytes;
        kept["max"] = array.max;
        kept["exact"] = array.exact;
    }
    facts["max"] = most;
    facts["point_max"] = report.arrays.front().max;
    facts["arrays"] = arrays;
    facts["inverted_cells"] = report.inverted_cells;
    return facts;
}

}  // namespace subvol
