// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/mesh_sets.h"
#include "value_prediction.h"

namespace subvol::detail {

// A .svw file of steps: kSeriesMagic; place, length and unpacked length of the index, and the hash of these three and of the
// index as it is stored (8 bytes each, lowest first); meshes and steps one after the other; zeros, where the file would
// otherwise stand for more memory than kMostGrowth times its bytes; the index. Numbers are as in wavelet_format.h. Hashes are
// those of byte_hash.h, so that no byte is read that is not as it was written.
//
//   mesh    compressed: levels; points and cells, creases, sharp faces, as in a file of wavelets; refined so often they are
//             those of the steps
//
//             patches: how many; for each its name and its sides: how many, and 6 · cell + side less that of the one before
//
//             sets of cells: how many; for each its name and its cells: how many, and each less the one before
//
//   step    for each array a byte, 1 if the step has it; then for each channel of these
//             a byte: the prediction and, times 4, what of earlier steps it is added to (Spatial, Temporal)
//             a byte: how many bytes each residual has; 0: all are 0
//             exact values: how many; for each its point as the difference from the one before, and a real
//           for each of these arrays how many bounds, 0 or as many as channels; two reals each
//           for each block the number of its bytes; the blocks, compressed. A block has the residuals of channels one after the
//             other, each as planes of bytes, lowest first, without sign as 0, -1, 1, -2, …; it ends with the channel with
//             which it reaches kBlockBytes
//   index   compressed:
//             meshes: how many; for each place, length, hash, unpacked length
//             arrays: how many; for each its name, channels, and of each channel origin, step, least, greatest value (reals).
//               The first array has the points, and no name.
//             steps: how many; for each its time (real), the number of its mesh, 1 if it is a key step, place, length, hash
//
// Files of the first version begin with kFirstSeriesMagic, and have no hashes.

inline constexpr std::string_view kSeriesMagic = "subvol-series-2\n", kFirstSeriesMagic = "subvol-series-1\n";
inline constexpr std::size_t kSeriesHead = kSeriesMagic.size() + 32, kFirstSeriesHead = kFirstSeriesMagic.size() + 24;
inline constexpr std::size_t kBlockBytes = std::size_t{1} << 20;
inline constexpr int kFractionBits = 8;
inline constexpr std::int64_t kMostQuantized = std::int64_t{1} << 50;

/// From which values of a step the residual is predicted.
enum class Spatial : std::uint8_t { None, ByNumber, InCells, BetweenSheets };
/// What the step before, or the two before, predict.
enum class Temporal : std::uint8_t { None, Same, Linear };

/// How a channel is made of whole numbers: origin + n · step / 2⁸, within [min, max]. A residual of 1 changes n by 2⁸: what is
/// predicted may lie between steps.
struct Quantization {
    double origin = 0, step = 0, min = 0, max = 0;

    [[nodiscard]] double value(std::int64_t n) const {
        const double x = origin + std::ldexp(static_cast<double>(n), -kFractionBits) * step, near = 1e-6 * step;
        return x < min + near ? min : x > max - near ? max : x;  // the ends are whole numbers of steps, but for rounding
    }
};

struct SeriesArray {
    std::string name;
    std::vector<Quantization> channels;
};

struct SeriesPlace {
    std::uint64_t place = 0, length = 0;
    std::optional<std::uint64_t> hash = {};  ///< hash of the bytes there; none in files of the first version
};

struct SeriesMesh {
    SeriesPlace place;
    std::uint64_t unpacked = 0;
};

struct SeriesStep {
    double time = 0;
    std::size_t mesh = 0;
    bool key = true;
    SeriesPlace place;
};

struct SeriesIndex {
    std::vector<SeriesMesh> meshes;
    std::vector<SeriesArray> arrays;
    std::vector<SeriesStep> steps;

    /// Of all arrays, as if a step had all of them.
    [[nodiscard]] std::uint64_t channels() const {
        std::uint64_t sum = 0;
        for (const SeriesArray& array : arrays) sum += array.channels.size();
        return sum;
    }
};

// Few bytes can say that they are a large mesh with many steps. Reading a step takes at most so much memory, or so many times
// the bytes of the file, and decodes at most so many values, or so many for each byte of the steps that are decoded. The writer
// keeps to both: it adds zeros to the file, and begins anew with a key step.
inline constexpr std::uint64_t kSeriesMemory = std::uint64_t{512} << 20, kMostGrowth = 8192;
inline constexpr std::uint64_t kMostDecoded = std::uint64_t{1} << 28, kMostDecodedPerByte = 1024;
inline constexpr int kMostKeySteps = 1000;

/// What is in memory while a step is read.
///
/// cells, points: of the mesh, refined; channels: of its arrays, points included; set_bytes: of patches and sets, as stored
[[nodiscard]] inline std::uint64_t series_memory(std::uint64_t cells, std::uint64_t points, std::uint64_t channels,
                                                 std::uint64_t set_bytes) {
    // A cell with its part of the topology, as measured. A point; in each channel the numbers of three steps, residuals of
    // at most 6 bytes, the value. A side of a cell, of a byte or more: itself and its number.
    constexpr std::uint64_t kCell = 300, kPoint = 24, kChannel = 3 * 8 + 6 + 8, kSetByte = 16;
    return kCell * cells + (kPoint + kChannel * channels) * std::max(points, cells) + kSetByte * set_bytes;
}

/// What the steps before predict for value `p`.
[[nodiscard]] inline std::int64_t earlier(Temporal temporal, const std::vector<std::int64_t>& before,
                                          const std::vector<std::int64_t>& two_before, std::size_t p) {
    if (temporal == Temporal::None) return 0;
    return temporal == Temporal::Same ? before[p] : 2 * before[p] - two_before[p];
}

/// Few bytes stand for no more cells than these; larger meshes are stored cell by cell.
inline constexpr std::size_t kMostRefinedCells = std::size_t{1} << 22;
inline constexpr int kMostLevels = 6;

/// The cells, creases and sharp faces of a mesh that was refined; its points are at the origin.
[[nodiscard]] HexMesh refined_cells(const HexMesh& coarse, int levels);

/// Whether a text begins as a file of steps does.
[[nodiscard]] bool is_series_text(std::string_view text);

/// The times of a file of steps; of one step none.
///
/// throws: Error(InvalidInput) if the file is not right
[[nodiscard]] std::vector<double> series_file_times(const std::filesystem::path& path);

/// What is read of a step.
struct SeriesMeshAndSets {
    HexMesh mesh;
    MeshSets sets;
};

/// A step, from 0.
///
/// throws: Error(InvalidInput) if the file is not right, or has no such step
[[nodiscard]] SeriesMeshAndSets read_series_file(const std::filesystem::path& path, std::size_t step);

}  // namespace subvol::detail
