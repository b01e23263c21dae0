// SPDX-License-Identifier: Apache-2.0
// The module subvol_mpi.so: MPI.
#include <mpi.h>

#include <algorithm>
#include <vector>

#include "mpi_functions.h"
#include "subvol/version.h"

namespace {

constexpr std::size_t kMost = std::size_t{1} << 30;  // bytes of a message: MPI 3 counts with int

void start(int& rank, int& size) {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
}

std::int64_t largest(std::int64_t mine) {
    std::int64_t result = 0;
    MPI_Allreduce(&mine, &result, 1, MPI_INT64_T, MPI_MAX, MPI_COMM_WORLD);
    return result;
}

void sum(std::int64_t* numbers, std::size_t count) {
    constexpr std::size_t kAtOnce = kMost / sizeof(std::int64_t);
    for (std::size_t at = 0; at < count; at += kAtOnce) {
        const auto some = static_cast<int>(std::min(kAtOnce, count - at));
        MPI_Allreduce(MPI_IN_PLACE, numbers + at, some, MPI_INT64_T, MPI_SUM, MPI_COMM_WORLD);
    }
}

void broadcast(char* bytes, std::size_t count, int from) {
    for (std::size_t at = 0; at < count; at += kMost) {
        MPI_Bcast(bytes + at, static_cast<int>(std::min(kMost, count - at)), MPI_BYTE, from, MPI_COMM_WORLD);
    }
}

void exchange(const char* out, std::size_t out_count, int to, char* in, std::size_t in_count, int from) {
    std::vector<MPI_Request> requests;
    const auto pieces = [&](std::size_t count, int other, const auto& begin) {
        for (std::size_t at = 0; other >= 0 && at < count; at += kMost) {
            begin(at, static_cast<int>(std::min(kMost, count - at)), &requests.emplace_back());
        }
    };
    pieces(in_count, from, [&](std::size_t at, int count, MPI_Request* request) {
        MPI_Irecv(in + at, count, MPI_BYTE, from, 0, MPI_COMM_WORLD, request);
    });
    pieces(out_count, to, [&](std::size_t at, int count, MPI_Request* request) {
        MPI_Isend(out + at, count, MPI_BYTE, to, 0, MPI_COMM_WORLD, request);
    });
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

void finish() {
    MPI_Finalize();
}

void abort_all(int code) {
    MPI_Abort(MPI_COMM_WORLD, code);
}

}  // namespace

extern "C" {
extern const char subvol_module_version[];
const char subvol_module_version[] = SUBVOL_VERSION;

const subvol::cli::MpiFunctions* subvol_mpi() {
    static constexpr subvol::cli::MpiFunctions kFunctions{&start, &largest, &sum, &broadcast, &exchange, &finish, &abort_all};
    return &kFunctions;
}
}
