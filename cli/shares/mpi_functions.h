// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace subvol::cli {

/// What the command needs of MPI, as its module has it. Sizes are in bytes and may exceed 2³¹. Failures of MPI end the program,
/// as MPI does by default.
struct MpiFunctions {
    void (*start)(int& rank, int& size);
    /// The largest of a number over all ranks.
    std::int64_t (*largest)(std::int64_t mine);
    /// Adds up, over all ranks, number by number.
    void (*sum)(std::int64_t* numbers, std::size_t count);
    /// From one rank to all others.
    void (*broadcast)(char* bytes, std::size_t count, int from);
    /// Sends to one rank and receives from another at the same time; a rank is -1 for none.
    void (*exchange)(const char* out, std::size_t out_count, int to, char* in, std::size_t in_count, int from);
    void (*finish)();
    void (*abort)(int code);
};

}  // namespace subvol::cli
