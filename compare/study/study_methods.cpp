// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "study_keys.h"
#include "subvol/approximate.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/printable.h"
#include "subvol/fit_kernel.h"
#include "subvol/option.h"
#include "subvol/reduce.h"
#include "subvol/refine.h"
#include "subvol/sample.h"
#include "subvol/wavelet_file.h"

namespace subvol {

namespace detail {

namespace {

constexpr double kSeeds = 9007199254740992;  // 2⁵³: whole numbers up to it are exact in a double

using Keys = std::vector<Key>;

Keys operator+(Keys a, const Keys& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

Key flag(const char* name) {
    return {name, KeyKind::Switch, 0, 0, false};
}

Key whole(const char* name, double least, double most, std::optional<StudyValue> fallback = {}) {
    return {name, KeyKind::Whole, least, most, std::move(fallback)};
}

Key number(const char* name, double least, double most, std::optional<StudyValue> fallback = {}) {
    return {name, KeyKind::Number, least, most, std::move(fallback)};
}

/// One of several texts; the first is the default.
Key choice(const char* name, std::vector<std::string> choices) {
    std::string first = choices.front();
    return {name, KeyKind::Text, 0, 0, std::move(first), std::move(choices)};
}

Key kernel(const std::optional<std::string>& fallback = {}) {
    return {"kernel", KeyKind::KernelShape, 0, 0, fallback ? std::optional<StudyValue>(*fallback) : std::nullopt};
}

/// The key of an option of the library. The values that reading changes are never used.
template <class Options>
Key described(const char* key, std::optional<StudyValue> fallback = {}) {
    static Options any;
    const std::vector<Option> options = options_of(any);
    return key_of(*std::ranges::find(options, key, &Option::key), std::move(fallback));
}

Keys kernel_keys() {
    return {described<SampleOptions>("per_edge", 1.0), number("spacing_voxels", 0, 200), flag("centers"),
            described<SampleOptions>("kernel", "compact"), described<SampleOptions>("correction", "second")};
}

/// A key of pictures that has a place of its own in the order of cases.
///
/// methods:  those that have the fallback; of a key that is not an option, those that have it
/// made:     no option
/// option:   the option's key, if studies call it otherwise
struct PictureKey {
    Key key;
    std::vector<std::string> methods;
    bool made = false;
    std::string option{};
};

std::vector<PictureKey> picture_keys() {
    const std::vector<std::string> kernels{"splat", "sheets", "footprints"}, sheets{"splat", "sheets"};
    std::vector<PictureKey> keys;
    for (const Key& key : kernel_keys()) keys.push_back({key, kernels, key.name == "spacing_voxels"});
    const auto fallback = [](const char* name, const StudyValue& value) { return Key{.name = name, .fallback = value}; };
    const std::vector<PictureKey> more{
        {fallback("sheets", 200.0), sheets},
        {described<SampleOptions>("boundary_levels"), sheets, true},
        {flag("visible_only"), kernels, true},
        {fallback("levels", 1.0), {"tets", "pt"}},
        {fallback("order", "topological"), {"pt"}},
        {fallback("tolerance", 1e-3), {"dense"}, false, "image_tolerance"},
        {whole("max_levels", 1, 8, 6.0), {"dense"}, true},
        {whole("resolution", 2, 2000, 200.0), {"grid"}, true},
        {flag("half"), {"grid"}, true},
        {fallback("samples", 1.0), {"tets", "dense", "grid"}},
        {whole("repeat", 1, 100, 1.0), {"splat", "sheets", "footprints", "tets", "pt", "dense", "grid"}, true},
        {fallback("backend", "cpu"), {"splat"}}};
    keys.insert(keys.end(), more.begin(), more.end());
    return keys;
}

/// Whether a value is one word or number. Cuts are rows of numbers; cases have one mesh with one field.
bool has_one_value(const Option& option) {
    const bool rows = std::holds_alternative<NumbersValue>(option.value);
    return !rows && option.name != "around" && option.name != "color-field";
}

/// The keys of a method of pictures: first those that have a place in the order, then its other options.
StudyMethod as_study_method(const PictureMethod& method) {
    StudyMethod made{method.name, StudyKind::Pictures, {}};
    std::vector<std::string> taken;
    for (const PictureKey& one : picture_keys()) {
        const bool mentioned = std::ranges::find(one.methods, method.name) != one.methods.end();
        if (one.made) {
            if (mentioned) made.keys.push_back(one.key);
            continue;
        }
        const std::string& name = one.option.empty() ? one.key.name : one.option;
        const auto option = std::ranges::find(method.options, name, &Option::key);
        if (option == method.options.end()) continue;
        made.keys.push_back(key_of(*option, mentioned ? one.key.fallback : std::nullopt));
        made.keys.back().name = one.key.name;
        taken.push_back(name);
    }
    for (const Option& option : method.options) {
        if (has_one_value(option) && std::ranges::find(taken, option.key()) == taken.end()) made.keys.push_back(key_of(option));
    }
    return made;
}

/// The methods that no renderer of meshes has: the closed form of a model, pictures made elsewhere, and those without pictures.
const std::vector<StudyMethod>& own_methods() {
    const auto make = []() -> std::vector<StudyMethod> {
        const Keys kernels = kernel_keys();
        const Key resolution = whole("resolution", 2, 2000, 200.0), half = flag("half");
        const Keys places{whole("places", 1, 1e7, 1e5), choice("where", {"anywhere", "extraordinary", "boundary"}),
                          number("within", 0, 1, 1.0), whole("seed", 0, kSeeds, 0.0)};
        const Keys volume{described<RefineOptions>("levels", 2.0), whole("places", 1, 1e7, 1e5), whole("seed", 0, kSeeds, 0.0),
                          whole("resolution", 2, 2000, 64.0), number("iso", -1e300, 1e300)};
        std::vector<std::string> shapes = names_of<KernelShape>();
        shapes.insert(shapes.end(), {"tucker", "radial_bound"});
        const Keys fit{Key{"shape", KeyKind::Text, 0, 0, "gaussian", shapes}, described<FitOptions>("extent"),
                       described<FitOptions>("sign_slip", false), described<FitOptions>("terms"), whole("rank", 1, 16)};
        using enum StudyKind;
        const Key repeat = whole("repeat", 1, 100, 1.0), samples = whole("samples", 1, 16, 1.0);
        return {{"exact", Pictures, {number("step", 0, 1, 1e-3), samples, repeat}},
                {"file", Pictures, {Key{"file"}}},
                {"field", Fields, kernels + places + Keys{flag("every_second")}},
                {"volume", Fields, kernels + volume},
                {"voxels", Fields, Keys{resolution, half} + places},
                {"approximate", Fields,
                 Keys{whole("coarser", 1, 10), Key{"onto"}, described<ApproximateOptions>("smoothing")} + places},
                {"wavelets", Fields, Keys{described<WaveletFileOptions>("tolerance", 1e-3)} + places},
                {"reduce", Fields, Keys{number("target", 0, 1, 1e-2), described<ReduceOptions>("move")} + places},
                {"mesh", Fields, places},
                {"values", Fields, {choice("rule", {"paper", "cubic", "samples"}), kernel("paper_bc")}},
                {"counts", Fields, {described<SampleOptions>("per_edge", 1.0)}},
                {"errors", Kernels, {kernel("gaussian")}},
                {"fit", Kernels, fit},
                {"slice", Kernels, {kernel(), whole("pixels", 8, 2048, 385.0)}}};
    };
    static const std::vector<StudyMethod> kMethods = make();
    return kMethods;
}

}  // namespace

std::vector<StudyMethod> all_methods(std::span<const PictureMethod> pictures) {
    std::vector<StudyMethod> all;
    for (const PictureMethod& method : pictures) all.push_back(as_study_method(method));
    all.insert(all.end(), own_methods().begin(), own_methods().end());
    return all;
}

StudyMethod find_method(const std::string& name, const std::string& path, std::span<const PictureMethod> pictures) {
    std::vector<std::string> names;
    for (const PictureMethod& method : pictures) {
        if (name == method.name) return as_study_method(method);
        names.push_back(method.name);
    }
    for (const StudyMethod& method : own_methods()) {
        if (name == method.name) return method;
        names.push_back(method.name);
    }
    std::string known;
    for (const std::string& one : names) known += (known.empty() ? "" : ", ") + one;
    refuse(path, "there is no method '" + shortened(name) + "'" + did_you_mean(name, names), known);
}

}  // namespace detail

StudyKind method_kind(const std::string& method) {
    const auto own = std::ranges::find(detail::own_methods(), method, &detail::StudyMethod::name);
    return own == detail::own_methods().end() ? StudyKind::Pictures : own->kind;
}

}  // namespace subvol
