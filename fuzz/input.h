// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "subvol/error.h"

namespace subvol::fuzz {

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

/// Whatever is wrong has to leave as an Error; anything else ends the fuzzer.
template <class Call>
int run(const Call& call) {
    try {
        call();
    } catch (const Error&) {
    }
    return 0;
}

/// Ends the fuzzer if something does not hold.
inline void check(bool holds) {
    if (!holds) std::abort();
}

/// A folder that this process alone writes to.
inline std::filesystem::path own_folder() {
    const auto folder = std::filesystem::temp_directory_path() / ("fuzz_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder);
    return folder;
}

/// The bytes as a file, for what reads files only: one in the temporary folder, again and again.
inline std::filesystem::path as_file(const std::uint8_t* data, std::size_t size, const std::string& extension) {
    static const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("fuzz_" + std::to_string(::getpid()) + extension);
    std::ofstream(path, std::ios::binary) << text_of(data, size);
    return path;
}

}  // namespace subvol::fuzz
