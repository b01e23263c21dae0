// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <utility>

#include "bind.h"

namespace subvol::python {
namespace {

/// What numpy makes, or the error if it cannot.
template <class Make>
auto or_error(const Make& make, const Error& otherwise) {
    try {
        return make();
    } catch (py::error_already_set& error) {
        if (error.matches(PyExc_TypeError) || error.matches(PyExc_ValueError)) throw otherwise;
        throw;
    }
}

/// numpy takes a sequence whose length raises an exception for an object, and drops the exception: this raises it again.
void raise_of_lengths(const py::array& objects) {
    for (const py::handle object : objects.attr("ravel")()) {
        if (PySequence_Check(object.ptr()) != 0 && PySequence_Size(object.ptr()) < 0) throw py::error_already_set();
    }
}

std::string shape_of(const py::array& array) {
    std::string text = "(";
    for (py::ssize_t d = 0; d < array.ndim(); ++d) text += (d > 0 ? ", " : "") + std::to_string(array.shape(d));
    return text + (array.ndim() == 1 ? ",)" : ")");
}

/// Any array of numbers, as numpy makes it of what was given.
py::array array_of(const py::handle& given, bool integers, const std::string& what) {
    py::array array = array_from(given, {ErrorCode::InvalidInput, "cannot be made an array", what, "an array of numbers"});
    const char kind = array.dtype().kind();
    const bool right = kind == 'i' || kind == 'u' || (kind == 'f' && !integers);
    if (right || array.size() == 0) return array;
    throw Error(ErrorCode::InvalidInput, "has the type " + py::str(array.dtype()).cast<std::string>(), what,
                integers ? "integers" : "real numbers");
}

/// Whether there are numbers that int64 does not hold: numpy would make negative ones of them.
bool beyond_int64(const py::array& array) {
    if (array.dtype().kind() != 'u' || array.itemsize() < 8) return false;
    const py::array_t<std::uint64_t, py::array::c_style | py::array::forcecast> all(array);
    return std::any_of(all.data(), all.data() + all.size(), [](std::uint64_t n) { return n >> 63 != 0; });
}

template <class T>
py::array_t<T> converted(const py::array& array, const std::string& what) {
    if (std::is_same_v<T, std::int64_t> && beyond_int64(array)) {
        throw Error(ErrorCode::InvalidInput, "has a number of 2^63 or more", what, "numbers below 2^63");
    }
    return or_error([&] { return py::array_t<T, py::array::c_style | py::array::forcecast>(array); },
                    {ErrorCode::InvalidInput, "cannot be converted", what, "an array of numbers"});
}

void check_columns(const py::array& array, py::ssize_t columns, const std::string& what) {
    if (array.ndim() == 2 && array.shape(1) == columns) return;
    throw Error(ErrorCode::InvalidInput, "has the shape " + shape_of(array), what, "(n, " + std::to_string(columns) + ")");
}

struct ToPython {
    py::object operator()(std::monostate) const { return py::none(); }
    template <class Plain>
    py::object operator()(const Plain& value) const {
        return py::cast(value);
    }
    py::object operator()(const FactValue::List& list) const {
        py::list items;
        for (const FactValue& item : list) items.append(std::visit(*this, item.value));
        return items;
    }
    py::object operator()(const Facts& facts) const {
        py::dict items;
        for (const Fact& fact : facts.all()) items[py::str(fact.name)] = std::visit(*this, fact.value.value);
        return items;
    }
};

}  // namespace

py::array array_from(const py::handle& given, const Error& otherwise) {
    return or_error(
        [&] {
            py::array array(py::module_::import("numpy").attr("asarray")(given));
            if (array.dtype().kind() == 'O') raise_of_lengths(array);
            return array;
        },
        otherwise);
}

template <class T>
py::array_t<T> rows_of(const py::handle& given, py::ssize_t columns, const std::string& what) {
    const py::array array = array_of(given, std::is_integral_v<T>, what);
    check_columns(array, columns, what);
    return converted<T>(array, what);
}

template <class T>
py::array_t<T> numbers(const py::handle& given, const std::string& what) {
    const py::array array = array_of(given, std::is_integral_v<T>, what);
    if (array.ndim() != 1) throw Error(ErrorCode::InvalidInput, "has the shape " + shape_of(array), what, "(n,)");
    return converted<T>(array, what);
}

template py::array_t<double> rows_of<double>(const py::handle&, py::ssize_t, const std::string&);
template py::array_t<float> rows_of<float>(const py::handle&, py::ssize_t, const std::string&);
template py::array_t<double> numbers<double>(const py::handle&, const std::string&);
template py::array_t<float> numbers<float>(const py::handle&, const std::string&);
template py::array_t<std::int64_t> numbers<std::int64_t>(const py::handle&, const std::string&);

namespace {

/// Numbers below `end` as they are: a number that is negative or too large is named as it was given.
template <class T>
void fill_indices(const py::array& array, std::size_t end, std::size_t columns, const std::string& what, Index* to) {
    const auto numbers = converted<T>(array, what);
    const T* const from = numbers.data();
    for (std::size_t i = 0; i < static_cast<std::size_t>(numbers.size()); ++i) {
        if (!std::cmp_less(from[i], 0) && std::cmp_less(from[i], end)) {
            to[i] = static_cast<Index>(from[i]);
            continue;
        }
        throw Error(ErrorCode::InvalidInput,
                    "row " + std::to_string(i / columns) + " has the number " + std::to_string(from[i]) + "; there are " +
                        std::to_string(end) + " points",
                    what, "numbers from 0");
    }
}

}  // namespace

template <std::size_t N>
std::vector<std::array<Index, N>> index_rows(const py::handle& given, std::size_t end, const std::string& what) {
    const py::array array = array_of(given, true, what);
    check_columns(array, N, what);
    std::vector<std::array<Index, N>> rows(static_cast<std::size_t>(array.shape(0)));
    if (rows.empty()) return rows;
    Index* const to = rows.front().data();
    if (py::isinstance<py::array_t<Index>>(array)) {
        fill_indices<Index>(array, end, N, what, to);
    } else if (array.dtype().kind() == 'u') {
        fill_indices<std::uint64_t>(array, end, N, what, to);
    } else {
        fill_indices<std::int64_t>(array, end, N, what, to);
    }
    return rows;
}

template std::vector<std::array<Index, 8>> index_rows<8>(const py::handle&, std::size_t, const std::string&);
template std::vector<std::array<Index, 4>> index_rows<4>(const py::handle&, std::size_t, const std::string&);
template std::vector<std::array<Index, 3>> index_rows<3>(const py::handle&, std::size_t, const std::string&);
template std::vector<std::array<Index, 2>> index_rows<2>(const py::handle&, std::size_t, const std::string&);

void for_each_named(const py::handle& given, const std::string& what,
                    const std::function<void(const std::string& name, const py::handle& array)>& use) {
    if (!py::hasattr(given, "items")) refuse_type(what, "a dictionary of arrays by name", given);
    for (const py::handle item :
         py::list(given.attr("items")())) {  // a list: making arrays may run code that changes the mapping
        const py::sequence pair(py::reinterpret_borrow<py::object>(item));
        const py::object name = pair[0];
        if (!py::isinstance<py::str>(name)) {
            throw Error(ErrorCode::InvalidInput, "has the name " + py::repr(name).cast<std::string>() + ", which is not text",
                        what, "names such as '" + py::str(name).cast<std::string>() + "'");
        }
        const std::string text = py::str(name);
        use(text, pair[1]);
    }
}

void refuse_type(const std::string& what, const std::string& needed, const py::handle& given) {
    throw py::type_error(what + ": " + needed + " is needed, not " +
                         py::str(py::type::of(given).attr("__name__")).cast<std::string>());
}

py::array read_only(py::array array) {
    py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
    return array;
}

py::object read_only(const py::dict& items, const char* of, const char* instead) {
    return py::module_::import("subvol._read_only").attr("ReadOnlyDict")(items, of, instead);
}

std::vector<Vec3> vectors(const py::handle& given, const std::string& what) {
    const py::array_t<double> rows = rows_of<double>(given, 3, what);
    std::vector<Vec3> points(static_cast<std::size_t>(rows.shape(0)));
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    if (!points.empty()) std::memcpy(static_cast<void*>(points.data()), rows.data(), points.size() * sizeof(Vec3));
    return points;
}

py::array owned(std::vector<Vec3> values) {
    auto* kept = new std::vector<Vec3>(std::move(values));
    const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<Vec3>*>(p); });
    return py::array(py::dtype::of<double>(), std::vector<py::ssize_t>{length(kept->size()), 3},
                     reinterpret_cast<const double*>(kept->data()), owner);
}

py::array as_array(const Box& box) {
    return owned(std::vector<Vec3>{box.lower, box.upper});
}

py::dict dict_of(const Facts& facts) {
    return py::dict(ToPython{}(facts));
}

}  // namespace subvol::python
