// SPDX-License-Identifier: Apache-2.0
// Reads one step of a file of steps. The head says where the index is; the index has the places of meshes and steps, their
// hashes, and how the values of each array are rounded. To decode a step, those from its last key step on are decoded in turn:
//
//     head → index → mesh, refined if a coarser one is stored → key step → … → step → values
//
// In a step, a channel has a number n at each point, in 1/256 of its rounding. Planes of bytes give residuals in whole
// roundings; with the prediction from points that are known already, they make the difference from what the one or two steps
// before say, and so n. The value is origin + rounding · n / 256, within the channel's range, or one that is kept exactly.
// Channels are independent of each other, so they are decoded in parallel.
//
// Nothing in a file is trusted: each range must be there, with its hash if the file has hashes; meshes and steps must follow
// each other without gaps; and memory and work are refused that so few bytes do not stand for.
#include <tbb/parallel_for.h>

#include <system_error>

#include "series_channels.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/read_file.h"
#include "subvol/detail/vtu_bytes.h"
#include "subvol/error.h"
#include "subvol/refine.h"
#include "wavelet_bytes.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMostChannels = 1000;
constexpr std::uint64_t kMostPadding = std::uint64_t{64} << 20;
constexpr int kMostResidualBytes = 6;
constexpr std::int64_t kMostChange = 4 * kMostQuantized;

/// The bytes of a file, each range only if it is there, and as it was written.
class SeriesBytes {
public:
    explicit SeriesBytes(const std::filesystem::path& path) : path_(path), file_(path.string()) {
        std::error_code error;
        size_ = std::filesystem::file_size(path, error);
        if (error) throw Error(ErrorCode::Io, "cannot be read: " + error.message(), file_);
    }

    [[nodiscard]] std::string range(const SeriesPlace& place, const char* what) const {
        if (place.place > size_ || place.length > size_ - place.place) fail(std::string(what) + " is not in the file");
        std::string bytes = read_range(path_, place.place, place.length);
        if (bytes.size() != place.length) fail(std::string(what) + " is not in the file");
        if (place.hash && *place.hash != hash_of(bytes)) fail("the bytes of " + std::string(what) + " are damaged");
        return bytes;
    }

    [[noreturn]] void fail(const std::string& what, const std::string& allowed = {}) const {
        throw Error(ErrorCode::InvalidInput, what, file_, allowed);
    }

    /// Refuses memory that so few bytes do not stand for.
    void expect_growth(std::uint64_t packed, std::uint64_t unpacked, std::uint64_t always = kSeriesMemory / 2) const {
        if (unpacked <= always || unpacked / kMostGrowth <= packed) return;
        fail(std::to_string(packed) + " bytes say that they are " + std::to_string(unpacked),
             "at most " + std::to_string(kMostGrowth) + " times as many, or " + std::to_string(always >> 20) + " MiB");
    }

    /// Refuses what reading a step would take, if the file is too small for it. counts: of the refined mesh
    void expect_memory(std::uint64_t cells, std::uint64_t points, std::uint64_t channels, std::uint64_t set_bytes) const {
        if (std::max(cells, points) >= kNone) fail(std::to_string(cells) + " cells are too many");
        expect_growth(size_, series_memory(cells, points, channels, set_bytes), kSeriesMemory);
    }

    [[nodiscard]] std::string unpacked(const std::string& packed, std::uint64_t length) const {
        expect_growth(packed.size(), length);
        auto contents = decompressed(Compressor::Lzma, packed, length);
        if (!contents) fail(Contents::kDamaged);
        return std::move(*contents);
    }

    [[nodiscard]] std::uint64_t size() const { return size_; }
    [[nodiscard]] const std::string& file() const { return file_; }

private:
    std::filesystem::path path_;
    std::string file_;
    std::uint64_t size_ = 0;
};

SeriesPlace read_place(Contents& in, bool with_hash) {
    SeriesPlace place;
    place.place = in.number();
    place.length = in.number();
    if (with_hash) place.hash = in.number();
    return place;
}

Quantization read_quantization(Contents& in) {
    Quantization q;
    for (double* x : {&q.origin, &q.step, &q.min, &q.max}) {
        *x = in.real();
        if (!std::isfinite(*x)) in.fail("a number of a quantization is not finite");
    }
    if (q.step < 0 || q.min > q.max) in.fail("a quantization has a step or a range below 0");
    return q;
}

/// What is before the index: where the index is, and whether there are hashes.
struct SeriesHead {
    SeriesPlace index;
    std::uint64_t unpacked = 0, length = 0;
    bool with_hashes = false;
};

SeriesHead read_head_of(const SeriesBytes& bytes) {
    const std::string magic = bytes.range({0, kSeriesMagic.size()}, "the head");
    if (!is_series_text(magic)) bytes.fail("not a file of steps", "it begins with subvol-series-");
    SeriesHead head;
    head.with_hashes = magic == kSeriesMagic;
    head.length = head.with_hashes ? kSeriesHead : kFirstSeriesHead;
    const std::string text = bytes.range({0, head.length}, "the head");
    std::array<std::uint64_t, 4> numbers{};
    for (std::size_t k = magic.size(); k < text.size(); ++k) {
        const std::size_t at = k - magic.size();
        numbers[at / 8] |= std::uint64_t{static_cast<unsigned char>(text[k])} << 8 * (at % 8);
    }
    head.index = {numbers[0], numbers[1]};
    head.unpacked = numbers[2];
    if (head.with_hashes) {
        const std::string stored = text.substr(0, kFirstSeriesHead) + bytes.range(head.index, "the index");
        if (hash_of(stored) != numbers[3]) bytes.fail("the bytes of the head or of the index are damaged");
    }
    return head;
}

/// Meshes and steps lie one after the other between the head and the index: no byte belongs to two of them, or to none but
/// zeros before the index.
void check_places(const SeriesBytes& bytes, const SeriesHead& head, const SeriesIndex& index) {
    std::vector<SeriesPlace> places;
    for (const SeriesMesh& mesh : index.meshes) places.push_back(mesh.place);
    for (const SeriesStep& step : index.steps) places.push_back(step.place);
    std::ranges::sort(places, {}, &SeriesPlace::place);
    std::uint64_t end = head.length;
    for (const SeriesPlace& place : places) {
        if (place.place != end) {
            bytes.fail("a mesh or a step begins at byte " + std::to_string(place.place) + ", where " +
                           (place.place < end ? "another one is" : "none does"),
                       "they follow each other: byte " + std::to_string(end));
        }
        if (place.length == 0 || place.length > bytes.size() - end) bytes.fail("a mesh or a step is not in the file");
        end += place.length;
    }
    if (head.index.place < end || head.index.place - end > kMostPadding ||
        head.index.length != bytes.size() - head.index.place) {
        bytes.fail("the index does not follow the last step, or is not the end of the file");
    }
    const std::string padding = bytes.range({end, head.index.place - end}, "the end of the steps");
    if (padding.find_first_not_of('\0') != std::string::npos) bytes.fail("bytes before the index are damaged");
}

SeriesIndex read_index(const SeriesBytes& bytes) {
    // Times and places do not repeat: an index is not packed as well as values are.
    constexpr std::uint64_t kMostIndex = std::uint64_t{16} << 20, kMostIndexGrowth = 64;
    const SeriesHead head = read_head_of(bytes);
    if (head.unpacked > kMostIndex && head.unpacked / kMostIndexGrowth > bytes.size()) {
        bytes.fail(std::to_string(bytes.size()) + " bytes have an index of " + std::to_string(head.unpacked),
                   "at most 64 times as many, or 16 MiB");
    }
    const std::string contents = bytes.unpacked(bytes.range(head.index, "the index"), head.unpacked);
    Contents in(contents, bytes.file());
    SeriesIndex index;
    const std::size_t meshes = in.count("meshes", 3);
    for (std::size_t k = 0; k < meshes; ++k) {
        SeriesMesh mesh{read_place(in, head.with_hashes), 0};
        mesh.unpacked = in.number();
        index.meshes.push_back(mesh);
    }
    const std::size_t arrays = in.count("arrays", 34);
    for (std::size_t a = 0; a < arrays; ++a) {
        SeriesArray array{in.text(), {}};
        const std::size_t channels = in.count("channels", 32);
        if (a == 0 && channels != 3) in.fail("points have " + std::to_string(channels) + " coordinates", "3");
        if (channels == 0 || channels > kMostChannels) {
            in.fail("an array has " + std::to_string(channels) + " channels", "1 to 1000");
        }
        for (std::size_t c = 0; c < channels; ++c) array.channels.push_back(read_quantization(in));
        index.arrays.push_back(std::move(array));
    }
    if (arrays == 0) in.fail("there are no points");
    const std::size_t steps = in.count("steps", 12);
    if (steps == 0) in.fail("there is no step");
    std::size_t since_key = 0;
    for (std::size_t k = 0; k < steps; ++k) {
        SeriesStep step;
        step.time = in.real();
        step.mesh = in.number();
        const std::uint64_t key = in.number();
        if (key > 1) in.fail("step " + std::to_string(k) + " is key step " + std::to_string(key), "0 or 1");
        step.key = key == 1;
        step.place = read_place(in, head.with_hashes);
        if (!std::isfinite(step.time) || (k > 0 && !(step.time > index.steps.back().time)))
            in.fail("the times of steps do not ascend");
        if (step.mesh >= meshes)
            in.fail("step " + std::to_string(k) + " has mesh " + std::to_string(step.mesh),
                    std::to_string(meshes) + " are there");
        if (!step.key && (k == 0 || step.mesh != index.steps.back().mesh))
            in.fail("step " + std::to_string(k) + " depends on another mesh");
        since_key = step.key ? 0 : since_key + 1;
        if (since_key >= kMostKeySteps)
            in.fail("step " + std::to_string(k) + " depends on " + std::to_string(since_key) + " others",
                    "less than " + std::to_string(kMostKeySteps));
        index.steps.push_back(step);
    }
    in.expect_end();
    check_places(bytes, head, index);
    return index;
}

/// The values of an array in a step: as whole numbers, and those that are kept as they are.
struct StepChannel {
    Spatial spatial = Spatial::None;
    Temporal temporal = Temporal::None;
    std::size_t bytes_each = 0;
    std::size_t block = 0, place_in_block = 0;
    std::vector<std::size_t> exact_points;
    std::vector<double> exact_values;
    std::vector<std::int64_t> numbers;
};

struct StepArray {
    bool present = false;
    std::vector<StepChannel> channels;
    std::vector<std::array<double, 2>> bounds;
};

/// Decodes steps one after the other, from a key step on.
class StepDecoder {
public:
    StepDecoder(const SeriesBytes& bytes, const SeriesIndex& index, HexMesh mesh)
        : bytes_(bytes), index_(index), mesh_(std::move(mesh)), predictions_(mesh_) {}

    void decode(std::size_t step) {
        const SeriesPlace& place = index_.steps[step].place;
        const std::string text = bytes_.range(place, "a step");
        Contents in(text, bytes_.file());
        if (index_.steps[step].key) last_ = two_before_ = {};
        std::vector<StepArray> arrays(index_.arrays.size());
        read_head(in, arrays);
        const std::vector<std::string> blocks = read_blocks(in, text, arrays);
        std::vector<StepChannel*> channels;
        std::vector<std::array<const std::vector<std::int64_t>*, 2>> known;
        for (std::size_t a = 0; a < arrays.size(); ++a) {
            for (std::size_t c = 0; c < arrays[a].channels.size(); ++c) {
                channels.push_back(&arrays[a].channels[c]);
                known.push_back({numbers_of(last_, a, c), numbers_of(two_before_, a, c)});
                const std::size_t needed = static_cast<std::size_t>(channels.back()->temporal);
                for (std::size_t k = 0; k < needed; ++k) {
                    if (known.back()[k] == nullptr) bytes_.fail("an array depends on a step that does not have it");
                }
                predictions_.make(channels.back()->spatial);
            }
        }
        tbb::parallel_for(std::size_t{0}, channels.size(),
                          [&](std::size_t k) { decode_channel(*channels[k], known[k], blocks); });
        two_before_ = std::move(last_);
        last_ = std::move(arrays);
    }

    /// The mesh of the step that was decoded last.
    [[nodiscard]] HexMesh take() {
        HexMesh mesh = std::move(mesh_);
        for (std::size_t a = 0; a < last_.size(); ++a) {
            if (!last_[a].present) continue;
            std::vector<double> values = values_of(a);
            if (a == 0) {
                for (std::size_t p = 0; p < mesh.points.size(); ++p) {
                    mesh.points[p] = Vec3(values[3 * p], values[3 * p + 1], values[3 * p + 2]);
                }
                continue;
            }
            mesh.attributes.push_back({index_.arrays[a].name, static_cast<int>(index_.arrays[a].channels.size()),
                                       std::move(values), last_[a].bounds});
        }
        return mesh;
    }

private:
    [[nodiscard]] std::size_t points() const { return mesh_.points.size(); }

    [[nodiscard]] static const std::vector<std::int64_t>* numbers_of(const std::vector<StepArray>& step, std::size_t array,
                                                                     std::size_t channel) {
        return step.empty() || !step[array].present ? nullptr : &step[array].channels[channel].numbers;
    }

    void read_head(Contents& in, std::vector<StepArray>& arrays) const {
        std::uint64_t channels = 0;
        for (std::size_t a = 0; a < arrays.size(); ++a) {
            const std::uint64_t present = in.byte();
            if (present > 1) in.fail("a step has " + std::to_string(present) + " of an array", "0 or 1");
            arrays[a].present = present == 1;
            if (arrays[a].present) channels += index_.arrays[a].channels.size();
            if (a == 0 && !arrays[a].present) in.fail("a step has no points");
        }
        bytes_.expect_growth(bytes_.size(), channels * points() * sizeof(double));
        for (std::size_t a = 0; a < arrays.size(); ++a) {
            if (!arrays[a].present) continue;
            arrays[a].channels.resize(index_.arrays[a].channels.size());
            for (StepChannel& channel : arrays[a].channels) read_channel(in, channel);
        }
        for (std::size_t a = 0; a < arrays.size(); ++a) {
            if (!arrays[a].present) continue;
            const std::size_t bounds = in.count("bounds", 16);
            if (bounds != 0 && a == 0) in.fail("points have bounds");
            for (std::size_t k = 0; k < bounds; ++k) {
                const double low = in.real(), high = in.real();
                arrays[a].bounds.push_back({low, high});
            }
        }
    }

    void read_channel(Contents& in, StepChannel& channel) const {
        const std::uint64_t mode = in.byte();
        if (mode / 4 > 2) in.fail("there is no prediction " + std::to_string(mode));
        channel.spatial = static_cast<Spatial>(mode % 4);
        channel.temporal = static_cast<Temporal>(mode / 4);
        channel.bytes_each = in.byte();
        if (channel.bytes_each > kMostResidualBytes) {
            in.fail("residuals of " + std::to_string(channel.bytes_each) + " bytes", "at most 6");
        }
        const std::size_t exact = in.count("exact values", 9);
        std::uint64_t point = 0;
        for (std::size_t k = 0; k < exact; ++k) {
            const std::uint64_t change = in.number();
            if (change >= points() || point + change >= points()) in.fail("an exact value is at no point");
            point += change;
            channel.exact_points.push_back(point);
            channel.exact_values.push_back(in.real());
        }
    }

    [[nodiscard]] std::vector<std::string> read_blocks(Contents& in, const std::string& text,
                                                       std::vector<StepArray>& arrays) const {
        std::vector<std::size_t> sizes;
        bool full = true;
        for (StepArray& array : arrays) {
            for (StepChannel& channel : array.channels) {
                if (channel.bytes_each == 0) continue;
                if (full) sizes.push_back(0);
                channel.block = sizes.size() - 1;
                channel.place_in_block = sizes.back();
                sizes.back() += channel.bytes_each * points();
                full = sizes.back() >= kBlockBytes;
            }
        }
        std::vector<SeriesPlace> packed;
        for (std::size_t b = 0; b < sizes.size(); ++b) packed.push_back({0, in.number()});
        std::uint64_t place = text.size() - in.left(), unpacked = 0;
        for (std::size_t b = 0; b < sizes.size(); ++b) {
            packed[b].place = place;
            if (packed[b].length > text.size() - place) in.fail("a block of a step is not in the file");
            place += packed[b].length;
            unpacked += sizes[b];
        }
        if (place != text.size()) in.fail("bytes follow the last block of a step");
        bytes_.expect_growth(text.size(), unpacked);
        std::vector<std::string> blocks(sizes.size());
        tbb::parallel_for(std::size_t{0}, sizes.size(), [&](std::size_t b) {
            auto block =
                decompressed(Compressor::Lzma, std::string_view(text).substr(packed[b].place, packed[b].length), sizes[b]);
            if (!block) bytes_.fail(Contents::kDamaged);
            blocks[b] = std::move(*block);
        });
        return blocks;
    }

    void decode_channel(StepChannel& channel, const std::array<const std::vector<std::int64_t>*, 2>& known,
                        const std::vector<std::string>& blocks) {
        static const std::vector<std::int64_t> kNothing;
        const auto &last = known[0] ? *known[0] : kNothing, &two_before = known[1] ? *known[1] : kNothing;
        const ValuePrediction* prediction = predictions_.find(channel.spatial);
        std::vector<std::int64_t>& numbers = channel.numbers;
        numbers.resize(points());
        const char* planes = channel.bytes_each == 0 ? nullptr : blocks[channel.block].data() + channel.place_in_block;
        const auto residual = [&](std::size_t i) {
            std::uint64_t rest = 0;
            for (std::size_t plane = 0; plane < channel.bytes_each; ++plane) {
                rest |= std::uint64_t{static_cast<unsigned char>(planes[plane * points() + i])} << 8 * plane;
            }
            return unfolded(rest) * (std::int64_t{1} << kFractionBits);
        };
        const auto within = [&](std::int64_t n, std::int64_t most) {
            if (n < -most || n > most) bytes_.fail("a value of a step is too large");
            return n;
        };
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            if (prediction == nullptr) {
                numbers[i] = within(residual(i), kMostChange);
            } else {
                numbers[prediction->order[i]] = within(prediction->predict(i, numbers) + residual(i), kMostChange);
            }
        }
        for (std::size_t p = 0; p < numbers.size(); ++p) {
            numbers[p] = within(numbers[p] + earlier(channel.temporal, last, two_before, p), kMostQuantized);
        }
    }

    [[nodiscard]] std::vector<double> values_of(std::size_t array) const {
        const auto& quantizations = index_.arrays[array].channels;
        const std::size_t channels = quantizations.size(), count = last_[array].channels.front().numbers.size();
        std::vector<double> values(channels * count);
        for (std::size_t c = 0; c < channels; ++c) {
            const StepChannel& channel = last_[array].channels[c];
            for (std::size_t p = 0; p < count; ++p) values[p * channels + c] = quantizations[c].value(channel.numbers[p]);
            for (std::size_t k = 0; k < channel.exact_points.size(); ++k) {
                values[channel.exact_points[k] * channels + c] = channel.exact_values[k];
            }
        }
        return values;
    }

    const SeriesBytes& bytes_;
    const SeriesIndex& index_;
    HexMesh mesh_;
    Predictions predictions_;
    std::vector<StepArray> last_, two_before_;
};

/// Numbers that are written as differences, each below a limit.
std::vector<std::uint64_t> read_differences(Contents& in, const char* what, std::uint64_t limit) {
    const std::size_t count = in.count(what, 1);
    if (count > limit) in.fail(std::to_string(count) + " " + what + " in one list", "there are " + std::to_string(limit));
    std::vector<std::uint64_t> numbers(count);
    std::int64_t number = 0;
    for (std::uint64_t& n : numbers) {
        const std::int64_t change = in.signed_number();
        const auto most = static_cast<std::int64_t>(limit);
        if (change < -most || change > most || number + change < 0 || number + change >= most) {
            in.fail(std::string("the file names ") + what + " that do not exist");
        }
        number += change;
        n = static_cast<std::uint64_t>(number);
    }
    return numbers;
}

MeshSets read_sets(Contents& in, std::size_t cells) {
    MeshSets sets;
    const std::size_t patches = in.count("patches", 2);
    for (std::size_t k = 0; k < patches; ++k) {
        Patch& patch = sets.patches.emplace_back(Patch{in.text(), {}});
        for (const std::uint64_t n : read_differences(in, "sides of cells", 6 * cells)) {
            patch.sides.push_back({static_cast<Index>(n / 6), static_cast<std::uint8_t>(n % 6)});
        }
    }
    const std::size_t count = in.count("sets", 2);
    for (std::size_t k = 0; k < count; ++k) {
        CellSet& set = sets.sets.emplace_back(CellSet{in.text(), {}});
        for (const std::uint64_t n : read_differences(in, "cells", cells)) set.cells.push_back(static_cast<Index>(n));
    }
    return sets;
}

SeriesMeshAndSets read_cells_of(const SeriesBytes& bytes, const SeriesMesh& stored, std::uint64_t channels) {
    const std::string contents = bytes.unpacked(bytes.range(stored.place, "a mesh"), stored.unpacked);
    Contents in(contents, bytes.file());
    const std::uint64_t levels = in.number();
    if (levels > kMostLevels) in.fail("the number of levels is " + std::to_string(levels), "0 to 6");
    Contents ahead = in;
    const std::uint64_t points = ahead.number(), cells = ahead.number();
    if (std::max(points, cells) > contents.size() * 8) in.fail("more points or cells than the file has room for");
    if (levels > 0 && cells > kMostRefinedCells >> 3 * levels) {
        in.fail(std::to_string(levels) + " levels of " + std::to_string(cells) + " cells are too many",
                "at most 4194304 cells that are refined");
    }
    bytes.expect_memory(cells << 3 * levels, points, channels, 0);
    HexMesh mesh = read_cells(in, 0);
    if (levels > 0) mesh = refined_cells(mesh, static_cast<int>(levels));
    bytes.expect_memory(mesh.cells.size(), mesh.points.size(), channels, in.left());
    MeshSets sets = read_sets(in, mesh.cells.size());
    in.expect_end();
    return {std::move(mesh), std::move(sets)};
}

/// Refuses many steps of many values that few bytes stand for.
void expect_decoding(const SeriesBytes& bytes, const SeriesIndex& index, std::size_t key, std::size_t step,
                     std::uint64_t points) {
    std::uint64_t length = 0;
    for (std::size_t k = key; k <= step; ++k) length += index.steps[k].place.length;
    const std::uint64_t values = (step - key + 1) * index.channels() * points;
    if (values <= kMostDecoded || values / kMostDecodedPerByte <= length) return;
    bytes.fail(std::to_string(length) + " bytes of steps have " + std::to_string(values) + " values",
               "at most " + std::to_string(kMostDecodedPerByte) + " for each, or " + std::to_string(kMostDecoded));
}

}  // namespace

HexMesh refined_cells(const HexMesh& coarse, int levels) {
    HexMesh fine = refine(coarse, {.scheme = {.kind = Scheme::Linear}, .levels = levels});
    fine.attributes.clear();
    return fine;
}

bool is_series_text(std::string_view text) {
    return text.starts_with(kSeriesMagic) || text.starts_with(kFirstSeriesMagic);
}

std::vector<double> series_file_times(const std::filesystem::path& path) {
    std::vector<double> times;
    for (const SeriesStep& step : read_index(SeriesBytes(path)).steps) times.push_back(step.time);
    return times;
}

SeriesMeshAndSets read_series_file(const std::filesystem::path& path, std::size_t step) {
    const SeriesBytes bytes(path);
    const SeriesIndex index = read_index(bytes);
    if (step >= index.steps.size()) bytes.fail("there is no step " + std::to_string(step));
    std::size_t key = step;
    while (!index.steps[key].key) --key;
    try {
        SeriesMeshAndSets cells = read_cells_of(bytes, index.meshes[index.steps[step].mesh], index.channels());
        expect_decoding(bytes, index, key, step, cells.mesh.points.size());
        StepDecoder decoder(bytes, index, std::move(cells.mesh));
        for (std::size_t k = key; k <= step; ++k) decoder.decode(k);
        HexMesh mesh = decoder.take();
        if (index.steps.size() > 1) mesh.time = index.steps[step].time;
        return {std::move(mesh), std::move(cells.sets)};
    } catch (const Error& error) {
        if (error.where() == bytes.file()) throw;
        throw Error(error.code(), error.message(), bytes.file(), error.allowed());
    }
}

}  // namespace subvol::detail
