// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "subvol/detail/vtu_bytes.h"
#include "subvol/error.h"
#include "subvol/hex_mesh.h"
#include "wavelet_format.h"

namespace subvol::detail {

/// Writes whole numbers, reals and names as .svw files have them.
class Bytes {
public:
    void number(std::uint64_t n) {
        for (; n >= 128; n >>= 7) text_ += static_cast<char>((n & 127) | 128);
        text_ += static_cast<char>(n);
    }
    void byte(std::uint64_t n) { text_ += static_cast<char>(n); }
    void real(double x) {
        const auto bits = std::bit_cast<std::uint64_t>(x);
        for (int k = 0; k < 8; ++k) byte(bits >> 8 * k & 255);
    }
    void text(std::string_view t) {
        number(t.size());
        text_ += t;
    }
    [[nodiscard]] const std::string& all() const { return text_; }

private:
    std::string text_;
};

/// Reads them. What is not there, or not right, is an Error(InvalidInput) that names the file.
class Contents {
public:
    /// more: where the bytes after these come from; length: of all
    Contents(std::string_view bytes, const std::string& file, LzmaReader* more = nullptr, std::uint64_t length = 0)
        : bytes_(bytes), file_(file), more_(more), length_left_(more == nullptr ? bytes.size() : length) {}

    [[noreturn]] void fail(const std::string& what, const std::string& allowed = {}) const {
        throw Error(ErrorCode::InvalidInput, what, file_, allowed);
    }

    std::uint64_t byte() {
        if (length_left_ == 0) fail("the contents end too early");
        if (bytes_.empty()) load_more();
        const auto b = static_cast<unsigned char>(bytes_.front());
        bytes_.remove_prefix(1);
        --length_left_;
        return b;
    }

    std::uint64_t number() {
        std::uint64_t n = 0;
        for (int shift = 0; shift < 64; shift += 7) {
            const std::uint64_t b = byte();
            if (shift == 63 && b > 1) break;
            n |= (b & 127) << shift;
            if (b < 128) return n;
        }
        fail("a number has more than 64 bits");
    }

    std::int64_t signed_number() { return unfolded(number()); }

    /// How many things follow, each of at least so many bytes; 0: others are compared with them.
    std::size_t count(const char* of, std::size_t bytes_each) {
        const std::uint64_t n = number();
        if (bytes_each > 0 && n > length_left_ / bytes_each) fail(std::to_string(n) + " " + of + " do not fit into the file");
        return n;
    }

    double real() {
        std::uint64_t bits = 0;
        for (int k = 0; k < 8; ++k) bits |= byte() << 8 * k;
        return std::bit_cast<double>(bits);
    }

    std::string text() {
        const std::size_t n = count("bytes of a name", 1);
        std::string t;
        for (std::size_t i = 0; i < n; ++i) t += static_cast<char>(byte());
        return t;
    }

    Index point(std::size_t points) {
        const std::uint64_t n = number();
        if (n >= points) fail("point " + std::to_string(n) + " is named", "there are " + std::to_string(points));
        return static_cast<Index>(n);
    }

    [[nodiscard]] std::size_t left() const { return length_left_; }

    /// Everything has been read, and there is nothing else.
    void expect_end() {
        if (left() > 0) fail(std::to_string(left()) + " bytes follow the last array");
        if (more_ == nullptr) return;
        const auto rest = more_->next();
        if (!bytes_.empty() || !rest || !rest->empty()) fail(kDamaged);
    }

    static constexpr const char* kDamaged = "the compressed contents are damaged";

private:
    void load_more() {
        const auto piece = more_ == nullptr ? std::nullopt : more_->next();
        if (!piece || piece->empty()) fail(kDamaged);
        bytes_ = *piece;
    }

    std::string_view bytes_;
    const std::string& file_;
    LzmaReader* more_;
    std::uint64_t length_left_;
};

/// The cells, creases and sharp faces of a mesh, without its points.
void put_mesh(const HexMesh& mesh, Bytes& out);

/// A mesh of which the cells, creases and sharp faces are stored; its points are all at the origin.
///
/// bytes_of_point: how many bytes follow at least for each point; there are no more points than corners of cells
/// throws: Error(InvalidInput) if a corner is not a point
[[nodiscard]] HexMesh read_cells(Contents& in, std::size_t bytes_of_point);

}  // namespace subvol::detail
