// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace subvol::detail {

/// A dataset of an HDF5 file. type: the number of a NumberType, or -1 if it consists neither of numbers nor of single
/// characters in this file; stored: the bytes of its storage; filtered: they may be compressed, each `chunk` bytes alone;
/// grows: its first dimension is unlimited
struct Hdf5Shape {
    static constexpr unsigned kMostRank = 8;
    int type = -1;
    unsigned rank = 0;
    std::uint64_t lengths[kMostRank] = {};
    std::uint64_t stored = 0;
    std::uint64_t chunk = 0;
    std::uint64_t address = 0;  // in the file: the same by all names of a dataset
    bool filtered = false;
    bool characters = false;
    bool grows = false;
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
    /// Texts and integers of an attribute. They return the number of characters or integers, at most `most`.
    std::int64_t (*text)(std::int64_t file, const char* object, const char* name, char* into, std::size_t most);
    std::int64_t (*integers)(std::int64_t file, const char* object, const char* name, std::int64_t* into, std::size_t most);
};

}  // namespace subvol::detail
