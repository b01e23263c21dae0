// SPDX-License-Identifier: Apache-2.0
#include "subvol/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "page_data.h"
#include "page_kernels.h"
#include "page_texts.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/text_codes.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/version.h"

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
    for (const char* name : {"viridis", "plasma", "inferno", "cividis", "turbo", "coolwarm", "grey", "bone"}) {
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
                  {"background", json_of(options.background)},
                  {"camera", camera_json(options.camera)},
                  {"opacityUnit", unit},
                  {"bounds", {json_of(box.lower), json_of(box.upper)}},
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
        json["reference"] = {{"width", image.width},
                             {"height", image.height},
                             {"png", base64(png_bytes(image.width, image.height, srgb_bytes(image, options.background)))}};
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
