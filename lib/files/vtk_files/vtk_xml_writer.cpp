// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/vtk_xml_writer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "subvol/detail/text_codes.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/detail/vtu_bytes.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kBlock = 1 << 17;  // bytes that are compressed together
constexpr std::size_t kAtOnce = 32;      // blocks that all threads compress before the next ones are begun

// The fastest level: higher ones gain only a few percent, since the last digits of numbers are mostly noise.
std::string zipped(std::span<const std::byte> bytes) {
    return zlib_compressed({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, 1);
}

}  // namespace

std::string attribute_value(std::string_view text) {
    return xml_escaped(without_controls(text));
}

VtkXmlWriter::VtkXmlWriter(OutputFile& out, const std::string& data_set) : out_(out), data_set_(data_set) {
    const std::string order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
    line("<?xml version=\"1.0\"?>");
    line("<VTKFile type=\"" + data_set + "\" version=\"1.0\" byte_order=\"" + order +
         "\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<" + data_set + ">");
}

// An array begins with a header: the number of blocks, their size, the size of the last one if it is not full, and the
// compressed size of each. These sizes are known only at the end: the header is then overwritten, so that no more than kAtOnce
// blocks need to be in memory.
void VtkXmlWriter::write_array(const char* type, std::string_view name, std::size_t components, std::size_t bytes,
                               const Fill& fill, std::optional<std::size_t> tuples) {
    line("<DataArray type=\"" + std::string(type) + "\" Name=\"" + attribute_value(name) + "\" NumberOfComponents=\"" +
         std::to_string(components) + (tuples ? "\" NumberOfTuples=\"" + std::to_string(*tuples) : std::string()) +
         "\" format=\"binary\">");
    const std::size_t count = (bytes + kBlock - 1) / kBlock;
    std::vector<std::uint64_t> header{count, kBlock, bytes % kBlock};
    header.resize(3 + count);
    const auto header_text = [&] {
        return base64({reinterpret_cast<const char*>(header.data()), header.size() * sizeof(std::uint64_t)});
    };
    const std::uint64_t place = out_.position();
    out_.write(header_text());
    std::string data;  // not written yet: base64 encodes groups of three bytes
    for (std::size_t first = 0; first < count; first += kAtOnce) {
        std::vector<std::string> blocks(std::min(kAtOnce, count - first));
        tbb::parallel_for(std::size_t{0}, blocks.size(), [&](std::size_t b) {
            const std::size_t begin = (first + b) * kBlock;
            std::vector<std::byte> block(std::min(kBlock, bytes - begin));
            fill(begin, block);
            blocks[b] = zipped(block);
        });
        for (std::size_t b = 0; b < blocks.size(); ++b) {
            header[3 + first + b] = blocks[b].size();
            data += blocks[b];
            const std::size_t whole = data.size() / 3 * 3;
            out_.write(base64(std::string_view(data).substr(0, whole)));
            data.erase(0, whole);
        }
    }
    out_.write(base64(data));
    out_.overwrite(place, header_text());
    line("\n</DataArray>");
}

// VTK's form: character codes, with a 0 after each string.
void VtkXmlWriter::strings(std::string_view name, std::span<const std::string> values) {
    std::string text = "<Array type=\"String\" Name=\"" + attribute_value(name) + "\" NumberOfTuples=\"" +
                       std::to_string(values.size()) + "\" format=\"ascii\">\n";
    for (const auto& value : values) {
        for (const char c : value) text += std::to_string(int{static_cast<signed char>(c)}) + " ";
        text += "0\n";
    }
    line(text + "</Array>");
}

void VtkXmlWriter::end() {
    line("</" + data_set_ + ">\n</VTKFile>");
}

}  // namespace subvol::detail
