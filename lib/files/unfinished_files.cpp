// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/unfinished_files.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <string>

namespace subvol::detail {

namespace {

constexpr std::size_t kPlaces = 64, kLongestName = 4096;

// A handler of signals may interrupt anything, so there are no locks and no allocation: a place is free, being changed, or
// holds a whole name.
enum class State { Free, Changing, Held };

struct Destination {
    std::atomic<State> state = State::Free;
    std::array<char, kLongestName> file{};
    std::array<char, kLongestName> folder{};  // empty: not to be removed
};
static_assert(std::atomic<State>::is_always_lock_free);

std::array<Destination, kPlaces> places;
std::atomic<void (*)() noexcept> of_module = nullptr;

void put(const std::string& name, std::array<char, kLongestName>& to) {
    *std::ranges::copy(name, to.begin()).out = '\0';
}

}  // namespace

UnfinishedFile::UnfinishedFile(const std::filesystem::path& file, bool with_folder) {
    const std::string name = file.string(), folder = with_folder ? file.parent_path().string() : "";
    if (name.size() >= kLongestName) return;
    for (std::size_t i = 0; i < kPlaces; ++i) {
        State free = State::Free;
        if (!places[i].state.compare_exchange_strong(free, State::Changing)) continue;
        put(name, places[i].file);
        put(folder, places[i].folder);
        places[i].state = State::Held;
        place_ = i;
        return;
    }
}

UnfinishedFile::~UnfinishedFile() {
    if (place_) places[*place_].state = State::Free;
}

void remove_unfinished_files() noexcept {
    for (const Destination& place : places) {
        if (place.state != State::Held) continue;
        (void)unlink(place.file.data());
        if (place.folder[0] != '\0') (void)rmdir(place.folder.data());
    }
    if (auto* const remove_others = of_module.load()) remove_others();
}

void remove_unfinished_files_of(void (*module)() noexcept) {
    of_module = module;
}

}  // namespace subvol::detail
