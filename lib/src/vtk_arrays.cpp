#include "vtk_arrays.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>
#include <set>

namespace subvol {

namespace {

// Attribute sections that are laid out alike: KEYWORD name type, then the values.
const std::map<std::string_view, std::size_t> kComponents{
    {"VECTORS", 3}, {"NORMALS", 3}, {"TENSORS", 9}, {"TENSORS6", 6}, {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1}, {"EDGE_FLAGS", 1}};

const std::set<std::string_view> kTypes{"BIT",
                                        "CHAR",
                                        "SIGNED_CHAR",
                                        "UNSIGNED_CHAR",
                                        "SHORT",
                                        "UNSIGNED_SHORT",
                                        "INT",
                                        "UNSIGNED_INT",
                                        "LONG",
                                        "UNSIGNED_LONG",
                                        "FLOAT",
                                        "DOUBLE",
                                        "VTKIDTYPE",
                                        "VTKTYPEINT64",
                                        "VTKTYPEUINT64",
                                        "VTKTYPEINT32",
                                        "VTKTYPEUINT32",
                                        "LONG_LONG",
                                        "UNSIGNED_LONG_LONG"};

int hex_digit(char c) {
    int digit = -1;
    std::from_chars(&c, &c + 1, digit, 16);
    return digit;
}

// VTK writes the odd characters of a name as %20 and the like.
std::string decoded(std::string_view name) {
    std::string result;
    for (std::size_t i = 0; i < name.size(); ++i) {
        const int high = name[i] == '%' && i + 2 < name.size() ? hex_digit(name[i + 1]) : -1;
        const int low = high >= 0 ? hex_digit(name[i + 2]) : -1;
        result += low >= 0 ? static_cast<char>(16 * high + low) : name[i];
        if (low >= 0) i += 2;
    }
    return as_utf8(result);
}

std::size_t checked_components(const TextScanner& in, std::size_t components) {
    if (components < 1 || components > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        in.fail("an array cannot have " + std::to_string(components) + " components");
    }
    return components;
}

}  // namespace

void skip_metadata(TextScanner& in) {
    in.line();
    while (in.line().find_first_not_of(" \t\r") != std::string_view::npos) continue;
}

void VtkArrayReader::start_data(bool at_cells, std::size_t tuples) {
    in_data_ = true;
    at_cells_ = at_cells;
    tuples_ = tuples;
}

bool VtkArrayReader::read_section(const std::string& keyword) {
    if (keyword == "FIELD") {
        read_field();
        return true;
    }
    const auto plain = kComponents.find(keyword);
    const bool known = plain != kComponents.end() || keyword == "SCALARS" || keyword == "LOOKUP_TABLE" ||
                       keyword == "COLOR_SCALARS" || keyword == "TEXTURE_COORDINATES";
    if (!known) return false;
    if (!in_data_) in_.fail(keyword + " stands before POINT_DATA or CELL_DATA");
    if (plain != kComponents.end()) {
        read_attribute(keyword, plain->second);
    } else if (keyword == "SCALARS") {
        read_scalars();
    } else if (keyword == "LOOKUP_TABLE") {
        read_lookup_table();
    } else {
        const std::string name(in_.word());
        const std::size_t components = checked_components(in_, in_.count({keyword}));
        if (keyword == "TEXTURE_COORDINATES") read_type(keyword);
        read_values(name, components);
    }
    return true;
}

void VtkArrayReader::read_type(const std::string& what) {
    const std::string_view type = in_.word();
    if (!kTypes.contains(upper_case(type))) in_.fail_word({what}, "a data type", type);
}

void VtkArrayReader::read_attribute(const std::string& keyword, std::size_t components) {
    const std::string name(in_.word());
    read_type(keyword);
    read_values(name, components);
}

void VtkArrayReader::read_scalars() {
    const std::string name(in_.word());
    read_type("SCALARS " + in_quotes(name));
    // The number of components may be left out: it is there if more stands on the line.
    std::size_t components = 1;
    TextScanner ahead = in_;
    if (ahead.line().find_first_not_of(" \t\r") != std::string_view::npos) {
        components = checked_components(in_, in_.count({"SCALARS: components"}));
    }
    if (upper_case(in_.peek()) == "LOOKUP_TABLE") {
        in_.word();
        in_.word();
    }
    read_values(name, components);
}

void VtkArrayReader::read_lookup_table() {
    const std::string name(in_.word());
    const std::size_t size = in_.count({"LOOKUP_TABLE"});
    skip_values(name, 4, size);
}

void VtkArrayReader::read_field() {
    in_.word();  // the field's name says nothing
    const std::size_t arrays = in_.count({"FIELD"});
    for (std::size_t a = 0; a < arrays; ++a) {
        if (upper_case(in_.peek()) == "METADATA") {
            in_.word();
            skip_metadata(in_);
        }
        const std::string name(in_.word());
        const std::string what = "FIELD array " + in_quotes(name);
        const std::size_t components = in_.count({what});
        const std::size_t tuples = in_.count({what});
        if (upper_case(in_.peek()) == "STRING") {
            in_.word();
            in_.line();
            const std::size_t lines = std::min(components * tuples, 2 * in_.room_for(1));
            for (std::size_t i = 0; i < lines; ++i) in_.line();
            found_.warnings.push_back("text array \"" + decoded(name) + "\" ignored");
            continue;
        }
        read_type(what);
        if (!in_data_) {
            skip_values(name, components, tuples);
            continue;
        }
        if (tuples != tuples_) {
            in_.fail(what + " has " + std::to_string(tuples) + " tuples", std::to_string(tuples_) + " are needed");
        }
        read_values(name, checked_components(in_, components));
    }
}

void VtkArrayReader::read_values(const std::string& name, std::size_t components) {
    FileArray array{decoded(name), static_cast<int>(components), at_cells_, {}};
    const std::string what = "array " + in_quotes(name) + ": value";
    const std::size_t count = tuples_ * components;
    array.values.reserve(std::min(count, in_.room_for(1)));
    for (std::size_t i = 0; i < count; ++i) array.values.push_back(in_.real({what, static_cast<std::int64_t>(i)}));
    found_.arrays.push_back(std::move(array));
}

void VtkArrayReader::skip_values(const std::string& name, std::size_t components, std::size_t tuples) {
    const std::string what = "array " + in_quotes(name) + ": value";
    for (std::size_t i = 0; i < components * tuples; ++i) in_.real({what, static_cast<std::int64_t>(i)});
}

}  // namespace subvol
