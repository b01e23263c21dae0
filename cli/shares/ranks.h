// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "report.h"
#include "share.h"

namespace subvol {
class Error;
}

namespace subvol::cli {

struct MpiFunctions;

/// The rank of this process and the number of processes, as mpirun or srun puts them into the environment; nothing if it was
/// started alone. MPI itself is not needed to know it.
struct RankInEnvironment {
    int rank = 0, size = 1;
    int on_host = 1;  ///< the number of processes on this computer
};
[[nodiscard]] std::optional<RankInEnvironment> rank_in_environment();

/// The processes of one run, which MPI started together: each does a share, rank 0 joins them, writes and speaks.
///
/// All ranks make the same calls in the same order. Each call first finds out whether a rank has failed: then all of them throw
/// the error of the first one that did, so that none waits for what will not come.
class Ranks {
public:
    /// Loads the module with MPI.
    ///
    /// throws: Error(MissingCapability) if this build has none
    Ranks();

    [[nodiscard]] int rank() const { return rank_; }
    [[nodiscard]] int size() const { return size_; }
    [[nodiscard]] bool first() const { return rank_ == 0; }
    [[nodiscard]] Share share() const { return {rank_ + 1, size_}; }
    /// The share of another rank.
    [[nodiscard]] Share share_of(int rank) const { return {rank + 1, size_}; }

    /// The bytes of every rank, at rank 0; elsewhere nothing.
    [[nodiscard]] std::vector<std::string> gather(std::string mine);

    /// to: for every rank what it gets; returns what each rank had for this one
    [[nodiscard]] std::vector<std::string> exchange(std::vector<std::string> to);

    /// The bytes of rank 0 at all of them.
    [[nodiscard]] std::string broadcast(std::string of_first);

    /// Adds up, over all ranks, number by number; exact, in whatever order.
    void sum(std::vector<std::int64_t>& numbers);

    /// The lists of all ranks one behind the other, at rank 0; elsewhere an empty one.
    [[nodiscard]] Json gather_list(const Json& mine);

    /// "ranks", "bytes_sent" and each rank's peak, at rank 0; elsewhere nothing.
    [[nodiscard]] Facts facts();

    /// Waits for all ranks. error: that of this rank, or null
    ///
    /// throws: the error of the first rank that has one
    void agree(const Error* error);

    /// Whether an error was one that all ranks have thrown.
    [[nodiscard]] bool agreed() const { return agreed_; }

    /// To be called at the end, by all.
    void finish();

private:
    void begin_call() { agree(nullptr); }

    const MpiFunctions& mpi_;
    int rank_ = 0, size_ = 1;
    std::int64_t bytes_sent_ = 0;
    bool agreed_ = false;
};

}  // namespace subvol::cli
