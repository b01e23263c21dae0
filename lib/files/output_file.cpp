// SPDX-License-Identifier: Apache-2.0
#include "output_file.h"

#include <sys/types.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "subvol/error.h"

namespace subvol::detail {

OutputFile::OutputFile(const std::filesystem::path& target)
    : target_(target), file_(target), stream_(std::fopen(file_.path().c_str(), "wb")) {
    if (!stream_) fail(errno);
}

OutputFile::~OutputFile() {
    if (stream_) std::fclose(stream_);
}

void OutputFile::write(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stream_) != text.size()) fail(errno);
}

std::uint64_t OutputFile::position() const {
    const auto position = ::ftello(stream_);
    if (position < 0) fail(errno);
    return static_cast<std::uint64_t>(position);
}

void OutputFile::overwrite(std::uint64_t position, std::string_view text) {
    if (::fseeko(stream_, static_cast<off_t>(position), SEEK_SET) != 0) fail(errno);
    write(text);
    if (::fseeko(stream_, 0, SEEK_END) != 0) fail(errno);
}

void OutputFile::close() {
    if (stream_ && std::fclose(std::exchange(stream_, nullptr)) != 0) fail(errno);
}

void OutputFile::commit() {
    close();
    file_.commit();
}

void OutputFile::fail(int error) const {
    throw Error(ErrorCode::Io, "cannot be written: " + std::generic_category().message(error), target_.string());
}

void write_text_file(const std::filesystem::path& file, std::string_view text) {
    OutputFile out(file);
    out.write(text);
    out.commit();
}

}  // namespace subvol::detail
