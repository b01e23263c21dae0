// SPDX-License-Identifier: Apache-2.0
#include "recent_files.h"

#include <algorithm>
#include <fstream>
#include <system_error>

#include "subvol/detail/atomic_file.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMost = 10;

bool is_there(const std::string& name) {
    std::error_code ignored;
    return name.starts_with("model:") || std::filesystem::exists(name, ignored);
}

}  // namespace

std::vector<std::string> recent_files(const std::filesystem::path& list) {
    std::vector<std::string> names;
    if (list.empty()) return names;
    std::ifstream lines(list);
    for (std::string line; names.size() < kMost && std::getline(lines, line);) {
        if (!line.empty() && is_there(line)) names.push_back(line);
    }
    return names;
}

void add_recent(const std::filesystem::path& list, const std::string& file) {
    if (list.empty()) return;
    std::error_code failed;
    const std::string name =
        file.starts_with("model:") ? file : std::filesystem::absolute(file, failed).lexically_normal().string();
    if (failed || name.find('\n') != std::string::npos) return;
    std::vector<std::string> names = recent_files(list);
    std::erase(names, name);
    names.insert(names.begin(), name);
    names.resize(std::min(names.size(), kMost));
    std::string text;
    for (const std::string& one : names) text += one + "\n";
    std::filesystem::create_directories(list.parent_path(), failed);
    try {
        write_text_file(list, text);
    } catch (const Error&) {  // read-only homes have no list
    }
}

}  // namespace subvol::detail
