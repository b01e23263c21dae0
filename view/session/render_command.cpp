// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "session_state.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/view_options.h"

namespace subvol::detail {

namespace {

std::string comma_separated(std::initializer_list<double> numbers) {
    std::string text;
    for (const double number : numbers) text += (text.empty() ? "" : ",") + exact_text(number);
    return text;
}

std::string opacity_text(const std::vector<TransferFunction::OpacityKnot>& knots) {
    std::string text;
    for (const auto& knot : knots) text += (text.empty() ? "" : ",") + exact_text(knot.value) + ":" + exact_text(knot.alpha);
    return text;
}

/// The words without the options that the method does not read; their values follow them.
std::vector<std::string> words_of_method(const std::vector<std::string>& words, Method method, BodyKind body) {
    std::vector<std::string> kept;
    bool keeps = true;
    for (const std::string& word : words) {
        if (word.starts_with("--")) keeps = reads(method, body, std::string_view(word).substr(2));
        if (keeps) kept.push_back(word);
    }
    return kept;
}

}  // namespace

std::string render_command(const ViewState& state, const ViewBody& body, const ViewSource& source,
                           const std::vector<std::string>& read_words) {
    const LookOptions& look = state.look;
    std::vector<std::string> words{"subvol", "render", source.input, "-o", "picture.png"};
    const auto add = [&](const char* option, const std::string& value) {
        words.emplace_back(option);
        words.push_back(value);
    };
    add("--size", std::to_string(state.width) + "x" + std::to_string(state.height));
    add("--camera", camera_text(state.camera));
    add("--look", std::string(name_of(look.look)));
    if (!look.colors.empty()) add("--tf", look.colors);
    if (look.range) {
        add("--tf-range", comma_separated({look.range->min, look.range->max}));
    } else if (look.stretch) {
        add("--tf-range", "field");
    }
    const ColorShape& shape = look.shape;
    const auto color_text = [](const Vec3& color) { return comma_separated({color.x, color.y, color.z}); };
    if (shape.scale.logarithmic) words.emplace_back("--log");
    if (shape.scale.linear_within > 0) add("--symlog", exact_text(shape.scale.linear_within));
    if (shape.bands > 0) add("--bands", std::to_string(shape.bands));
    if (shape.below) add("--below", color_text(*shape.below));
    if (shape.above) add("--above", color_text(*shape.above));
    if (!look.opacity.empty()) add("--opacity", opacity_text(look.opacity));
    if (look.opacity_unit_world) add("--opacity-unit", exact_text(*look.opacity_unit_world));
    if (look.clamp) words.emplace_back("--clamp");
    if (state.background) add("--background", color_text(*state.background));
    if (state.method != Method::Splat) add("--method", std::string(name_of(state.method)));
    const bool computed = body.field() == "density" && std::ranges::find(read_words, "--density") != read_words.end();
    if (!computed) add("--field", body.field());  // --density says which field, and excludes --field
    if (source.times.size() > 1) add("--step", std::to_string(state.step));
    const auto plane_text = [](const CutPlane& plane) {
        const Vec3 &at = plane.point, &normal = plane.normal;
        return comma_separated({at.x, at.y, at.z, normal.x, normal.y, normal.z});
    };
    for (const CutPlane& plane : state.clip.planes) add("--clip", plane_text(plane));
    if (const auto& box = state.clip.box) {
        const Vec3 &low = box->lower, &high = box->upper;
        add("--clip-box", comma_separated({low.x, low.y, low.z, high.x, high.y, high.z}));
    }
    for (const CutPlane& plane : state.clip.slices) add("--slice", plane_text(plane));
    if (state.clip.around_slices && !state.clip.slices.empty()) words.emplace_back("--around");
    if (state.axes) words.emplace_back("--axes");
    const Method method = state.method;
    if (state.edges && reads(method, kind_of(body), "edges")) words.emplace_back("--edges");
    if (state.legend) words.emplace_back("--legend");
    for (const auto& [name, value] : state.flow.words()) add(("--" + name).c_str(), value);
    words.insert(words.end(), read_words.begin(), read_words.end());
    const std::vector<std::string> more = words_of_method(source.more_words, method, kind_of(body));
    words.insert(words.end(), more.begin(), more.end());
    std::string line;
    for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
    return line;
}

}  // namespace subvol::detail
