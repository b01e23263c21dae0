// SPDX-License-Identifier: Apache-2.0
// A library for LD_PRELOAD that makes one call of a program fail, or all calls from one on: allocations, and calls of the
// system. tests/cli/failed_calls.py runs every command with it.
//
//     SUBVOL_FAIL=write:17    the 17th call that writes fails with "no space left on device"
//     SUBVOL_FAIL=alloc:3+    the 3rd allocation fails, and all after it
//     SUBVOL_FAIL=alloc@libz.so:1   the 1st allocation that a function of this library makes itself fails
//     SUBVOL_FAIL=read:0      nothing fails
//     SUBVOL_FAIL_REPORT=F    at the end F holds the number of such calls, and the stack of the first one that failed
//
// Calls are counted from the beginning of main() on, in this process alone: what the loader allocates, or a child writes, is
// not meant. Allocations are counted by replacing malloc and its relatives. Calls of the system are counted by the kernel
// (seccomp): it asks a thread of this library about each of them, whoever makes them, so that calls within the C library are
// counted too. Writing to standard error never fails, because the message is what the tests look at. Linux 5.5 or later.
#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/sched.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>

extern "C" {
// The C library's own allocator, under the names that it exports.
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t count, std::size_t bytes);
void* __libc_realloc(void* block, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);
}

namespace {

constexpr int kUnsupported = 77;  // the exit code of a test that is skipped
constexpr std::size_t kMostCalls = 8;

struct Kind {
    const char* name;
    int error;
    long calls[kMostCalls];  // of the system; -1 after the last one
};

constexpr Kind kKinds[] = {
    {"alloc", ENOMEM, {-1}},
    {"write", ENOSPC, {SYS_write, SYS_pwrite64, SYS_writev, SYS_pwritev, SYS_ftruncate, SYS_fallocate, -1}},
    {"read", EIO, {SYS_read, SYS_pread64, SYS_readv, SYS_preadv, -1}},
#ifdef SYS_open
    {"open", EMFILE, {SYS_openat, SYS_open, SYS_creat, -1}},
    {"rename", EIO, {SYS_renameat, SYS_renameat2, SYS_rename, -1}},
#else
    {"open", EMFILE, {SYS_openat, -1}},
    {"rename", EIO, {SYS_renameat, SYS_renameat2, -1}},
#endif
    {"sync", EIO, {SYS_fsync, SYS_fdatasync, SYS_syncfs, -1}},
    {"close", EIO, {SYS_close, -1}},
    {"map", ENOMEM, {SYS_mmap, SYS_mremap, -1}},
    {"thread", EAGAIN, {SYS_clone, SYS_clone3, -1}},
    {"process", EAGAIN, {SYS_clone, SYS_clone3, -1}},
};

int (*real_main)(int, char**, char**) = nullptr;
const Kind* kind = nullptr;
std::atomic<long> fail_at{0};  // 0: never
bool fail_on = false;
bool fail_allocations = false;
const char* library = nullptr;  // null: any
std::atomic<long> calls{0};
std::atomic<bool> reported{false};
int listener = -1;
thread_local bool is_ours = false;  // a call of this library itself

bool fails(long number) {
    return fail_at > 0 && (number == fail_at || (fail_on && number > fail_at));
}

/// Notes the number of calls, or, if it is 0, the stack.
void report(long number) {
    const char* const name = std::getenv("SUBVOL_FAIL_REPORT");
    if (name == nullptr) return;
    is_ours = true;
    const int file = open(name, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (file >= 0) {
        if (number > 0) {
            dprintf(file, "calls %ld\n", number);
        } else {
            constexpr int kMostFrames = 48;
            void* frames[kMostFrames];
            backtrace_symbols_fd(frames, backtrace(frames, kMostFrames), file);
        }
        close(file);
    }
    is_ours = false;
}

/// Whether a function is in the library whose allocations are to fail.
bool is_in_library(const void* function) {
    if (library == nullptr) return true;
    Dl_info about{};
    return dladdr(function, &about) != 0 && std::strstr(about.dli_fname, library) != nullptr;
}

/// Whether an allocation is to fail. caller: the instruction after its call
bool allocation_fails(const void* caller) {
    if (!fail_allocations || is_ours || !is_in_library(caller)) return false;
    if (!fails(++calls)) return false;
    if (!reported.exchange(true)) report(0);
    errno = ENOMEM;
    return true;
}

bool is_thread_of_this_process(std::uint32_t thread) {
    char name[64];
    std::snprintf(name, sizeof(name), "/proc/self/task/%u", thread);
    return access(name, F_OK) == 0;
}

/// Whether a call is of the kind that is asked for.
bool counts(const seccomp_notif& call) {
    if (!is_thread_of_this_process(call.pid)) return false;
    const bool writes = call.data.nr == SYS_write || call.data.nr == SYS_writev;
    if (writes && call.data.args[0] == STDERR_FILENO) return false;
    if (call.data.nr == SYS_clone || call.data.nr == SYS_clone3) {
        std::uint64_t flags = call.data.args[0];
        if (call.data.nr == SYS_clone3) std::memcpy(&flags, reinterpret_cast<const void*>(call.data.args[0]), sizeof(flags));
        return ((flags & CLONE_THREAD) != 0) == (std::strcmp(kind->name, "thread") == 0);
    }
    return true;
}

/// Answers what the kernel asks, until the program ends.
void* answer(void*) {
    for (;;) {
        seccomp_notif call{};
        if (ioctl(listener, SECCOMP_IOCTL_NOTIF_RECV, &call) != 0) continue;
        seccomp_notif_resp answer{};
        answer.id = call.id;
        const bool is_failure = counts(call) && fails(++calls);
        if (is_failure) {
            if (call.data.nr == SYS_close) close(static_cast<int>(call.data.args[0]));  // Linux closes it even if that fails
            answer.error = -kind->error;
        } else {
            answer.flags = SECCOMP_USER_NOTIF_FLAG_CONTINUE;
        }
        ioctl(listener, SECCOMP_IOCTL_NOTIF_SEND, &answer);
    }
    return nullptr;
}

/// Lets the kernel ask about the calls of this kind, of this thread and of all that it starts.
bool watch_system() {
    sock_filter program[kMostCalls + 3] = {BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr))};
    std::uint16_t length = 1;
    std::uint8_t count = 0;
    while (kind->calls[count] >= 0) ++count;
    for (std::uint8_t i = 0; i < count; ++i) {
        program[length++] = BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(kind->calls[i]),
                                     static_cast<std::uint8_t>(count - i), 0);
    }
    program[length++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    program[length++] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_USER_NOTIF);
    sock_fprog filter{length, program};
    // The thread that answers begins first, and therefore is not asked about.
    pthread_t thread{};
    static pthread_barrier_t begun;
    pthread_barrier_init(&begun, nullptr, 2);
    const auto work = [](void*) -> void* {
        pthread_barrier_wait(&begun);
        return answer(nullptr);
    };
    if (pthread_create(&thread, nullptr, work, nullptr) != 0) return false;
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    listener = static_cast<int>(syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_NEW_LISTENER, &filter));
    if (listener < 0) return false;
    pthread_barrier_wait(&begun);
    return true;
}

/// Reads SUBVOL_FAIL; false if it is not understood.
bool read_task() {
    const char* const text = std::getenv("SUBVOL_FAIL");
    const char* const colon = text == nullptr ? nullptr : std::strchr(text, ':');
    if (colon == nullptr) return false;
    static char name[64];
    const char* const at = std::strchr(text, '@');
    if (at != nullptr && at < colon) {
        std::snprintf(name, sizeof(name), "%.*s", static_cast<int>(colon - at - 1), at + 1);
        library = name;
    }
    const auto length = static_cast<std::size_t>((library == nullptr ? colon : at) - text);
    for (const Kind& one : kKinds) {
        if (std::strlen(one.name) == length && std::strncmp(one.name, text, length) == 0) kind = &one;
    }
    char* end = nullptr;
    fail_at = std::strtol(colon + 1, &end, 10);
    fail_on = *end == '+';
    return kind != nullptr;
}

int main_with_failures(int argc, char** argv, char** environment) {
    void* frame = nullptr;
    backtrace(&frame, 1);  // loads what it needs now, while nothing fails
    if (!read_task()) return real_main(argc, argv, environment);
    unsetenv("LD_PRELOAD");  // children are not meant
    if (kind->calls[0] < 0) {
        fail_allocations = true;
    } else if (!watch_system()) {
        std::perror("fail_calls: seccomp");
        _exit(kUnsupported);
    }
    return real_main(argc, argv, environment);
}

[[gnu::destructor]] void note_calls() {
    if (kind == nullptr) return;
    const long all = calls;
    fail_at = 0;  // the report itself does not fail
    if (all > 0) report(all);
}

}  // namespace

extern "C" {

/// For programs that load this library and call it: from now on the call of that number fails (0: none). Returns the number of
/// calls since it was called last.
[[gnu::visibility("default")]] long fail_next_call(long number) {
    fail_at = 0;
    const long before = calls.exchange(0);
    fail_at = number;
    return before;
}

int __libc_start_main(int (*program)(int, char**, char**), int argc, char** argv, void (*start)(), void (*finish)(),
                      void (*loader)(), void* stack) {
    real_main = program;
    const auto original = reinterpret_cast<decltype(&__libc_start_main)>(dlsym(RTLD_NEXT, "__libc_start_main"));
    return original(&main_with_failures, argc, argv, start, finish, loader, stack);
}

void* malloc(std::size_t bytes) {
    return allocation_fails(__builtin_return_address(0)) ? nullptr : __libc_malloc(bytes);
}

void* calloc(std::size_t count, std::size_t bytes) {
    return allocation_fails(__builtin_return_address(0)) ? nullptr : __libc_calloc(count, bytes);
}

void* realloc(void* block, std::size_t bytes) {
    return allocation_fails(__builtin_return_address(0)) ? nullptr : __libc_realloc(block, bytes);
}

void* memalign(std::size_t alignment, std::size_t bytes) {
    return allocation_fails(__builtin_return_address(0)) ? nullptr : __libc_memalign(alignment, bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
    return memalign(alignment, bytes);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t bytes) {
    void* const found = memalign(alignment, bytes);
    if (found == nullptr) return ENOMEM;
    *block = found;
    return 0;
}

}  // extern "C"
