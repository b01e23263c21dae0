// SPDX-License-Identifier: Apache-2.0
#include "subvol/control_mesh.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "label_net.h"
#include "label_smoothing.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {

using namespace detail;

namespace {

constexpr std::size_t kMostMaterials = 1000;

struct Material {
    std::int32_t label;
    std::string name;
};

std::string default_name(std::int32_t label) {
    return "label_" + std::to_string(label);
}

/// "3" or "3=bone"
Material material_from(const std::string& text, const std::string& option) {
    const std::size_t sign = text.find('=');
    const std::string_view number = std::string_view(text).substr(0, sign);
    Material material{0, {}};
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), material.label);
    if (error != std::errc() || end != number.data() + number.size() || material.label < 1 || sign + 1 == text.size()) {
        throw Error(ErrorCode::InvalidInput, in_quotes(text) + " is not a label", option, "a number from 1, or 3=NAME");
    }
    material.name = sign == std::string::npos ? default_name(material.label) : text.substr(sign + 1);
    return material;
}

std::vector<Material> materials_from(const std::vector<std::string>& texts, const std::string& option) {
    std::vector<Material> materials;
    for (const std::string& text : texts) {
        materials.push_back(material_from(text, option));
        for (std::size_t k = 0; k + 1 < materials.size(); ++k) {
            if (materials[k].label == materials.back().label) {
                throw Error(ErrorCode::InvalidInput, "label " + std::to_string(materials[k].label) + " is there twice", option);
            }
            if (materials[k].name == materials.back().name) {
                throw Error(ErrorCode::InvalidInput, "two labels have the name " + in_quotes(materials[k].name), option,
                            "a name of its own for each");
            }
        }
    }
    return materials;
}

/// The voxels of each label.
std::map<std::int32_t, std::size_t> counts_of(const LabelGrid& grid) {
    std::map<std::int32_t, std::size_t> counts;
    for (const auto& [at, block] : grid.blocks()) {
        if (!block.voxels) {
            counts[block.label] += LabelGrid::kVoxels;
            continue;
        }
        std::size_t row = 0;  // of voxels with one label
        for (std::size_t v = 0; v < LabelGrid::kVoxels; ++v) {
            ++row;
            if (v + 1 < LabelGrid::kVoxels && (*block.voxels)[v + 1] == (*block.voxels)[v]) continue;
            if ((*block.voxels)[v] != 0) counts[(*block.voxels)[v]] += row;
            row = 0;
        }
    }
    return counts;
}

std::string list_of(const std::map<std::int32_t, std::size_t>& counts) {
    constexpr std::size_t kMostNamed = 20;
    std::string text;
    std::size_t named = 0;
    for (const auto& [label, count] : counts) {
        if (named++ == kMostNamed) return text + " and " + std::to_string(counts.size() - kMostNamed) + " more";
        text += (text.empty() ? "" : ", ") + std::to_string(label);
    }
    return text;
}

/// The materials of the options, or of all labels; checked.
std::vector<Material> chosen_materials(const std::map<std::int32_t, std::size_t>& counts, const LabelOptions& options) {
    const std::string option = option_name("label", options.names);
    std::vector<Material> materials = materials_from(options.labels, option);
    if (counts.empty()) throw Error(ErrorCode::InvalidInput, "none has a label: all are 0, which is outside", "voxels");
    for (const Material& material : materials) {
        if (counts.contains(material.label)) continue;
        throw Error(ErrorCode::InvalidInput, "no voxel has the label " + std::to_string(material.label), option,
                    "labels: " + list_of(counts));
    }
    const std::size_t count = materials.empty() ? counts.size() : materials.size();
    if (count > kMostMaterials) {
        throw Error(ErrorCode::InvalidInput, "have " + std::to_string(count) + " labels", "voxels",
                    "up to " + std::to_string(kMostMaterials) + " become materials: " + option + " chooses them");
    }
    if (materials.empty()) {
        for (const auto& [label, voxels] : counts) materials.push_back({label, default_name(label)});
    }
    return materials;
}

/// The surfaces of all materials of a net.
std::vector<Surface> surfaces_of(const LabelNet& net, const std::vector<Vec3>& places, std::size_t count,
                                 const LabelGrid& grid) {
    const bool mirrored = glm::determinant(grid.to_world()) < 0;
    std::vector<Surface> surfaces(count);
    std::vector<Index> numbers(places.size(), kNone);
    std::vector<std::vector<Index>> quads(count);
    for (Index q = 0; q < net.quads.size(); ++q) {
        for (const std::uint32_t material : net.quads[q].materials) {
            if (material != 0) quads[material - 1].push_back(q);
        }
    }
    for (std::size_t m = 0; m < count; ++m) {
        Surface& surface = surfaces[m];
        std::vector<Index> used;
        for (const Index q : quads[m]) {
            const bool turned = (net.quads[q].materials[1] == m + 1) != mirrored;
            for (auto triangle : split_quad(net.quads[q], places)) {
                if (turned) std::swap(triangle[1], triangle[2]);
                for (Index& p : triangle) {
                    if (numbers[p] == kNone) {
                        numbers[p] = static_cast<Index>(surface.points.size());
                        surface.points.push_back(grid.to_world() * places[p] + grid.origin());
                        used.push_back(p);
                    }
                    p = numbers[p];
                }
                surface.triangles.push_back(triangle);
            }
        }
        for (const Index p : used) numbers[p] = kNone;
        quads[m] = {};
    }
    return surfaces;
}

}  // namespace

std::vector<Option> options_of(LabelOptions& options) {
    return {
        Option("label", options.labels)
            .help("N[=NAME]",
                  "of labels: one that becomes a material, and the name of its set (label_N without one); all others are "
                  "outside. Without this option all labels become materials"),
        Option("smooth", options.smooth)
            .between(0, 1000)
            .help("N",
                  "of labels: rounds of smoothing, in which no point leaves the place between its voxels (0: their steps)")};
}

Facts facts_of(const std::vector<LabelReport>& labels) {
    FactValue::List list;
    for (const LabelReport& label : labels) {
        Facts own;
        own["name"] = label.name;
        own["label"] = static_cast<std::size_t>(label.label);
        own["voxels"] = label.voxels;
        own["voxels_world"] = label.voxels_world;
        own["enclosed_world"] = label.enclosed_world;
        list.emplace_back(std::move(own));
    }
    Facts facts;
    facts["labels"] = std::move(list);
    return facts;
}

LabelSurfaces label_surfaces(const LabelGrid& grid, const LabelOptions& given) {
    LabelOptions options = given;
    check_options(options);
    const std::map<std::int32_t, std::size_t> counts = counts_of(grid);
    const std::vector<Material> materials = chosen_materials(counts, options);
    std::map<std::int32_t, std::uint32_t> numbers;
    std::vector<double> volumes;
    for (const Material& material : materials) {
        numbers[material.label] = static_cast<std::uint32_t>(volumes.size() + 1);
        volumes.push_back(static_cast<double>(counts.at(material.label)));
    }
    report_progress(options.progress, "walls of labels", 0);
    LabelNet net = label_net(grid, [&](std::int32_t label) {
        const auto found = numbers.find(label);
        return found == numbers.end() ? 0U : found->second;
    });
    mark_sharp_edges(net);
    const std::vector<Vec3> places = smoothed_places(net, options.smooth, volumes, options.progress);
    const double voxel = std::abs(glm::determinant(grid.to_world()));
    const std::vector<double> enclosed = volumes_of(net, places, materials.size());
    std::vector<Surface> surfaces = surfaces_of(net, places, materials.size(), grid);
    LabelSurfaces made;
    for (std::size_t m = 0; m < materials.size(); ++m) {
        made.materials.push_back({materials[m].name, std::move(surfaces[m])});
        made.report.push_back(
            {materials[m].name, materials[m].label, counts.at(materials[m].label), voxel * volumes[m], voxel * enclosed[m]});
    }
    return made;
}

}  // namespace subvol
