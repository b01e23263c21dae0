// SPDX-License-Identifier: Apache-2.0
// A page of HTML that shows a volume in a browser: one file with data, scripts, shaders and styles inside.
//
//     steps ─► arrays of places, values, boundary ─► rounded to bits, compressed, base64 ┐
//     options ─► head: camera, light, colours, fields, reference picture, as JSON         ┴─► html
//
// The page must not exceed a number of bytes. It is made with 21 bits for places and 16 for values first; if it is too large,
// with 16 and 12; then kernels are merged, and how many are kept is found by a secant from the bytes of the tries before. The
// boundary is not reduced, so a page with many triangles may be refused. Places and boundaries that are those of the step
// before are not stored again. Errors of the fields are measured last, at places between kernels, by evaluating what the page
// reads against what was given.
#include "subvol/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "page_arrays.h"
#include "page_kernels.h"
#include "page_texts.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/text_codes.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/rbf_field.h"
#include "subvol/shading.h"
#include "subvol/version.h"

namespace subvol::detail {

namespace {

/// How the data of a page are made smaller.
///
/// kept: the part of the kernels that is left after merging
struct PageRounding {
    int place_bits = 21, value_bits = 16;  // cells at walls may be a millionth of the body
    double kept = 1;
};

/// The data of a page: a description, with the places of the arrays, and their bytes.
struct PageData {
    PageJson json;
    std::string compressed;
    std::size_t kernels = 0, kept = 0, triangles = 0;
    std::vector<PageError> errors{};  // of each field
};

constexpr std::size_t kPlaces = 8192;  // at which errors are measured

/// Places in the kernels of a volume: off their middles, where sums of few kernels are not typical.
std::vector<Vec3> places_in(const RbfVolume& volume) {
    const std::size_t step = std::max<std::size_t>(1, volume.size() / kPlaces);
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < volume.size(); i += step) {
        const std::size_t other = std::min(i + 1, volume.size() - 1);
        const Vec3 d = volume.centers[other] - volume.centers[i];
        const Mat3 inverse = glm::inverse(matrix(volume.frames[i]));
        const bool near = glm::dot(d, inverse * d) < 1;  // the next kernel in the list is often the next one in space
        places.push_back(volume.centers[i] + (near ? 0.5 : 0.0) * d);
    }
    return places;
}

struct ErrorSum {
    double squares = 0, most = 0;
    std::size_t count = 0;

    void add(const RbfVolume& given, std::size_t channel, const RbfVolume& kept) {
        const std::vector<Vec3> places = places_in(given);
        const std::vector<double> right = RbfField(given, {.channel = channel}).evaluate(places);
        const std::vector<double> found = RbfField(kept).evaluate(places);
        for (std::size_t i = 0; i < places.size(); ++i) {
            const double error = std::abs(found[i] - right[i]);
            if (!std::isfinite(error)) continue;
            squares += error * error;
            most = std::max(most, error);
            ++count;
        }
    }
};

template <class Item>
bool same(const std::vector<Item>& a, const std::vector<Item>& b) {
    return a == b;
}

/// Steps often have the same mesh: its places are stored once.
class Places {
public:
    Places(PageArrays& arrays, int bits) : arrays_(arrays), bits_(bits) {}

    /// The number of the array for these kernels, and what the page will read from it.
    int of(const RbfVolume& volume) {
        if (known_ && same(volume.centers, centers_) && same(volume.frames, frames_)) return number_;
        numbers_ = place_numbers(volume);
        number_ = arrays_.add(numbers_, kPlaceNumbers, bits_);
        centers_ = volume.centers;
        frames_ = volume.frames;
        known_ = true;
        return number_;
    }
    [[nodiscard]] const std::vector<double>& numbers() const { return numbers_; }

private:
    PageArrays& arrays_;
    int bits_, number_ = -1;
    bool known_ = false;
    std::vector<double> numbers_;
    std::vector<Vec3> centers_;
    std::vector<Symmetric3> frames_;
};

class Boundaries {
public:
    explicit Boundaries(PageArrays& arrays) : arrays_(arrays) {}

    PageJson of(const Surface& surface) {
        if (points_ < 0 || !same(surface.points, last_.points)) {
            std::vector<double> numbers;
            for (const Vec3& p : surface.points) numbers.insert(numbers.end(), {p.x, p.y, p.z});
            points_ = arrays_.add(numbers, 3, 16);
        }
        if (triangles_ < 0 || !same(surface.triangles, last_.triangles)) {
            std::vector<std::uint32_t> corners;
            for (const auto& t : surface.triangles) corners.insert(corners.end(), t.begin(), t.end());
            triangles_ = arrays_.add_integers(corners, 3);
        }
        last_ = surface;
        return {{"points", points_}, {"triangles", triangles_}};
    }

private:
    PageArrays& arrays_;
    Surface last_;
    int points_ = -1, triangles_ = -1;
};

/// with_errors: they take longer than all else
PageData page_data(std::span<const PageStep> steps, std::size_t fields, const PageRounding& rounding, bool with_errors) {
    PageData data;
    PageArrays arrays;
    Places places(arrays, rounding.place_bits);
    Boundaries boundaries(arrays);
    std::vector<ErrorSum> errors(fields);
    data.json["steps"] = PageJson::array();
    for (const PageStep& step : steps) {
        const std::size_t given = step.volume.size();
        const auto kept = static_cast<std::size_t>(std::llround(rounding.kept * static_cast<double>(given)));
        const bool merge = rounding.kept < 1;
        const RbfVolume merged = merge ? merged_kernels(step.volume, kept) : RbfVolume{};
        const RbfVolume& volume = merge ? merged : step.volume;
        PageJson entry{
            {"label", step.label}, {"places", places.of(volume)}, {"boundary", boundaries.of(step.boundary.surface)}};
        for (std::size_t f = 0; f < fields; ++f) {
            std::vector<double> values = value_numbers(volume, volume.channels[f]);
            std::vector<double> surface = step.boundary.values[f];
            entry["values"].push_back(
                {{"kernels", arrays.add(values, kValueNumbers, rounding.value_bits)}, {"surface", arrays.add(surface, 1, 16)}});
            if (!with_errors) continue;
            errors[f].add(step.volume, f, kernels_of_numbers(places.numbers(), values, volume.kernel));
        }
        data.json["steps"].push_back(std::move(entry));
        data.kernels += given;
        data.kept += volume.size();
        data.triangles += step.boundary.surface.triangles.size();
    }
    data.json["arrays"] = arrays.directory();
    data.compressed = arrays.compressed();
    for (const ErrorSum& error : errors) {
        const double count = static_cast<double>(std::max<std::size_t>(error.count, 1));
        data.errors.push_back({std::sqrt(error.squares / count), error.most});
    }
    return data;
}

}  // namespace

}  // namespace subvol::detail

namespace subvol {

using namespace detail;

namespace {

constexpr double kOpacityUnitsPerDiagonal = 100;

std::string_view embedded(std::string_view name) {
    return std::ranges::find(kTexts, name, &EmbeddedText::name)->text;
}

PageJson json_of(const Vec3& v) {
    return {v.x, v.y, v.z};
}

/// A number with as many digits as a picture can show.
double short_number(double value) {
    return std::round(value * 1e5) / 1e5;
}

PageJson json_of(const TransferFunction& function) {
    PageJson json;
    for (const auto& knot : function.color) {
        json["color"].push_back({knot.value, short_number(knot.rgb.x), short_number(knot.rgb.y), short_number(knot.rgb.z)});
    }
    for (const auto& knot : function.opacity) json["opacity"].push_back({knot.value, knot.alpha});
    return json;
}

/// The colours that a reader of the page can choose from, over [0,1].
PageJson presets() {
    PageJson json;
    for (const std::string& name : color_map_names()) {
        json[name] = json_of(transfer_function_preset(name, 0, 1))["color"];
    }
    return json;
}

void refuse(const std::string& problem, const PageStep& step, const char* allowed) {
    throw Error(ErrorCode::InvalidInput, problem, step.label.empty() ? "a page" : "step " + step.label, allowed);
}

void check(const PageStep& step, const PageOptions& options) {
    validate(step.volume);
    if (step.volume.size() == 0) refuse("there are no kernels", step, "at least one");
    if (!std::holds_alternative<CompactKernel>(step.volume.kernel)) {
        refuse("a page draws the compact kernel only", step, "kernels without --kernel");
    }
    if (step.volume.channels.size() != options.fields.size() || step.boundary.values.size() != options.fields.size()) {
        refuse("there are " + std::to_string(step.volume.channels.size()) + " channels and values of " +
                   std::to_string(step.boundary.values.size()) + " fields on the boundary for " +
                   std::to_string(options.fields.size()) + " fields",
               step, "as many of each");
    }
    for (const RbfChannel& channel : step.volume.channels) {
        if (!channel.hessians.empty()) refuse("a page draws no kernels with Hessians", step, "the correction 'second'");
    }
    if (step.boundary.surface.triangles.empty()) refuse("the volume has no boundary", step, "a page clips at one");
    for (const auto& values : step.boundary.values) {
        if (values.size() != step.boundary.surface.points.size()) refuse("a point of the boundary has no value", step, "");
    }
}

PageJson camera_json(const Camera& camera) {
    return {{"eye", json_of(camera.eye)},
            {"target", json_of(camera.target)},
            {"up", json_of(camera.up)},
            {"fovy", camera.fovy_deg},
            {"ortho", camera.ortho_height}};
}

PageJson light_json(const Shading& shading) {
    return {{"material", {shading.ambient, shading.diffuse, shading.specular, shading.shininess}},
            {"head", shading.head},
            {"key", json_of(glm::normalize(shading.key))}};
}

PageJson head_json(std::span<const PageStep> steps, const PageOptions& options) {
    Box box;
    for (const PageStep& step : steps) {
        for (const Vec3& p : step.boundary.surface.points) box.add(p);
    }
    const double unit = options.opacity_unit_world > 0 ? options.opacity_unit_world : box.diagonal() / kOpacityUnitsPerDiagonal;
    PageJson json{{"version", SUBVOL_VERSION},
                  {"title", options.title},
                  {"source", options.source},
                  {"look", name_of(options.look)},
                  {"solid", options.solid},
                  {"background", json_of(options.background)},
                  {"camera", camera_json(options.camera)},
                  {"up", std::string(name_of(options.up))},
                  {"opacityUnit", unit},
                  {"bounds", {json_of(box.lower), json_of(box.upper)}},
                  {"light", {{"colors", light_json(Shading{})}, {"plain", light_json(plain_shading())}}},
                  {"presets", presets()}};
    for (const PageField& field : options.fields) {
        PageJson entry = json_of(field.function);
        entry["name"] = field.name;
        entry["unit"] = field.unit;
        entry["min"] = field.min;
        entry["max"] = field.max;
        json["fields"].push_back(std::move(entry));
    }
    if (options.reference) {
        const Image& image = *options.reference;
        json["reference"] = {
            {"width", image.width}, {"height", image.height}, {"png", base64(png_bytes(image, options.background))}};
    }
    return json;
}

/// JSON between <script> and </script>: no text of it may end the element, or begin a comment in it, so there is no `<`.
std::string inside_script(const PageJson& json) {
    std::string text;
    for (const char c : json.dump(-1, ' ', false, PageJson::error_handler_t::replace)) {
        if (c == '<') {
            text += "\\u003c";
        } else {
            text += c;
        }
    }
    return text;
}

/// All that runs on the page.
std::string page_script() {
    std::string script = "\n'use strict';\n";
    for (const char* name :
         {"page_data", "page_transfer", "page_camera", "page_gl", "page_draw", "page_pick", "page_editor", "page_main"}) {
        script += embedded(name);
    }
    return script;
}

std::string facts_html(const PageOptions& options, const PageData& data, const PageRounding& rounding) {
    std::string html;
    const auto fact = [&](const std::string& name, const std::string& value) {
        html += "<dt>" + xml_escaped(name) + "</dt><dd>" + xml_escaped(value) + "</dd>\n";
    };
    fact("File", options.source);
    for (const auto& [name, value] : options.facts) fact(name, value);
    fact("Kernels", data.kept == data.kernels ? std::to_string(data.kept)
                                              : std::to_string(data.kept) + ", merged from " + std::to_string(data.kernels) +
                                                    " to fit into the page");
    fact("Boundary", std::to_string(data.triangles) + " triangles");
    std::string errors;
    for (std::size_t f = 0; f < data.errors.size(); ++f) {
        const PageField& field = options.fields[f];
        const double range = field.max > field.min ? field.max - field.min : 1;
        errors += (f ? "; " : "") + field.name + " " + number_text(std::round(1e6 * data.errors[f].rmse / range) / 1e4) +
                  " % of its range (root mean square; at most " +
                  number_text(std::round(1e6 * data.errors[f].max_abs / range) / 1e4) + " %)";
    }
    fact("Error of rounding" + std::string(rounding.kept < 1 ? " and merging" : ""), errors);
    fact("Made by", std::string("OpenSubVol ") + SUBVOL_VERSION);
    return html;
}

std::string page_html(const PageOptions& options, PageJson json, const PageData& data, const PageRounding& rounding) {
    json.update(data.json);
    const std::string script = page_script(), style = "\n" + std::string(embedded("page_style"));
    std::string html = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n" + html_policy(script, style);
    html +=
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"generator\" content=\"OpenSubVol " SUBVOL_VERSION "\">\n<title>";
    html += xml_escaped(options.title) + "</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>" + style +
            "</style>\n</head>\n<body>\n";
    std::string_view body = embedded("page_body");
    const auto fill = [&](std::string_view mark, const std::string& text) {
        const std::size_t at = body.find(mark);
        html += std::string(body.substr(0, at)) + text;
        body.remove_prefix(at + mark.size());
    };
    fill("{title}", xml_escaped(options.title));
    fill("{facts}", facts_html(options, data, rounding));
    html += body;
    for (const EmbeddedText& text : kTexts) {
        if (!text.name.ends_with("_vert") && !text.name.ends_with("_frag") && !text.name.ends_with("_glsl")) continue;
        html += "<script type=\"x-shader\" id=\"" + std::string(text.name) + "\">" + std::string(text.text) + "</script>\n";
    }
    html += "<script type=\"application/json\" id=\"head\">" + inside_script(json) + "</script>\n";
    html += "<script type=\"text/plain\" id=\"bytes\">" + base64(data.compressed) + "</script>\n<script>" + script;
    return html + "</script>\n</body>\n</html>\n";
}

}  // namespace

PageResult make_page(std::span<const PageStep> steps, const PageOptions& options) {
    if (options.look == PageLook::Solid && !options.solid)
        throw Error(ErrorCode::InvalidInput, "fog has no look Solid", "a page", "Volume or Xray");
    if (steps.empty() || options.fields.empty()) {
        throw Error(ErrorCode::InvalidInput, steps.empty() ? "a page has no step" : "a page has no field", {}, "at least one");
    }
    for (const PageStep& step : steps) check(step, options);
    const PageJson head = head_json(steps, options);

    // First fewer bits, which cost little; then fewer kernels, as many as fit.
    PageRounding rounding;
    std::string html;
    PageData data;
    constexpr int kTries = 12;
    double last_kept = 0, last_bytes = 0;
    for (int attempt = 0;; ++attempt) {
        report_progress(options.progress, "page", attempt / static_cast<double>(kTries));
        data = page_data(steps, options.fields.size(), rounding, false);
        html = page_html(options, head, data, rounding);
        constexpr std::size_t kErrorText = 200;  // the errors, which are not known yet
        const std::size_t bytes = html.size() + kErrorText * options.fields.size();
        if (bytes <= options.max_bytes) break;
        const double least = 8.0 / static_cast<double>(steps.front().volume.size());
        if (attempt == kTries || rounding.kept <= least) {
            throw Error(ErrorCode::InvalidInput,
                        "the page needs " + std::to_string(bytes) + " bytes even with few kernels: its boundary has " +
                            std::to_string(data.triangles) + " triangles",
                        "--max-bytes " + std::to_string(options.max_bytes), "more bytes, fewer fields or fewer steps");
        }
        if (attempt == 0) {
            rounding.place_bits = 16;
            rounding.value_bits = 12;
        } else {
            // Bytes are nearly linear in the kernels; the first guess is that there is nothing else.
            const double now = static_cast<double>(bytes), most = 0.98 * static_cast<double>(options.max_bytes);
            const bool known = last_kept > rounding.kept && last_bytes > now;
            const double slope = known ? (last_bytes - now) / (last_kept - rounding.kept) : now / rounding.kept;
            last_kept = rounding.kept;
            last_bytes = now;
            rounding.kept = std::clamp(rounding.kept + (most - now) / slope, least, std::max(least, 0.97 * rounding.kept));
        }
    }
    data = page_data(steps, options.fields.size(), rounding, true);
    PageResult result;
    result.html = page_html(options, head, data, rounding);
    result.report = {.bytes = result.html.size(),
                     .bits = rounding.value_bits,
                     .kernels = data.kernels,
                     .kept = data.kept,
                     .triangles = data.triangles,
                     .errors = data.errors};
    return result;
}

}  // namespace subvol
