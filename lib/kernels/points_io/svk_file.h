// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/detail/output_file.h"
#include "subvol/detail/svk_layout.h"

namespace subvol::detail {

/// A .svk file that is read extent by extent. Each extent is checked against its hash, so damaged bytes are an error and not a
/// wrong picture. Memory is allocated for what the file is long enough to hold.
///
/// throws: Error(Io); Error(InvalidInput) if the file is malformed; both name the file
class SvkFile {
public:
    /// Reads the head.
    explicit SvkFile(std::filesystem::path path);
    ~SvkFile();
    SvkFile(const SvkFile&) = delete;
    SvkFile& operator=(const SvkFile&) = delete;

    [[nodiscard]] const SvkContents& contents() const { return contents_; }
    [[nodiscard]] const SvkLayout& layout() const { return layout_; }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

    /// May be called by several threads at once.
    [[nodiscard]] std::string part(std::size_t block, std::size_t part) const;
    [[nodiscard]] std::string top() const;
    [[nodiscard]] Surface boundary() const;

    /// The kernels' numbers in a part: where they were in the volume that was written. Each is less than their count.
    [[nodiscard]] std::vector<std::uint32_t> numbers_in(std::size_t block, std::string_view part) const;

    /// All that has been read so far.
    [[nodiscard]] std::uint64_t bytes_read() const { return bytes_read_; }

    [[noreturn]] void fail(const std::string& what, const std::string& allowed = {}) const;

private:
    [[nodiscard]] std::string read(std::uint64_t offset, std::uint64_t bytes) const;
    [[nodiscard]] std::string read(const SvkExtent& extent, std::size_t hash, const std::string& name) const;
    void read_head();
    void check_kernels(const SvkArrays& arrays, const std::string& name) const;

    std::filesystem::path path_;
    int file_ = -1;
    SvkContents contents_;
    SvkLayout layout_;
    std::vector<std::uint64_t> hashes_;
    mutable std::atomic<std::uint64_t> bytes_read_ = 0;
};

/// Writes a .svk file, whose extents come in any order.
class SvkWriter {
public:
    /// throws: Error(Io)
    SvkWriter(const std::filesystem::path& path, SvkContents contents);

    [[nodiscard]] const SvkLayout& layout() const { return layout_; }

    void write_boundary(const Surface& boundary);
    void write_top(std::string_view bytes);
    void write_part(std::size_t block, std::size_t part, std::string_view bytes);

    /// Writes the head; then the file has its name.
    void finish();

private:
    void write(const SvkExtent& extent, std::size_t hash, std::string_view bytes);
    [[nodiscard]] std::string head() const;

    SvkContents contents_;
    OutputFile out_;
    std::uint64_t position_ = 0;  // behind the last bytes that were written
    SvkLayout layout_;
    std::vector<std::uint64_t> hashes_;
};

}  // namespace subvol::detail
