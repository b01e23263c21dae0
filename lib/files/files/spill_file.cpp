// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/spill_file.h"

#include <fcntl.h>
#include <stdlib.h>  // mkostemp
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::uint64_t kGapBytes = 4096;        // read on rather than begin anew
constexpr std::uint64_t kChunkBytes = 4U << 20;  // of one read with gaps

}  // namespace

SpillFile::SpillFile(std::filesystem::path folder, std::size_t record_bytes)
    : folder_(folder.empty() ? std::filesystem::path(".") : std::move(folder)), record_bytes_(record_bytes) {
    std::string name = (folder_ / ".subvol-split-XXXXXX").string();
    file_ = mkostemp(name.data(), O_CLOEXEC);
    if (file_ < 0) fail("be written", errno);
    (void)unlink(name.c_str());
}

SpillFile::~SpillFile() {
    (void)close(file_);
}

void SpillFile::fail(const char* what, int error) const {
    throw Error(ErrorCode::Io,
                std::string("a temporary file in it cannot ") + what + ": " + std::generic_category().message(error),
                folder_.string(), "as much room as the mesh and its bricks take");
}

void SpillFile::write_bytes(std::uint64_t at, std::span<const char> bytes) {
    while (!bytes.empty()) {
        const ssize_t done = pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(at));
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0) fail("be written", done < 0 ? errno : ENOSPC);
        at += static_cast<std::uint64_t>(done);
        bytes = bytes.subspan(static_cast<std::size_t>(done));
    }
}

void SpillFile::read_bytes(std::uint64_t at, std::span<char> bytes) const {
    while (!bytes.empty()) {
        const ssize_t done = pread(file_, bytes.data(), bytes.size(), static_cast<off_t>(at));
        if (done < 0 && errno == EINTR) continue;
        if (done < 0) fail("be read", errno);
        if (done == 0) {
            std::ranges::fill(bytes, '\0');
            return;
        }
        at += static_cast<std::uint64_t>(done);
        bytes = bytes.subspan(static_cast<std::size_t>(done));
    }
}

void SpillFile::write(std::uint64_t first, std::span<const char> records) {
    write_bytes(first * record_bytes_, records);
}

void SpillFile::read(std::uint64_t first, std::span<char> records) const {
    read_bytes(first * record_bytes_, records);
}

void SpillFile::write_some(std::span<const Index> numbers, std::span<const char> records) {
    for (std::size_t begin = 0, end = 0; begin < numbers.size(); begin = end) {
        for (end = begin + 1; end < numbers.size() && numbers[end] == numbers[end - 1] + 1;) ++end;
        write(numbers[begin], records.subspan(begin * record_bytes_, (end - begin) * record_bytes_));
    }
}

void SpillFile::read_some(std::span<const Index> numbers, std::span<char> records) const {
    std::vector<char> chunk;
    for (std::size_t begin = 0, end = 0; begin < numbers.size(); begin = end) {
        bool gaps = false;
        for (end = begin + 1; end < numbers.size(); ++end) {
            const std::uint64_t step = numbers[end] - numbers[end - 1];
            if ((step - 1) * record_bytes_ > kGapBytes) break;
            if ((numbers[end] - numbers[begin]) * std::uint64_t{record_bytes_} > kChunkBytes) break;
            gaps = gaps || step != 1;
        }
        const std::span<char> into = records.subspan(begin * record_bytes_, (end - begin) * record_bytes_);
        if (!gaps) {
            read(numbers[begin], into);
            continue;
        }
        chunk.resize((std::size_t{numbers[end - 1] - numbers[begin]} + 1) * record_bytes_);
        read(numbers[begin], chunk);
        for (std::size_t i = begin; i < end; ++i) {
            std::memcpy(into.data() + (i - begin) * record_bytes_,
                        chunk.data() + std::size_t{numbers[i] - numbers[begin]} * record_bytes_, record_bytes_);
        }
    }
}

}  // namespace subvol::detail
