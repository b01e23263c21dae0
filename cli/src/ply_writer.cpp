#include "ply_writer.h"

#include <bit>
#include <cstdint>
#include <fstream>
#include <limits>

#include "subvol/atomic_file.h"
#include "subvol/error.h"

namespace subvol::cli {
namespace {

static_assert(std::endian::native == std::endian::little, "the binary encoding writes numbers as they lie in memory");

/// Puts numbers one after the other in either encoding.
class NumberWriter {
public:
    NumberWriter(std::ostream& out, PlyEncoding encoding) : out_(out), ascii_(encoding == PlyEncoding::Ascii) {}

    template <class Number>
    void put(Number number) {
        if (!ascii_) {
            out_.write(reinterpret_cast<const char*>(&number), sizeof number);
            return;
        }
        out_.precision(std::numeric_limits<Number>::max_digits10);
        out_ << +number << ' ';
    }

    void put_point(const Vec3& p) {
        put(p.x);
        put(p.y);
        put(p.z);
    }

    void end_row() {
        if (ascii_) out_ << '\n';
    }

private:
    std::ostream& out_;
    bool ascii_;
};

void write_header(std::ostream& out, const RbfVolume& volume, PlyEncoding encoding) {
    out << "ply\nformat " << (encoding == PlyEncoding::Ascii ? "ascii" : "binary_little_endian") << " 1.0\n"
        << "comment OpenSubVol radial basis functions: w = (1-e)^3, e = d.inverse(S).d < 1, d = x - centre\n"
        << "comment a kernel stands for value + gradient.d + moment*e; the field is their w-weighted mean inside the boundary\n"
        << "comment field " << volume.channels.front().name << '\n'
        << "comment kernel_radius " << support_radius(volume.kernel) << '\n'
        << "element vertex " << volume.size() << '\n';
    for (const char* name : {"x", "y", "z"}) out << "property double " << name << '\n';
    for (const char* name : {"value", "gx", "gy", "gz", "moment", "sxx", "sxy", "sxz", "syy", "syz", "szz"}) {
        out << "property float " << name << '\n';
    }
    out << "element boundary_vertex " << volume.boundary.points.size() << '\n';
    for (const char* name : {"x", "y", "z"}) out << "property double " << name << '\n';
    out << "element boundary_triangle " << volume.boundary.triangles.size() << '\n'
        << "property list uchar uint vertex_indices\nend_header\n";
}

void write_kernels(NumberWriter& out, const RbfVolume& volume) {
    const RbfChannel& channel = volume.channels.front();
    for (std::size_t i = 0; i < volume.size(); ++i) {
        out.put_point(volume.centers[i]);
        out.put(channel.values[i]);
        for (float g : channel.gradients[i]) out.put(g);
        out.put(channel.moments[i]);
        for (float s : volume.frames[i]) out.put(s);
        out.end_row();
    }
}

void write_boundary(NumberWriter& out, const Surface& boundary) {
    for (const Vec3& p : boundary.points) {
        out.put_point(p);
        out.end_row();
    }
    for (const auto& triangle : boundary.triangles) {
        out.put(std::uint8_t{3});
        for (Index p : triangle) out.put(static_cast<std::uint32_t>(p));
        out.end_row();
    }
}

}  // namespace

void write_ply(const std::filesystem::path& path, const RbfVolume& volume, PlyEncoding encoding) {
    AtomicFile file(path);
    std::ofstream out(file.path(), std::ios::binary);
    write_header(out, volume, encoding);
    NumberWriter numbers(out, encoding);
    write_kernels(numbers, volume);
    write_boundary(numbers, volume.boundary);
    out.close();
    if (!out) throw Error(ErrorCode::Io, "could not be written", path.string());
    file.commit();
}

}  // namespace subvol::cli
