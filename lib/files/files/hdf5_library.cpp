// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <mutex>
#include <system_error>
#include <utility>

#include "hdf5_functions.h"
#include "subvol/detail/hdf5_file.h"
#include "subvol/detail/module.h"
#include "subvol/detail/read_file.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

void expect_hdf5(const std::filesystem::path& path) {
    constexpr std::string_view kBegin = "\x89HDF\r\n\x1a\n";
    std::array<char, kBegin.size()> begin{};
    std::error_code none;
    const bool folder = std::filesystem::is_directory(path, none);
    if (!folder && !not_regular(path).empty()) {
        throw Error(ErrorCode::InvalidInput, "is not a regular file", path.string(), "files of HDF5 are");
    }
    std::ifstream in(path, std::ios::binary);
    const int error = errno;
    if (!in || folder) {
        throw Error(ErrorCode::Io, "cannot be read: " + std::generic_category().message(folder ? EISDIR : error),
                    path.string());
    }
    in.read(begin.data(), begin.size());
    if (std::string_view(begin.data(), begin.size()) != kBegin) {
        throw Error(ErrorCode::InvalidInput, "not an HDF5 file", path.string());
    }
}

#ifdef SUBVOL_FOREIGN_HDF5

constexpr std::size_t kMostOfDeflate = 1040;  // 1032, and some bytes for the blocks

const Hdf5Functions& library() {
    using Entry = const Hdf5Functions* (*)();
    static const Hdf5Functions& functions = *reinterpret_cast<Entry>(load_module("hdf5", "reading files of HDF5"))();
    return functions;
}

// HDF5's library is not thread-safe: only one thread at a time may use it.
std::mutex& hdf5_mutex() {
    static std::mutex mutex;
    return mutex;
}

using Lock = std::scoped_lock<std::mutex>;

class Hdf5Library : public Hdf5Source {
public:
    explicit Hdf5Library(const std::filesystem::path& path) : size_(std::filesystem::file_size(path)) {
        const Lock lock(hdf5_mutex());
        file_ = library().open(path.c_str());
        if (file_ < 0) throw Error(ErrorCode::InvalidInput, "the HDF5 file is damaged or not complete", path.string());
    }
    ~Hdf5Library() override {
        const Lock lock(hdf5_mutex());
        library().close(file_);
    }
    Hdf5Library(const Hdf5Library&) = delete;
    Hdf5Library& operator=(const Hdf5Library&) = delete;

    [[nodiscard]] std::vector<std::string> names(const std::string& group) const override {
        const Lock lock(hdf5_mutex());
        std::vector<std::string> names;
        library().each_name(file_, group.c_str(), &names, [](void* into, const char* name) {
            static_cast<std::vector<std::string>*>(into)->emplace_back(name);
        });
        return names;
    }

    [[nodiscard]] std::optional<Hdf5Dataset> find(const std::string& path) const override {
        const Lock lock(hdf5_mutex());
        Hdf5Shape shape;
        if (library().shape(file_, path.c_str(), &shape) < 0 || shape.type < 0) return std::nullopt;
        const std::size_t stored = std::min<std::size_t>(shape.stored, size_);
        return Hdf5Dataset{static_cast<NumberType>(shape.type),
                           {shape.lengths, shape.lengths + shape.rank},
                           stored * (shape.filtered ? kMostOfDeflate : 1),
                           shape.filtered ? shape.chunk : 0,
                           shape.address,
                           shape.characters,
                           shape.grows};
    }

    [[nodiscard]] std::optional<std::string> values(const std::string& path, const Hdf5Dataset& dataset,
                                                    std::span<const std::size_t> starts,
                                                    std::span<const std::size_t> counts) const override {
        const Lock lock(hdf5_mutex());
        std::size_t size = size_of(dataset.type);
        for (const std::size_t count : counts) size *= count;
        std::string bytes(size, '\0');
        const std::vector<std::uint64_t> first(starts.begin(), starts.end()), lengths(counts.begin(), counts.end());
        const auto rank = static_cast<unsigned>(counts.size());
        if (library().read(file_, path.c_str(), rank, first.data(), lengths.data(), bytes.data()) < 0) return std::nullopt;
        return bytes;
    }

    [[nodiscard]] std::optional<std::string> text(const std::string& object, const std::string& attribute) const override {
        const Lock lock(hdf5_mutex());
        std::array<char, 256> text{};
        const auto length = library().text(file_, object.c_str(), attribute.c_str(), text.data(), text.size());
        if (length < 0) return std::nullopt;
        return std::string(text.data(), static_cast<std::size_t>(length));
    }

    [[nodiscard]] std::vector<std::int64_t> integers(const std::string& object, const std::string& attribute) const override {
        const Lock lock(hdf5_mutex());
        std::array<std::int64_t, 16> numbers{};
        const auto count = library().integers(file_, object.c_str(), attribute.c_str(), numbers.data(), numbers.size());
        return {numbers.begin(), numbers.begin() + std::max<std::int64_t>(0, count)};
    }

    [[nodiscard]] std::vector<double> reals(const std::string& object, const std::string& attribute) const override {
        const Lock lock(hdf5_mutex());
        std::array<double, 16> numbers{};
        const auto count = library().reals(file_, object.c_str(), attribute.c_str(), numbers.data(), numbers.size());
        return {numbers.begin(), numbers.begin() + std::max<std::int64_t>(0, count)};
    }

private:
    std::size_t size_;
    std::int64_t file_ = -1;
};

}  // namespace

std::unique_ptr<Hdf5Source> open_hdf5(const std::filesystem::path& path) {
    expect_hdf5(path);
    return std::make_unique<Hdf5Library>(path);
}

Hdf5Output::Hdf5Output(const std::filesystem::path& target) : target_(target), file_(target) {
    const Lock lock(hdf5_mutex());
    open_ = library().create(file_.path().c_str());
    check(open_);
}

Hdf5Output::~Hdf5Output() {
    const Lock lock(hdf5_mutex());
    if (open_ >= 0) library().close(open_);
}

void Hdf5Output::check(std::int64_t result) const {
    if (result < 0) {
        throw Error(ErrorCode::Io, "cannot be written: the disk is full, or HDF5's library fails", target_.string());
    }
}

void Hdf5Output::group(const std::string& path) {
    const Lock lock(hdf5_mutex());
    check(library().group(open_, path.c_str()));
}

void Hdf5Output::write(const std::string& path, NumberType type, std::size_t columns, const void* values, std::size_t count) {
    const Lock lock(hdf5_mutex());
    const std::array<std::uint64_t, 2> lengths{columns > 0 ? count / columns : count, columns};
    check(library().write(open_, path.c_str(), static_cast<int>(type), columns > 0 ? 2 : 1, lengths.data(), values));
}

void Hdf5Output::attribute(const std::string& object, const std::string& name, const std::string& text) {
    const Lock lock(hdf5_mutex());
    check(library().write_text(open_, object.c_str(), name.c_str(), text.data(), text.size()));
}

void Hdf5Output::attribute(const std::string& object, const std::string& name, std::span<const std::int64_t> values) {
    const Lock lock(hdf5_mutex());
    check(library().write_integers(open_, object.c_str(), name.c_str(), values.data(), values.size()));
}

void Hdf5Output::commit() {
    {
        const Lock lock(hdf5_mutex());
        check(library().finish(std::exchange(open_, -1)));
    }
    file_.commit();
}

#else

}  // namespace

std::unique_ptr<Hdf5Source> open_hdf5(const std::filesystem::path& path) {
    expect_hdf5(path);
    throw Error(ErrorCode::MissingCapability, "this build cannot read HDF5 files", path.string(),
                "it needs the HDF5 library and the build option SUBVOL_HDF5");
}

Hdf5Output::Hdf5Output(const std::filesystem::path& target) : target_(target), file_(target) {
    throw Error(ErrorCode::MissingCapability, "this build cannot write HDF5 files", target.string(),
                "it needs the HDF5 library and the build option SUBVOL_HDF5");
}
Hdf5Output::~Hdf5Output() = default;
void Hdf5Output::check(std::int64_t) const {
}
void Hdf5Output::group(const std::string&) {
}
void Hdf5Output::write(const std::string&, NumberType, std::size_t, const void*, std::size_t) {
}
void Hdf5Output::attribute(const std::string&, const std::string&, const std::string&) {
}
void Hdf5Output::attribute(const std::string&, const std::string&, std::span<const std::int64_t>) {
}
void Hdf5Output::commit() {
}

#endif

}  // namespace subvol::detail
