// SPDX-License-Identifier: Apache-2.0
// Arrays of several megabytes lie in huge pages. The work on large meshes makes and drops such arrays by the gigabyte, and with
// pages of 4 kB half of the processor's time went into getting them (docs/adr/0021).
#include <malloc.h>
#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <new>

#if defined(MADV_HUGEPAGE) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;
constexpr std::size_t kLarge = 2 * kHugePage;  // from here on there is a whole huge page in the block, wherever it begins

/// The system may refuse, or have no huge pages: then the block stays as it is.
void ask_for_huge_pages(void* block, std::size_t bytes) {
    const auto begin = reinterpret_cast<std::uintptr_t>(block);
    const std::size_t before = (kHugePage - begin % kHugePage) % kHugePage;
    const std::size_t whole = (bytes - before) / kHugePage * kHugePage;
    madvise(static_cast<char*>(block) + before, whole, MADV_HUGEPAGE);
}

/// What a brick or a level frees serves the next one, as it is, instead of going back to the system in between.
[[maybe_unused]] const bool kept_for_reuse = [] {
    mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the largest that glibc takes
    mallopt(M_TRIM_THRESHOLD, 256 << 20);
    return true;
}();

}  // namespace

void* operator new(std::size_t bytes) {
    void* block = std::malloc(bytes == 0 ? 1 : bytes);
    if (block == nullptr) throw std::bad_alloc();
    if (bytes >= kLarge) ask_for_huge_pages(block, bytes);
    return block;
}

void operator delete(void* block) noexcept {
    std::free(block);
}
void operator delete(void* block, std::size_t) noexcept {
    std::free(block);
}

#endif
