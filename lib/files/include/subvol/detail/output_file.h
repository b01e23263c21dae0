// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "subvol/detail/atomic_file.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// A file that appears complete or not at all. Every failure, such as a full disk, is an Error(Io) that names the file.
class OutputFile {
public:
    explicit OutputFile(const std::filesystem::path& target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(std::string_view text);
    template <class T>
    void write_values(std::span<const T> values) {
        write({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
    }
    /// The number of bytes written so far.
    [[nodiscard]] std::uint64_t position() const;
    /// Overwrites bytes that are already written.
    void overwrite(std::uint64_t position, std::string_view text);
    /// Writes at a place, also beyond the end; the next bytes are written after them.
    void write_at(std::uint64_t position, std::string_view text);
    void seek(std::uint64_t position);
    /// Closes the file; nothing can be written afterwards.
    void close();
    /// Closes the file and gives it its final name.
    void commit(Sync sync = Sync::Now);

private:
    [[noreturn]] void fail(int error) const;

    std::filesystem::path target_;
    AtomicFile file_;
    std::FILE* stream_;
};

/// Writes numbers as they are in memory, or as text, each with the fewest digits that reproduce it exactly.
class NumberWriter {
public:
    explicit NumberWriter(OutputFile& out, bool ascii = false) : out_(&out), ascii_(ascii) {}

    /// Collects the bytes instead.
    NumberWriter() = default;
    [[nodiscard]] const std::string& bytes() const { return buffer_; }

    template <class Number>
    void put(Number number) {
        if (!ascii_) {
            buffer_.append(reinterpret_cast<const char*>(&number), sizeof number);
            if (buffer_.size() > kFlush) flush();
            return;
        }
        std::array<char, 32> digits;
        buffer_.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
        buffer_ += ' ';
    }

    template <class Numbers>
    void put_all(const Numbers& numbers) {
        for (const auto number : numbers) put(number);
    }

    template <class Number>
    void put_point(const Vec3& p) {
        for (int k = 0; k < 3; ++k) put(static_cast<Number>(p[k]));
    }

    void end_row() {
        if (!ascii_) return;
        buffer_.back() = '\n';
        if (buffer_.size() > kFlush) flush();
    }

    /// Writes what is left: to be called at the end.
    void flush() {
        if (!out_) return;
        out_->write(buffer_);
        buffer_.clear();
    }

private:
    static constexpr std::size_t kFlush = 1 << 16;
    OutputFile* out_ = nullptr;
    bool ascii_ = false;
    std::string buffer_;
};

/// More bytes than fit into a `.glb` file with what describes them.
inline constexpr std::size_t kMostGlbBytes = 0xF0000000U;

/// What comes before the bytes of a `.glb` file: its head, the chunk of JSON, and the head of the chunk of bytes.
///
/// json:  describes one buffer of so many bytes
/// bytes: a multiple of 4, at most `kMostGlbBytes`
[[nodiscard]] std::string glb_head(std::string json, std::size_t bytes);

}  // namespace subvol::detail
