// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/module.h"

#include <dlfcn.h>
#include <link.h>

#include <cstddef>
#include <filesystem>
#include <memory>
#include <new>
#include <system_error>
#include <vector>

#include "subvol/error.h"
#include "subvol/version.h"

namespace subvol::detail {

namespace fs = std::filesystem;

namespace {

// The folders where the file that contains this code, a program or a shared library, looks for libraries. `dlopen` would search
// them itself, but not where a sanitizer calls it in our place, and its message does not name them.
std::vector<fs::path> library_folders() {
    Dl_info ignored;
    void* file = nullptr;
    if (dladdr1(reinterpret_cast<void*>(&load_module), &ignored, &file, RTLD_DL_LINKMAP) == 0) return {};
    Dl_serinfo head;
    if (dlinfo(file, RTLD_DI_SERINFOSIZE, &head) != 0) return {};
    const std::unique_ptr<void, void (*)(void*)> memory(::operator new(head.dls_size), [](void* p) { ::operator delete(p); });
    auto* list = static_cast<Dl_serinfo*>(memory.get());
    if (dlinfo(file, RTLD_DI_SERINFOSIZE, list) != 0 || dlinfo(file, RTLD_DI_SERINFO, list) != 0) return {};
    std::vector<fs::path> folders;
    for (unsigned i = 0; i < list->dls_cnt; ++i) folders.emplace_back(list->dls_serpath[i].dls_name);
    return folders;
}

// Folders that depend on where a program was started are left out: files there are not ours.
fs::path find_module(const std::string& file) {
    std::error_code ignored;
    for (const fs::path& folder : library_folders()) {
        if (folder.is_absolute() && fs::is_regular_file(folder / file, ignored)) return folder / file;
    }
    return {};
}

}  // namespace

void* load_module(const std::string& name, const std::string& purpose) {
    const std::string file = "subvol_" + name + ".so";
    const auto fail = [&](const std::string& why, const std::string& allowed) -> Error {
        return {ErrorCode::MissingCapability, purpose + " needs the module " + file + ", which " + why, {}, allowed};
    };
    const fs::path path = find_module(file);
    if (path.empty()) throw fail("is not installed", "it belongs into the folder lib/…/subvol of the installation");
    void* module = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (module == nullptr) throw fail(std::string("cannot be loaded: ") + dlerror(), {});
    const auto* version = static_cast<const char*>(dlsym(module, "subvol_module_version"));
    void* entry = dlsym(module, ("subvol_" + name).c_str());
    if (version == nullptr || entry == nullptr || version != std::string(SUBVOL_VERSION)) {
        throw fail("is of another version at " + path.string(), std::string("of version ") + SUBVOL_VERSION);
    }
    return entry;
}

}  // namespace subvol::detail
