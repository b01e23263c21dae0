// SPDX-License-Identifier: Apache-2.0
#include <string>

#include "subvol/detail/atomic_file.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/vtk_xml_writer.h"
#include "subvol/error.h"
#include "subvol/quantity.h"
#include "subvol/streamlines.h"

namespace subvol {
namespace {

/// A name as a cell of a table.
std::string cell_of_table(const std::string& name) {
    if (name.find_first_of(",\"\n") == std::string::npos) return name;
    std::string quoted = "\"";
    for (const char c : name) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

void write_table(const std::filesystem::path& path, const Streamlines& lines) {
    using detail::exact_text;
    std::string table = "line,seed,time,x,y,z";
    for (const ProbedField& field : lines.fields) {
        if (field.channels == 1) table += "," + cell_of_table(field.name);
        if (field.channels == 1) continue;
        for (const std::string& part : component_names(static_cast<int>(field.channels)))
            table += "," + cell_of_table(field.name + "." + part);
    }
    table += "\n";
    for (std::size_t i = 0; i < lines.count(); ++i) {
        for (std::size_t p = lines.firsts[i]; p < lines.firsts[i + 1]; ++p) {
            table += std::to_string(i) + "," + std::to_string(lines.seeds[i]) + "," + exact_text(lines.times[p]);
            for (int k = 0; k < 3; ++k) table += "," + exact_text(lines.points[p][k]);
            for (const ProbedField& field : lines.fields) {
                for (std::size_t c = 0; c < field.channels; ++c)
                    table += "," + exact_text(field.values[p * field.channels + c]);
            }
            table += "\n";
        }
    }
    detail::write_text_file(path, table);
}

void write_lines(const std::filesystem::path& path, const Streamlines& lines) {
    detail::OutputFile out(path);
    detail::VtkXmlWriter xml(out, "PolyData");
    const std::size_t points = lines.points.size();
    xml.line("<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfVerts=\"0\" NumberOfLines=\"" +
             std::to_string(lines.count()) + "\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>");
    xml.made_array<double>("Points", 3, 3 * points,
                           [&](std::size_t i) { return lines.points[i / 3][static_cast<int>(i % 3)]; });
    xml.line("</Points>\n<Lines>");
    xml.made_array<std::int64_t>("connectivity", 1, points, [](std::size_t i) { return static_cast<std::int64_t>(i); });
    xml.made_array<std::int64_t>("offsets", 1, lines.count(),
                                 [&](std::size_t i) { return static_cast<std::int64_t>(lines.firsts[i + 1]); });
    xml.line("</Lines>\n<PointData>");
    xml.array<double>("time", 1, lines.times);
    for (const ProbedField& field : lines.fields) xml.array<double>(field.name, field.channels, field.values);
    xml.line("</PointData>\n<CellData>");
    xml.made_array<std::int64_t>("seed", 1, lines.count(),
                                 [&](std::size_t i) { return static_cast<std::int64_t>(lines.seeds[i]); });
    xml.line("</CellData>\n</Piece>");
    xml.end();
    out.commit();
}

}  // namespace

void write_streamlines(const std::filesystem::path& path, const Streamlines& lines) {
    const std::string extension = path.extension().string();
    if (extension == ".csv") return write_table(path, lines);
    if (extension == ".vtp") return write_lines(path, lines);
    throw Error(ErrorCode::InvalidInput, "'" + detail::printable(extension) + "' is not a format of streamlines", path.string(),
                ".vtp, .csv");
}

}  // namespace subvol
