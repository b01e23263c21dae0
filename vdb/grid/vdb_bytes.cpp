// SPDX-License-Identifier: Apache-2.0
#include "vdb_bytes.h"

#include <algorithm>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kBuffer = 1 << 16;
constexpr const char* kNotWhole = "is not a whole OpenVDB file: ";

}  // namespace

VdbBytes::VdbBytes(const std::filesystem::path& path) : path_(path), file_(path, std::ios::binary), buffer_(kBuffer) {
    std::error_code no_size;
    size_ = std::filesystem::file_size(path, no_size);
    if (!file_ || no_size || !std::filesystem::is_regular_file(path))
        throw Error(ErrorCode::Io, "cannot be read", path.string());
}

const char* VdbBytes::take(std::size_t count) {
    if (count > left()) fail_short();
    if (position_ < loaded_from_ || position_ + count > loaded_from_ + loaded_) {
        const std::size_t size = std::min<std::uint64_t>(buffer_.size(), left());
        file_.seekg(static_cast<std::streamoff>(position_));
        if (!file_.read(buffer_.data(), static_cast<std::streamsize>(size))) fail_short();
        loaded_from_ = position_;
        loaded_ = size;
    }
    const char* const bytes = buffer_.data() + (position_ - loaded_from_);
    position_ += count;
    return bytes;
}

std::string VdbBytes::text() {
    const auto size = take<std::uint32_t>();
    if (size > left()) fail("a text of " + std::to_string(size) + " bytes", std::to_string(left()) + " bytes are left");
    std::string text;
    while (text.size() < size) {
        const std::size_t part = std::min<std::size_t>(size - text.size(), kMostAtOnce);
        text.append(take(part), part);
    }
    return text;
}

void VdbBytes::skip(std::uint64_t count) {
    if (count > left()) fail_short();
    position_ += count;
}

void VdbBytes::fail(const std::string& message, const std::string& allowed) const {
    throw Error(ErrorCode::InvalidInput, kNotWhole + ("at byte " + std::to_string(position_)) + ", " + message, path_.string(),
                allowed);
}

void VdbBytes::fail_short() const {
    throw Error(ErrorCode::InvalidInput, std::string(kNotWhole) + "it ends too early", path_.string());
}

}  // namespace subvol::detail
