// SPDX-License-Identifier: Apache-2.0
#include "kernel_cache.h"

#include <algorithm>

namespace subvol::detail {

KernelCache::KernelCache(const SvkFile& file, std::uint64_t most_bytes)
    : file_(file), most_bytes_(most_bytes), slots_(file.layout().blocks() * file.layout().parts()) {
}

const std::string& KernelCache::part(std::size_t block, std::size_t part) {
    Slot& slot = slots_[block * file_.layout().parts() + part];
    if (slot.bytes.empty()) {  // no part is without bytes, but for numbers of no kernels
        slot.bytes = file_.part(block, part);
        slot.turn = turn_;
        bytes_ += slot.bytes.size();
    }
    slot.view = view_;
    return slot.bytes;
}

void KernelCache::trim() {
    ++turn_;
    if (bytes_ <= most_bytes_) return;
    std::vector<Slot*> held;
    for (Slot& slot : slots_) {
        if (!slot.bytes.empty()) held.push_back(&slot);
    }
    std::ranges::stable_sort(held, [&](const Slot* a, const Slot* b) {
        if (a->view != b->view) return a->view < b->view;
        return a->view == view_ && a->turn > b->turn;
    });
    for (Slot* const slot : held) {
        if (bytes_ <= most_bytes_) return;
        bytes_ -= slot->bytes.size();
        slot->bytes = {};
    }
}

}  // namespace subvol::detail
