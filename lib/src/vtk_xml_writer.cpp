#include "vtk_xml_writer.h"

#include <tbb/parallel_for.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <vector>

#include "text_scanner.h"

namespace subvol {

namespace {

constexpr std::size_t kBlock = 1 << 20;  // compressed by themselves, all at once

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        unsigned bits = 0;
        for (std::size_t k = i; k < i + 3; ++k) {
            bits = (bits << 8) | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0u);
        }
        for (unsigned k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[(bits >> (18 - 6 * k)) & 63];
    }
    return text;
}

std::string zipped(std::string_view bytes) {
    uLongf size = compressBound(bytes.size());
    std::string result(size, '\0');
    // The fastest level: a higher one gains some percent of numbers that are mostly noise.
    [[maybe_unused]] const int done = compress2(reinterpret_cast<Bytef*>(result.data()), &size,
                                                reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), Z_BEST_SPEED);
    assert(done == Z_OK);
    result.resize(size);
    return result;
}

// The header: how many blocks, their size, that of the last one if it is not full, and the compressed size of each.
std::string compressed_array(std::string_view bytes) {
    std::vector<std::string> blocks((bytes.size() + kBlock - 1) / kBlock);
    tbb::parallel_for(std::size_t{0}, blocks.size(),
                      [&](std::size_t b) { blocks[b] = zipped(bytes.substr(b * kBlock, kBlock)); });
    std::vector<std::uint64_t> header{blocks.size(), kBlock, bytes.size() % kBlock};
    std::string data;
    for (const auto& block : blocks) {
        header.push_back(block.size());
        data += block;
    }
    return base64({reinterpret_cast<const char*>(header.data()), header.size() * sizeof(std::uint64_t)}) + base64(data);
}

}  // namespace

std::string xml_escaped(std::string_view text) {
    std::string result;
    for (const char c : without_controls(text)) {  // XML has none
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    }
    return result;
}

VtkXmlHeader::VtkXmlHeader(const std::string& data_set, const std::string& compressor) {
    const std::string order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
    line("<?xml version=\"1.0\"?>");
    line("<VTKFile type=\"" + data_set + "\" version=\"1.0\" byte_order=\"" + order + "\" header_type=\"UInt64\"" +
         (compressor.empty() ? "" : " compressor=\"" + compressor + "\"") + ">");
}

void VtkXmlHeader::array(const std::string& type, std::string_view name, std::size_t components, std::size_t block_size) {
    text_ += "<DataArray type=\"" + type + "\" Name=\"" + xml_escaped(name) + "\" NumberOfComponents=\"" +
             std::to_string(components) + "\" format=\"appended\" offset=\"" + std::to_string(offset_) + "\"/>\n";
    offset_ += block_size;
}

VtkXmlWriter::VtkXmlWriter(const std::string& data_set) : header_(data_set, "vtkZLibDataCompressor") {
}

void VtkXmlWriter::append(const char* type, std::string_view name, std::size_t components, std::span<const std::byte> bytes) {
    const std::string block = compressed_array({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    header_.array(type, name, components, block.size());
    appended_ += block;
}

// VTK's form: the characters' numbers, a 0 behind each string.
void VtkXmlWriter::strings(std::string_view name, std::span<const std::string> values) {
    std::string text = "<Array type=\"String\" Name=\"" + xml_escaped(name) + "\" NumberOfTuples=\"" +
                       std::to_string(values.size()) + "\" format=\"ascii\">\n";
    for (const auto& value : values) {
        for (const char c : value) text += std::to_string(int{static_cast<signed char>(c)}) + " ";
        text += "0\n";
    }
    line(text + "</Array>");
}

void VtkXmlWriter::write(OutputFile& out, const std::string& data_set_end) const {
    out.write(header_.text() + data_set_end + "\n<AppendedData encoding=\"base64\">\n_");
    out.write(appended_);
    out.write("\n</AppendedData>\n</VTKFile>\n");
}

}  // namespace subvol
