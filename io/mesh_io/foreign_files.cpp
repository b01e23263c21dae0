// SPDX-License-Identifier: Apache-2.0
// The converter is a program in Python, embedded by the build: python/subvol/_foreign_file.py. Its list of formats is text in
// JSON between two marks, which is read here, so that there is one list.
#include "subvol/foreign_files.h"

#include <algorithm>
#include <cctype>
#include <mutex>
#include <nlohmann/json.hpp>

#include "foreign_texts.h"
#include "formats.h"
#include "subvol/detail/refuse_surface.h"

namespace subvol {

using namespace detail;

namespace {

constexpr std::string_view kListBegins = "json.loads(\"\"\"", kListEnds = "\"\"\")";

std::string in_lower_case(std::string text) {
    std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

ForeignFormat format_of_row(const nlohmann::json& row) {
    ForeignFormat format{row.at("endings"), row.at("program"), {}, {}, row.value("steps", false)};
    const auto add = [&](const char* reader, const std::string& package) {
        format.by += (format.by.empty() ? "" : " or ") + std::string(reader);
        format.packages += (format.packages.empty() ? "" : ", ") + package;
    };
    if (row.contains("meshio")) add("meshio", "python3-meshio");
    if (row.contains("vtk")) add("VTK", "python3-vtk9");
    for (const std::string package : row.value("packages", nlohmann::json::array())) format.packages += ", " + package;
    return format;
}

ForeignReader& reader() {
    static ForeignReader chosen;
    return chosen;
}

// The times of the file that was read last: they are asked for before and after a step is read.
struct LastTimes {
    std::mutex mutex;
    std::filesystem::path path;
    std::filesystem::file_time_type written;
    std::vector<double> times;
};

LastTimes& last_times() {
    static LastTimes last;
    return last;
}

void keep_times(const std::filesystem::path& path, const std::vector<double>& times) {
    std::error_code none;
    const auto written = std::filesystem::last_write_time(path, none);
    LastTimes& last = last_times();
    const std::scoped_lock lock(last.mutex);
    last.path = none ? std::filesystem::path() : path;
    last.written = written;
    last.times = times;
}

std::vector<double> foreign_times(const std::filesystem::path& path) {
    refuse_missing(path);
    {
        std::error_code none;
        const auto written = std::filesystem::last_write_time(path, none);
        LastTimes& last = last_times();
        const std::scoped_lock lock(last.mutex);
        if (!none && last.path == path && last.written == written) return last.times;
    }
    std::vector<double> times = reader()(path, {.only_times = true}).times;
    keep_times(path, times);
    return times;
}

ReadResult read_foreign(const std::filesystem::path& path, const ReadOptions& options) {
    refuse_missing(path);
    const ForeignFile file = reader()(path, {.step = options.step});
    keep_times(path, file.times);
    ReadOptions of_step = options;
    of_step.step.reset();
    of_step.time.reset();
    ReadResult result = read_vtu(file.vtu, path.string(), of_step);
    result.warnings.insert(result.warnings.begin(), file.warnings.begin(), file.warnings.end());
    if (!options.step && file.times.size() > 1) {
        result.warnings.push_back("the file has " + std::to_string(file.times.size()) + " steps; the last one is read");
    }
    return result;
}

constexpr MeshFormat kOneStep{.extensions = {}, .name = "another program", .read = read_foreign};
constexpr MeshFormat kSteps{.extensions = {}, .name = "another program", .read = read_foreign, .times = foreign_times};

}  // namespace

std::string_view foreign_program() {
    return kTexts[0].text;
}

const std::vector<ForeignFormat>& foreign_formats() {
    static const std::vector<ForeignFormat> formats = [] {
        const std::string_view text = foreign_program();
        const std::size_t begin = text.find(kListBegins) + kListBegins.size();
        std::vector<ForeignFormat> found;
        for (const auto& row : nlohmann::json::parse(text.substr(begin, text.find(kListEnds, begin) - begin)))
            found.push_back(format_of_row(row));
        return found;
    }();
    return formats;
}

const ForeignFormat* foreign_format(const std::filesystem::path& path) {
    const std::string extension = in_lower_case(path.extension().string()), name = in_lower_case(path.filename().string());
    const auto has_it = [&](const ForeignFormat& format) {
        return std::ranges::any_of(format.endings,
                                   [&](const std::string& ending) { return ending == extension || ending == name; });
    };
    const auto found = std::ranges::find_if(foreign_formats(), has_it);
    return found == foreign_formats().end() ? nullptr : &*found;
}

void read_foreign_files(ForeignReader chosen) {
    reader() = std::move(chosen);
}

const MeshFormat* detail::foreign_row(const std::filesystem::path& path) {
    if (!reader()) return nullptr;
    const ForeignFormat* format = foreign_format(path);
    if (format == nullptr) return nullptr;
    return format->steps ? &kSteps : &kOneStep;
}

}  // namespace subvol
