// SPDX-License-Identifier: Apache-2.0
#include "pdf_canvas.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"

namespace subvol::detail {

namespace {

constexpr double kCircle = .5523;  // of the radius: where the control points of a quarter of a circle lie
constexpr double kMarker = 3.4;

/// "#0072b2" as "0 .45 .7".
std::string rgb(const std::string& color) {
    std::string numbers;
    for (std::size_t i = 1; i + 1 < color.size(); i += 2) {
        numbers += fixed_text(static_cast<double>(std::stoi(color.substr(i, 2), nullptr, 16)) / 255, 3) + " ";
    }
    return numbers;
}

std::string stream(const std::string& dictionary, const std::string& bytes) {
    return "<< " + dictionary + " /Length " + std::to_string(bytes.size()) + " >>\nstream\n" + bytes + "endstream";
}

// Helvetica's advances of the characters from 32 to 126, in 1/1000 em.
constexpr std::array<int, 95> kAdvances{
    278, 278, 355, 556, 556, 889, 667, 191, 333,  333, 389, 584, 278, 333, 278, 278, 556, 556, 556, 556, 556, 556, 556, 556,
    556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778,
    667, 778, 722, 667, 611, 722, 667, 944, 667,  667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278, 556,
    556, 222, 222, 500, 222, 833, 556, 556, 556,  556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584};

enum class Face { Plain, Raised, Symbol };  // Helvetica, the same small and raised, and the font Symbol

/// What is not ASCII: bytes of the font's encoding with their advance.
struct Special {
    std::string_view utf8, bytes;
    int advance;
    Face face = Face::Plain;
};
constexpr std::array<Special, 31> kSpecials{{{"≤", "\\243", 549, Face::Symbol},
                                             {"≥", "\\263", 549, Face::Symbol},
                                             {"≈", "\\273", 549, Face::Symbol},
                                             {"∞", "\\245", 713, Face::Symbol},
                                             {"√", "\\326", 549, Face::Symbol},
                                             {"α", "a", 631, Face::Symbol},
                                             {"ε", "e", 439, Face::Symbol},
                                             {"λ", "l", 549, Face::Symbol},
                                             {"π", "p", 549, Face::Symbol},
                                             {"ρ", "r", 549, Face::Symbol},
                                             {"σ", "s", 603, Face::Symbol},
                                             {"Δ", "D", 612, Face::Symbol},
                                             {"·", "\\267", 278},
                                             {"×", "\\327", 584},
                                             {"–", "\\226", 556},
                                             {"−", "-", 333},
                                             {"°", "\\260", 400},
                                             {"µ", "\\265", 556},
                                             {"½", "\\275", 834},
                                             {"…", "\\205", 1000},
                                             {"⁰", "0", 556, Face::Raised},
                                             {"¹", "1", 556, Face::Raised},
                                             {"²", "2", 556, Face::Raised},
                                             {"³", "3", 556, Face::Raised},
                                             {"⁴", "4", 556, Face::Raised},
                                             {"⁵", "5", 556, Face::Raised},
                                             {"⁶", "6", 556, Face::Raised},
                                             {"⁷", "7", 556, Face::Raised},
                                             {"⁸", "8", 556, Face::Raised},
                                             {"⁹", "9", 556, Face::Raised},
                                             {"⁻", "-", 333, Face::Raised}}};
constexpr double kRaised = .65;  // of the font's size

/// A part of a text that is set at once. width: of an em of the text's size
struct Run {
    std::string bytes;
    double width = 0;
    Face face = Face::Plain;
};

std::vector<Run> runs_of(std::string_view utf8) {
    std::vector<Run> runs;
    const auto add = [&](const std::string& bytes, int advance, Face face) {
        if (runs.empty() || runs.back().face != face) runs.push_back({.bytes = {}, .width = 0, .face = face});
        runs.back().bytes += bytes;
        runs.back().width += advance / 1000. * (face == Face::Raised ? kRaised : 1);
    };
    while (!utf8.empty()) {
        const auto byte = static_cast<unsigned char>(utf8.front());
        const auto* special = std::ranges::find_if(kSpecials, [&](const Special& s) { return utf8.starts_with(s.utf8); });
        if (special != kSpecials.end()) {
            add(std::string(special->bytes), special->advance, special->face);
            utf8.remove_prefix(special->utf8.size());
        } else if (byte >= 32 && byte < 127) {
            const bool escaped = byte == '(' || byte == ')' || byte == '\\';
            add((escaped ? "\\" : "") + std::string(1, utf8.front()), kAdvances[byte - 32U], Face::Plain);
            utf8.remove_prefix(1);
        } else if ((byte == 0xC2 || byte == 0xC3) && utf8.size() > 1) {  // a letter of Latin-1: most are as wide as a digit
            const unsigned code = (byte & 3U) << 6U | (static_cast<unsigned char>(utf8[1]) & 0x3FU);
            add({'\\', static_cast<char>('0' + (code >> 6U)), static_cast<char>('0' + (code >> 3U & 7U)),
                 static_cast<char>('0' + (code & 7U))},
                kAdvances['0' - ' '], Face::Plain);
            utf8.remove_prefix(2);
        } else {
            add("?", kAdvances['?' - ' '], Face::Plain);
            do {
                utf8.remove_prefix(1);
            } while (!utf8.empty() && (static_cast<unsigned char>(utf8.front()) & 0xC0U) == 0x80);
        }
    }
    return runs;
}

/// As UTF-16, which PDF's texts may be in: all characters appear right.
std::string title_hex(const std::string& utf8) {
    constexpr const char* kDigits = "0123456789ABCDEF";
    std::string hex = "<FEFF";
    for (std::size_t i = 0; i < utf8.size();) {
        const auto lead = static_cast<unsigned char>(utf8[i]);
        const std::size_t more = lead < 0x80 ? 0 : lead < 0xe0 ? 1 : lead < 0xf0 ? 2 : 3;
        unsigned code = lead < 0x80 ? lead : lead & (0x3fU >> more);
        for (std::size_t k = 1; k <= more && i + k < utf8.size(); ++k)
            code = code << 6U | (static_cast<unsigned char>(utf8[i + k]) & 0x3fU);
        if (code > 0xffff) code = '?';
        for (int shift = 12; shift >= 0; shift -= 4) hex += kDigits[code >> static_cast<unsigned>(shift) & 0xfU];
        i += more + 1;
    }
    return hex + ">";
}

}  // namespace

std::string PdfCanvas::at(const Vec2& place) const {
    return coordinate(place.x) + " " + coordinate(size_.y - place.y);
}

void PdfCanvas::grid(const Vec2& from, const Vec2& to) {
    page_ += ".886 G 1 w " + at(from) + " m " + at(to) + " l S\n";
}

void PdfCanvas::frame(const Vec2& corner, const Vec2& size) {
    page_ += ".467 G 1 w " + at(corner + Vec2(0, size.y)) + " " + coordinate(size.x) + " " + coordinate(size.y) + " re S\n";
}

std::string PdfCanvas::marker(std::size_t shape, const Vec2& place) const {
    const auto polygon = [&](const std::vector<Vec2>& corners) {
        std::string path;
        for (const Vec2& corner : corners) path += at(place + corner) + (path.empty() ? " m " : " l ");
        return path + "b\n";
    };
    switch (shape % 4) {
        case 0: {
            constexpr double r = kMarker, k = kCircle * kMarker;
            std::string path = at(place + Vec2(r, 0)) + " m ";
            const auto quarter = [&](const Vec2& a, const Vec2& b, const Vec2& c) {
                path += at(place + a) + " " + at(place + b) + " " + at(place + c) + " c ";
            };
            quarter({r, k}, {k, r}, {0, r});
            quarter({-k, r}, {-r, k}, {-r, 0});
            quarter({-r, -k}, {-k, -r}, {0, -r});
            quarter({k, -r}, {r, -k}, {r, 0});
            return path + "b\n";
        }
        case 1:
            return polygon({{-3.2, -3.2}, {3.2, -3.2}, {3.2, 3.2}, {-3.2, 3.2}});
        case 2:
            return polygon({{0, -4.2}, {4, 2.8}, {-4, 2.8}});
        default:
            return polygon({{0, -4.4}, {4.2, 0}, {0, 4.4}, {-4.2, 0}});
    }
}

void PdfCanvas::series(const Series& series) {
    page_ += "q " + rgb(series.color) + "RG " + rgb(series.color) + "rg 1.8 w 1 j" + (series.dashed ? " [5 3] 0 d" : "") + "\n";
    for (const auto& strand : series.strands) {
        if (strand.size() < 2) continue;
        for (std::size_t i = 0; i < strand.size(); ++i) page_ += at(strand[i]) + (i == 0 ? " m\n" : " l\n");
        page_ += "S\n";
    }
    page_ += "1 w [] 0 d\n";
    for (const Vec2& place : series.markers) page_ += marker(series.shape, place);
    page_ += "Q\n";
}

void PdfCanvas::text(const Vec2& place, Anchor anchor, const std::string& words, double size, bool upward) {
    const std::vector<Run> runs = runs_of(words);
    double width = 0;
    for (const Run& run : runs) width += run.width;
    const double back = anchor == Anchor::Start ? 0 : anchor == Anchor::Middle ? width / 2 : width;
    page_ += "q .11 g " + std::string(upward ? "0 1 -1 0 " : "1 0 0 1 ") + at(place) + " cm BT " + coordinate(-back * size) +
             " 0 Td\n";
    for (const Run& run : runs) {
        const bool raised = run.face == Face::Raised;
        page_ += (run.face == Face::Symbol ? "/S " : "/F ") + coordinate(raised ? kRaised * size : size) + " Tf " +
                 coordinate(raised ? .38 * size : 0) + " Ts (" + run.bytes + ") Tj\n";
    }
    page_ += "ET Q\n";
}

std::string PdfCanvas::file(const std::string& title) const {
    const std::vector<std::string> objects{"<< /Type /Catalog /Pages 2 0 R >>",
                                           "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
                                           "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 " + coordinate(size_.x) + " " +
                                               coordinate(size_.y) +
                                               "] /Contents 4 0 R /Resources << /Font << /F 6 0 R /S 7 0 R >> >> >>",
                                           stream("", page_),
                                           "<< /Title " + title_hex(printable(title)) + " /Producer (OpenSubVol) >>",
                                           "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>",
                                           "<< /Type /Font /Subtype /Type1 /BaseFont /Symbol >>"};
    std::string file = "%PDF-1.4\n%\xe2\xe3\xcf\xd3\n";
    std::string places;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        std::string place = std::to_string(file.size());
        places += std::string(10 - place.size(), '0') + place + " 00000 n \n";
        file += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
    }
    const std::string count = std::to_string(objects.size() + 1), table = std::to_string(file.size());
    return file + "xref\n0 " + count + "\n0000000000 65535 f \n" + places + "trailer\n<< /Size " + count +
           " /Root 1 0 R /Info 5 0 R >>\nstartxref\n" + table + "\n%%EOF\n";
}

}  // namespace subvol::detail
