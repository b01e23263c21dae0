// SPDX-License-Identifier: Apache-2.0
// The module subvol_openexr.so.
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTestFile.h>
#include <OpenEXR/ImfThreading.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>

#include "picture_modules.h"
#include "subvol/version.h"

namespace subvol::detail {

namespace {

constexpr const char *kNoteName = "subvolPart", *kCameraName = "subvolCamera";
constexpr std::array kNames{"R", "G", "B", "A", "Z"};
constexpr std::size_t kBlockBytes = std::size_t{16} << 20;  // of pixels that are read together: a short file ends it early
constexpr int kLongestSide = 1 << 16;                       // of pictures that are read here
constexpr int kManyPixels = 1 << 18;                        // that are packed by all threads

std::string said(int error) {
    return std::generic_category().message(error);
}

/// A file whose failures are known at the end: OpenEXR does not report those of its last bytes.
class FileStream : public Imf::OStream {
public:
    explicit FileStream(const std::string& path) : Imf::OStream(path.c_str()), file_(std::fopen(path.c_str(), "wb")) {
        if (file_ == nullptr) error_ = errno;
    }
    ~FileStream() override { (void)close(); }
    FileStream(const FileStream&) = delete;
    FileStream& operator=(const FileStream&) = delete;

    void write(const char bytes[], int count) override {
        const auto size = static_cast<std::size_t>(count);
        if (error_ == 0 && std::fwrite(bytes, 1, size, file_) != size) error_ = errno != 0 ? errno : ENOSPC;
        if (error_ != 0) throw std::runtime_error("cannot be written");
    }
    std::uint64_t tellp() override { return static_cast<std::uint64_t>(std::ftell(file_)); }
    void seekp(std::uint64_t place) override {
        if (error_ == 0 && std::fseek(file_, static_cast<long>(place), SEEK_SET) != 0) error_ = errno;
    }

    /// Returns the first error; 0: none.
    int close() {
        if (file_ != nullptr && std::fclose(file_) != 0 && error_ == 0) error_ = errno;
        file_ = nullptr;
        return error_;
    }
    [[nodiscard]] int error() const { return error_; }

private:
    std::FILE* file_;
    int error_ = 0;
};

int threads_for(std::int64_t pixels) {
    if (pixels < kManyPixels) return 0;
    static const int count = [] {
        const int all = static_cast<int>(std::min(std::thread::hardware_concurrency(), 16u));
        Imf::setGlobalThreadCount(all);
        return all;
    }();
    return count;
}

Imath::Box2i box_of(const PixelWindow& window) {
    return {{window.left, window.top}, {window.left + (window.width - 1), window.top + (window.height - 1)}};
}

std::optional<PictureFault> write(const std::string& path, const PictureValues& picture) {
    FileStream stream(path);
    if (stream.error() != 0) return PictureFault{ErrorCode::Io, "cannot be written: " + said(stream.error())};
    const Imath::Box2i data = box_of(picture.data);
    Imf::Header header(box_of(picture.display), data);
    header.compression() = Imf::ZIP_COMPRESSION;
    if (picture.note != nullptr) header.insert(kNoteName, Imf::StringAttribute(picture.note));
    if (picture.camera != nullptr) header.insert(kCameraName, Imf::StringAttribute(picture.camera));
    Imf::FrameBuffer frame;
    const auto in_row = static_cast<std::size_t>(picture.data.width);
    const auto add = [&](const char* name, const float* values, std::size_t step) {
        header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        frame.insert(name, Imf::Slice::Make(Imf::FLOAT, values, data, step, step * in_row));
    };
    for (std::size_t c = 0; c < 4; ++c) add(kNames[c], picture.rgba + c, 4 * sizeof(float));
    if (picture.depth != nullptr) add("Z", picture.depth, sizeof(float));
    try {
        Imf::OutputFile file(stream, header, threads_for(std::int64_t{picture.data.width} * picture.data.height));
        file.setFrameBuffer(frame);
        file.writePixels(picture.data.height);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception&) {
        if (stream.error() == 0) {
            return PictureFault{ErrorCode::MissingCapability, "cannot be written; memory may be short"};
        }
    }
    if (const int error = stream.close()) return PictureFault{ErrorCode::Io, "cannot be written: " + said(error)};
    return {};
}

/// How many of the channels R, G, B, A, Z there are, if these are all; else 0.
int known_channels(const Imf::ChannelList& channels) {
    int count = 0;
    bool known = true;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel, ++count) {
        const Imf::Channel& c = channel.channel();
        const bool one_each = c.xSampling == 1 && c.ySampling == 1 && !c.pLinear && c.type != Imf::UINT;
        known = known && one_each && std::ranges::find(kNames, std::string(channel.name())) != kNames.end();
    }
    for (int c = 0; c < count && c < 5; ++c) known = known && channels.findChannel(kNames[static_cast<std::size_t>(c)]);
    return known && count >= 3 ? count : 0;
}

/// Refuses headers of larger pictures, for which the file would get large buffers.
class SideLimit {
public:
    SideLimit() { Imf::Header::setMaxImageSize(kLongestSide, kLongestSide); }
    ~SideLimit() { Imf::Header::setMaxImageSize(0, 0); }
    SideLimit(const SideLimit&) = delete;
    SideLimit& operator=(const SideLimit&) = delete;
};

std::unique_ptr<Imf::InputFile> opened(const std::string& path) {
    const SideLimit limit;
    bool tiled = false, deep = false, parts = false;
    if (!Imf::isOpenExrFile(path.c_str(), tiled, deep, parts) || tiled || deep || parts) return {};
    try {
        return std::make_unique<Imf::InputFile>(path.c_str());
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception&) {
        return {};  // OpenImageIO says what is wrong
    }
}

/// A text of the header; empty if it has none of this name.
std::string text_of(const Imf::Header& header, const char* name) {
    const auto* text = header.findTypedAttribute<Imf::StringAttribute>(name);
    return text != nullptr ? text->value() : std::string();
}

std::string camera(const std::string& path) {
    const std::unique_ptr<Imf::InputFile> file = opened(path);
    return file ? text_of(file->header(), kCameraName) : std::string();
}

std::optional<PictureFault> read(const std::string& path, DecodedPicture& picture, bool& taken) {
    taken = false;
    const std::unique_ptr<Imf::InputFile> file = opened(path);
    if (!file) return {};
    const Imf::Header& header = file->header();
    const int channels = known_channels(header.channels());
    if (channels == 0) return {};
    const Imath::Box2i data = header.dataWindow(), whole = header.displayWindow();
    const std::int64_t width = std::int64_t{data.max.x} - data.min.x + 1, height = std::int64_t{data.max.y} - data.min.y + 1;
    const std::int64_t whole_width = std::int64_t{whole.max.x} - whole.min.x + 1;
    const std::int64_t whole_height = std::int64_t{whole.max.y} - whole.min.y + 1;
    const std::int64_t longest = std::max({width, height, whole_width, whole_height});
    if (std::min({width, height, whole_width, whole_height}) < 1 || longest > kLongestSide) return {};
    if (std::max(width * height, std::max(width, whole_width) * whole_height) > std::int64_t{1} << 28) return {};
    taken = true;
    picture.channels = std::min(channels, 4);
    picture.alpha = channels > 3 ? 3 : -1;
    picture.data = {data.min.x, data.min.y, static_cast<int>(width), static_cast<int>(height)};
    picture.display = {whole.min.x, whole.min.y, static_cast<int>(whole_width), static_cast<int>(whole_height)};
    picture.note = text_of(header, kNoteName);
    const bool depth = picture.wants_depth && channels == 5;
    const auto in_row = static_cast<std::size_t>(width), count = static_cast<std::size_t>(picture.channels);
    const auto rows = static_cast<int>(std::max(std::size_t{1}, kBlockBytes / (in_row * 4 * sizeof(float))));
    const std::size_t step = sizeof(float) * count;
    try {
        for (int y = data.min.y; y <= data.max.y; y += rows) {
            const int last = std::min(data.max.y, y + rows - 1);
            const Imath::Box2i block({data.min.x, y}, {data.max.x, last});
            const std::size_t pixels = in_row * static_cast<std::size_t>(last - y + 1), before = picture.values.size();
            picture.values.resize(before + pixels * count);
            Imf::FrameBuffer frame;
            for (std::size_t c = 0; c < count; ++c) {
                frame.insert(kNames[c],
                             Imf::Slice::Make(Imf::FLOAT, picture.values.data() + before + c, block, step, step * in_row));
            }
            if (depth) {
                picture.depth.resize(picture.depth.size() + pixels);
                frame.insert("Z", Imf::Slice::Make(Imf::FLOAT, picture.depth.data() + picture.depth.size() - pixels, block,
                                                   sizeof(float), sizeof(float) * in_row));
            }
            file->setFrameBuffer(frame);
            file->readPixels(y, last);
        }
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception&) {
        return PictureFault{ErrorCode::InvalidInput, "is not a complete image"};
    }
    return {};
}

}  // namespace

}  // namespace subvol::detail

extern "C" {
extern const char subvol_module_version[];
const char subvol_module_version[] = SUBVOL_VERSION;

const subvol::detail::OpenExr* subvol_openexr() {
    using namespace subvol::detail;
    static constexpr OpenExr kFunctions{&write, &read, &camera};
    return &kFunctions;
}
}
