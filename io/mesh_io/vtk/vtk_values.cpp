// SPDX-License-Identifier: Apache-2.0
// Values and arrays of legacy VTK files. Keywords, names and counts are words in every file. The values after them are words in
// a text file; in a binary one they are big-endian numbers that begin after the end of the line, and bits are packed from the
// highest one of each byte.
//
// An array begins with its keyword; the number of its components follows from this, or is written after the name. There are
// values for all points or cells, as the last POINT_DATA or CELL_DATA says. Colours become numbers from 0 to 1. Texts, lookup
// tables and fields before the data are passed over value by value. Names are decoded, %20 to a space.
#include "vtk_values.h"

#include <algorithm>
#include <charconv>
#include <limits>
#include <map>

namespace subvol::detail {

namespace {

constexpr std::endian kOrder = std::endian::big;

// VTK writes its ids with 32 bits in a legacy file, even if they are longer in memory; `long` is that of 64-bit systems.
const std::map<std::string_view, VtkType> kTypes{{"BIT", {NumberType::UInt8, true}},
                                                 {"CHAR", {NumberType::Int8}},
                                                 {"SIGNED_CHAR", {NumberType::Int8}},
                                                 {"UNSIGNED_CHAR", {NumberType::UInt8}},
                                                 {"SHORT", {NumberType::Int16}},
                                                 {"UNSIGNED_SHORT", {NumberType::UInt16}},
                                                 {"INT", {NumberType::Int32}},
                                                 {"UNSIGNED_INT", {NumberType::UInt32}},
                                                 {"LONG", {NumberType::Int64}},
                                                 {"UNSIGNED_LONG", {NumberType::UInt64}},
                                                 {"LONG_LONG", {NumberType::Int64}},
                                                 {"UNSIGNED_LONG_LONG", {NumberType::UInt64}},
                                                 {"VTKIDTYPE", {NumberType::Int32}},
                                                 {"VTKTYPEINT32", {NumberType::Int32}},
                                                 {"VTKTYPEUINT32", {NumberType::UInt32}},
                                                 {"VTKTYPEINT64", {NumberType::Int64}},
                                                 {"VTKTYPEUINT64", {NumberType::UInt64}},
                                                 {"FLOAT", {NumberType::Float32}},
                                                 {"DOUBLE", {NumberType::Float64}}};

}  // namespace

void VtkValues::set_binary() {
    binary_ = true;
    in_.name_bytes();
}

VtkType VtkValues::read_type(const std::string& what) {
    const std::string_view word = in_.word();
    auto type = kTypes.find(upper_case(word));
    // FreeFem's number of components touches its type: "int1".
    if (type == kTypes.end() && word.ends_with('1')) type = kTypes.find(upper_case(word.substr(0, word.size() - 1)));
    if (type == kTypes.end()) in_.fail_word({what}, "a data type", word);
    return type->second;
}

void VtkValues::begin(VtkType type) {
    type_ = type;
    bits_read_ = 0;
    if (binary_) in_.line();
}

void VtkValues::begin_integers(VtkType type, const std::string& what) {
    if (binary_ && !is_integer(type.number)) in_.fail(what + ": an integer type is needed");
    begin(type);
}

double VtkValues::real(const Place& place) {
    if (!binary_) {
        const double value = in_.real(place);
        in_.expect_type(value, type_.number, place);
        return value;
    }
    if (type_.bits) return static_cast<double>(bit(place));
    return real_from(in_.bytes(size_of(type_.number), place), type_.number, kOrder);
}

std::int64_t VtkValues::integer(const Place& place) {
    if (!binary_) return in_.integer(place);
    if (type_.bits) return bit(place);
    return integer_from(in_.bytes(size_of(type_.number), place), type_.number, kOrder);
}

std::size_t VtkValues::count(const Place& place) {
    return in_.as_count(integer(place), place);
}

std::int64_t VtkValues::bit(const Place& place) {
    if (bits_read_ % 8 == 0) bits_ = static_cast<unsigned char>(in_.bytes(1, place)[0]);
    return (bits_ >> (7 - bits_read_++ % 8)) & 1;
}

void VtkValues::skip(std::size_t values, const std::string& what) {
    for (std::size_t i = 0; i < values; ++i) real({what, static_cast<std::int64_t>(i)});
}

void VtkValues::skip_texts(std::size_t texts, const std::string& what) {
    in_.line();
    // A text takes at least one byte, except at the end of a file that is cut off.
    const std::size_t some = std::min(texts, in_.bytes_left() + 1);
    for (std::size_t i = 0; i < some; ++i) skip_text({what, static_cast<std::int64_t>(i)});
}

// In a BINARY file a text follows its length; the first two bits of the length give its number of bytes.
void VtkValues::skip_text(const Place& place) {
    if (!binary_) {
        in_.line();
        return;
    }
    const auto byte = [&] { return static_cast<unsigned char>(in_.bytes(1, place)[0]); };
    const unsigned first = byte();
    std::uint64_t length = first & 0x3F;
    for (unsigned more = (1u << (3 - (first >> 6))) - 1; more > 0; --more) length = (length << 8) | byte();
    in_.bytes(length, place);
}

std::size_t VtkValues::room() const {
    if (!binary_) return in_.room_for(1);
    return type_.bits ? 8 * in_.bytes_left() : in_.bytes_left() / size_of(type_.number);
}

namespace {

// Attribute sections with the same layout, KEYWORD name type, then the values; and their numbers of components.
const std::map<std::string_view, std::size_t> kComponents{
    {"VECTORS", 3}, {"NORMALS", 3}, {"TENSORS", 9}, {"TENSORS6", 6}, {"GLOBAL_IDS", 1}, {"PEDIGREE_IDS", 1}, {"EDGE_FLAGS", 1}};

// Colours are bytes in BINARY files, and numbers from 0 to 1 in texts.
VtkType type_of_colors(const VtkValues& values) {
    return values.binary() ? VtkType{NumberType::UInt8} : VtkType{NumberType::Float32};
}

int hex_digit(char c) {
    int digit = -1;
    std::from_chars(&c, &c + 1, digit, 16);
    return digit;
}

// VTK encodes special characters in a name, such as a space as %20.
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

void VtkArrayReader::start_data(bool at_cells, std::size_t tuples, std::string wrong) {
    in_data_ = true;
    at_cells_ = at_cells;
    tuples_ = tuples;
    wrong_ = std::move(wrong);
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
    if (!in_data_) in_.fail(keyword + " comes before POINT_DATA or CELL_DATA");
    if (plain != kComponents.end()) {
        read_attribute(keyword, plain->second);
    } else if (keyword == "SCALARS") {
        read_scalars();
    } else if (keyword == "LOOKUP_TABLE") {
        read_lookup_table();
    } else if (keyword == "COLOR_SCALARS") {
        read_colors();
    } else {
        read_texture_coordinates();
    }
    return true;
}

void VtkArrayReader::read_attribute(const std::string& keyword, std::size_t components) {
    const std::string name(in_.word());
    read_values(name, values_.read_type(keyword), components);
}

void VtkArrayReader::read_scalars() {
    const std::string name(in_.word());
    const VtkType type = values_.read_type("SCALARS " + in_quotes(name));
    // The number of components is optional: it is there if the line goes on.
    std::size_t components = 1;
    TextScanner ahead = in_;
    if (ahead.line().find_first_not_of(" \t\r") != std::string_view::npos) {
        components = checked_components(in_, in_.count({"SCALARS: components"}));
    }
    if (upper_case(in_.peek()) == "LOOKUP_TABLE") {
        in_.word();
        in_.word();
    }
    read_values(name, type, components);
}

void VtkArrayReader::read_colors() {
    const std::string name(in_.word());
    read_values(name, type_of_colors(values_), checked_components(in_, in_.count({"COLOR_SCALARS"})));
    if (!values_.binary() || leaves_out()) return;
    for (double& value : found_.arrays.back().values) value /= 255;
}

void VtkArrayReader::read_texture_coordinates() {
    const std::string name(in_.word());
    const std::size_t components = checked_components(in_, in_.count({"TEXTURE_COORDINATES"}));
    read_values(name, values_.read_type("TEXTURE_COORDINATES"), components);
}

void VtkArrayReader::read_lookup_table() {
    const std::string name(in_.word());
    const std::size_t size = in_.count({"LOOKUP_TABLE"});
    skip_values(name, type_of_colors(values_), 4 * size);
    found_.ignored.push_back({"lookup table", decoded(name)});
}

void VtkArrayReader::read_field() {
    in_.word();  // the name of the field is not used
    const std::size_t arrays = in_.count({"FIELD"});
    for (std::size_t a = 0; a < arrays; ++a) {
        if (upper_case(in_.peek()) == "METADATA") {
            in_.word();
            skip_metadata(in_);
        }
        read_field_array();
    }
}

void VtkArrayReader::read_field_array() {
    const std::string name(in_.word());
    const std::string what = "FIELD array " + in_quotes(name);
    const std::size_t components = in_.count({what});
    const std::size_t tuples = in_.count({what});
    const std::string type_word = upper_case(in_.peek());
    if (type_word == "STRING" || type_word == "UTF8_STRING") {
        in_.word();
        values_.skip_texts(components * tuples, what);
        found_.ignore({"array", decoded(name), 1, "it consists of texts"});
        return;
    }
    const VtkType type = values_.read_type(what);
    if (!in_data_ && is_time_array(name) && components * tuples == 1) {
        values_.begin(type);
        const double time = values_.real({what, 0});
        take_time(name, {&time, 1}, found_);
        return;
    }
    if (!in_data_) {
        skip_values(name, type, components * tuples);
        found_.ignored.push_back({"array", decoded(name), 1, "it is at no points or cells"});
        return;
    }
    if (tuples != tuples_) {
        const std::string reason =
            what + " has " + std::to_string(tuples) + " tuples (" + std::to_string(tuples_) + " are needed)";
        found_.unread.push_back({decoded(name), in_.place_of(in_.position()) + ": " + reason});
        skip_values(name, type, checked_components(in_, components) * tuples);
        return;
    }
    read_values(name, type, checked_components(in_, components));
}

void VtkArrayReader::read_values(const std::string& name, VtkType type, std::size_t components) {
    FileArray array{.name = decoded(name), .components = static_cast<int>(components), .at_cells = at_cells_, .values = {}};
    array.integers = is_integer(type.number);
    const std::string what = "array " + in_quotes(name) + ": value";
    const std::size_t count = tuples_ * components;
    values_.begin(type);
    array.values.reserve(std::min(count, values_.room()));
    for (std::size_t i = 0; i < count; ++i) array.values.push_back(values_.real({what, static_cast<std::int64_t>(i)}));
    if (leaves_out()) {
        found_.unread.push_back({array.name, wrong_});
    } else {
        found_.arrays.push_back(std::move(array));
    }
}

void VtkArrayReader::skip_values(const std::string& name, VtkType type, std::size_t values) {
    values_.begin(type);
    values_.skip(values, "array " + in_quotes(name) + ": value");
}

}  // namespace subvol::detail
