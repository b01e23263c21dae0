// SPDX-License-Identifier: Apache-2.0
#include "subvol/model.h"

#include <array>

#include "model_block.h"
#include "model_solid.h"
#include "subvol/detail/near_name.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

constexpr int kMinResolution = 2, kMaxResolution = 512;

struct Entry {
    const char* name;
    const char* description;
    int default_resolution;
    HexMesh (*make)(Index resolution);
};

template <const model::Solid& kSolid>
HexMesh make(Index resolution) {
    return model::make_solid(kSolid, resolution);
}

// The defaults of the models of [mnmq2007] give its numbers of points after one level (its table 2), within 5 %.
constexpr std::array<Entry, 9> kModels{{
    {"pawn", "a chess pawn: a signed density in a bent and twisted block; N cells high, N/2 wide and deep", 64,
     make<model::kPawn>},
    {"ball", "a unit ball about an inner cube of N cells a side, N/2 shells; 20 lines of three-celled edges, 8 singular points",
     16, model::make_ball},
    {"twist", "the benchmark: a twisted and bent block of N cells a side with an exact field", 40, model::make_twist},
    {"alien", "a signed density as the pawn's: a big-headed visitor, bent and twisted; N cells high", 64, make<model::kAlien>},
    {"train1", "a signed density: a steam engine in a curve, over a hump; N cells long", 112, make<model::kTrain1>},
    {"car", "a signed density: a toy car with its windows cut out, arched and twisted; N cells long", 88, make<model::kCar>},
    {"fan", "a signed density: twisted blades in a ring that is curled; N cells high and wide", 56, make<model::kFan>},
    {"nozzle",
     "the speed of a gas in a bent nozzle; N cells long, N/4 across the square core of an O-grid with 4 lines of three-celled "
     "edges",
     48, model::make_nozzle},
    {"train2", "a signed density: a streamlined engine and its wagon, swaying; N cells long", 152, make<model::kTrain2>},
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
    std::vector<std::string> names;
    for (const Entry& entry : kModels) names.emplace_back(entry.name);
    throw Error(ErrorCode::InvalidInput, "there is no model '" + name + "'" + detail::did_you_mean(name, names), {},
                known_names());
}

}  // namespace subvol
