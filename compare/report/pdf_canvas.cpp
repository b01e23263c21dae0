// SPDX-License-Identifier: Apache-2.0
#include "pdf_canvas.h"

#include <vector>

#include "subvol/detail/number_text.h"

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

/// The outline in units of 1/1000 em, y up.
std::string outline(const Glyph& glyph) {
    std::string path;
    for (const auto& polygon : glyph.polygons) {
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            path += fixed_text(1000 * polygon[i].x, 0) + " " + fixed_text(-1000 * polygon[i].y, 0) + (i == 0 ? " m\n" : " l\n");
        }
        path += "h\n";
    }
    return path + "f\n";
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
    const PlacedText placed = place_glyphs(words);
    const double back = anchor == Anchor::Start ? 0 : anchor == Anchor::Middle ? placed.width / 2 : placed.width;
    const std::string turn = upward ? "0 1 -1 0 " : "1 0 0 1 ";
    page_ += "q .11 g " + turn + at(place) + " cm\n";
    for (const PlacedGlyph& letter : placed.glyphs) {
        if (letter.glyph->polygons.empty()) continue;
        const std::size_t number = letters_.try_emplace(letter.glyph, letters_.size()).first->second;
        page_ += "q " + fixed_text(size / 1000, 5) + " 0 0 " + fixed_text(size / 1000, 5) + " " +
                 coordinate((letter.start - back) * size) + " 0 cm /L" + std::to_string(number) + " Do Q\n";
    }
    page_ += "Q\n";
}

std::string PdfCanvas::file(const std::string& title) const {
    constexpr std::size_t kFirstLetter = 6;  // objects before it: catalogue, pages, page, its contents, the title
    std::vector<const Glyph*> letters(letters_.size());
    for (const auto& [glyph, number] : letters_) letters[number] = glyph;
    std::string names;
    for (std::size_t i = 0; i < letters.size(); ++i)
        names += "/L" + std::to_string(i) + " " + std::to_string(kFirstLetter + i) + " 0 R ";
    std::vector<std::string> objects{"<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
                                     "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 " + coordinate(size_.x) + " " +
                                         coordinate(size_.y) + "] /Contents 4 0 R /Resources << /XObject << " + names +
                                         ">> >> >>",
                                     stream("", page_), "<< /Title " + title_hex(title) + " /Producer (OpenSubVol) >>"};
    for (const Glyph* letter : letters) {
        objects.push_back(stream("/Type /XObject /Subtype /Form /BBox [-1000 -1000 3000 2000]", outline(*letter)));
    }
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
