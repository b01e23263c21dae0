// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace subvol {

// Sums of sheets in 64-bit fixed point. What each kernel adds to a sum is rounded to a whole number of steps; whole numbers
// have the same sum in any order and in any groups. So a picture has the same bits however its kernels are divided among
// processes, and these send each other sums, whose number depends on the picture, not on the number of kernels.

/// Up to this number of kernels `--sheet-sums auto` sums floats; above it where sums take fewer bytes than kernels.
inline constexpr std::uint64_t kKernelsOfFixedSums = 20'000'000;

/// The most sheets that are summed so: a tile of 32 × 32 pixels on all of them is held at once.
inline constexpr int kMostFixedSheets = 4096;

/// What decides the step of each sum: the number of kernels of the picture, and bounds of what one of them may have within its
/// support. Bounds of parts of the kernels are joined by `add`, in any order.
///
/// value, color: absolute, in cells of the transfer function; gradient: a component, in cells for each world unit
struct SumBounds {
    std::uint64_t kernels = 0;
    double value = 0, color = 0, gradient = 0;

    void add(const SumBounds& more) {
        kernels += more.kernels;
        value = std::max(value, more.value);
        color = std::max(color, more.color);
        gradient = std::max(gradient, more.gradient);
    }
};

/// How a picture is summed in fixed point.
///
/// splits:   the rows of the picture where the bands of processes begin, multiples of `kBandRows`, and behind them where the
///           last band ends: process i draws the rows from splits[i] to before splits[i + 1]. Empty: all rows, by this process
/// own:      the number of this process
/// join:     gets the bounds of this process's kernels; returns those of all. None: these are all
/// exchange: gets what each process is sent by this one; returns what each has sent to this one. All processes call it equally
///           often. None: this process has all kernels that its rows need
struct FixedSums {
    std::vector<int> splits{};
    std::size_t own = 0;
    std::function<SumBounds(const SumBounds&)> join{};
    std::function<std::vector<std::string>(std::vector<std::string>)> exchange{};
};

/// What was summed and sent.
///
/// tile_batches:      pairs of a tile of 32 × 32 pixels and eight sheets on which this process had kernels
/// tile_batches_sent: those of them that belong to another process, each as 8192 numbers of 8 bytes for each sum
/// ends_sent:         places where rays enter or leave the volume, each as a number for each sum
/// sums:              for each pixel and sheet: 2, with a colour channel 1 more, with light 3 more
struct FixedSumsReport {
    std::size_t tile_batches = 0, tile_batches_sent = 0, ends_sent = 0, sums = 0;
};

}  // namespace subvol
