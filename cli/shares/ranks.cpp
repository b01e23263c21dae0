// SPDX-License-Identifier: Apache-2.0
#include "ranks.h"

#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "mpi_functions.h"
#include "subvol/detail/byte_lists.h"
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
    using ModuleEntry = const MpiFunctions* (*)();
    return *reinterpret_cast<ModuleEntry>(detail::load_module("mpi", "working in several processes of MPI"))();
}

std::string bytes_of(const Error& error) {
    detail::BytePacker out;
    out.put(std::array{error.code()});
    for (const std::string& text : {error.message(), error.where(), error.allowed()}) out.put(text);
    return out.take();
}

Error error_from(const std::string& bytes) {
    detail::ByteUnpacker in(bytes, "these bytes are not an error");
    std::vector<ErrorCode> code;
    std::array<std::string, 3> texts;
    in.take(code);
    for (std::string& text : texts) in.take(text);
    return {code.at(0), texts[0], texts[1], texts[2]};
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

void Ranks::finish() {
    mpi_.finish();
}

Json Ranks::gather_list(const Json& mine) {
    Json all = Json::array();
    for (const std::string& bytes : gather(mine.dump())) {
        for (const Json& item : Json::parse(bytes)) all.push_back(item);
    }
    return all;
}

Facts Ranks::facts() {
    const std::array figures{bytes_sent_, peak_memory_bytes()};  // without what this call sends
    detail::BytePacker out;
    out.put(figures);
    std::int64_t sent = 0;
    std::vector<std::int64_t> peaks;
    for (const std::string& bytes : gather(out.take())) {
        std::vector<std::int64_t> one;
        detail::ByteUnpacker(bytes, "these bytes are not the figures of a rank").take(one);
        sent += one.at(0);
        peaks.push_back(one.at(1));
    }
    Facts facts;
    if (!first()) return facts;
    facts["ranks"] = size_;
    facts["bytes_sent"] = sent;
    facts["peak_bytes_of_ranks"] = peaks;
    return facts;
}

}  // namespace subvol::cli
