// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "input.h"

namespace subvol::fuzz {

/// A file of a case. letter: the first byte of the inputs that replace it; text: what it has otherwise
struct CaseFile {
    char letter;
    std::string name;
    std::string text;
};

/// A temporary folder of files that are read together. Each input is one of them.
class CaseFolder {
public:
    CaseFolder(const std::string& name, std::vector<CaseFile> files) : files_(std::move(files)) {
        root_ = std::filesystem::temp_directory_path() / ("fuzz_" + name + "_" + std::to_string(::getpid()));
        for (const CaseFile& file : files_) std::filesystem::create_directories((root_ / file.name).parent_path());
        for (const CaseFile& file : files_) write(file, file.text);
    }

    /// Puts the input in the place of its file; the one that it replaced before is as at first.
    void put(const std::uint8_t* data, std::size_t size) {
        if (changed_ != nullptr) write(*changed_, changed_->text);
        changed_ = nullptr;
        for (const CaseFile& file : files_) {
            if (size == 0 || static_cast<char>(data[0]) != file.letter) continue;
            write(file, text_of(data + 1, size - 1));
            changed_ = &file;
        }
    }

    [[nodiscard]] std::filesystem::path path(const std::string& name) const { return root_ / name; }

private:
    void write(const CaseFile& file, std::string_view text) const {
        std::ofstream(root_ / file.name, std::ios::binary) << text;
    }

    std::vector<CaseFile> files_;
    std::filesystem::path root_;
    const CaseFile* changed_ = nullptr;
};

}  // namespace subvol::fuzz
