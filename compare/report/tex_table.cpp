// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <string_view>

#include "subvol/study_table.h"

namespace subvol {

namespace {

struct Sign {
    std::string_view text, tex;
};

// What LaTeX reads otherwise, and what its default fonts lack.
constexpr std::array<Sign, 32> kSigns{{{"\\", "\\textbackslash{}"},
                                       {"{", "\\{"},
                                       {"}", "\\}"},
                                       {"$", "\\$"},
                                       {"&", "\\&"},
                                       {"#", "\\#"},
                                       {"%", "\\%"},
                                       {"_", "\\_"},
                                       {"^", "\\textasciicircum{}"},
                                       {"~", "\\textasciitilde{}"},
                                       {"<", "\\textless{}"},
                                       {">", "\\textgreater{}"},
                                       {"≤", "$\\leq$"},
                                       {"≥", "$\\geq$"},
                                       {"∞", "$\\infty$"},
                                       {"−", "$-$"},
                                       {"–", "--"},
                                       {"×", "$\\times$"},
                                       {"·", "$\\cdot$"},
                                       {"⁰", "$^0$"},
                                       {"¹", "$^1$"},
                                       {"²", "$^2$"},
                                       {"³", "$^3$"},
                                       {"⁴", "$^4$"},
                                       {"⁵", "$^5$"},
                                       {"⁶", "$^6$"},
                                       {"⁷", "$^7$"},
                                       {"⁸", "$^8$"},
                                       {"⁹", "$^9$"},
                                       {"⁻", "$^-$"},
                                       {"½", "$\\frac12$"},
                                       {"…", "\\dots{}"}}};

}  // namespace

std::string tex_text(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const Sign* found = nullptr;
        for (const Sign& sign : kSigns) {
            if (text.starts_with(sign.text)) found = &sign;
        }
        if (found) {
            out += found->tex;
            text.remove_prefix(found->text.size());
        } else {
            out += text.front();
            text.remove_prefix(1);
        }
    }
    return out;
}

std::string as_tex(const StudyTable& table) {
    std::string columns;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
        bool words = false;
        for (const auto& row : table.rows) words = words || std::holds_alternative<std::string>(row[c]);
        columns += words ? 'l' : 'r';
    }
    std::string text =
        "% \\usepackage{booktabs}, and \\usepackage{graphicx} for wide tables\n\\begin{table}\n\\centering\n\\caption{" +
        tex_text(table.title) + (table.caption.empty() ? "" : ". " + tex_text(table.caption)) + "}\n\\label{tab:" + table.name +
        "}\n";
    constexpr std::size_t kNarrow = 6;  // wider tables are scaled to the width of the text
    const bool wide = table.columns.size() > kNarrow;
    text += std::string(wide ? "\\resizebox{\\linewidth}{!}{%\n" : "") + "\\begin{tabular}{" + columns + "}\n\\toprule\n";
    const auto line = [&](const auto& cell) {
        for (std::size_t c = 0; c < table.columns.size(); ++c) text += (c > 0 ? " & " : "") + tex_text(cell(c));
        text += " \\\\\n";
    };
    line([&](std::size_t c) { return table.columns[c]; });
    text += "\\midrule\n";
    for (std::size_t r = 0; r < table.rows.size(); ++r) line([&](std::size_t c) { return shown(table, r, c); });
    return text + "\\bottomrule\n\\end{tabular}" + (wide ? "}" : "") + "\n\\end{table}\n";
}

}  // namespace subvol
