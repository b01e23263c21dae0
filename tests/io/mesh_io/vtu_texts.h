// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <lz4.h>
#include <lzma.h>
#include <zlib.h>

#include <sstream>

#include "binary_texts.h"
#include "mesh_texts.h"

namespace subvol::test {

inline std::string base64(const std::string& bytes) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned bits = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            bits = (bits << 8) | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        }
        for (unsigned k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[(bits >> (18 - 6 * k)) & 63];
    }
    return text;
}

inline std::string from_base64(const std::string& text) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0, count = 0;
    for (const char c : text.substr(0, text.find('='))) {
        bits = (bits << 6) | static_cast<unsigned>(digits.find(c));
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes += static_cast<char>(bits >> count);
    }
    return bytes;
}

inline std::string compressed_by(const std::string& compressor, const std::string& bytes) {
    std::string result(2 * bytes.size() + 1024, '\0');
    if (compressor == "vtkZLibDataCompressor") {
        uLongf size = result.size();
        compress(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
        result.resize(size);
    } else if (compressor == "vtkLZMADataCompressor") {
        std::size_t size = 0;
        static_cast<void>(lzma_easy_buffer_encode(1, LZMA_CHECK_CRC32, nullptr,
                                                  reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(),
                                                  reinterpret_cast<std::uint8_t*>(result.data()), &size, result.size()));
        result.resize(size);
    } else {
        const int size =
            LZ4_compress_default(bytes.data(), result.data(), static_cast<int>(bytes.size()), static_cast<int>(result.size()));
        result.resize(static_cast<std::size_t>(size));
    }
    return result;
}

/// Writes small .vtu files in every encoding.
///
/// format: ascii, binary, appended; encoding: of appended data
struct VtuText {
    std::string format = "ascii";
    std::string encoding = "raw";
    std::string compressor{};
    std::string header_type = "UInt32";
    std::endian order = std::endian::little;
    std::size_t block_size = 64;  // of compressed data, small enough for several
    std::string appended{};

    /// A DataArray; attributes: Name and the like
    template <class T>
    std::string array(const std::string& type, const std::string& attributes, const std::vector<T>& values) {
        const std::string begin = "<DataArray type=\"" + type + "\" " + attributes + " format=\"" + format + "\"";
        if (format == "ascii") return begin + ">\n" + words(values) + "\n</DataArray>\n";
        const bool raw = format == "appended" && encoding == "raw";
        const std::string data = block(bytes_of(values, order), raw);
        if (format == "binary") return begin + ">\n  " + data + "\n</DataArray>\n";
        const std::size_t offset = appended.size();
        appended += data;
        return begin + " offset=\"" + std::to_string(offset) + "  \"/>\n";
    }

    std::string piece(const HexMesh& mesh, const std::string& data) {
        std::vector<std::int64_t> offsets;
        for (std::size_t c = 1; c <= mesh.cells.size(); ++c) offsets.push_back(static_cast<std::int64_t>(8 * c));
        // One array after the other: each appends its data, and compilers choose the order within an expression.
        std::string text = "<Piece NumberOfPoints=\"" + std::to_string(mesh.points.size()) + "\" NumberOfCells=\"" +
                           std::to_string(mesh.cells.size()) + "\">\n" + data + "<Points>\n";
        text += array("Float64", "Name=\"Points\" NumberOfComponents=\"3\"", coordinates_as<double>(mesh));
        text += "</Points>\n<Cells>\n";
        text += array("Int32", "Name=\"connectivity\"", corners_as<std::int32_t>(mesh));
        text += array("Int64", "Name=\"offsets\"", offsets);
        text += array("UInt8", "Name=\"types\"", std::vector<std::uint8_t>(mesh.cells.size(), 12));
        return text + "</Cells>\n</Piece>\n";
    }

    [[nodiscard]] std::string file(const std::string& pieces) const {
        std::string text = std::string("<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"") +
                           (order == std::endian::big ? "BigEndian" : "LittleEndian") + "\" header_type=\"" + header_type +
                           "\"" + (compressor.empty() ? "" : " compressor=\"" + compressor + "\"") + ">\n<UnstructuredGrid>\n" +
                           pieces + "</UnstructuredGrid>\n";
        if (!appended.empty()) text += "<AppendedData encoding=\"" + encoding + "\">\n _" + appended + "\n</AppendedData>\n";
        return text + "</VTKFile>\n";
    }

private:
    template <class T>
    static std::string words(const std::vector<T>& values) {
        std::ostringstream text;
        text.precision(17);
        for (const T& value : values) text << +value << " ";
        return text.str();
    }

    [[nodiscard]] std::string header(const std::vector<std::uint64_t>& numbers) const {
        if (header_type == "UInt64") return bytes_of(numbers, order);
        return bytes_of(std::vector<std::uint32_t>(numbers.begin(), numbers.end()), order);
    }

    [[nodiscard]] std::string block(const std::string& bytes, bool raw) const {
        const auto coded = [&](const std::string& part) { return raw ? part : base64(part); };
        if (compressor.empty()) return coded(header({bytes.size()}) + bytes);
        std::vector<std::uint64_t> numbers{(bytes.size() + block_size - 1) / block_size, block_size, bytes.size() % block_size};
        std::string blocks;
        for (std::size_t begin = 0; begin < bytes.size(); begin += block_size) {
            const std::string one = compressed_by(compressor, bytes.substr(begin, block_size));
            numbers.push_back(one.size());
            blocks += one;
        }
        return coded(header(numbers)) + coded(blocks);
    }
};

}  // namespace subvol::test
