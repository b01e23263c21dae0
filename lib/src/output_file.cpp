#include "output_file.h"

#include <cerrno>
#include <system_error>
#include <utility>

#include "subvol/error.h"

namespace subvol {

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

}  // namespace subvol
