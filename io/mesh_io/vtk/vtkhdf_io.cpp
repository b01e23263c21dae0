// SPDX-License-Identifier: Apache-2.0
// Reads and writes unstructured grids of VTKHDF. All partitions of all steps lie one after the other in the same datasets, so a
// part of the mesh is a range of each:
//
//     Steps: the step's first partition, its number of partitions, and where its points, cells and corners begin
//       └→ NumberOfPoints, NumberOfCells, … of each partition → ranges of Points, Types, Offsets, Connectivity, arrays
//
// Offsets have one more entry than cells in each partition. The faces of polyhedra are not placed by steps: the counts of all
// partitions before are added up. Arrays may begin at places of their own. Each partition becomes a part; parts are joined to
// one mesh. A file is written with one partition: fields and sets as arrays, whole numbers of labels as integers.
#include <algorithm>
#include <tuple>
#include <utility>

#include "assemble.h"
#include "formats.h"
#include "join_pieces.h"
#include "mesh_arrays.h"
#include "mesh_file.h"
#include "subvol/detail/hdf5_file.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/vtkhdf_writer.h"
#include "subvol/error.h"
#include "vtk_cells.h"

namespace subvol::detail {

namespace {

const std::string kRoot = "/VTKHDF";
const std::string kSteps = kRoot + "/Steps";

constexpr std::string_view kAmrType = "OverlappingAMR";

// Returns the type.
std::string check_root(const Hdf5File& file) {
    const auto version = file.numbers(kRoot, "Version");
    if (version.empty()) file.fail("not a VTKHDF file: there is no group VTKHDF with a version");
    if (version[0] != 1 && version[0] != 2) {
        file.fail("version " + std::to_string(version[0]) + " of VTKHDF is not supported", "1 and 2 are");
    }
    // Files of the first writers have no type: they are unstructured grids.
    const std::string type = file.text(kRoot, "Type").value_or(file.has(kRoot + "/Types") ? "UnstructuredGrid" : "");
    if (type != "UnstructuredGrid" && type != kAmrType) {
        file.fail(in_quotes(type) + " is not an UnstructuredGrid or OverlappingAMR", "a volume mesh of these types is needed");
    }
    return type;
}

// Where the values of a partition begin, and how many there are.
struct Range {
    std::size_t first = 0, count = 0;
};
// faces, face_corners, cell_faces: those of polyhedra
struct Partition {
    Range points, cells, corners, faces, face_corners, cell_faces;
    std::size_t offsets = 0, face_offsets = 0;  // each partition has one more of them than cells or faces
};

class VtkHdfReader {
public:
    VtkHdfReader(const Hdf5File& file, const ReadOptions& options)
        : file_(file), options_(options), in_(std::string_view(), file.name(), TextScanner::Comments::None) {
        in_.name_no_place();
    }

    ReadResult read() {
        std::vector<std::string> warnings;
        const std::size_t steps = std::max<std::size_t>(1, vtkhdf_times(file_).size());
        step_ = chosen_step(options_, steps, file_.name(), warnings);
        std::vector<MeshFile> parts;
        const std::vector<Partition> partitions = find_partitions();
        for (const Partition& partition : partitions) {
            if (partition.points.count > 0) parts.push_back(read_part(partition, partitions.size() == 1));
        }
        if (parts.empty()) parts.emplace_back();
        MeshFile found = parts.size() == 1 ? std::move(parts.front()) : join_pieces(std::move(parts), "part", file_.name());
        found.warnings.insert(found.warnings.begin(), warnings.begin(), warnings.end());
        add_left_out_warning(found, {}, file_.name());
        return assemble(std::move(found), file_.name(), kVtkNames, options_);
    }

private:
    // A number of the step, in a dataset of the group Steps; the other number if there is none.
    [[nodiscard]] std::size_t of_step(const std::string& name, std::size_t otherwise) const {
        const std::string path = kSteps + "/" + name;
        if (!file_.has(path) || file_.rows(path) == 0) return otherwise;  // before the first step is written
        const auto values = file_.integers(path, step_, 1);
        if (values.empty()) return otherwise;
        return checked(values[0], path);
    }

    [[nodiscard]] std::size_t checked(std::int64_t count, const std::string& path) const {
        if (count < 0 || static_cast<std::uint64_t>(count) >= kNone) {
            file_.fail(in_quotes(path) + ": count out of range: " + std::to_string(count));
        }
        return static_cast<std::size_t>(count);
    }

    [[nodiscard]] std::vector<Partition> find_partitions() const {
        const std::size_t all = file_.rows(kRoot + "/NumberOfPoints");
        const std::size_t first = of_step("PartOffsets", 0);
        const std::size_t count = of_step("NumberOfParts", all > first ? parts_from(first, all) : 0);
        const auto points = file_.integers(kRoot + "/NumberOfPoints", first, count);
        const auto cells = file_.integers(kRoot + "/NumberOfCells", first, count);
        const auto corners = file_.integers(kRoot + "/NumberOfConnectivityIds", first, count);
        Partition next;
        next.points.first = of_step("PointOffsets", 0);
        next.cells.first = of_step("CellOffsets", 0);
        next.corners.first = of_step("ConnectivityIdOffsets", 0);
        std::vector<Partition> partitions;
        for (std::size_t p = 0; p < count; ++p) {
            next.points.count = checked(points[p], kRoot + "/NumberOfPoints");
            next.cells.count = checked(cells[p], kRoot + "/NumberOfCells");
            next.corners.count = checked(corners[p], kRoot + "/NumberOfConnectivityIds");
            next.offsets = next.cells.first + first + p;
            partitions.push_back(next);
            next.points.first += next.points.count;
            next.cells.first += next.cells.count;
            next.corners.first += next.corners.count;
        }
        if (file_.has(kRoot + "/NumberOfFaces")) find_faces(first, partitions);
        return partitions;
    }

    // The faces of polyhedra follow each other in the order of the partitions of all steps. first: the step's first partition
    void find_faces(std::size_t first, std::vector<Partition>& partitions) const {
        const auto place = [&](const char* name, Range Partition::*range) {
            const std::string path = kRoot + "/" + name;
            std::size_t begin = 0;
            const auto counts = file_.integers(path, 0, first + partitions.size());
            for (std::size_t p = 0; p < counts.size(); ++p) {
                const std::size_t count = checked(counts[p], path);
                if (p >= first) partitions[p - first].*range = {begin, count};
                begin += count;
                std::ignore = checked(static_cast<std::int64_t>(begin), path);
            }
        };
        place("NumberOfFaces", &Partition::faces);
        place("NumberOfFaceConnectivityIds", &Partition::face_corners);
        place("NumberOfPolyhedronToFaceIds", &Partition::cell_faces);
        for (std::size_t p = 0; p < partitions.size(); ++p) {
            partitions[p].face_offsets = partitions[p].faces.first + first + p;
        }
    }

    // The offsets of other cells than polyhedra repeat.
    [[nodiscard]] VtkFaces read_faces(const Partition& part) const {
        const auto list = [&](const char* name, std::size_t begin, std::size_t count) {
            return file_.integers(kRoot + "/" + name, begin, count);
        };
        const auto ends = [&](const char* name, std::size_t begin, std::size_t count) {
            std::vector<std::int64_t> all = list(name, begin, count + 1);
            all.erase(all.begin());
            return all;
        };
        VtkFaces faces;
        faces.points = list("FaceConnectivity", part.face_corners.first, part.face_corners.count);
        faces.point_ends = ends("FaceOffsets", part.face_offsets, part.faces.count);
        faces.numbers = list("PolyhedronToFaces", part.cell_faces.first, part.cell_faces.count);
        faces.number_ends = ends("PolyhedronOffsets", part.offsets, part.cells.count);
        return faces;
    }

    // Up to the first partition of another step.
    [[nodiscard]] std::size_t parts_from(std::size_t first, std::size_t all) const {
        const std::string path = kSteps + "/PartOffsets";
        if (!file_.has(path)) return all - first;
        std::size_t end = all;
        for (const std::int64_t other : file_.integers(path)) {
            if (other > static_cast<std::int64_t>(first)) end = std::min(end, static_cast<std::size_t>(other));
        }
        return end - first;
    }

    MeshFile read_part(const Partition& part, bool alone) const {
        MeshFile found;
        const std::string points = kRoot + "/Points";
        if (file_.columns(points) != 3) file_.fail(in_quotes(points) + " does not have three columns");
        const auto places = file_.reals(points, part.points.first, part.points.count);
        found.points.reserve(part.points.count);
        for (std::size_t p = 0; p < part.points.count; ++p) {
            add_point(found, {places[3 * p], places[3 * p + 1], places[3 * p + 2]}, 0);
        }
        read_cells(part, found, alone);
        return found;
    }

    // Cells, and then the arrays.
    void read_cells(const Partition& part, MeshFile& found, bool alone) const {
        const auto types = file_.integers(kRoot + "/Types", part.cells.first, part.cells.count);
        const auto ends = file_.integers(kRoot + "/Offsets", part.offsets, part.cells.count + 1);
        const auto corners = file_.integers(kRoot + "/Connectivity", part.corners.first, part.corners.count);
        const bool polyhedra = std::ranges::find(types, kVtkPolyhedron) != types.end();
        if (polyhedra && !file_.has(kRoot + "/NumberOfFaces")) file_.fail("its polyhedra have no faces");
        const VtkFaces faces = polyhedra ? read_faces(part) : VtkFaces{};
        VtkCellSorter sorter(in_, found, options_);
        std::vector<Index> of_cell;
        for (std::size_t c = 0; c < part.cells.count; ++c) {
            if (ends[c] < 0 || ends[c + 1] < ends[c] || ends[c + 1] > static_cast<std::int64_t>(corners.size())) {
                file_.fail("\"" + kRoot + "/Offsets\": " + kVtkNames.cell(c) + " ends at " + std::to_string(ends[c + 1]),
                           "up to " + std::to_string(corners.size()) + ", never falling");
            }
            of_cell.clear();
            for (std::int64_t k = ends[c]; k < ends[c + 1]; ++k) {
                const std::int64_t corner = corners[static_cast<std::size_t>(k)];
                if (corner < 0 || static_cast<std::size_t>(corner) >= part.points.count) {
                    file_.fail(kVtkNames.cell(c) + ": there is no point with index " + std::to_string(corner),
                               "there are " + std::to_string(part.points.count) + " points, counted from 0");
                }
                of_cell.push_back(static_cast<Index>(corner));
            }
            if (types[c] != kVtkPolyhedron) {
                sorter.take(types[c], of_cell, 0);
                continue;
            }
            auto faces_of_cell = faces.of_cell(c, 0, part.points.count);
            if (!faces_of_cell) file_.fail(kVtkNames.cell(c) + ": its faces are not those of a polyhedron");
            sorter.take_polyhedron(std::move(*faces_of_cell));
        }
        // Polyhedra are split once all arrays are there.
        read_arrays(part.points, "PointData", false, found);
        read_arrays(part.cells, "CellData", true, found);
        if (alone) read_field_data(found);
        sorter.report(alone ? std::optional<std::string_view>(file_.name()) : std::nullopt);
        refuse_not_finite(found, in_, kVtkNames);
    }

    void read_field_data(MeshFile& found) const {
        std::vector<NamedNumbers> taken;
        std::vector<std::string> ignored;
        for (const std::string& name : file_.names(kRoot + "/FieldData")) {
            const std::string path = kRoot + "/FieldData/" + name;
            const auto there = is_field_array(name) ? file_.find(path) : std::nullopt;
            if (is_time_array(name) && file_.has(path) && file_.rows(path) == 1 && file_.columns(path) == 1) {
                take_time(name, file_.reals(path), found);
                continue;
            }
            if (!there) {
                found.ignored.push_back({"array", as_utf8(name), 1, "it is at no points or cells"});
                continue;
            }
            if (!there->characters && is_integer(there->type)) {
                taken.push_back({as_utf8(name), file_.integers(path)});
            } else {
                ignored.push_back(as_utf8(name));
            }
        }
        take_field_arrays(taken, found);
        ignore_field_arrays(ignored, found);
        take_node_set_arrays(found);
    }

    // Arrays may have offsets of their own at each step.
    void read_arrays(const Range& range, const std::string& group, bool at_cells, MeshFile& found) const {
        ByName<FileSet> sets(found.sets);
        for (const std::string& name : file_.names(kRoot + "/" + group)) {
            const std::string path = kRoot + "/" + group + "/" + name;
            if (!file_.has(path)) {
                found.ignored.push_back({"array", as_utf8(name), 1, "it consists of texts"});
                continue;
            }
            const std::size_t components = file_.columns(path);
            if (components == 0) continue;
            const std::size_t of_mesh = of_step(at_cells ? "CellOffsets" : "PointOffsets", 0);
            const std::size_t first = of_step(group + "Offsets/" + name, of_mesh) + (range.first - of_mesh);
            auto values = file_.reals(path, first, range.count);
            if (at_cells && is_set_array(name, components)) {
                add_to_set(sets, as_utf8(name), 0, values);
            } else {
                found.arrays.push_back({as_utf8(name), static_cast<int>(components), at_cells, std::move(values)});
                const auto there = file_.find(path);
                found.arrays.back().integers = there && is_integer(there->type);
            }
        }
    }

    const Hdf5File& file_;
    ReadOptions options_;
    TextScanner in_;
    std::size_t step_ = 0;
};

}  // namespace

ReadResult read_vtkhdf(const Hdf5File& file, const ReadOptions& options) {
    return check_root(file) == kAmrType ? read_vtkhdf_amr(file, options) : VtkHdfReader(file, options).read();
}

std::vector<double> vtkhdf_times(const Hdf5File& file) {
    static_cast<void>(check_root(file));
    const std::string path = kSteps + "/Values";
    return file.has(path) ? file.reals(path) : std::vector<double>();
}

ReadResult read_vtkhdf(const std::filesystem::path& path, const ReadOptions& options) {
    return read_vtkhdf(Hdf5File(open_hdf5(path), path.string()), options);
}

std::vector<double> vtkhdf_times(const std::filesystem::path& path) {
    return vtkhdf_times(Hdf5File(open_hdf5(path), path.string()));
}

std::vector<std::string> write_vtkhdf(const std::filesystem::path& path, const WrittenMesh& written) {
    const HexMesh& mesh = written.mesh;
    constexpr std::uint8_t kHexahedron = 12;
    VtkHdfWriter out(path);
    std::vector<std::int64_t> corners;
    corners.reserve(8 * mesh.cells.size());
    for (const auto& cell : mesh.cells) corners.insert(corners.end(), cell.begin(), cell.end());
    out.grid(mesh.points, corners, kHexahedron, 8);
    std::vector<std::string> warnings;
    const auto warn = [&](const char* kind, const std::string& name, const std::string& in_file) {
        if (name != in_file) warnings.push_back(std::string(kind) + " " + in_quotes(name) + " is called " + in_quotes(in_file));
    };
    for (const Attribute& attribute : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        const bool at_cells = is_at_cells(mesh, attribute);
        const std::span<const double> values = at_cells ? attribute.cells : attribute.values;
        if (at_cells && attribute.constant && are_whole(values)) {  // labels, which readers take for such by their type
            const std::vector<std::int64_t> labels(values.begin(), values.end());
            warn("field", attribute.name, out.cell_array(attribute.name, std::span<const std::int64_t>(labels), channels));
            continue;
        }
        warn("field", attribute.name,
             at_cells ? out.cell_array(attribute.name, values, channels) : out.array(attribute.name, values, channels));
    }
    std::vector<std::uint8_t> in_set;
    for (const CellSet& set : written.sets.sets) {
        if (set.cells.empty()) continue;
        in_set.assign(mesh.cells.size(), 0);
        for (const Index c : set.cells) in_set[c] = 1;
        const std::string name = set_array_name(set);
        warn("array", name, out.cell_array(name, std::span<const std::uint8_t>(in_set)));
    }
    for (const NodeSet& set : written.sets.nodes) {
        if (set.cells.empty()) continue;
        const std::string name = node_array_name(set);
        const std::vector<std::uint8_t> flags = flags_of(mesh, set, mesh.points.size());
        warn("array", name, out.array(name, std::span<const std::uint8_t>(flags), 1));
    }
    for (const NamedNumbers& array : settled_arrays(mesh, written.sets))
        warn("array", array.name, out.field(array.name, array.numbers));
    out.commit();
    return warnings;
}

}  // namespace subvol::detail
