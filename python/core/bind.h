// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "subvol/camera.h"
#include "subvol/error.h"
#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/limit.h"
#include "subvol/mesh_sets.h"
#include "subvol/optics.h"
#include "subvol/option.h"
#include "subvol/picture_look.h"
#include "subvol/progress.h"
#include "subvol/refine.h"
#include "subvol/refine_mixed.h"

namespace subvol::python {

namespace py = pybind11;

/// A surface of triangles as arrays: (n,3) float64 and (m,3) integers.
struct SurfaceArrays {
    py::array points;
    py::array triangles;
};

// Arrays that come in. `what` is their name in messages. Numbers of any width and stride are accepted; text, objects and
// complex numbers are refused with Error(InvalidInput), as is another shape. Arrays of the type T in C order are read in place.

/// The array that numpy makes of it, copied only if it must be. TypeError and ValueError, by which numpy says that it cannot,
/// become the Error; what the object's own code raises besides, KeyboardInterrupt and MemoryError too, passes on.
[[nodiscard]] py::array array_from(const py::handle& given, const Error& otherwise);

/// Rows of N numbers each.
template <class T>
[[nodiscard]] py::array_t<T> rows_of(const py::handle& given, py::ssize_t columns, const std::string& what);
/// A row of numbers.
template <class T>
[[nodiscard]] py::array_t<T> numbers(const py::handle& given, const std::string& what);
/// Point numbers from 0 to below `end`, N a row.
template <std::size_t N>
[[nodiscard]] std::vector<std::array<Index, N>> index_rows(const py::handle& given, std::size_t end, const std::string& what);
[[nodiscard]] std::vector<Vec3> vectors(const py::handle& given, const std::string& what);
/// A field of (points,) or (points, channels) numbers.
[[nodiscard]] Attribute attribute_of(const std::string& name, const py::handle& given, std::size_t points);
/// Arrays by name, as the mapping has them: `use(name, array)`.
///
/// throws: Error(InvalidInput) if it is not a mapping, or a name is not text: 3 and "3" would be one name
void for_each_named(const py::handle& given, const std::string& what,
                    const std::function<void(const std::string& name, const py::handle& array)>& use);

/// TypeError: "grids[1]: a Grid is needed, not NoneType".
[[noreturn]] void refuse_type(const std::string& what, const std::string& needed, const py::handle& given);

/// An object of ours. pybind11 would make a null pointer of None, and other words of another type.
template <class T>
[[nodiscard]] const T& object_of(const py::handle& given, const std::string& what, const std::string& needed) {
    if (!py::isinstance<T>(given)) refuse_type(what, needed, given);
    return given.cast<const T&>();
}
/// The objects of a list or tuple, which has to outlive the pointers. This is how every call takes several objects of ours.
template <class T>
[[nodiscard]] std::vector<const T*> objects_of(const py::handle& given, const std::string& what, const std::string& needed) {
    if (!py::isinstance<py::list>(given) && !py::isinstance<py::tuple>(given)) refuse_type(what, "a list", given);
    std::vector<const T*> objects;
    for (const py::handle item : given)
        objects.push_back(&object_of<T>(item, what + "[" + std::to_string(objects.size()) + "]", needed));
    return objects;
}

/// A read-only array over memory of `owner`, which the array keeps alive. The memory must not move as long as the owner lives.
template <class T>
[[nodiscard]] py::array view(const T* data, std::vector<py::ssize_t> shape, const py::handle& owner) {
    py::array array(py::dtype::of<T>(), std::move(shape), data, owner);
    py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
    return array;
}

/// An array that owns the vector's memory: nothing is copied. Python may write to it.
template <class T>
[[nodiscard]] py::array owned(std::vector<T> values, std::vector<py::ssize_t> shape) {
    auto* kept = new std::vector<T>(std::move(values));
    const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<T>*>(p); });
    return py::array(py::dtype::of<T>(), std::move(shape), kept->data(), owner);
}
[[nodiscard]] py::array owned(std::vector<Vec3> values);

/// What a property returns that is made anew each time, so that a change of it would be lost without a word: an array that
/// cannot be written to, or a dictionary that refuses changes with a sentence (subvol/_read_only.py).
///
/// of: whose property it is, as in "the fields of a mesh"; instead: how to have another, as in "mesh.with_fields({…})"
[[nodiscard]] py::array read_only(py::array array);
[[nodiscard]] py::object read_only(const py::dict& items, const char* of, const char* instead = "");

[[nodiscard]] inline py::ssize_t length(std::size_t n) {
    return static_cast<py::ssize_t>(n);
}

[[nodiscard]] inline py::tuple as_tuple(const Vec3& v) {
    return py::make_tuple(v.x, v.y, v.z);
}

/// Lower and upper corner, (2,3).
[[nodiscard]] py::array as_array(const Box& box);

/// The patches and sets of a mesh that was read; none for others. Meshes are given to C++ without them. They are copied, as
/// another thread of Python may give the mesh others while a call works with them.
[[nodiscard]] MeshSets sets_of(const py::object& mesh);
/// The same of a mesh that came from Python.
[[nodiscard]] MeshSets sets_of(const HexMesh& mesh);
/// A mesh as an object of Python, with its patches and sets.
[[nodiscard]] py::object with_sets(HexMesh mesh, MeshSets sets);

/// Does long work on a thread of its own, while this one, without the GIL, waits, passes on what is reported, and looks for
/// signals: so Ctrl-C ends the work wherever it runs, and `progress` is called on the thread that made the call.
///
/// progress: None, or a callable (stage: str, fraction: float); an exception in it cancels the work and is raised
void run(const py::object& progress, const std::function<void(Progress*)>& work);

/// The same with a result.
template <class Work>
[[nodiscard]] auto result_of(const py::object& progress, const Work& work) {
    std::optional<decltype(work(static_cast<Progress*>(nullptr)))> result;
    run(progress, [&](Progress* listener) { result.emplace(work(listener)); });
    return std::move(*result);
}

/// Facts under their names; groups are dictionaries, too.
[[nodiscard]] py::dict dict_of(const Facts& facts);

/// Keywords set the members that their descriptions refer to; None leaves the default.
///
/// throws:  TypeError for another keyword or type; Error(InvalidInput) for a value that the description does not allow, and for
///          one that has no effect with the others
/// besides: options that were given in another way
void set_options(const std::vector<Option>& options, const py::dict& given, const std::vector<std::string>& besides = {});
/// Puts the keywords of a call into `module.keywords`, from which signatures, docstrings and stubs are made.
///
/// besides: options that are not keywords of this kind
void describe(py::module_& module, const char* call, const std::vector<Option>& options,
              const std::vector<std::string>& besides = {});
/// The options of a scheme and others; the error for a scheme of tetrahedra says what to do.
[[nodiscard]] std::vector<Option> scheme_and(SchemeOptions& scheme, std::vector<Option> others = {});

/// The look of a picture and its colours.
struct PictureLight {
    LookOptions options;
    Optics optics;
};

/// Seeds of streamlines: None: middles of cells; a text or several as of `parse_seeds`; else places (n,3).
[[nodiscard]] std::vector<Vec3> seeds_in(const HexMesh& mesh, const py::object& seeds, std::size_t count,
                                         const LimitOptions& limit);

/// A scheme of hexahedra, or of tetrahedra.
struct GivenScheme {
    std::string name = "mcq";
    SchemeOptions rules{};  ///< all of the scheme but its kind

    [[nodiscard]] std::optional<TetScheme> tets() const;
    /// throws: Error(InvalidInput) for another scheme
    [[nodiscard]] SchemeOptions hexes() const;
};

[[nodiscard]] std::vector<Option> options_of(GivenScheme& scheme);

/// Words of the command for the library's enumerators. throws: Error(InvalidInput) that lists the words
[[nodiscard]] Scheme scheme_named(const std::string& name);
/// The volume of a scheme of tetrahedra, as the command makes it.
///
/// crease_angle: none: 60 degrees
/// through:      whether it passes through the points and values of the mesh, on the limit
/// cells:        gets the control cells of its cells; null: they are not asked for
[[nodiscard]] MixedMesh refined_tets(const HexMesh& mesh, TetScheme scheme, int levels,
                                     const std::optional<double>& crease_angle, bool through, Progress* progress,
                                     std::vector<Index>* cells = nullptr);
[[nodiscard]] RefineOptions refine_options(const std::string& scheme, int levels, double tension,
                                           const std::optional<double>& crease_angle);

void bind_mesh(py::module_& module);
void bind_refine(py::module_& module);
void bind_measure(py::module_& module);
void bind_points(py::module_& module);
void bind_look(py::module_& module);
void bind_render(py::module_& module);
void bind_compare(py::module_& module);
void bind_page(py::module_& module);
void bind_studies(py::module_& module);

}  // namespace subvol::python
