// SPDX-License-Identifier: Apache-2.0
// Refinement in Python: one level of a scheme for a mesh, tables that are applied many times, and the limit at parameters of
// cells.
//
//     subdivide        mesh ─► L levels, on request moved to the limit; schemes of tetrahedra give hexahedra again
//     Refinement       mesh ─► tables of L levels, once ─► other points, fields or arrays of the same cells
//     evaluate_limit   cells and (u, v, w) ─► positions, Jacobians, values and derivatives
//
// Tables hold no unused points, while arrays have a row for each point of the mesh: rows of used points are picked before
// tables are applied. Arrays of 32-bit floats stay so, all others become doubles. The Jacobian of query q is turned from
// columns to rows, so that jacobians[q] @ d(uvw) is d(x). A mesh of tetrahedra is joined from its split hexahedra before it is
// refined.
#include "bind.h"
#include "subvol/limit.h"
#include "subvol/mesh_motion.h"
#include "subvol/option.h"
#include "subvol/topology.h"

namespace subvol::python {
namespace {

HexMesh moved(HexMesh mesh, bool to_limit, Scheme scheme) {
    return to_limit ? on_limit(std::move(mesh), scheme) : mesh;
}

/// A level of a scheme. levels: of it, and its description
struct GivenLevel {
    GivenScheme scheme{};
    RefineOptions levels{.levels = 1};
};

std::vector<Option> options_of(GivenLevel& given) {
    std::vector<Option> all = options_of(given.scheme);
    all.push_back(subvol::options_of(given.levels).back());
    return all;
}

py::object subdivide(const HexMesh& mesh, bool to_limit, const py::object& progress, const py::kwargs& keywords) {
    GivenLevel given;
    set_options(options_of(given), keywords);
    const int levels = given.levels.levels;
    if (const auto tets = given.scheme.tets()) {
        return py::cast(result_of(progress, [&](Progress* listener) {
            return in_hexahedra(refined_tets(mesh, *tets, levels, given.scheme.rules.crease_angle_deg, to_limit, listener));
        }));
    }
    RefineOptions options{.scheme = given.scheme.hexes(), .levels = levels};
    HexMesh fine = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return moved(refine(mesh, options), to_limit, options.scheme.kind);
    });
    return with_sets(std::move(fine), sets_of_children(sets_of(mesh), levels));
}

/// A refinement that is computed once. Arrays have a row for each point of the mesh that it was made from, unused ones too.
class Refinement {
public:
    Refinement(const HexMesh& mesh, int levels, const std::string& scheme, double tension, const py::object& progress)
        : points_(mesh.points.size()) {
        validate(mesh);
        RefineOptions options = refine_options(scheme, levels, tension, {});
        find_used(mesh);
        control_ = without_unused_points({mesh.points, mesh.cells, {}, mesh.creases, mesh.sharp_faces});
        tables_ = result_of(progress, [&](Progress* listener) {
            options.progress = listener;
            return refinement_tables(build_topology(control_), options);
        });
    }

    [[nodiscard]] HexMesh apply_to_mesh(const HexMesh& given) const {
        const HexMesh* mesh = &given;
        std::optional<HexMesh> compact;
        if (given.points.size() == points_ && !used_.empty()) mesh = &compact.emplace(without_unused_points(given));
        if (!same_cells(control_, *mesh)) {
            throw Error(ErrorCode::InvalidInput, "has other cells than the mesh of the refinement", "apply",
                        "a mesh whose points and fields differ, not its cells");
        }
        const py::gil_scoped_release without_gil;
        HexMesh fine{{}, tables_.cells, {}, tables_.creases, tables_.sharp_faces};
        fine.points.resize(tables_.points());
        tables_.apply(std::span(reinterpret_cast<const double*>(mesh->points.data()), 3 * mesh->points.size()), 3,
                      std::span(reinterpret_cast<double*>(fine.points.data()), 3 * fine.points.size()));
        for (const Attribute& attribute : mesh->attributes) {
            fine.attributes.push_back(
                {attribute.name, attribute.channels,
                 tables_.apply(std::span<const double>(attribute.values), static_cast<std::size_t>(attribute.channels))});
        }
        return fine;
    }

    [[nodiscard]] py::array apply_to_array(const py::object& values, const py::object& out) const {
        const py::array given =
            array_from(values, {ErrorCode::InvalidInput, "cannot be made an array", "values", "an array of numbers"});
        return py::isinstance<py::array_t<float>>(given) ? apply_to<float>(given, out) : apply_to<double>(given, out);
    }

    [[nodiscard]] const RefinementTables& tables() const { return tables_; }
    [[nodiscard]] std::size_t points() const { return points_; }

    [[nodiscard]] py::tuple matrix() const {
        if (!used_.empty()) throw Error(ErrorCode::InvalidInput, "has unused points", "matrix", "mesh.without_unused_points()");
        CsrMatrix matrix = [&] {
            const py::gil_scoped_release without_gil;
            return tables_.over_control_points().csr();
        }();
        std::vector<std::int64_t> offsets(matrix.offsets.begin(), matrix.offsets.end());
        const py::ssize_t rows = length(offsets.size()), terms = length(matrix.columns.size());
        return py::make_tuple(owned(std::move(matrix.weights), {terms}), owned(std::move(matrix.columns), {terms}),
                              owned(std::move(offsets), {rows}));
    }

private:
    /// used_ stays empty if all points are used.
    void find_used(const HexMesh& mesh) {
        std::vector<std::uint8_t> seen(points_);
        for (const auto& cell : mesh.cells) {
            for (const Index corner : cell) seen[corner] = 1;
        }
        std::vector<Index> used;
        for (std::size_t p = 0; p < points_; ++p) {
            if (seen[p] != 0) used.push_back(static_cast<Index>(p));
        }
        if (used.size() < points_) used_ = std::move(used);
    }

    template <class T>
    [[nodiscard]] py::array apply_to(const py::array& given, const py::object& out) const {
        const bool flat = given.ndim() == 1;
        const py::ssize_t channels = flat ? 1 : given.ndim() == 2 ? given.shape(1) : 0;
        const py::array_t<T> rows = flat ? numbers<T>(given, "values") : rows_of<T>(given, channels, "values");
        if (static_cast<std::size_t>(rows.shape(0)) != points_ || channels < 1) {
            throw Error(ErrorCode::InvalidInput, "has " + std::to_string(rows.shape(0)) + " rows", "values",
                        "one for each of the " + std::to_string(points_) + " points");
        }
        std::vector<py::ssize_t> shape{length(tables_.points())};
        if (!flat) shape.push_back(channels);
        py::array_t<T> fine = out.is_none() ? py::array_t<T>(shape) : checked_out<T>(out, shape);
        const auto wide = static_cast<std::size_t>(channels);
        const T* from = rows.data();
        std::span<T> to(fine.mutable_data(), static_cast<std::size_t>(fine.size()));
        const py::gil_scoped_release without_gil;
        std::vector<T> chosen;
        for (const Index p : used_) chosen.insert(chosen.end(), from + p * wide, from + (p + 1) * wide);
        tables_.apply(used_.empty() ? std::span<const T>(from, points_ * wide) : std::span<const T>(chosen), wide, to);
        return fine;
    }

    template <class T>
    [[nodiscard]] static py::array_t<T> checked_out(const py::object& out, const std::vector<py::ssize_t>& shape) {
        bool fits = py::isinstance<py::array_t<T, py::array::c_style>>(out);
        if (fits) {
            const auto array = py::cast<py::array_t<T>>(out);
            fits = array.writeable() && std::equal(shape.begin(), shape.end(), array.shape(), array.shape() + array.ndim());
            if (fits) return array;
        }
        throw Error(ErrorCode::InvalidInput, "has another type, shape or order, or cannot be written to", "out",
                    "an array as apply would return it");
    }

    std::size_t points_;
    std::vector<Index> used_;
    HexMesh control_;
    RefinementTables tables_;
};

std::vector<Option> keywords_of(LimitOptions& options) {
    return scheme_and(options.scheme, options_of(options));
}

py::dict limit_of(const HexMesh& mesh, const py::object& cells, const py::object& uvw, const py::object& progress,
                  const py::kwargs& keywords) {
    const py::array_t<std::int64_t> numbers_of_cells = numbers<std::int64_t>(cells, "cells");
    const std::vector<Vec3> places = vectors(uvw, "uvw");
    if (static_cast<std::size_t>(numbers_of_cells.size()) != places.size()) {
        throw Error(ErrorCode::InvalidInput, "has " + std::to_string(places.size()) + " rows", "uvw",
                    "as many as cells: " + std::to_string(numbers_of_cells.size()));
    }
    std::vector<LimitQuery> queries(places.size());
    for (std::size_t q = 0; q < places.size(); ++q) {
        const std::int64_t cell = numbers_of_cells.data()[q];
        if (cell < 0 || static_cast<std::uint64_t>(cell) >= mesh.cells.size()) {
            throw Error(ErrorCode::InvalidInput, "there is no cell " + std::to_string(cell), "cells[" + std::to_string(q) + "]",
                        "0 to " + std::to_string(mesh.cells.size() - 1));
        }
        queries[q] = {static_cast<Index>(cell), places[q]};
    }
    LimitOptions options;
    set_options(keywords_of(options), keywords);
    LimitSamples samples = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return evaluate_limit(mesh, queries, options);
    });
    const py::ssize_t count = length(queries.size());
    // GLM's matrices are column-major: [q, column, row] in memory, turned so that jacobians[q] @ d(uvw) is d(x).
    std::vector<double> jacobians;
    jacobians.reserve(9 * queries.size());
    for (const Mat3& jacobian : samples.jacobians) {
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column) jacobians.push_back(jacobian[column][row]);
        }
    }
    py::dict fields, derivatives;
    for (LimitAttribute& attribute : samples.attributes) {
        const py::ssize_t channels = length(attribute.channels);
        const bool scalar = channels == 1;
        fields[py::str(attribute.name)] = owned(
            std::move(attribute.values), scalar ? std::vector<py::ssize_t>{count} : std::vector<py::ssize_t>{count, channels});
        py::array rows = owned(std::move(attribute.derivatives));
        derivatives[py::str(attribute.name)] = scalar ? rows : rows.reshape({count, channels, py::ssize_t(3)});
    }
    py::dict result, report;
    report["exact"] = samples.report.exact;
    report["refined"] = samples.report.refined;
    report["unconverged"] = samples.report.unconverged;
    report["deepest_level"] = samples.report.deepest_level;
    result["positions"] = owned(std::move(samples.positions));
    result["jacobians"] = owned(std::move(jacobians), {count, 3, 3});
    result["fields"] = fields;
    result["derivatives"] = derivatives;
    result["report"] = report;
    return result;
}

}  // namespace

MixedMesh refined_tets(const HexMesh& mesh, TetScheme scheme, int levels, const std::optional<double>& crease_angle,
                       bool through, Progress* progress, std::vector<Index>* cells) {
    constexpr double kCreaseAngleDeg = 60;  // as of the command
    MixedMesh control = join_split_cells(mesh);
    if (scheme == TetScheme::Boxspline) control = in_tetrahedra(std::move(control));
    const MixedRefineOptions options{
        .scheme = scheme, .levels = levels, .crease_angle_deg = crease_angle.value_or(kCreaseAngleDeg), .progress = progress};
    MixedMesh fine = through ? volume_through(control, options).mesh : refine(control, options);
    if (cells != nullptr) *cells = control_cells(control, levels);
    return fine;
}

void bind_refine(py::module_& module) {
    module.def("subdivide", &subdivide, py::arg("mesh"), py::arg("on_limit"), py::arg("progress"));
    GivenLevel given;
    describe(module, "subdivide", options_of(given));
    py::class_<Refinement>(module, "Refinement", "A refinement that is computed once and applied any number of times.")
        .def(py::init<const HexMesh&, int, const std::string&, double, const py::object&>(), py::arg("mesh"),
             py::arg("levels") = 1, py::arg("scheme") = "mcq", py::arg("tension") = 1.0 / 16.0,
             py::arg("progress") = py::none())
        .def("apply", &Refinement::apply_to_mesh, py::arg("mesh"))
        .def("apply", &Refinement::apply_to_array, py::arg("values"), py::arg("out") = py::none())
        .def("matrix", &Refinement::matrix)
        .def_property_readonly("points", [](const Refinement& r) { return r.tables().points(); })
        .def_property_readonly("control_points", &Refinement::points)
        .def_property_readonly("levels", [](const Refinement& r) { return r.tables().levels.size(); })
        .def_property_readonly("nbytes", [](const Refinement& r) { return r.tables().bytes(); })
        .def_property_readonly("cells",
                               [](const py::object& self) {
                                   const auto& cells = self.cast<const Refinement&>().tables().cells;
                                   return view(cells.front().data(), {length(cells.size()), 8}, self);
                               })
        .def("__repr__", [](const Refinement& r) {
            return "<subvol.Refinement: " + std::to_string(r.points()) + " points to " + std::to_string(r.tables().points()) +
                   " in " + std::to_string(r.tables().levels.size()) + (r.tables().levels.size() == 1 ? " level>" : " levels>");
        });
    module.def("evaluate_limit", &limit_of, py::arg("mesh"), py::arg("cells"), py::arg("uvw"), py::arg("progress"));
    LimitOptions limit;
    describe(module, "evaluate_limit", keywords_of(limit));
}

}  // namespace subvol::python
