// SPDX-License-Identifier: Apache-2.0
#include "subvol/method.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {
namespace {

constexpr Methods kSplat = bit(Method::Splat), kSheets = bit(Method::Sheets), kTets = bit(Method::Tets),
                  kProjected = bit(Method::Projected), kDense = bit(Method::Dense), kGrid = bit(Method::Grid);
constexpr Methods kKernels = kSplat | kSheets | bit(Method::Footprints), kCells = kTets | kProjected | kDense,
                  kEvery = kKernels | kCells | kGrid;

constexpr Bodies kMesh = bit(BodyKind::Mesh), kTetMesh = bit(BodyKind::Tets), kVoxels = bit(BodyKind::Voxels),
                 kBricks = bit(BodyKind::Bricks), kFile = bit(BodyKind::KernelFile);
constexpr Bodies kMeshes = kMesh | kTetMesh, kPoints = bit(BodyKind::Kernels) | kFile,
                 kAll = kMeshes | kPoints | kVoxels | kBricks;

constexpr std::string_view kNoKernels = "it draws no kernels";
constexpr std::string_view kNoSheets = "it sums no kernels on planes of equal depth";
constexpr std::string_view kOwnDevice = "it always runs on the same kind of device";
constexpr std::string_view kNoShadows = "it does not compute the light inside the volume";
constexpr std::string_view kNoLimit = "it draws voxels as they are";
constexpr std::string_view kNoCuts = "its kernels cannot be cut";

/// An option, its keyword, the methods and the bodies that read it, why others do not.
constexpr std::array kUses{
    OptionUse{"per-edge", "per_edge", kKernels, kMesh, kNoKernels},
    OptionUse{"centers", "centers", kKernels, kMesh, kNoKernels},
    OptionUse{"spacing", "spacing", kKernels, kMesh | kVoxels, kNoKernels},
    OptionUse{"spacing-voxels", "", kKernels, kMesh | kVoxels, kNoKernels},
    OptionUse{"tolerance", "tolerance", kKernels, kMesh, kNoKernels},
    OptionUse{"footprint", "", kKernels, kMesh, kNoKernels},
    OptionUse{"footprint-size", "", kKernels, kMesh, kNoKernels},
    OptionUse{"values", "values", kKernels, kMesh, kNoKernels},
    OptionUse{"value-kernel", "value_kernel", kKernels, kMesh, kNoKernels},
    OptionUse{"kernel", "kernel", kKernels, kMeshes | kBricks | kVoxels, kNoKernels},
    OptionUse{"threshold", "", kKernels, kMeshes | kVoxels, kNoKernels},
    OptionUse{"correction", "correction", kKernels, kMeshes | kBricks | kVoxels, kNoKernels},
    OptionUse{"reduce", "", kKernels, kMesh, kNoKernels},
    OptionUse{"refine", "", kKernels, kMesh, kNoKernels},
    OptionUse{"scheme", "scheme", kKernels | kCells, kMeshes | kBricks, kNoLimit},
    OptionUse{"tension", "tension", kKernels | kCells, kMesh | kBricks, kNoLimit},
    OptionUse{"crease-angle", "crease_angle", kKernels | kCells, kMeshes | kBricks, kNoLimit},
    OptionUse{.name = "levels",
              .keyword = "levels",
              .methods = kKernels | kCells,
              .bodies = kMeshes | kBricks,
              .reason = kNoLimit,
              .bricks = kTets},
    OptionUse{"samples", "samples", kEvery, kAll, ""},
    OptionUse{"tolerance-image", "image_tolerance", kSplat | kSheets | kDense, kAll,
              "it has no sheets and draws one level only"},
    OptionUse{"order", "order", kProjected, kMeshes, "it does not sort tetrahedra"},
    OptionUse{"kbuffer", "kbuffer", kProjected, kMeshes, "it has no k-buffer"},
    OptionUse{"lod", "lod", kKernels | kProjected, kAll & ~kBricks, "it draws everything"},
    OptionUse{"seconds", "seconds", kSplat | kSheets | kProjected, kMeshes, "it has no time limit"},
    OptionUse{"backend", "backend", kSplat, kAll, kOwnDevice},
    OptionUse{"device", "device", kSplat | kSheets | kProjected, kAll & ~kBricks, "it runs on the CPU"},
    OptionUse{"sheets", "sheets", kSplat | kSheets, kAll, kNoSheets},
    OptionUse{"plain-sums", "", kKernels, kAll, kNoKernels},
    OptionUse{"shade", "shade", kKernels, kAll, "it draws without light"},
    OptionUse{"shadows", "shadows", kSplat, kAll & ~kBricks, kNoShadows},
    OptionUse{"ambient-occlusion", "ambient_occlusion", kSplat, kAll & ~kBricks, kNoShadows},
    OptionUse{"color-field", "color_field", kKernels, kMeshes | kPoints, "it draws one field"},
    OptionUse{"edges", "", kKernels | kCells, kMeshes, "voxels have no cells"},
    OptionUse{"clip", "clip", kEvery & ~bit(Method::Footprints), kAll, kNoCuts},
    OptionUse{"clip-box", "clip_box", kEvery & ~bit(Method::Footprints), kAll, kNoCuts},
    OptionUse{"slice", "slice", kEvery & ~bit(Method::Footprints), kAll, kNoCuts},
    OptionUse{"around", "around", kEvery & ~bit(Method::Footprints), kAll, kNoCuts},
    OptionUse{"memory", "", kKernels | kTets, kBricks | kFile, "it holds everything in memory"},
};

std::string shown(const OptionUse& use, OptionNames names) {
    return names == OptionNames::Flags ? option_name(use.name, names) : std::string(use.keyword);
}

std::string_view noun_of(BodyKind body) {
    switch (body) {
        case BodyKind::Mesh:
            return "a mesh";
        case BodyKind::Tets:
            return "a mesh that is refined as tetrahedra";
        case BodyKind::Kernels:
        case BodyKind::KernelFile:
            return "points";
        case BodyKind::Voxels:
            return "a grid of voxels";
        case BodyKind::Bricks:
            return "a folder of bricks";
    }
    return "";
}

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i) text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
    return text;
}

/// What an option needs, and what it is not given together with.
std::string needs_of(const Option& option) {
    std::string all;
    const auto add = [&](const std::string& words) { all += (all.empty() ? "" : ", ") + words; };
    for (const OptionNeed& need : option.needs) {
        std::string words = need_text(need, OptionNames::Flags);
        words.insert(words.find("--"), "`");
        add(words + "`");
    }
    for (const std::string& other : option.excludes)
        add((&other == &option.excludes.front() ? "not with `--" : "`--") + other + "`");
    return all;
}

}  // namespace

std::span<const OptionUse> option_uses() {
    return kUses;
}

bool reads(Method method, BodyKind body, std::string_view option) {
    const auto* use = std::ranges::find(kUses, option, &OptionUse::name);
    if (use == kUses.end()) return true;
    const Methods able = body == BodyKind::Bricks ? use->methods & use->bricks : use->methods;
    return (able & bit(method)) != 0 && (use->bodies & bit(body)) != 0;
}

std::string option_table(std::span<const Option> described) {
    constexpr std::pair<BodyKind, const char*> kBodies[]{{BodyKind::Mesh, "mesh"},
                                                         {BodyKind::Tets, "tetrahedra"},
                                                         {BodyKind::Kernels, "points"},
                                                         {BodyKind::Voxels, "voxels"},
                                                         {BodyKind::Bricks, "bricks"}};
    std::string table = "| option | keyword |", rule = "\n|---|---|";
    for (const auto& row : NameTable<Method>::rows) {
        table += " " + std::string(row.name) + " |";
        rule += "---|";
    }
    table += " bodies | also |" + rule + "---|---|\n";
    for (const OptionUse& use : kUses) {
        table += "| `" + shown(use, OptionNames::Flags) + "` | " +
                 (use.keyword.empty() ? "" : "`" + std::string(use.keyword) + "`") + " |";
        for (const auto& row : NameTable<Method>::rows) table += (use.methods & bit(row.value)) != 0 ? " x |" : " |";
        std::string bodies;
        for (const auto& [body, name] : kBodies) {
            if ((use.bodies & bit(body)) != 0) bodies += (bodies.empty() ? "" : ", ") + std::string(name);
        }
        const auto option = std::ranges::find(described, use.name, &Option::name);
        const std::string needs = option == described.end() ? std::string() : needs_of(*option);
        table += " " + bodies + " | " + needs + " |\n";
    }
    return table;
}

std::string names_of(Methods methods) {
    std::vector<std::string> names;
    for (const auto& row : NameTable<Method>::rows) {
        if ((methods & bit(row.value)) != 0) names.emplace_back(row.name);
    }
    return joined(names);
}

Methods methods_of(BodyKind body) {
    switch (body) {
        case BodyKind::Mesh:
        case BodyKind::Tets:
            return kKernels | kCells;
        case BodyKind::Kernels:
        case BodyKind::KernelFile:
            return kKernels;
        case BodyKind::Voxels:
            return kKernels | kGrid;
        case BodyKind::Bricks:
            return kSplat | kTets;
    }
    return 0;
}

void check_method(Method method, BodyKind body, OptionNames names) {
    const Methods able = methods_of(body);
    if ((able & bit(method)) != 0) return;
    const std::string option = names == OptionNames::Flags ? "--method" : "method";
    throw Error(ErrorCode::InvalidInput, "'" + std::string(name_of(method)) + "' cannot draw " + std::string(noun_of(body)),
                option, "use " + names_of(able));
}

void check_options(Methods methods, BodyKind body, const GivenOptions& given, OptionNames names) {
    for (const OptionUse& use : kUses) {
        if (names == OptionNames::Keywords && use.keyword.empty()) continue;
        if (!given(use.name)) continue;
        if ((use.methods & methods) == 0) {
            throw Error(ErrorCode::InvalidInput,
                        "has no effect with method '" + names_of(methods) + "': " + std::string(use.reason), shown(use, names),
                        "methods that use it: " + names_of(use.methods));
        }
        const bool in_bricks = body == BodyKind::Bricks;
        if ((use.bodies & bit(body)) == 0 || (in_bricks && (use.bricks & use.methods & methods) == 0))
            throw Error(ErrorCode::InvalidInput, "has no effect on " + std::string(noun_of(body)), shown(use, names));
    }
}

void check_flow(const FlowChoices& flow, Method method, BodyKind body, bool whole, OptionNames names) {
    if (!flow.any()) return;
    const std::string option = option_name(flow.streamlines.empty() ? "glyphs" : "streamlines", names);
    if (body != BodyKind::Mesh) throw Error(ErrorCode::InvalidInput, "needs a mesh of hexahedra in memory", option);
    if (method == Method::Footprints) {
        throw Error(ErrorCode::InvalidInput, "is not drawn within footprints", option,
                    option_name("method", names) + " " + names_of(kSplat | kSheets | kCells));
    }
    if (!whole) {
        throw Error(ErrorCode::InvalidInput, "goes through a whole body", option,
                    "no " + option_name("patch", names) + " and no " + option_name("part-opacity", names) + "; " +
                        option_name("opacity", names) + " 0%:.2 makes its surface translucent");
    }
}

void check_options_of_shells(const GivenOptions& given, OptionNames names) {
    constexpr std::array<std::string_view, 10> kOfShells{"scheme", "tension",  "crease-angle", "levels", "samples",
                                                         "clip",   "clip-box", "shade",        "edges",  "color-field"};
    for (const OptionUse& use : kUses) {
        if (names == OptionNames::Keywords && use.keyword.empty()) continue;
        if (std::ranges::find(kOfShells, use.name) != kOfShells.end() || !given(use.name)) continue;
        throw Error(ErrorCode::InvalidInput, "has no effect on shells and patches: no volume is drawn", shown(use, names));
    }
}

}  // namespace subvol
