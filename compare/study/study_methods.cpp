// SPDX-License-Identifier: Apache-2.0
#include "study_keys.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/printable.h"
#include "subvol/fit_kernel.h"
#include "subvol/sample.h"

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

/// The names of an enum.
template <class Enum>
Key choice(const char* name, Enum fallback, const std::vector<std::string>& besides = {}) {
    std::vector<std::string> choices = names_of<Enum>();
    choices.insert(choices.end(), besides.begin(), besides.end());
    return {name, KeyKind::Text, 0, 0, std::string(name_of(fallback)), std::move(choices)};
}

Key kernel(const std::optional<std::string>& fallback = {}) {
    return {"kernel", KeyKind::KernelShape, 0, 0, fallback ? std::optional<StudyValue>(*fallback) : std::nullopt};
}

std::vector<StudyMethod> make_methods() {
    const Key samples = whole("samples", 1, 16, 1.0), repeat = whole("repeat", 1, 100, 1.0);
    const Key level = whole("levels", 0, 6, 1.0), resolution = whole("resolution", 2, 2000, 200.0), half = flag("half");
    const Keys kernels{whole("per_edge", 1, 64, 1.0), number("spacing_voxels", 0, 200), flag("centers"), kernel("compact"),
                       choice("correction", Correction::Second)};
    const Keys splats =
        kernels + Keys{whole("sheets", 2, 65536, 200.0), whole("boundary_levels", 0, 6), flag("visible_only"), repeat};
    const Keys places{whole("places", 1, 1e7, 1e5), choice("where", {"anywhere", "extraordinary", "boundary"}),
                      number("within", 0, 1, 1.0), whole("seed", 0, kSeeds, 0.0)};
    const Keys volume{whole("levels", 0, 6, 2.0), whole("places", 1, 1e7, 1e5), whole("seed", 0, kSeeds, 0.0),
                      whole("resolution", 2, 2000, 64.0), number("iso", -1e300, 1e300)};
    const Keys dense{whole("levels", 0, 8), number("tolerance", 0, 1, 1e-3), whole("max_levels", 1, 8, 6.0), samples, repeat};
    const Keys fit{choice("shape", KernelShape::Gaussian, {"tucker", "radial_bound"}), number("extent", 0, 3),
                   flag("sign_slip"), whole("terms", 1, 6), whole("rank", 1, 16)};
    using enum StudyKind;
    return {{"splat", Pictures, splats + Keys{choice("backend", {"cpu", "auto", "gl"})}},
            {"sheets", Pictures, splats},
            {"footprints", Pictures, kernels + Keys{flag("visible_only"), repeat}},
            {"tets", Pictures, {level, samples, repeat}},
            {"pt", Pictures, {level, choice("order", {"topological", "centroid", "lists", "havs"}), repeat}},
            {"dense", Pictures, dense},
            {"grid", Pictures, {resolution, half, samples, repeat}},
            {"field", Fields, kernels + places + Keys{flag("every_second")}},
            {"volume", Fields, kernels + volume},
            {"voxels", Fields, Keys{resolution, half} + places},
            {"values", Fields, {choice("rule", {"paper", "cubic", "samples"}), kernel("paper_bc")}},
            {"counts", Fields, {whole("per_edge", 1, 64, 1.0)}},
            {"errors", Kernels, {kernel("gaussian")}},
            {"fit", Kernels, fit},
            {"slice", Kernels, {kernel(), whole("pixels", 8, 2048, 385.0)}}};
}

}  // namespace

const std::vector<StudyMethod>& study_methods() {
    static const std::vector<StudyMethod> kMethods = make_methods();
    return kMethods;
}

const StudyMethod& find_method(const std::string& name, const std::string& path) {
    std::string known;
    std::vector<std::string> names;
    for (const StudyMethod& method : study_methods()) {
        if (name == method.name) return method;
        names.emplace_back(method.name);
        known += (known.empty() ? "" : ", ") + std::string(method.name);
    }
    refuse(path, "there is no method '" + shortened(name) + "'" + did_you_mean(name, names), known);
}

}  // namespace detail

StudyKind method_kind(const std::string& method) {
    return detail::find_method(method, "study").kind;
}

}  // namespace subvol
