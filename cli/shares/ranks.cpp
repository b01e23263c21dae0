// SPDX-License-Identifier: Apache-2.0
#include "ranks.h"

#include <array>
#include <bit>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "mpi_functions.h"
#include "subvol/detail/module.h"
#include "subvol/error.h"

namespace subvol::cli {
namespace {

std::optional<int> number_in(const char* variable) {
    const char* text = std::getenv(variable);
    if (text == nullptr) return std::nullopt;
    int number = 0;
    const auto [end, error] = std::from_chars(text, text + std::strlen(text), number);
    if (error != std::errc() || *end != '\0' || number < 0) return std::nullopt;
    return number;
}

const MpiFunctions& load_mpi() {
    using Entry = const MpiFunctions* (*)();
    return *reinterpret_cast<Entry>(detail::load_module("mpi", "working in several processes of MPI"))();
}

/// An error as bytes: its code, and its three texts, each after its length.
std::string bytes_of(const Error& error) {
    std::string bytes(1, static_cast<char>(error.code()));
    for (const std::string& part : {error.message(), error.where(), error.allowed()}) {
        const std::uint64_t length = part.size();
        bytes.append(reinterpret_cast<const char*>(&length), sizeof length);
        bytes += part;
    }
    return bytes;
}

Error error_from(const std::string& bytes) {
    std::array<std::string, 3> parts;
    std::size_t at = 1;
    for (std::string& part : parts) {
        std::uint64_t length = 0;
        std::memcpy(&length, bytes.data() + at, sizeof length);
        part = bytes.substr(at + sizeof length, length);
        at += sizeof length + length;
    }
    return {static_cast<ErrorCode>(bytes[0]), parts[0], parts[1], parts[2]};
}

}  // namespace

std::optional<RankInEnvironment> rank_in_environment() {
    struct Names {
        const char *rank, *size, *on_host;
    };
    constexpr std::array<Names, 3> kNames{Names{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_LOCAL_SIZE"},
                                          Names{"PMI_RANK", "PMI_SIZE", "MPI_LOCALNRANKS"},
                                          Names{"PMIX_RANK", "SLURM_STEP_NUM_TASKS", "SLURM_NTASKS_PER_NODE"}};
    for (const Names& names : kNames) {
        const auto rank = number_in(names.rank), size = number_in(names.size);
        if (!rank || !size || *size < 2) continue;
        return RankInEnvironment{*rank, *size, std::max(1, number_in(names.on_host).value_or(1))};
    }
    return std::nullopt;
}

Ranks::Ranks() : mpi_(load_mpi()) {
    mpi_.start(rank_, size_);
}

void Ranks::agree(const Error* error) {
    // The first rank that failed has the largest number; 0: none.
    const std::int64_t failed = mpi_.largest(error != nullptr ? size_ - rank_ : 0);
    if (failed == 0) return;
    agreed_ = true;
    const int who = size_ - static_cast<int>(failed);
    std::string bytes = who == rank_ ? bytes_of(*error) : std::string();
    const std::int64_t length = mpi_.largest(who == rank_ ? static_cast<std::int64_t>(bytes.size()) : 0);
    bytes.resize(static_cast<std::size_t>(length));
    mpi_.broadcast(bytes.data(), bytes.size(), who);
    throw error_from(bytes);
}

std::vector<std::string> Ranks::gather(std::string mine) {
    std::vector<std::string> to(static_cast<std::size_t>(size_));
    to[0] = std::move(mine);
    std::vector<std::string> got = exchange(std::move(to));
    if (!first()) got.clear();
    return got;
}

std::vector<std::string> Ranks::exchange(std::vector<std::string> to) {
    begin_call();
    std::vector<std::string> got(to.size());
    const auto self = static_cast<std::size_t>(rank_);
    got[self] = std::move(to[self]);
    for (int step = 1; step < size_; ++step) {
        const int next = (rank_ + step) % size_, before = (rank_ - step + size_) % size_;
        const std::string& out = to[static_cast<std::size_t>(next)];
        std::string& in = got[static_cast<std::size_t>(before)];
        const std::uint64_t out_size = out.size();
        std::uint64_t in_size = 0;
        mpi_.exchange(reinterpret_cast<const char*>(&out_size), sizeof out_size, next, reinterpret_cast<char*>(&in_size),
                      sizeof in_size, before);
        in.resize(in_size);
        mpi_.exchange(out.data(), out.size(), next, in.data(), in.size(), before);
        bytes_sent_ += static_cast<std::int64_t>(out.size());
        to[static_cast<std::size_t>(next)] = {};
    }
    return got;
}

std::string Ranks::broadcast(std::string of_first) {
    begin_call();
    const std::int64_t length = mpi_.largest(first() ? static_cast<std::int64_t>(of_first.size()) : 0);
    of_first.resize(static_cast<std::size_t>(length));
    mpi_.broadcast(of_first.data(), of_first.size(), 0);
    if (first()) bytes_sent_ += length * (size_ - 1);
    return of_first;
}

void Ranks::sum(std::vector<std::int64_t>& numbers) {
    begin_call();
    mpi_.sum(numbers.data(), numbers.size());
    bytes_sent_ += static_cast<std::int64_t>(numbers.size() * sizeof(std::int64_t));
}

// Floats that are not negative have the order of their bits, so the place is found digit by digit: how many numbers begin with
// each value of the next bits.
float Ranks::in_place(const std::vector<float>& mine, std::size_t place) {
    constexpr unsigned kBits = 11;
    std::uint32_t found = 0, known = 0;  // the digits that are found, and their mask
    auto left = static_cast<std::int64_t>(place);
    for (unsigned shift = 32; shift > 0;) {
        const unsigned digits = std::min(kBits, shift);
        shift -= digits;
        std::vector<std::int64_t> counts(std::size_t{1} << digits);
        for (const float number : mine) {
            const auto bits = std::bit_cast<std::uint32_t>(number);
            if ((bits & known) == found) ++counts[(bits >> shift) & ((1U << digits) - 1)];
        }
        sum(counts);
        std::uint32_t digit = 0;
        while (digit + 1 < counts.size() && left >= counts[digit]) left -= counts[digit++];
        found |= digit << shift;
        known |= ((1U << digits) - 1) << shift;
    }
    return std::bit_cast<float>(found);
}

void Ranks::finish() {
    mpi_.finish();
}

}  // namespace subvol::cli
