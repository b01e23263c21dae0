// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <type_traits>
#include <vector>

namespace subvol::detail {

/// The bytes of a .vdb file, read forwards. Nothing beyond the file's end is taken, and no memory is allocated for a length
/// that the file cannot have.
class VdbBytes {
public:
    /// throws: Error(Io) if the file cannot be read
    explicit VdbBytes(const std::filesystem::path& path);

    /// A number as the file stores it: little-endian, as memory is on the machines that OpenVDB supports.
    template <class T>
    [[nodiscard]] T take() {
        static_assert(std::is_trivially_copyable_v<T>);
        T value;
        std::memcpy(&value, take(sizeof(T)), sizeof(T));
        return value;
    }
    /// The next `count` bytes, at most `kMostAtOnce`; valid until the next call.
    [[nodiscard]] const char* take(std::size_t count);
    /// A text after its length of 32 bits.
    [[nodiscard]] std::string text();
    void skip(std::uint64_t count);
    void seek(std::uint64_t position) { position_ = position; }

    [[nodiscard]] std::uint64_t position() const { return position_; }
    [[nodiscard]] std::uint64_t left() const { return position_ < size_ ? size_ - position_ : 0; }
    /// Whether that many items, of at least `bytes` bytes each, fit into the rest of the file.
    [[nodiscard]] bool has_room_for(std::uint64_t items, std::uint64_t bytes) const { return items <= left() / bytes; }

    /// throws: Error(InvalidInput) "FILE: is not a whole OpenVDB file: at byte 1234, message (allowed)"
    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const;

    static constexpr std::size_t kMostAtOnce = 8192;

private:
    [[noreturn]] void fail_short() const;

    std::filesystem::path path_;
    std::ifstream file_;
    std::uint64_t size_ = 0;
    std::uint64_t position_ = 0;
    std::uint64_t loaded_from_ = 0;
    std::size_t loaded_ = 0;
    std::vector<char> buffer_;
};

}  // namespace subvol::detail
