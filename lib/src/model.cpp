#include "subvol/model.h"

#include <array>

#include "model_parts.h"
#include "subvol/error.h"

namespace subvol {
namespace {

constexpr int kMinResolution = 2, kMaxResolution = 512;

struct Entry {
    const char* name;
    const char* description;
    int default_resolution;
    HexMesh (*make)(Index resolution);
};

constexpr std::array<Entry, 3> kModels{{
    {"pawn", "a chess pawn: a signed density in a bent and twisted block; N cells high, N/2 wide and deep", 64,
     model::make_pawn},
    {"ball", "a unit ball about an inner cube of N cells a side, N/2 shells; 20 lines of three-celled edges, 8 singular points",
     16, model::make_ball},
    {"twist", "the benchmark: a twisted and bent block of N cells a side with an exact field", 40, model::make_twist},
}};

std::string known_names() {
    std::string names;
    for (const Entry& entry : kModels) names += (names.empty() ? "" : ", ") + std::string(entry.name);
    return names;
}

}  // namespace

std::vector<ModelInfo> list_models() {
    std::vector<ModelInfo> models;
    for (const Entry& entry : kModels) models.push_back({entry.name, entry.description, entry.default_resolution});
    return models;
}

HexMesh make_model(const std::string& name, int resolution) {
    for (const Entry& entry : kModels) {
        if (name != entry.name) continue;
        const int n = resolution == 0 ? entry.default_resolution : resolution;
        if (n < kMinResolution || n > kMaxResolution) {
            throw Error(ErrorCode::InvalidInput, "resolution " + std::to_string(n) + " is out of range", "model " + name,
                        std::to_string(kMinResolution) + ".." + std::to_string(kMaxResolution));
        }
        return entry.make(static_cast<Index>(n));
    }
    throw Error(ErrorCode::InvalidInput, "there is no model '" + name + "'", {}, known_names());
}

}  // namespace subvol
