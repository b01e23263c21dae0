// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/unfinished_files.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <string>

namespace subvol::detail {

namespace {

constexpr std::size_t kPlaces = 64, kMostBlocks = 64, kLongestName = 4096;

// A handler of signals may interrupt anything, so there are no locks: a place is free, being changed, or holds a whole name,
// and blocks of places are added but never removed.
enum class State { Free, Changing, Held };

}  // namespace

struct UnfinishedFile::Place {
    std::atomic<State> state = State::Free;
    std::array<char, kLongestName> file{};
    std::array<char, kLongestName> folder{};  // empty: not to be removed
};
static_assert(std::atomic<State>::is_always_lock_free);

namespace {

struct Block {
    std::array<UnfinishedFile::Place, kPlaces> places{};
    std::atomic<Block*> next = nullptr;
};

Block first_block;
std::atomic<void (*)() noexcept> of_module = nullptr;

void put(const std::string& name, std::array<char, kLongestName>& to) {
    *std::ranges::copy(name, to.begin()).out = '\0';
}

/// The block after this one, which is made if there is none.
Block* block_after(Block& block) {
    if (Block* const next = block.next) return next;
    auto made = std::make_unique<Block>();
    Block* none = nullptr;
    if (!block.next.compare_exchange_strong(none, made.get())) return none;  // another thread was faster
    return made.release();
}

}  // namespace

UnfinishedFile::UnfinishedFile(const std::filesystem::path& file, bool with_folder) {
    const std::string name = file.string(), folder = with_folder ? file.parent_path().string() : "";
    if (name.size() >= kLongestName) return;
    Block* block = &first_block;
    for (std::size_t b = 0; b < kMostBlocks; ++b, block = block_after(*block)) {
        for (Place& place : block->places) {
            State free = State::Free;
            if (!place.state.compare_exchange_strong(free, State::Changing)) continue;
            put(name, place.file);
            put(folder, place.folder);
            place.state = State::Held;
            place_ = &place;
            return;
        }
    }
}

UnfinishedFile::~UnfinishedFile() {
    if (place_ != nullptr) place_->state = State::Free;
}

void remove_unfinished_files() noexcept {
    const auto for_each_held = [](const auto& remove) {
        for (const Block* block = &first_block; block != nullptr; block = block->next) {
            for (const UnfinishedFile::Place& place : block->places) {
                if (place.state == State::Held) remove(place);
            }
        }
    };
    for_each_held([](const UnfinishedFile::Place& place) { (void)unlink(place.file.data()); });
    // A folder is removed once it is empty: files of other places may have been in it.
    for_each_held([](const UnfinishedFile::Place& place) {
        if (place.folder[0] != '\0') (void)rmdir(place.folder.data());
    });
    if (auto* const remove_others = of_module.load()) remove_others();
}

void remove_unfinished_files_of(void (*module)() noexcept) {
    of_module = module;
}

}  // namespace subvol::detail
