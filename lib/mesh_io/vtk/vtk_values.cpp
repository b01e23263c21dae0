// SPDX-License-Identifier: Apache-2.0
#include "vtk_values.h"

#include <algorithm>
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
    const auto type = kTypes.find(upper_case(word));
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
    if (!binary_) return in_.real(place);
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

}  // namespace subvol::detail
