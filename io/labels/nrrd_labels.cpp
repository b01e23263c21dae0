// SPDX-License-Identifier: Apache-2.0
// Labels of NRRD files: lines of text up to an empty one, then the values.
//
//     NRRD0004                                 magic
//     # a remark
//     type: short                              fields, in any order
//     space directions: (1,0,0) (0,1,0) (0,0,2.5)
//     key:=value                               keys, which are passed over
//                                              an empty line
//     …                                        values: raw, gzip or ascii, the first axis fastest
//
// Teem, the library of the format, trusts the sizes that a header has. This reader takes no more than labels need, and no
// memory for values that are not there.
#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <span>
#include <vector>

#include "label_readers.h"
#include "subvol/detail/gzip.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/number_type.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

const std::map<std::string, NumberType, std::less<>>& nrrd_types() {
    static const std::map<std::string, NumberType, std::less<>> types = [] {
        std::map<std::string, NumberType, std::less<>> table;
        const auto add = [&](NumberType type, std::initializer_list<const char*> names) {
            for (const char* name : names) table[name] = type;
        };
        add(NumberType::Int8, {"signed char", "int8", "int8_t"});
        add(NumberType::UInt8, {"uchar", "unsigned char", "uint8", "uint8_t"});
        add(NumberType::Int16, {"short", "short int", "signed short", "signed short int", "int16", "int16_t"});
        add(NumberType::UInt16, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"});
        add(NumberType::Int32, {"int", "signed int", "int32", "int32_t"});
        add(NumberType::UInt32, {"uint", "unsigned int", "uint32", "uint32_t"});
        add(NumberType::Int64,
            {"longlong", "long long", "long long int", "signed long long", "signed long long int", "int64", "int64_t"});
        add(NumberType::UInt64, {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"});
        add(NumberType::Float32, {"float"});
        add(NumberType::Float64, {"double"});
        return table;
    }();
    return types;
}

class NrrdReader {
public:
    NrrdReader(std::string_view text, std::string_view file) : text_(text), in_(text, file, TextScanner::Comments::None) {}

    LabelGrid read() {
        read_header();
        const NumberType type = label_type();
        const std::array<std::size_t, 3> size = sizes();
        LabelGrid grid(edges(), origin());
        LabelRows rows(grid, size);
        const std::string encoding = lower_case(field("encoding"));
        const std::string_view data = text_.substr(data_begins_);
        if (encoding == "raw" || encoding == "gzip" || encoding == "gz") {
            const std::endian order = byte_order(type);
            std::string rest;  // bytes of a number that goes on in the next piece
            const auto take = [&](std::string_view bytes) {
                rest += bytes;
                const std::size_t whole = rest.size() / size_of(type) * size_of(type);
                rows.take(integers_from(std::string_view(rest).substr(0, whole), type, order));
                rest.erase(0, whole);
            };
            if (encoding == "raw") {
                constexpr std::size_t kPiece = std::size_t{1} << 20;
                for (std::size_t begin = 0; begin < data.size(); begin += kPiece) take(data.substr(begin, kPiece));
            } else if (!each_gunzipped(data, take)) {
                in_.name_no_place();
                in_.fail("its gzipped values are not whole");
            }
        } else if (encoding == "ascii" || encoding == "text" || encoding == "txt") {
            TextScanner words = in_;
            words.seek(data_begins_);
            while (!words.at_end()) {
                const std::int64_t label = words.integer({"label"});
                rows.take(std::span(&label, 1));
            }
        } else {
            fail_field("encoding", "raw, gzip or ascii");
        }
        rows.finish();
        return grid;
    }

private:
    static std::string lower_case(std::string text) {
        std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        return text;
    }

    void read_header() {
        const std::string_view magic = in_.line();
        constexpr std::string_view kMagic = "NRRD000";
        if (!magic.starts_with(kMagic) || trimmed(magic).size() != kMagic.size() + 1) in_.fail("is not a NRRD file");
        for (;;) {
            if (in_.bytes_left() == 0) in_.fail("the header has no end", "an empty line before the values");
            const std::string_view line = in_.line();
            if (trimmed(line).empty()) break;
            if (line.front() == '#') continue;
            const std::size_t colon = line.find(':');
            if (colon == std::string_view::npos) in_.fail(in_quotes(trimmed(line)) + " is not a field", "NAME: VALUE");
            if (line.substr(colon).starts_with(":=")) continue;  // a key of another program
            const std::string name = lower_case(std::string(trimmed(line.substr(0, colon))));
            if (fields_.contains(name)) in_.fail("the field " + in_quotes(name) + " is there twice");
            fields_[name] = {std::string(trimmed(line.substr(colon + 1))), in_.position()};
        }
        data_begins_ = text_.size() - in_.bytes_left();
        for (const char* name : {"data file", "datafile"}) {
            if (fields_.contains(name)) fail_field(name, "values in the file itself");
        }
        for (const char* name : {"line skip", "lineskip", "byte skip", "byteskip"}) {
            if (fields_.contains(name) && field(name) != "0") fail_field(name, "0");
        }
    }

    const std::string& field(const std::string& name) {
        const auto found = fields_.find(name);
        if (found == fields_.end()) {
            in_.name_no_place();
            in_.fail("the header has no field " + in_quotes(name));
        }
        return found->second.value;
    }

    [[noreturn]] void fail_field(const std::string& name, const std::string& allowed) {
        const auto found = fields_.find(name);
        in_.fail_at(found->second.place, "the field " + in_quotes(name) + " is " + in_quotes(found->second.value), allowed);
    }

    NumberType label_type() {
        const auto found = nrrd_types().find(lower_case(field("type")));
        if (found == nrrd_types().end() || !is_integer(found->second)) fail_field("type", "integers, which are labels");
        return found->second;
    }

    std::endian byte_order(NumberType type) {
        if (size_of(type) == 1) return std::endian::little;
        const std::string order = lower_case(field("endian"));
        if (order != "little" && order != "big") fail_field("endian", "little or big");
        return order == "little" ? std::endian::little : std::endian::big;
    }

    std::array<std::size_t, 3> sizes() {
        if (field("dimension") != "3") fail_field("dimension", "3");
        std::array<std::size_t, 3> size{};
        TextScanner words(field("sizes"), {}, TextScanner::Comments::None);
        for (std::size_t& side : size) {
            const std::optional<double> number = number_from(words.word());
            constexpr double kMost = 2147483648;  // LabelGrid::kMostVoxels
            if (!number || !(*number >= 1 && *number <= kMost) || *number != std::floor(*number)) {
                fail_field("sizes", "three whole numbers from 1");
            }
            side = static_cast<std::size_t>(*number);
        }
        if (!words.at_end()) fail_field("sizes", "three whole numbers from 1");
        return size;
    }

    /// "(1,0,0) (0,1,0) (0,0,1)", so many of them
    std::vector<Vec3> vectors(const std::string& name, std::size_t count) {
        const std::string needed = counted(count, "vector", "vectors") + " of three numbers, as (1,0,0)";
        std::string_view rest = field(name);
        std::vector<Vec3> found;
        while (!(rest = trimmed(rest)).empty()) {
            const std::size_t end = rest.find(')');
            if (rest.front() != '(' || end == std::string_view::npos || found.size() == count) fail_field(name, needed);
            std::string_view inside = rest.substr(1, end - 1);
            Vec3& vector = found.emplace_back();
            for (int k = 0; k < 3; ++k) {
                const std::size_t comma = inside.find(',');
                const std::optional<double> number = number_from(inside.substr(0, comma));
                if (!number || !std::isfinite(*number) || (comma == std::string_view::npos) != (k == 2))
                    fail_field(name, needed);
                vector[k] = *number;
                if (k < 2) inside.remove_prefix(comma + 1);
            }
            rest.remove_prefix(end + 1);
        }
        if (found.size() != count) fail_field(name, needed);
        return found;
    }

    Mat3 edges() {
        if (fields_.contains("space directions")) {
            const std::vector<Vec3> found = vectors("space directions", 3);
            return {found[0], found[1], found[2]};
        }
        Mat3 edges(1);
        if (!fields_.contains("spacings")) return edges;
        TextScanner words(field("spacings"), {}, TextScanner::Comments::None);
        for (int axis = 0; axis < 3; ++axis) {
            const std::optional<double> number = number_from(words.word());
            if (!number || !std::isfinite(*number) || *number == 0) fail_field("spacings", "three numbers");
            edges[axis][axis] = *number;
        }
        if (!words.at_end()) fail_field("spacings", "three numbers");
        return edges;
    }

    Vec3 origin() { return fields_.contains("space origin") ? vectors("space origin", 1).front() : Vec3(0.0); }

    struct Field {
        std::string value;
        std::size_t place;
    };
    std::string_view text_;
    TextScanner in_;
    std::map<std::string, Field> fields_;
    std::size_t data_begins_ = 0;
};

}  // namespace

LabelGrid read_nrrd_labels(std::string_view text, std::string_view file) {
    return NrrdReader(text, file).read();
}

}  // namespace subvol::detail
