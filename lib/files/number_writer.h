// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <charconv>
#include <string>

#include "output_file.h"
#include "subvol/vec.h"

namespace subvol::detail {

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

}  // namespace subvol::detail
