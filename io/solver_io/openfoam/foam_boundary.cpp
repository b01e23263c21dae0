// SPDX-License-Identifier: Apache-2.0
// What fields are on patches. An entry of the boundaryField has a key, which is the name of a patch, of a group of patches, or
// a pattern in quotation marks, and a type. Solvers write a `value` for each face: what they compute with there. It counts
// whatever the type, but for these:
//
//     zeroGradient, extrapolatedCalculated     only repeat the cell's value: nothing changes across the face
//     …WallFunction                            a number by which a model gets its stress, not what the field is there
//     slip, symmetry, symmetryPlane            a vector has no component along the normal
//     empty, wedge, cyclic…, processor…        no boundary of the body
#include <algorithm>
#include <array>
#include <cmath>
#include <regex>
#include <tuple>
#include <utility>

#include "foam_text.h"

namespace subvol::detail {

/// An entry of the boundaryField. values: of each face, or one tuple for all
struct FoamText::PatchEntry {
    std::string key, type;
    bool uniform = false;
    std::vector<double> values;
};

namespace {

bool is_along(std::string_view type) {
    return type == "slip" || type == "basicSymmetry" || type.starts_with("symmetry");
}

bool is_one_of(std::string_view type, std::initializer_list<std::string_view> types) {
    return std::ranges::find(types, type) != types.end();
}

bool has_no_value(std::string_view type) {
    return is_along(type) || is_one_of(type, {"zeroGradient", "extrapolatedCalculated", "empty", "wedge"}) ||
           type.starts_with("cyclic") || type.starts_with("processor") || type.find("WallFunction") != std::string_view::npos;
}

/// Patterns of names and ".*", and of alternatives of these in parentheses; others match nothing, as their cost has no bound.
bool matches(const std::string& quoted, const std::string& name) {
    constexpr std::size_t kLongest = 128;
    constexpr std::ptrdiff_t kMostStars = 4;
    if (quoted.size() < 2 || quoted.front() != '"' || quoted.back() != '"') return false;
    const std::string pattern = quoted.substr(1, quoted.size() - 2);
    if (pattern.size() > kLongest || name.size() > kLongest) return false;
    if (std::ranges::count(pattern, '*') > kMostStars) return false;
    for (std::size_t k = 0; k < pattern.size(); ++k) {
        const char c = pattern[k];
        const bool word = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        const bool star = c == '*' && k > 0 && pattern[k - 1] == '.';
        if (!word && !star && std::string_view("_-.:()|").find(c) == std::string_view::npos) return false;
    }
    try {
        return std::regex_match(name, std::regex(pattern, std::regex::extended));
    } catch (const std::regex_error&) {
        return false;
    }
}

/// The entry of a patch: by its name, else by the last of its groups, else by the last pattern.
template <class Entry>
const Entry* entry_of(const std::vector<Entry>& entries, const FoamPatch& patch) {
    for (const Entry& entry : entries) {
        if (entry.key == patch.name) return &entry;
    }
    for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
        if (std::ranges::find(patch.groups, entry->key) != patch.groups.end()) return &*entry;
    }
    for (auto entry = entries.rbegin(); entry != entries.rend(); ++entry) {
        if (matches(entry->key, patch.name)) return &*entry;
    }
    return nullptr;
}

/// Components of the entries of a list, by its type: List<vector>.
std::size_t components_of_list(std::string_view type) {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 5> kTypes{
        {{"List<scalar>", 1}, {"List<vector>", 3}, {"List<symmTensor>", 6}, {"List<tensor>", 9}, {"List<sphericalTensor>", 1}}};
    const auto found = std::ranges::find(kTypes, type, &std::pair<std::string_view, std::size_t>::first);
    return found == kTypes.end() ? 0 : found->second;
}

}  // namespace

void FoamText::skip_entry() {
    int open = 0;
    for (std::string_view word = token(); word != ";" || open > 0; word = token()) {
        if (word.empty()) fail("an entry does not end");
        if (word == "#" && text_.substr(next_, 1) == "{") {  // code
            next_ = std::min(text_.find("#}", next_), text_.size() - 2) + 2;
            continue;
        }
        const std::size_t components = binary_ ? components_of_list(word) : 0;
        if (components > 0) {
            const std::size_t entries = count(components * size_of(real_type()));
            if (entries == 0) continue;
            if (token() != "(") fail("a list is expected");
            std::ignore = bytes(entries * components * size_of(real_type()));
            expect(")");
            continue;
        }
        if (word == "{" || word == "(" || word == "[") ++open;
        if (word == "}" || word == ")" || word == "]") --open;
        if (open < 0) fail("an entry does not end");
        if (word == "}" && open == 0) return;
    }
}

// The value of an entry, to behind its semicolon.
std::vector<double> FoamText::patch_value(std::size_t components, bool& uniform) {
    std::vector<double> values;
    skip_space();
    const std::size_t begin = next_;
    std::string_view kind = token();
    if (kind.starts_with('$')) {
        const std::size_t end = std::min(text_.find(';', begin), text_.size());
        if (kind == "$internalField" && !entries_.contains("internalField")) {  // of each cell: as zeroGradient
            next_ = end;
            expect(";");
            return {};
        }
        const std::string whole = std::exchange(text_, expanded(text_.substr(begin, end - begin)) + ";");
        next_ = 0;
        values = patch_value(components, uniform);
        text_ = whole;
        next_ = end;
        expect(";");
        return values;
    }
    uniform = kind == "uniform";
    if (uniform) {
        values = uniform_value(components);
    } else {
        if (kind != "nonuniform") fail("the value is " + in_quotes(std::string(kind)), "uniform or nonuniform");
        skip_space();
        if (next_ < text_.size() && (text_[next_] < '0' || text_[next_] > '9')) std::ignore = token();  // List<vector>
        skip_space();
        const std::size_t digits = next_;
        if (label() == 0) {
            skip_space();
            if (text_.substr(next_, 1) == "(") expect("("), expect(")");
        } else {
            next_ = digits;
            values = reals(components);
        }
    }
    expect(";");
    if (!std::ranges::all_of(values, [](double value) { return std::isfinite(value); })) fail("a value is not finite");
    return values;
}

FoamText::PatchEntry FoamText::patch_entry(std::string key, std::size_t components) {
    PatchEntry entry{std::move(key), {}, false, {}};
    expect("{");
    for (std::string word(token()); word != "}"; word = token()) {
        if (word.empty()) fail("the entry of patch " + in_quotes(entry.key) + " does not end");
        if (word.starts_with('#')) {
            std::ignore = token();  // the name of a file
        } else if (word == "type") {
            entry.type = token();
            expect(";");
        } else if (word == "value") {
            entry.values = patch_value(components, entry.uniform);
        } else {
            skip_entry();
        }
    }
    return entry;
}

std::vector<FoamOnPatch> FoamText::boundary_field(std::size_t components, std::span<const FoamPatch> patches) {
    std::vector<FoamOnPatch> on_patches(patches.size());
    for (std::string_view word = token(); word != "boundaryField"; word = token()) {
        if (word.empty()) return on_patches;
    }
    std::vector<PatchEntry> entries;
    expect("{");
    for (std::string key(token()); key != "}"; key = token()) {
        if (key.empty()) fail("the boundaryField does not end");
        if (key.starts_with('#')) {
            std::ignore = token();
        } else if (key.starts_with('$')) {
            skip_entry();
        } else {
            entries.push_back(patch_entry(std::move(key), components));
        }
    }
    for (std::size_t k = 0; k < patches.size(); ++k) {
        const PatchEntry* entry = entry_of(entries, patches[k]);
        if (entry == nullptr) continue;
        on_patches[k].along = is_along(entry->type) && components == 3;
        on_patches[k].level = is_one_of(entry->type, {"zeroGradient", "extrapolatedCalculated", "kqRWallFunction"}) ||
                              (is_along(entry->type) && components == 1);
        if (has_no_value(entry->type)) continue;
        const auto faces = static_cast<std::size_t>(patches[k].count);
        std::vector<double>& values = on_patches[k].values;
        if (entry->type == "noSlip") {
            values.assign(faces * components, 0);
        } else if (entry->uniform) {
            for (std::size_t f = 0; f < faces; ++f) values.insert(values.end(), entry->values.begin(), entry->values.end());
        } else if (!entry->values.empty() && entry->values.size() != faces * components) {
            fail(
                "patch " + in_quotes(patches[k].name) + " has " + counted(entry->values.size() / components, "value", "values"),
                counted(faces, "face", "faces"));
        } else {
            values = entry->values;
        }
        if (entry->type == "fixedValue" && faces > 0 && values.empty())
            fail("patch " + in_quotes(patches[k].name) + " of type fixedValue has no value");
    }
    return on_patches;
}

}  // namespace subvol::detail
