// SPDX-License-Identifier: Apache-2.0
// VTK's XML files: arrays in every encoding, and what is wrong with damaged ones.
#include "subvol/detail/vtk_xml.h"

#include <gmock/gmock.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include "lib/temp_folder.h"
#include "subvol/detail/text_codes.h"
#include "subvol/detail/vtk_xml_writer.h"

namespace subvol::detail {
namespace vtk_xml_test {

using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;

/// Numbers as bytes, the smallest byte first or last.
template <class Number>
std::string bytes_of(const std::vector<Number>& numbers, bool big = false) {
    std::string all;
    for (const Number number : numbers) {
        std::string bytes(sizeof number, '\0');
        std::memcpy(bytes.data(), &number, sizeof number);
        if (big != (std::endian::native == std::endian::big)) std::ranges::reverse(bytes);
        all += bytes;
    }
    return all;
}

std::string zipped(const std::string& bytes) {
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    EXPECT_EQ(
        compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()),
        Z_OK);
    packed.resize(size);
    return packed;
}

/// A file with one array. Its second line begins with the array.
std::string file_with(const std::string& array, const std::string& attributes = {}, const std::string& appended = {}) {
    return "<VTKFile type=\"PolyData\" version=\"1.0\" " + attributes + "><PolyData>\n" + array + "</PolyData>" + appended +
           "</VTKFile>";
}

const std::string kAppended = "<DataArray type=\"Int16\" Name=\"a\" format=\"appended\" offset=\"0\"/>";

std::string array_of(const std::string& type, const std::string& format, const std::string& content) {
    return "<DataArray type=\"" + type + "\" Name=\"a\" format=\"" + format + "\">" + content + "</DataArray>";
}

std::vector<double> reals_of(const std::string& text) {
    const VtkXml xml(text, "a.vtp", "PolyData", "a surface");
    const auto array = xml.data_set().child("DataArray");
    const std::vector<double> reals = xml.arrays().reals(array);
    EXPECT_EQ(xml.arrays().size(array), reals.size());
    return reals;
}

std::string refusal_of(const std::string& text) {
    return error_of([&] { static_cast<void>(reals_of(text)); });
}

TEST(VtkXmlFiles, HaveTheSameNumbersInEveryEncoding) {
    const std::vector<std::int16_t> numbers{-300, 7, 0, 32767, -32768};
    const std::string values = bytes_of(numbers), head = bytes_of<std::uint32_t>({10});
    const std::vector<double> expected(numbers.begin(), numbers.end());
    EXPECT_EQ(reals_of(file_with(array_of("Int16", "ascii", " -300 7\n0 +32767 -32768\n"))), expected);
    EXPECT_EQ(reals_of(file_with(array_of("Int16", "ascii", "<![CDATA[-300 7 0 32767 -32768]]>"))), expected);
    EXPECT_EQ(reals_of(file_with(array_of("Int16", "binary", "\n" + base64(head + values) + "\n"))), expected);
    EXPECT_EQ(reals_of(file_with(array_of("Int16", "binary", base64(head) + base64(values)))), expected) << "in two pieces";
    EXPECT_EQ(
        reals_of(file_with(array_of("Int16", "binary", base64(bytes_of<std::uint32_t>({10}, true) + bytes_of(numbers, true))),
                           "byte_order=\"BigEndian\"")),
        expected);
    EXPECT_EQ(reals_of(file_with(array_of("Int16", "binary", base64(bytes_of<std::uint64_t>({10}) + values)),
                                 "header_type=\"UInt64\"")),
              expected);
    // Two blocks, of which the first one ends within a number.
    const std::string first = zipped(values.substr(0, 5)), second = zipped(values.substr(5, 5));
    const auto sizes = [](const std::string& packed) { return static_cast<std::uint32_t>(packed.size()); };
    const std::string blocks = base64(bytes_of<std::uint32_t>({2, 5, 0, sizes(first), sizes(second)})) + base64(first + second);
    EXPECT_EQ(reals_of(file_with(array_of("Int16", "binary", blocks), "compressor=\"vtkZLibDataCompressor\"")), expected);
    // Raw bytes need not be well-formed XML.
    EXPECT_EQ(reals_of(file_with(kAppended, "", "<AppendedData encoding=\"raw\">\n _" + head + values + "</x><")), expected);
    EXPECT_EQ(
        reals_of(file_with(kAppended, "", "<AppendedData encoding=\"base64\">_" + base64(head + values) + "</AppendedData>")),
        expected);
}

TEST(VtkXmlFiles, NumbersOfEveryTypeAreRead) {
    const auto read = [](const std::string& type, const std::string& bytes) {
        return reals_of(file_with(
            array_of(type, "binary", base64(bytes_of<std::uint32_t>({static_cast<std::uint32_t>(bytes.size())}) + bytes))));
    };
    EXPECT_THAT(read("Int8", "\x80\x7f"), ElementsAre(-128, 127));
    EXPECT_THAT(read("UInt8", "\x80\xff"), ElementsAre(128, 255));
    EXPECT_THAT(read("UInt16", bytes_of<std::uint16_t>({65535})), ElementsAre(65535));
    EXPECT_THAT(read("Int32", bytes_of<std::int32_t>({-2147483647 - 1})), ElementsAre(-0x1p31));
    EXPECT_THAT(read("UInt32", bytes_of<std::uint32_t>({4294967295U})), ElementsAre(4294967295.0));
    EXPECT_THAT(read("Int64", bytes_of<std::int64_t>({-(std::int64_t{1} << 62)})), ElementsAre(-0x1p62));
    EXPECT_THAT(read("UInt64", bytes_of<std::uint64_t>({std::uint64_t{1} << 63})), ElementsAre(0x1p63));
    EXPECT_THAT(read("Float32", bytes_of<float>({0.1F})), ElementsAre(0.1F));
    EXPECT_THAT(read("Float64", bytes_of<double>({0.1, -0.0})), ElementsAre(0.1, -0.0));
}

TEST(VtkXmlFiles, WhatIsWrongIsSaidWithItsLine) {
    const auto binary = [](const std::string& bytes) { return file_with(array_of("Int16", "binary", base64(bytes))); };
    const std::string line = "a.vtp, line 2: array \"a\": ";
    for (const auto& [text, said] :
         {std::pair{file_with(array_of("Int128", "ascii", "1")), line + "the type \"Int128\" is not supported"},
          {file_with(array_of("Int16", "hex", "1")), line + "format \"hex\" is unknown (ascii, binary or appended)"},
          {file_with(array_of("Int16", "ascii", "1 x 3")), std::string("value 1: a number is expected, not \"x\"")},
          {file_with(array_of("UInt8", "ascii", "1 300")), std::string("a number of the type UInt8")},
          {binary("abc"), line + "its data end inside their header"},
          {binary(bytes_of<std::uint32_t>({11}) + "0123456789"), line + "its 11 bytes go beyond the end"},
          {binary(bytes_of<std::uint32_t>({9}) + "012345678"),
           line + "its 9 bytes are not a whole number of values of 2 bytes"},
          {binary(bytes_of<std::uint32_t>({4000000000U})), line + "its 4000000000 bytes go beyond the end"},
          {file_with(kAppended), line + "there are no appended data"},
          {file_with("<DataArray type=\"Int16\" Name=\"a\" format=\"appended\"/>", "", "<AppendedData encoding=\"raw\">_xx"),
           line + "it has no offset"},
          {file_with("<DataArray type=\"Int16\" Name=\"a\" format=\"appended\" offset=\"99\"/>", "",
                     "<AppendedData encoding=\"raw\">_"),
           line + "its offset 99 is beyond the appended data"}}) {
        EXPECT_THAT(refusal_of(text), HasSubstr(said));
    }
    const auto blocks = [](const std::vector<std::uint32_t>& head, const std::string& bytes) {
        return refusal_of(file_with(array_of("Int16", "binary", base64(bytes_of(head)) + base64(bytes)),
                                    "compressor=\"vtkZLibDataCompressor\""));
    };
    const std::string block = zipped("0123");
    const auto size = static_cast<std::uint32_t>(block.size());
    EXPECT_EQ(blocks({1, 4, 0, size}, block), "no error");
    EXPECT_THAT(blocks({1, 6, 0, size}, block), HasSubstr(line + "block 1 of 1: decompression failed"));
    EXPECT_THAT(blocks({1, 4, 0, size + 9}, block), HasSubstr(line + "block 1 of 1 goes beyond the end"));
    EXPECT_THAT(blocks({2, 4, 0, size, size}, block), HasSubstr(line + "block 2 of 2 goes beyond the end"));
    EXPECT_THAT(blocks({1U << 31, 4, 0, size}, block), HasSubstr(line + "its 2147483648 compressed blocks go beyond the end"));
}

TEST(VtkXmlFiles, OtherFilesAreRefused) {
    for (const auto& [text, said] :
         {std::pair{std::string(" \n"), "the file is empty"},
          {std::string("<VTKFile type=\"PolyData\">\n<PolyData></VTKFile>"), "a.vtp, line 2: not well-formed XML"},
          {std::string("<html/>"), "not a VTK XML file: its root element is \"html\""},
          {std::string("<VTKFile type=\"ImageData\"><ImageData/></VTKFile>"), "\"ImageData\" is not a PolyData (a surface)"},
          {std::string("<VTKFile type=\"PolyData\"/>"), "there is no PolyData element"},
          {file_with("", "byte_order=\"Middle\""), "byte_order \"Middle\" is unknown"},
          {file_with("", "header_type=\"Int8\""), "header_type \"Int8\""},
          {file_with("", "compressor=\"vtkNew\""), "vtkNew"}}) {
        EXPECT_THAT(refusal_of(text), HasSubstr(said));
    }
}

TEST(VtkXmlFiles, VersionsAndNumbersOfElementsAreRead) {
    const std::string text =
        "<VTKFile type=\"PolyData\" version=\"2.1\"><PolyData><Piece a=\" +17\n\" b=\"-1\" c=\"1.5\" "
        "d=\"\"/></PolyData></VTKFile>";
    const VtkXml xml(text, "a.vtp", "PolyData", "a surface");
    EXPECT_TRUE(xml.is_older_than(2, 2) && xml.is_older_than(3, 0));
    EXPECT_FALSE(xml.is_older_than(2, 1) || xml.is_older_than(1, 9));
    const auto piece = xml.data_set().child("Piece");
    EXPECT_EQ(number_attribute(piece, "a"), 17U);
    for (const char* name : {"b", "c", "d", "e"}) EXPECT_EQ(number_attribute(piece, name), std::nullopt) << name;
    EXPECT_EQ(xml.count(piece, "a"), 17U);
    EXPECT_THAT(error_of([&] { static_cast<void>(xml.count(piece, "b")); }), HasSubstr("a.vtp, line 1: "));
    EXPECT_THAT(error_of([&] { static_cast<void>(xml.array(piece, "T")); }), HasSubstr("no array \"T\""));
}

// Each tag that the parser sees is where it is in the whole text.
TEST(VtkXmlFiles, ShortenedTextsKeepThePlacesOfTheirTags) {
    std::string text = "<a>" + std::string(200, ' ') + "short</a>\n";
    for (int k = 0; k < 5; ++k) {
        text += "<b n=\"" + std::to_string(k) + "\">\n" + std::string(static_cast<std::size_t>(60 + 10 * k), '1') +
                " 2 3</b><!-- > x -->";
    }
    XmlTags tags(text);
    EXPECT_LT(tags.text().size(), text.size());
    std::size_t found = 0;
    for (std::size_t at = tags.text().find('<'); at != std::string::npos; at = tags.text().find('<', at + 1)) {
        ++found;
        EXPECT_EQ(text.substr(tags.place(at), 8), tags.text().substr(at, 8)) << at;
    }
    EXPECT_EQ(found, static_cast<std::size_t>(std::ranges::count(text, '<')));
}

using VtkXmlWriters = test::TempFolder;

TEST_F(VtkXmlWriters, WriteWhatIsReadAgain) {
    constexpr std::size_t kCount = 100'003;  // doubles: seven blocks of 2^17 bytes, of which the last one is not full
    std::vector<double> values(kCount);
    for (std::size_t i = 0; i < kCount; ++i) values[i] = std::sin(static_cast<double>(i)) * 1e5;
    const std::vector<std::int64_t> ids{-1, std::int64_t{1} << 60};
    const std::string odd = "a \"b\" <c> & 'd'\x01 é";
    {
        OutputFile out(path("a.vtp"));
        VtkXmlWriter writer(out, "PolyData");
        writer.array<double>(odd, 1, values);
        writer.made_array<double>("made", 1, kCount, [](std::size_t i) { return std::sin(static_cast<double>(i)) * 1e5; });
        writer.field<std::int64_t>("ids", ids);
        writer.array<float>("none", 3, {});
        writer.strings("names", std::vector<std::string>{"é", "", "ab"});
        writer.end();
        out.commit();
    }
    const std::string text = test::read_bytes(path("a.vtp"));
    const VtkXml xml(text, "a.vtp", "PolyData", "a surface");
    const auto first = xml.data_set().child("DataArray");
    EXPECT_EQ(std::string(first.attribute("Name").as_string()), "a \"b\" <c> & 'd'_ é") << "XML has no control characters";
    EXPECT_TRUE(xml.arrays().reals(first) == values);
    EXPECT_TRUE(xml.arrays().reals(xml.array(xml.data_set(), "made")) == values);
    EXPECT_EQ(xml.arrays().integers(xml.array(xml.data_set(), "ids")), ids);
    EXPECT_EQ(number_attribute(xml.array(xml.data_set(), "ids"), "NumberOfTuples"), 2U);
    EXPECT_EQ(xml.arrays().size(xml.array(xml.data_set(), "none")), 0U);
    EXPECT_THAT(error_of([&] { static_cast<void>(xml.arrays().integers(first)); }), HasSubstr("an integer type is needed"));
    // Character codes with a 0 after each string, as VTK writes them.
    EXPECT_THAT(xml.arrays().integers(xml.data_set().child("Array")), ElementsAre(-61, -87, 0, 0, 97, 98, 0));
}

TEST_F(VtkXmlWriters, NumbersAreWrittenToTheLastDigit) {
    const std::vector<double> values{0.1, -1e300, 5e-324, 1.0 / 3};
    std::uint64_t length = 0;
    {
        OutputFile out(path("a.txt"));
        NumberWriter numbers(out, true);
        numbers.put_all(values);
        numbers.end_row();
        numbers.put_point<float>({0.5, 1, 2});
        numbers.end_row();
        numbers.flush();
        out.overwrite(0, "7");
        out.write("end");
        length = out.position();
        out.commit();
    }
    std::string text = test::read_bytes(path("a.txt"));
    EXPECT_EQ(text.size(), length);
    ASSERT_EQ(text.front(), '7');
    text.front() = '0';
    TextScanner in(text, "a.txt", TextScanner::Comments::None);
    for (const double value : values) EXPECT_EQ(in.real({"value"}), value);
    EXPECT_TRUE(text.ends_with("\n0.5 1 2\nend")) << text;
}

}  // namespace vtk_xml_test
}  // namespace subvol::detail
