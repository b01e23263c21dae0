// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace subvol::detail {

/// A dataset of an HDF5 file.
struct Hdf5Shape {
    static constexpr unsigned kMostRank = 8;
    int type = -1;  ///< number of a NumberType, or -1 if it consists neither of numbers nor of single characters in this file
    unsigned rank = 0;
    std::uint64_t lengths[kMostRank] = {};
    std::uint64_t stored = 0;  ///< bytes of its storage
    std::uint64_t chunk = 0;
    std::uint64_t address = 0;  ///< in the file: the same by all names of a dataset
    bool filtered = false;      ///< the stored bytes may be compressed, each `chunk` bytes alone
    bool characters = false;
    bool grows = false;  ///< its first dimension is unlimited
};

/// What the module does with HDF5's library. Numbers below 0 stand for failure. Links to other files are not followed.
struct Hdf5Functions {
    std::int64_t (*open)(const char* path);
    void (*close)(std::int64_t file);
    /// Calls take(into, name) for each member of a group.
    int (*each_name)(std::int64_t file, const char* group, void* into, void (*take)(void* into, const char* name));
    int (*shape)(std::int64_t file, const char* dataset, Hdf5Shape* into);
    /// Reads numbers of the shape's type or characters, in this machine's byte order. lengths: of the dimensions, `rank` of
    /// them
    int (*read)(std::int64_t file, const char* dataset, unsigned rank, const std::uint64_t* starts,
                const std::uint64_t* lengths, void* into);
    /// Texts, integers and numbers of an attribute. They return the number of characters or numbers, at most `most`.
    std::int64_t (*text)(std::int64_t file, const char* object, const char* name, char* into, std::size_t most);
    std::int64_t (*integers)(std::int64_t file, const char* object, const char* name, std::int64_t* into, std::size_t most);
    std::int64_t (*reals)(std::int64_t file, const char* object, const char* name, double* into, std::size_t most);
    /// A new file, and what is put into it. rank: 1 or 2; a dataset's groups are made as they are needed; values are compressed
    std::int64_t (*create)(const char* path);
    int (*group)(std::int64_t file, const char* path);
    int (*write)(std::int64_t file, const char* dataset, int type, unsigned rank, const std::uint64_t* lengths,
                 const void* values);
    int (*write_text)(std::int64_t file, const char* object, const char* name, const char* text, std::size_t length);
    int (*write_integers)(std::int64_t file, const char* object, const char* name, const std::int64_t* values,
                          std::size_t count);
    /// As `close`, but below 0 if not everything could be written.
    int (*finish)(std::int64_t file);
};

}  // namespace subvol::detail
