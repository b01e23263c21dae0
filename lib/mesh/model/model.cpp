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
    ModelField field;
};

template <const model::Solid& kSolid>
HexMesh make(Index resolution) {
    return model::make_solid(kSolid, resolution);
}

template <class Field>
std::optional<double> value(const Vec3& x) {
    return Field{}.value(x);
}

// The defaults of the models of [mnmq2007] give its numbers of points after one level (its table 2), within 5 %.
constexpr std::array<Entry, 9> kModels{{
    {"pawn", "a chess pawn: a signed density in a bent and twisted block; N cells high, N/2 wide and deep", 64,
     make<model::kPawn>, value<PawnField>},
    {"ball", "a unit ball about an inner cube of N cells a side, N/2 shells; 20 lines of three-celled edges, 8 singular points",
     16, model::make_ball, value<BallField>},
    {"twist", "the benchmark: a twisted and bent block of N cells a side with an exact field", 40, model::make_twist,
     value<TwistField>},
    {"alien", "a signed density as the pawn's: a big-headed visitor, bent and twisted; N cells high", 64, make<model::kAlien>,
     value<AlienField>},
    {"train1", "a signed density: a steam engine in a curve, over a hump; N cells long", 112, make<model::kTrain1>,
     value<Train1Field>},
    {"car", "a signed density: a toy car with its windows cut out, arched and twisted; N cells long", 88, make<model::kCar>,
     value<CarField>},
    {"fan", "a signed density: twisted blades in a ring that is curled; N cells high and wide", 56, make<model::kFan>,
     value<FanField>},
    {"nozzle",
     "the speed of a gas in a bent nozzle; N cells long, N/4 across the square core of an O-grid with 4 lines of three-celled "
     "edges",
     48, model::make_nozzle, value<NozzleField>},
    {"train2", "a signed density: a streamlined engine and its wagon, swaying; N cells long", 152, make<model::kTrain2>,
     value<Train2Field>},
}};

const Entry& entry_of(const std::string& name) {
    std::vector<std::string> names;
    std::string known;
    for (const Entry& entry : kModels) {
        if (name == entry.name) return entry;
        names.emplace_back(entry.name);
        known += (known.empty() ? "" : ", ") + names.back();
    }
    throw Error(ErrorCode::InvalidInput, "there is no model '" + name + "'" + detail::did_you_mean(name, names), {}, known);
}

}  // namespace

std::vector<ModelInfo> list_models() {
    std::vector<ModelInfo> models;
    for (const Entry& entry : kModels) models.push_back({entry.name, entry.description, entry.default_resolution});
    return models;
}

HexMesh make_model(const std::string& name, int resolution) {
    const Entry& entry = entry_of(name);
    const int n = resolution == 0 ? entry.default_resolution : resolution;
    if (n < kMinResolution || n > kMaxResolution) {
        throw Error(ErrorCode::InvalidInput, "resolution " + std::to_string(n) + " is out of range", "model " + name,
                    std::to_string(kMinResolution) + ".." + std::to_string(kMaxResolution));
    }
    return entry.make(static_cast<Index>(n));
}

ModelField model_field(const std::string& name) {
    return entry_of(name).field;
}

}  // namespace subvol
